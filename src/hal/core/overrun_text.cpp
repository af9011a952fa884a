#include "hal/core/overrun_text.hpp"

namespace kerf::hal {

namespace {
std::string ns(std::int64_t value) { return std::to_string(value) + " ns"; }
}  // namespace

std::string overrun_text(const ThreadTiming& timing) {
  if (!timing.last_overrun) return {};
  const auto& last = *timing.last_overrun;
  const std::string head = "thread " + timing.name + " ";
  const std::string cycle = "cycle " + std::to_string(last.cycle);
  if (last.function.empty()) {
    return head + "was woken " + ns(last.woken_late_ns) + " late in " + cycle + ", its period is " +
           ns(timing.period_ns) + ": the machine was busy otherwise";
  }
  const bool exact = last.function == last.last_function;
  std::string text = head + "overran its period of " + ns(timing.period_ns) + " in " + cycle +
                     ", which took " + ns(last.took_ns) + ": ";
  text += exact ? "function " + last.function
                : "the functions " + last.function + " to " + last.last_function;
  text += " took " + ns(last.function_ns) + ", usually " + ns(last.function_usual_ns);
  if (exact && last.function_stats.count > 1)
    text += " (p99 " + ns(last.function_stats.p99_ns) + ")";
  if (!exact) text += "; for a while each is timed in every cycle, see 'halcmd timing'";
  return text;
}

}  // namespace kerf::hal
