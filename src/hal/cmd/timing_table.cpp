#include "hal/cmd/timing_table.hpp"

#include <cinttypes>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "hal/cmd/filter.hpp"
#include "hal/core/overrun_text.hpp"

namespace kerf::hal {

using rtapi::Result;

namespace {

using Json = nlohmann::ordered_json;

/// Calls `visit(thread, function or null)`; null for the thread itself, if its name matches.
template <class F>
void each(const View& view, const Filter& filter, F&& visit) {
  auto threads = view.timings();
  // Fastest first, as they were made.
  for (auto it = threads.rbegin(); it != threads.rend(); ++it) {
    const bool whole = filter.takes(it->name);
    if (whole) visit(*it, nullptr);
    for (const auto& function : it->functions)
      if (whole || filter.takes(function.name)) visit(*it, &function);
  }
}

double share_of_period(const FunctionStats& stats, std::int64_t period_ns) {
  return period_ns == 0 ? 0
                        : 100 * static_cast<double>(stats.mean_ns) / static_cast<double>(period_ns);
}

void put_row(std::string& out, const ThreadTiming& thread, const char* function,
             const FunctionStats& s) {
  char line[512];
  const int n = std::snprintf(line, sizeof line,
                              "%-15s %-40s %10" PRIu64 " %9" PRId64 " %9" PRId64 " %9" PRId64
                              " %9" PRId64 " %7.3f %8" PRIu32 "\n",
                              thread.name.c_str(), function, s.count, s.p50_ns, s.p99_ns, s.p999_ns,
                              s.max_ns, share_of_period(s, thread.period_ns), s.overruns);
  if (n > 0) out.append(line, std::min(static_cast<std::size_t>(n), sizeof line - 1));
}

const char* explained(TimingMode mode) {
  switch (mode) {
    case TimingMode::off: return "Timing is off: 'timing sampled' or 'timing every' starts it.";
    case TimingMode::sampled: return "Timing is sampled: each function in every 16th cycle.";
    case TimingMode::every: return "Timing is every: each function in every cycle.";
  }
  return "";
}

Json stats_json(const FunctionStats& s, std::int64_t period_ns) {
  return {{"count", s.count},
          {"mean_ns", s.mean_ns},
          {"p50_ns", s.p50_ns},
          {"p99_ns", s.p99_ns},
          {"p999_ns", s.p999_ns},
          {"max_ns", s.max_ns},
          {"period_percent", share_of_period(s, period_ns)},
          {"overruns", s.overruns}};
}

}  // namespace

Result<std::string> timing_text(const View& view, std::span<const std::string> patterns,
                                bool script) {
  const Filter filter{Type::unspecified, patterns, false};
  std::string out;
  if (!script) {
    out += explained(view.timing_mode());
    out += " Times in ns.\n";
    char line[256];
    std::snprintf(line, sizeof line, "%-15s %-40s %10s %9s %9s %9s %9s %7s %8s\n", "Thread",
                  "Function", "Count", "p50", "p99", "p99.9", "Max", "Period%", "Overruns");
    out += line;
  }
  std::string remarks;
  each(view, filter, [&](const ThreadTiming& thread, const FunctionTiming* function) {
    if (function != nullptr) return put_row(out, thread, function->name.c_str(), function->stats);
    put_row(out, thread, "(cycle)", thread.stats);
    put_row(out, thread, "(wake-up)", thread.wake_up);
    if (const auto text = overrun_text(thread); !text.empty()) remarks += text + "\n";
  });
  if (!script) {
    if (!remarks.empty()) out += "\nLast overruns:\n" + remarks;
    out += '\n';
  }
  return out;
}

Result<std::string> timing_json(const View& view, std::span<const std::string> patterns) {
  const Filter filter{Type::unspecified, patterns, false};
  Json out;
  out["mode"] = timing_mode_name(view.timing_mode());
  out["threads"] = Json::array();
  out["functions"] = Json::array();
  each(view, filter, [&](const ThreadTiming& thread, const FunctionTiming* function) {
    if (function != nullptr) {
      Json row = {{"name", function->name}, {"thread", thread.name}};
      row.update(stats_json(function->stats, thread.period_ns));
      out["functions"].push_back(std::move(row));
      return;
    }
    Json row = {{"name", thread.name}, {"period_ns", thread.period_ns}};
    row.update(stats_json(thread.stats, thread.period_ns));
    row["wake_up"] = stats_json(thread.wake_up, thread.period_ns);
    if (const auto& last = thread.last_overrun) {
      row["last_overrun"] = {
          {"cycle", last->cycle},
          {"took_ns", last->took_ns},
          {"woken_late_ns", last->woken_late_ns},
          {"function", last->function.empty() ? Json() : Json(last->function)},
          {"last_function", last->last_function.empty() ? Json() : Json(last->last_function)},
          {"function_ns", last->function_ns},
          {"function_usual_ns", last->function_usual_ns}};
    } else {
      row["last_overrun"] = nullptr;
    }
    out["threads"].push_back(std::move(row));
  });
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace kerf::hal
