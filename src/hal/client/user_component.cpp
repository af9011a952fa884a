#include "hal/client/user_component.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>

#include "hal/core/records.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {
namespace {

/// As parse_value reads it back, bit by bit.
std::string exact_text(Type type, std::uint64_t raw) {
  if (type != Type::floating) return plain_value_text(type, raw);
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", from_raw<double>(raw));
  return text;
}

}  // namespace

UserComponent::UserComponent(Session& session, std::string_view name)
    : session_(session), name_(name) {
  auto made = ask(session_, {"comp-new", name_});
  if (made.ok())
    present_ = true;
  else
    status_ = rtapi::Failure{made.error()};
}

UserComponent::~UserComponent() { leave(); }

void UserComponent::leave() {
  if (present_) (void)session_.request({"comp-exit", name_});
  present_ = false;
}

SlotRef UserComponent::add(const char* command, std::string_view suffix, Type type, Dir dir,
                           std::uint64_t raw, bool whole) {
  if (status_.ok()) {
    const std::string full = whole ? std::string(suffix) : name_ + "." + std::string(suffix);
    auto made = ask(session_, {command, name_, full, std::string(type_name(type)),
                               std::string(dir_name(dir)), exact_text(type, raw)});
    if (made.ok()) {
      const std::uint64_t link = std::strtoull(made->c_str(), nullptr, 10);
      return slot_at(session_.segment(), link);
    }
    status_ = rtapi::Failure{made.error()};
  }
  dummy_[0] = sizeof(std::uint64_t);
  return {slot_link(dummy_)};
}

rtapi::Status UserComponent::ready() {
  if (!status_.ok()) return status_;
  auto done = ask(session_, {"comp-ready", name_});
  if (!done.ok()) status_ = rtapi::Failure{done.error()};
  return status_;
}

}  // namespace kerf::hal
