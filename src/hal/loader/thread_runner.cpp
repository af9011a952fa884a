#include "hal/loader/thread_runner.hpp"

namespace kerf::hal {
namespace {

std::int32_t clamped(rtapi::Nanos ns) noexcept {
  return ns > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(ns);
}

}  // namespace

void ThreadRunner::run_cycle(rtapi::Nanos /*scheduled*/, rtapi::Nanos actual) noexcept {
  if (root_.running.get() != 0) {
    Period period{record_.period_ns, record_.period_ns};
    if (timed_ && last_ != 0) period.actual_ns = actual - last_;
    last_ = actual;
    if (const RunList* list = list_.observe(); list != nullptr) {
      if (timed_) {
        run_timed(*list, period);
      } else {
        for (std::size_t i = 0; i < list->count; ++i) {
          const RunEntry& e = list->entries[i];
          record_.running.set(e.record_offset);
          e.thunk(e.object, period);
        }
      }
    }
    record_.running.set(0);
    items_.threadbeat = items_.threadbeat.last() + 1;
  } else {
    last_ = 0;
  }
  // Release: whoever sees the count may reuse what this cycle has used.
  record_.cycles.publish(record_.cycles.get() + 1);
}

void ThreadRunner::run_timed(const RunList& list, const Period& period) noexcept {
  const rtapi::Nanos begin = clock_.now();
  rtapi::Nanos last = begin;
  std::int32_t longest = -1;
  for (std::size_t i = 0; i < list.count; ++i) {
    RunEntry e = list.entries[i];
    record_.running.set(e.record_offset);
    e.thunk(e.object, period);
    const rtapi::Nanos now = clock_.now();
    const std::int32_t took = clamped(now - last);
    last = now;
    if (took > longest) {
      longest = took;
      slowest_ = e.record->name.c_str();
    }
    e.time = took;
    const bool longer = took > e.tmax.get();
    if (longer) e.tmax = took;
    e.tmax_increased = longer;
  }
  const std::int32_t took = clamped(last - begin);
  items_.time = took;
  if (took > items_.tmax.get()) items_.tmax = took;
}

}  // namespace kerf::hal
