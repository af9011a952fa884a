#include "hal/cmd/save.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "hal/core/value_text.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::hal {
namespace {

constexpr std::size_t kValueWidth = 20;

std::string padded(const std::string& text) {
  return text.size() < kValueWidth ? std::string(kValueWidth - text.size(), ' ') + text : text;
}

void save_components(std::string& out, const View& view) {
  out += "# components\n";
  auto all = view.components();
  std::reverse(all.begin(), all.end());  // in the order of loading
  for (const auto& c : all) {
    if (c.type != ComponentKind::realtime) continue;
    if (!c.loaded_by_loadrt) {
      out += "#loadrt " + c.name + "  (not loaded by loadrt, no args saved)\n";
    } else {
      out += "loadrt " + c.name + (c.args.empty() ? "" : " " + c.args) + "\n";
    }
  }
}

void save_aliases(std::string& out, const View& view) {
  const auto some = [&](const char* kind, const std::vector<ItemInfo>& items) {
    out += std::string("# ") + kind + " aliases\n";
    for (const auto& i : items) {
      if (!i.original_name.empty())
        out += std::string("alias ") + kind + " " + i.original_name + " " + i.name + "\n";
    }
  };
  some("pin", view.pins());
  some("param", view.params());
}

std::string new_signal(const SignalInfo& s) {
  return "newsig " + s.name + " " + std::string(type_name(s.type)) + "\n";
}

void save_signals(std::string& out, const View& view, bool only_unlinked) {
  out += "# signals\n";
  for (const auto& s : view.signals()) {
    if (!only_unlinked || s.pins.empty()) out += new_signal(s);
  }
}

const char* arrow_from_pin(Dir dir) {
  return dir == Dir::in ? "<==" : dir == Dir::out ? "==>" : "<=>";
}
const char* arrow_to_pin(Dir dir) {
  return dir == Dir::in ? "==>" : dir == Dir::out ? "<==" : "<=>";
}

void save_links(std::string& out, const View& view, bool arrows) {
  out += "# links\n";
  for (const auto& p : view.pins()) {
    if (p.signal.empty()) continue;
    out += "linkps " + p.name + " " + (arrows ? arrow_from_pin(p.dir) : "") + " " + p.signal + "\n";
  }
}

/// newsig and linksp.
void save_nets_by_link(std::string& out, const View& view, bool arrows) {
  out += "# nets\n";
  for (const auto& s : view.signals()) {
    out += new_signal(s);
    for (const auto& p : s.pins)
      out += "linksp " + s.name + " " + (arrows ? arrow_to_pin(p.dir) : "") + " " + p.name + "\n";
  }
}

/// One line a signal. With arrows: the writer, then what reads and writes, then the readers.
void save_nets(std::string& out, const View& view, bool arrows) {
  out += "# nets\n";
  for (const auto& s : view.signals()) {
    if (s.pins.empty()) continue;
    out += "net " + s.name;
    if (!arrows) {
      for (const auto& p : s.pins) out += " " + p.name;
      out += '\n';
      continue;
    }
    bool first = true;
    bool to_readers = false;
    for (const Dir dir : {Dir::out, Dir::io, Dir::in}) {
      for (const auto& p : s.pins) {
        if (p.dir != dir) continue;
        if (!first && dir == Dir::io) out += " <=>";
        if (!first && dir == Dir::in && !to_readers) out += " =>";
        if (dir == Dir::in) to_readers = true;
        first = false;
        out += " " + p.name;
      }
    }
    out += '\n';
  }
}

std::string set_line(const ItemInfo& i) {
  return "setp " + i.name + " " + padded(value_text(i.type, i.raw)) + "\n";
}

void save_params(std::string& out, const View& view) {
  out += "# parameter values\n";
  for (const auto& p : view.params()) {
    if (p.dir == Dir::rw) out += set_line(p);
  }
}

void save_unconnected(std::string& out, const View& view) {
  out += "# unconnected pin values\n";
  for (const auto& p : view.pins()) {
    if (p.dir != Dir::out && p.signal.empty()) out += set_line(p);
  }
}

void save_threads(std::string& out, const View& view) {
  out += "# realtime thread/function links\n";
  for (const auto& t : view.threads()) {
    for (const auto& f : t.functions) out += "addf " + f + " " + t.name + "\n";
  }
}

using Part = void (*)(std::string& out, const View& view);
struct Item {
  const char* name;
  Part part;
};
constexpr Part kUnlinkedSignals = [](std::string& o, const View& v) { save_signals(o, v, true); };
constexpr Part kAllSignals = [](std::string& o, const View& v) { save_signals(o, v, false); };
constexpr Part kNetArrows = [](std::string& o, const View& v) { save_nets(o, v, true); };

constexpr Item kItems[] = {
    {"comp", save_components},
    {"alias", save_aliases},
    {"sig", kAllSignals},
    {"signal", kAllSignals},
    {"sigu", kUnlinkedSignals},
    {"link", [](std::string& o, const View& v) { save_links(o, v, false); }},
    {"linka", [](std::string& o, const View& v) { save_links(o, v, true); }},
    {"net", [](std::string& o, const View& v) { save_nets_by_link(o, v, false); }},
    {"neta", [](std::string& o, const View& v) { save_nets_by_link(o, v, true); }},
    {"netl", [](std::string& o, const View& v) { save_nets(o, v, false); }},
    {"netla", kNetArrows},
    {"netal", kNetArrows},
    {"param", save_params},
    {"parameter", save_params},
    {"unconnectedinpins", save_unconnected},
    {"thread", save_threads},
};

}  // namespace

rtapi::Result<std::string> save_text(const View& view, std::string_view item) {
  std::string out;
  if (item.empty() || item == "all" || item == "allu") {
    save_components(out, view);
    save_aliases(out, view);
    save_signals(out, view, true);
    save_nets(out, view, true);
    save_params(out, view);
    if (item == "allu") save_unconnected(out, view);
    save_threads(out, view);
    return out;
  }
  std::vector<std::string_view> known{"all", "allu"};
  for (const Item& i : kItems) {
    if (item == i.name) {
      i.part(out, view);
      return out;
    }
    known.emplace_back(i.name);
  }
  return rtapi::fail(rtapi::Errc::bad_argument, "Unknown 'save' type '" + std::string(item) + "'" +
                                                    rtapi::did_you_mean(item, known));
}

}  // namespace kerf::hal
