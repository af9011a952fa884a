#include "hal/cmd/json.hpp"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "hal/cmd/filter.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

using rtapi::Result;
using Json = nlohmann::ordered_json;

namespace {

/// Names may hold bytes that are no UTF-8: they are replaced, since JSON has no others.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json value_of(Type type, std::uint64_t raw) {
  switch (type) {
    case Type::bit: return from_raw<bool>(raw);
    case Type::floating: return number(from_raw<double>(raw));
    case Type::s32: return from_raw<std::int32_t>(raw);
    case Type::s64: return from_raw<std::int64_t>(raw);
    case Type::u32:
    case Type::port: return from_raw<std::uint32_t>(raw);
    case Type::u64: return from_raw<std::uint64_t>(raw);
    default: return nullptr;
  }
}

const char* dir_word(Dir dir) {
  switch (dir) {
    case Dir::in: return "in";
    case Dir::out: return "out";
    case Dir::io: return "io";
    case Dir::ro: return "ro";
    case Dir::rw: return "rw";
    default: return "unknown";
  }
}

Json or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json component_json(const ComponentInfo& c) {
  Json out;
  out["name"] = c.name;
  out["id"] = c.id;
  out["kind"] = c.type == ComponentKind::user       ? "user"
                : c.type == ComponentKind::realtime ? "realtime"
                                                    : "other";
  out["pid"] = c.type == ComponentKind::user ? Json(c.pid) : Json();
  out["ready"] = c.ready;
  out["args"] = c.args;
  return out;
}

Json item_json(const ItemInfo& item, bool is_pin) {
  Json out;
  out["name"] = item.name;
  out["original_name"] = or_null(item.original_name);
  out["type"] = type_name(item.type);
  out["dir"] = dir_word(item.dir);
  out["value"] = value_of(item.type, item.raw);
  out["owner"] = item.owner;
  out["owner_id"] = item.owner_id;
  if (is_pin) out["signal"] = or_null(item.signal);
  return out;
}

Json signal_json(const SignalInfo& s) {
  const auto pins = [&s](Dir dir) {
    Json out = Json::array();
    for (const auto& pin : s.pins)
      if (pin.dir == dir) out.push_back(pin.name);
    return out;
  };
  Json out;
  out["name"] = s.name;
  out["type"] = type_name(s.type);
  out["value"] = value_of(s.type, s.raw);
  out["writers"] = pins(Dir::out);
  out["readers"] = pins(Dir::in);
  out["bidirs"] = pins(Dir::io);
  return out;
}

/// Where a function runs.
struct Place {
  std::string thread;
  std::size_t position{0};
};

/// Value of a function's or thread's own item, such as NAME.time; null when it is not there.
Json own_item(const View& view, const std::string& name, const char* item) {
  const auto found = view.find_item(name + "." + item);
  return found ? value_of(found->type, found->raw) : Json();
}

void put_times(Json& out, const View& view, const std::string& name) {
  out["time_ns"] = own_item(view, name, "time");
  out["tmax_ns"] = own_item(view, name, "tmax");
}

Json stats_json(const FunctionStats& stats) {
  Json out;
  out["count"] = stats.count;
  out["mean_ns"] = stats.mean_ns;
  out["p50_ns"] = stats.p50_ns;
  out["p99_ns"] = stats.p99_ns;
  out["p999_ns"] = stats.p999_ns;
  out["max_ns"] = stats.max_ns;
  out["overruns"] = stats.overruns;
  return out;
}

Json overrun_json(const LastOverrun& o) {
  Json out;
  out["cycle"] = o.cycle;
  out["took_ns"] = o.took_ns;
  out["woken_late_ns"] = o.woken_late_ns;
  out["function"] = or_null(o.function);
  out["last_function"] = or_null(o.last_function);
  out["function_ns"] = o.function_ns;
  out["function_usual_ns"] = o.function_usual_ns;
  return out;
}

using Timings = std::map<std::string, ThreadTiming>;
Timings timings_of(const View& view) {
  Timings out;
  for (auto& timing : view.timings()) {
    const std::string name = timing.name;
    out.emplace(name, std::move(timing));
  }
  return out;
}

/// Statistics of a function of a thread; null when there are none.
Json function_stats(const Timings& timings, const std::string& thread, const std::string& name) {
  const auto timing = timings.find(thread);
  if (timing == timings.end()) return {};
  for (const auto& f : timing->second.functions)
    if (f.name == name) return stats_json(f.stats);
  return {};
}

Json thread_json(const View& view, const ThreadInfo& t, const Timings& timings) {
  Json out;
  out["name"] = t.name;
  out["period_ns"] = t.period_ns;
  out["cycles"] = t.cycles;
  put_times(out, view, t.name);
  const auto timing = timings.find(t.name);
  const bool timed = timing != timings.end();
  out["timing"] = timed ? stats_json(timing->second.stats) : Json();
  out["wake_up"] = timed ? stats_json(timing->second.wake_up) : Json();
  out["last_overrun"] =
      timed && timing->second.last_overrun ? overrun_json(*timing->second.last_overrun) : Json();
  Json functions = Json::array();
  std::size_t position = 0;
  for (const auto& name : t.functions) {
    Json f;
    f["name"] = name;
    f["position"] = ++position;
    put_times(f, view, name);
    f["timing"] = function_stats(timings, t.name, name);
    functions.push_back(std::move(f));
  }
  out["functions"] = std::move(functions);
  return out;
}

Json aliases_json(const View& view, const Filter& filter) {
  Json out = Json::array();
  const auto add = [&](const std::vector<ItemInfo>& items, const char* kind) {
    for (const auto& item : items) {
      if (item.original_name.empty() || !filter.takes(item.name)) continue;
      Json one;
      one["kind"] = kind;
      one["alias"] = item.name;
      one["original_name"] = item.original_name;
      out.push_back(std::move(one));
    }
  };
  add(view.pins(), "pin");
  add(view.params(), "parameter");
  return out;
}

Json components_json(const View& view, const Filter& filter) {
  Json out = Json::array();
  for (const auto& c : view.components())
    if (filter.takes(c.name)) out.push_back(component_json(c));
  return out;
}

Json items_json(const std::vector<ItemInfo>& items, const Filter& filter, bool pins) {
  Json out = Json::array();
  for (const auto& item : items)
    if (filter.takes(item.name, item.type)) out.push_back(item_json(item, pins));
  return out;
}

Json signals_json(const View& view, const Filter& filter) {
  Json out = Json::array();
  for (const auto& s : view.signals())
    if (filter.takes(s.name, s.type)) out.push_back(signal_json(s));
  return out;
}

Json functions_json(const View& view, const Filter& filter) {
  std::map<std::string, Place> places;
  for (const auto& t : view.threads()) {
    std::size_t position = 0;
    for (const auto& name : t.functions) places[name] = {t.name, ++position};
  }
  const Timings timings = timings_of(view);
  Json out = Json::array();
  for (const auto& f : view.functions()) {
    if (!filter.takes(f.name)) continue;
    const auto place = places.find(f.name);
    Json one;
    one["name"] = f.name;
    one["owner"] = f.owner;
    one["owner_id"] = f.owner_id;
    one["users"] = f.users;
    one["thread"] = place == places.end() ? Json() : Json(place->second.thread);
    one["position"] = place == places.end() ? Json() : Json(place->second.position);
    put_times(one, view, f.name);
    one["timing"] =
        place == places.end() ? Json() : function_stats(timings, place->second.thread, f.name);
    out.push_back(std::move(one));
  }
  return out;
}

Json threads_json(const View& view, const Filter& filter) {
  const Timings timings = timings_of(view);
  Json out = Json::array();
  for (const auto& t : view.threads())
    if (filter.takes(t.name)) out.push_back(thread_json(view, t, timings));
  return out;
}

}  // namespace

Result<std::string> show_json(const View& view, std::string_view item,
                              std::span<const std::string> patterns) {
  KERF_TRY(const Filter f, Filter::make(patterns));
  KERF_TRY(const ShownKinds shown, ShownKinds::of(item));
  Json out = Json::object();
  if (shown.comp) out["components"] = components_json(view, f);
  if (shown.alias) out["aliases"] = aliases_json(view, f);
  if (shown.pin) out["pins"] = items_json(view.pins(), f, true);
  if (shown.pinexact) out["pins"] = items_json(view.pins(), f.exactly(), true);
  if (shown.sig) out["signals"] = signals_json(view, f);
  if (shown.param) out["parameters"] = items_json(view.params(), f, false);
  if (shown.funct) out["functions"] = functions_json(view, f);
  if (shown.thread) out["threads"] = threads_json(view, f);
  return text_of(out);
}

Result<std::string> list_json(const View& view, std::string_view item,
                              std::span<const std::string> patterns) {
  KERF_TRY(const auto names, listed_names(view, item, patterns));
  return text_of(Json(names));
}

Result<std::string> status_json(const View& view, std::string_view item) {
  KERF_TRY(const ShownStatus shown, ShownStatus::of(item));
  Json out = Json::object();
  if (shown.all) out["running"] = view.running();
  if (shown.all) out["timing_mode"] = timing_mode_name(view.timing_mode());
  if (shown.lock) {
    const std::uint32_t bits = view.lock_bits();
    Json lock;
    lock["bits"] = bits;
    lock["load"] = (bits & lock_load) != 0;
    lock["config"] = (bits & lock_config) != 0;
    lock["params"] = (bits & lock_params) != 0;
    lock["run"] = (bits & lock_run) != 0;
    out["lock"] = std::move(lock);
  }
  if (shown.memory) {
    const auto counts = view.counts();
    Json memory;
    memory["used_bytes"] = counts.bytes_used;
    memory["reusable_bytes"] = counts.bytes_free;
    memory["total_bytes"] = counts.bytes_total;
    const std::pair<const char*, Kind> rows[] = {
        {"components", Kind::component}, {"pins", Kind::pin},           {"parameters", Kind::param},
        {"signals", Kind::signal},       {"functions", Kind::function}, {"threads", Kind::thread}};
    for (const auto& [label, kind] : rows) {
      const auto k = static_cast<std::size_t>(kind);
      memory[label] = {{"active", counts.active[k]}, {"recycled", counts.recycled[k]}};
    }
    out["memory"] = std::move(memory);
  }
  return text_of(out);
}

std::string value_json(const std::string& name, Type type, std::uint64_t raw) {
  Json out;
  out["name"] = name;
  out["type"] = type_name(type);
  out["value"] = value_of(type, raw);
  return text_of(out);
}

std::string type_json(const std::string& name, Type type) {
  Json out;
  out["name"] = name;
  out["type"] = type_name(type);
  return text_of(out);
}

std::string error_json(const std::string& file, int line, const std::string& message) {
  Json error;
  error["file"] = file;
  error["line"] = line;
  error["message"] = message;
  Json out;
  out["error"] = std::move(error);
  return out.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace kerf::hal
