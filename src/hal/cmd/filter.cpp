#include "hal/cmd/filter.hpp"

#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Result;

namespace {

rtapi::Failure<rtapi::Error> unknown(const char* command, std::string_view item,
                                     std::initializer_list<std::string_view> known) {
  return rtapi::fail(rtapi::Errc::bad_argument, std::string("Unknown '") + command + "' type '" +
                                                    std::string(item) + "'" +
                                                    rtapi::did_you_mean(item, known));
}

}  // namespace

Result<ShownKinds> ShownKinds::of(std::string_view item) {
  ShownKinds kinds;
  if (item.empty() || item == "all") {
    kinds = {true, true, true, false, true, true, true, true};
  } else if (item == "comp") {
    kinds.comp = true;
  } else if (item == "alias") {
    kinds.alias = true;
  } else if (item == "pin") {
    kinds.pin = true;
  } else if (item == "pinexact") {
    kinds.pinexact = true;
  } else if (item == "sig" || item == "signal") {
    kinds.sig = true;
  } else if (item == "param" || item == "parameter") {
    kinds.param = true;
  } else if (item == "funct" || item == "function") {
    kinds.funct = true;
  } else if (item == "thread") {
    kinds.thread = true;
  } else {
    return unknown("show", item,
                   {"all", "alias", "comp", "pin", "pinexact", "sig", "param", "funct", "thread"});
  }
  return kinds;
}

Result<ShownStatus> ShownStatus::of(std::string_view item) {
  if (item.empty() || item == "all") return ShownStatus{true, true, true};
  if (item == "lock") return ShownStatus{false, true, false};
  if (item == "mem") return ShownStatus{false, false, true};
  return unknown("status", item, {"all", "lock", "mem"});
}

Result<std::vector<std::string>> listed_names(const View& view, std::string_view item,
                                              std::span<const std::string> patterns) {
  KERF_TRY(const Filter f, Filter::make(patterns));
  std::vector<std::string> out;
  const auto add = [&](const std::string& name, Type type = Type::unspecified) {
    if (f.takes(name, type)) out.push_back(name);
  };
  if (item == "comp") {
    for (const auto& c : view.components()) add(c.name);
  } else if (item == "pin") {
    for (const auto& p : view.pins()) add(p.name, p.type);
  } else if (item == "sig" || item == "signal") {
    for (const auto& s : view.signals()) add(s.name, s.type);
  } else if (item == "param" || item == "parameter") {
    for (const auto& p : view.params()) add(p.name, p.type);
  } else if (item == "funct" || item == "function") {
    for (const auto& fn : view.functions()) add(fn.name);
  } else if (item == "thread") {
    for (const auto& t : view.threads()) add(t.name);
  } else {
    return unknown("list", item, {"comp", "pin", "sig", "param", "funct", "thread"});
  }
  return out;
}

}  // namespace kerf::hal
