#include "hal/cmd/show.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdarg>
#include <cstdio>

#include "hal/cmd/filter.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

using rtapi::Result;

namespace {

[[gnu::format(printf, 2, 3)]] void put(std::string& out, const char* fmt, ...) {
  char line[512];
  std::va_list args;
  va_start(args, fmt);
  const int n = std::vsnprintf(line, sizeof line, fmt, args);
  va_end(args);
  if (n > 0) out.append(line, std::min(static_cast<std::size_t>(n), sizeof line - 1));
}

const char* arrow(Dir dir) {
  switch (dir) {
    case Dir::in: return "<==";
    case Dir::out: return "==>";
    default: return "<=>";
  }
}
/// Seen from the signal.
const char* pin_arrow(Dir dir) {
  switch (dir) {
    case Dir::in: return "==>";
    case Dir::out: return "<==";
    default: return "<=>";
  }
}

void show_components(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Loaded HAL Components:\n";
    put(out, "ID      Type  %-*s PID   State\n", static_cast<int>(kNameLength), "Name");
  }
  for (const auto& c : view.components()) {
    if (!filter.takes(c.name)) continue;
    char pid[24] = "";
    if (c.type == ComponentKind::user) std::snprintf(pid, sizeof pid, "%" PRId64, c.pid);
    const char* type = c.type == ComponentKind::user       ? "User"
                       : c.type == ComponentKind::realtime ? "RT"
                                                           : "Other";
    put(out, "%6" PRIu32 "  %-4s  %-*s %5s %s\n", c.id, type, static_cast<int>(kNameLength),
        c.name.c_str(), pid, c.ready ? "ready" : "initializing");
  }
  out += '\n';
}

void show_pins(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Component Pins:\n";
    put(out, "Owner   Type  Dir%22s  Name\n", "Value");
  }
  for (const auto& p : view.pins()) {
    if (!filter.takes(p.name, p.type)) continue;
    const std::string type(type_name(p.type));
    const std::string dir(dir_name(p.dir));
    if (script) {
      put(out, "%s %-5s %s %s %s", p.owner.c_str(), type.c_str(), dir.c_str(),
          plain_value_text(p.type, p.raw).c_str(), p.name.c_str());
    } else {
      put(out, "%6" PRIu32 "  %-5s %-3s%22s  %s", p.owner_id, type.c_str(), dir.c_str(),
          value_text(p.type, p.raw).c_str(), p.name.c_str());
    }
    if (!p.signal.empty()) put(out, " %s %s", arrow(p.dir), p.signal.c_str());
    out += '\n';
  }
  out += '\n';
}

void show_params(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Parameters:\n";
    put(out, "Owner   Type  Dir%22s  Name\n", "Value");
  }
  for (const auto& p : view.params()) {
    if (!filter.takes(p.name, p.type)) continue;
    const std::string type(type_name(p.type));
    const std::string dir(dir_name(p.dir));
    if (script) {
      put(out, "%s %-5s %s %s %s\n", p.owner.c_str(), type.c_str(), dir.c_str(),
          plain_value_text(p.type, p.raw).c_str(), p.name.c_str());
    } else {
      put(out, "%6" PRIu32 "  %-5s %-3s%22s  %s\n", p.owner_id, type.c_str(), dir.c_str(),
          value_text(p.type, p.raw).c_str(), p.name.c_str());
    }
  }
  out += '\n';
}

void show_signals(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Signals:\n";
    put(out, "Type %22s  Name     (linked to)\n", "Value");
  }
  for (const auto& s : view.signals()) {
    if (!filter.takes(s.name, s.type)) continue;
    const std::string type(type_name(s.type));
    if (script) {
      put(out, "%-5s  %s  %s", type.c_str(), plain_value_text(s.type, s.raw).c_str(),
          s.name.c_str());
      for (const auto& pin : s.pins) put(out, " %s %s", pin_arrow(pin.dir), pin.name.c_str());
      out += '\n';
      continue;
    }
    put(out, "%-5s%22s  %s\n", type.c_str(), value_text(s.type, s.raw).c_str(), s.name.c_str());
    for (const auto& pin : s.pins)
      put(out, "%33s%s %s\n", "", pin_arrow(pin.dir), pin.name.c_str());
  }
  out += '\n';
}

/// Either name may match.
void show_aliases(std::string& out, const char* title, const std::vector<ItemInfo>& items,
                  const Filter& filter, bool script) {
  if (!script) {
    put(out, "%s Aliases:\n", title);
    put(out, " %-*s  %s\n", static_cast<int>(kNameLength), "Alias", "Original Name");
  }
  for (const auto& i : items) {
    if (i.original_name.empty()) continue;
    if (!filter.takes(i.name, i.type) && !filter.takes(i.original_name, i.type)) continue;
    if (script)
      put(out, " %s  %s\n", i.name.c_str(), i.original_name.c_str());
    else
      put(out, " %-*s  %s\n", static_cast<int>(kNameLength), i.name.c_str(),
          i.original_name.c_str());
  }
  out += '\n';
}

void show_functions(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Exported Functions:\n";
    out += "Owner   CodeAddr      Arg           FP   Users   Name\n";
  }
  for (const auto& f : view.functions()) {
    if (!filter.takes(f.name)) continue;
    if (script) {
      put(out, "%s %012" PRIx64 " %012" PRIx64 " %s %3" PRIu32 " %s\n", f.owner.c_str(), f.code,
          f.argument, "YES", f.users, f.name.c_str());
    } else {
      put(out, " %05" PRIu32 "  %012" PRIx64 "  %012" PRIx64 "  %-3s  %5" PRIu32 "   %s\n",
          f.owner_id, f.code, f.argument, "YES", f.users, f.name.c_str());
    }
  }
  out += '\n';
}

std::int64_t item_value(const View& view, const std::string& name) {
  const auto item = view.find_item(name);
  return item ? from_raw<std::int64_t>(item->raw) : 0;
}

void show_threads(std::string& out, const View& view, const Filter& filter, bool script) {
  if (!script) {
    out += "Realtime Threads:\n";
    out += "     Period  FP     Name               (     Time, Max-Time )\n";
  }
  for (const auto& t : view.threads()) {
    if (!filter.takes(t.name)) continue;
    const std::int64_t time = item_value(view, t.name + ".time");
    const std::int64_t tmax = item_value(view, t.name + ".tmax");
    if (script) {
      put(out, "%" PRId64 " %s %s %8" PRId64 " %" PRId64, t.period_ns, "YES", t.name.c_str(), time,
          tmax);
      for (const auto& f : t.functions) put(out, " %s", f.c_str());
      out += '\n';
      continue;
    }
    put(out, "%11" PRId64 "  %-3s  %20s ( %8" PRId64 ", %8" PRId64 " )\n", t.period_ns, "YES",
        t.name.c_str(), time, tmax);
    int position = 1;
    for (const auto& f : t.functions) put(out, "                 %2d %s\n", position++, f.c_str());
  }
  out += '\n';
}

}  // namespace

Result<std::string> show_text(const View& view, std::string_view item,
                              std::span<const std::string> patterns, bool script) {
  KERF_TRY(const Filter f, Filter::make(patterns));
  KERF_TRY(const ShownKinds shown, ShownKinds::of(item));
  std::string out;
  if (shown.comp) show_components(out, view, f, script);
  if (shown.pinexact) show_pins(out, view, f.exactly(), script);
  if (shown.pin) show_pins(out, view, f, script);
  if (shown.alias) show_aliases(out, "Pin", view.pins(), f, script);
  if (shown.sig) show_signals(out, view, f, script);
  if (shown.param) show_params(out, view, f, script);
  if (shown.alias) show_aliases(out, "Parameter", view.params(), f, script);
  if (shown.funct) show_functions(out, view, f, script);
  if (shown.thread) show_threads(out, view, f, script);
  return out;
}

Result<std::string> list_text(const View& view, std::string_view item,
                              std::span<const std::string> patterns) {
  KERF_TRY(const auto names, listed_names(view, item, patterns));
  std::string out;
  for (const auto& name : names) out += name + " ";
  return out + "\n";
}

Result<std::string> status_text(const View& view, std::string_view item) {
  KERF_TRY(const ShownStatus shown, ShownStatus::of(item));
  std::string out;
  if (shown.lock) {
    const std::uint32_t bits = view.lock_bits();
    out += "HAL locking status:\n";
    put(out, "  current lock value %" PRIu32 " (%02" PRIx32 ")\n", bits, bits);
    if (bits == lock_none) out += "  HAL_LOCK_NONE - nothing is locked\n";
    if ((bits & lock_load) != 0)
      out += "  HAL_LOCK_LOAD    - loading of new components is locked\n";
    if ((bits & lock_config) != 0) out += "  HAL_LOCK_CONFIG  - link and addf is locked\n";
    if ((bits & lock_params) != 0) out += "  HAL_LOCK_PARAMS  - setting params is locked\n";
    if ((bits & lock_run) != 0) out += "  HAL_LOCK_RUN     - running/stopping HAL is locked\n";
  }
  if (shown.memory) {
    const auto counts = view.counts();
    out += "HAL memory status\n";
    put(out, "  used/total shared memory:   %" PRIu64 "/%" PRIu64 "\n", counts.bytes_used,
        counts.bytes_total);
    std::uint32_t aliases = 0;
    for (const auto& items : {view.pins(), view.params()}) {
      aliases += static_cast<std::uint32_t>(std::count_if(
          items.begin(), items.end(), [](const ItemInfo& i) { return !i.original_name.empty(); }));
    }
    const std::pair<const char*, Kind> rows[] = {
        {"components:", Kind::component}, {"pins:", Kind::pin},
        {"parameters:", Kind::param},     {"aliases:", Kind::none},
        {"signals:", Kind::signal},       {"functions:", Kind::function},
        {"threads:", Kind::thread}};
    for (const auto& [label, kind] : rows) {
      const auto k = static_cast<std::size_t>(kind);
      const std::uint32_t active = kind == Kind::none ? aliases : counts.active[k];
      const std::uint32_t recycled = kind == Kind::none ? 0 : counts.recycled[k];
      put(out, "  active/recycled %-11s %" PRIu32 "/%" PRIu32 "\n", label, active, recycled);
    }
  }
  return out;
}

}  // namespace kerf::hal
