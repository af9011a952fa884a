#include "hal/loader/thread_runner.hpp"

#include <algorithm>

namespace kerf::hal {
namespace {

std::int32_t clamped_ns(rtapi::Nanos ns) noexcept {
  return ns > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(ns);
}

/// The mean of about the last 16, times 16.
std::uint64_t moved(std::uint64_t mean16, std::uint64_t value) noexcept {
  return mean16 + value - (mean16 >> 4U);
}

/// Calls the functions from `e` to `end`. What they need lies in rows, which the processor fetches ahead by itself.
inline void call_all(Word<Offset>& running, const RunEntry* e, const RunEntry* end,
                     const Period& period) noexcept {
  for (; e != end; ++e) {
    running.set(e->record_offset);
    e->thunk(e->object, period);
  }
}

/// After a pause other programs' data stands in the caches. The times of functions lie apart, so the processor is told of them so many
/// functions ahead.
constexpr std::size_t kAhead = 16;

inline void fetch_times(FunctionRecord* record) noexcept {
  __builtin_prefetch(&record->times, 1);
  // The bins of most functions.
  __builtin_prefetch(reinterpret_cast<const std::byte*>(&record->times) + 64, 1);
}

inline void call(Word<Offset>& running, const RunEntry& entry, const Period& period) noexcept {
  running.set(entry.record_offset);
  entry.thunk(entry.object, period);
}

}  // namespace

void ThreadRunner::run_cycle(rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept {
  if (root_.running.get() != 0) {
    Period period{record_.period_ns, record_.period_ns};
    const bool real = static_cast<bool>(counter_);
    if (real && last_ != 0) period.actual_ns = actual - last_;
    last_ = actual;
    if (const RunList* list = list_.observe(); list != nullptr) {
      const auto mode = static_cast<TimingMode>(root_.timing_mode.get());
      if (real && mode != TimingMode::off) {
        run_timed(*list, period, mode, scheduled, actual);
      } else {
        run_plain(*list, period);
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

void ThreadRunner::run_plain(const RunList& list, const Period& period) noexcept {
  call_all(record_.running, list.entries, list.entries + list.count, period);
}

void ThreadRunner::run_timed(const RunList& list, const Period& period, TimingMode mode,
                             rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept {
  const std::uint32_t epoch = root_.timing_epoch.get();
  const std::uint64_t begin = counter_.ticks();
  Timed timed{list, period, epoch, begin, {}};
  const std::uint64_t cycle = record_.cycles.get();
  const std::size_t count = list.count;
  if (mode == TimingMode::every || cycle < watched_until_) {
    time_each(timed, 0, count);
  } else {
    const std::size_t length = std::max<std::size_t>((count + kChunks - 1) / kChunks, 1);
    if (usual_count_ != count) {
      usual_count_ = count;
      for (auto& usual16 : usual16_) usual16 = 0;
    }
    const std::size_t turn = cycle % kSampledEvery;
    for (std::size_t i = turn * length; i < std::min(turn * length + kAhead, count); ++i)
      fetch_times(segment_.at<FunctionRecord>(list.entries[i].record_offset));
    std::size_t chunk = 0;
    for (std::size_t first = 0; first < count; first += length, ++chunk) {
      const std::size_t end = std::min(first + length, count);
      if (chunk == turn)
        time_each(timed, first, end);
      else
        time_together(timed, first, end, usual16_[chunk]);
    }
  }
  const rtapi::Nanos took = counter_.ns(timed.last - begin);
  const std::int32_t shown = clamped_ns(took);
  const rtapi::Nanos woken_late = std::max<rtapi::Nanos>(actual - scheduled, 0);
  record_.timing.follow(epoch);
  record_.timing.add(static_cast<std::uint32_t>(shown));
  record_.wake_up.follow(epoch);
  record_.wake_up.add(static_cast<std::uint32_t>(clamped_ns(woken_late)));
  items_.time = shown;
  if (shown > items_.tmax.get()) items_.tmax = shown;
  if (woken_late + took > record_.period_ns) [[unlikely]]
    note_overrun(list, timed.suspect, took, woken_late);
}

void ThreadRunner::time_each(Timed& timed, std::size_t first, std::size_t end) noexcept {
  if (first == end) return;
  // Copies: what the functions write must not make the compiler read these again.
  const rtapi::CycleCounter counter = counter_;
  const std::uint32_t epoch = timed.epoch;
  const RunEntry* const entries = timed.list.entries;
  std::byte* const base = segment_.base();
  const auto record_of = [base](const RunEntry& entry) __attribute__((always_inline)) {
    return reinterpret_cast<FunctionRecord*>(base + entry.record_offset);
  };
  std::uint64_t last = timed.last;
  std::uint64_t excess = timed.suspect.excess;
  const auto book = [&](std::size_t i, std::uint64_t took) __attribute__((always_inline)) {
    FunctionTimes& times = record_of(entries[i])->times;
    TimingRecord& record = record_of(entries[i])->timing;
    record.follow(epoch);
    const std::uint64_t usual16 = record.usual16.get();
    record.usual16.set(moved(usual16, took));
    if (took > (usual16 >> 4U) + excess) [[unlikely]] {
      excess = took - (usual16 >> 4U);
      timed.suspect = {excess, took, usual16 >> 4U, 1, i};
    }
    const std::int32_t ns = clamped_ns(counter.ns(took));
    record.add(static_cast<std::uint32_t>(ns));
    times.time = ns;
    const bool longer = ns > times.tmax.get();
    if (longer) [[unlikely]]
      times.tmax = ns;
    if (times.tmax_increased.last() != longer) [[unlikely]]
      times.tmax_increased = longer;
  };
  // The processor's counter waits for all that comes before it, but not for what follows. So a function's time is put down only
  // after the next one's end was read: the work is done while the counter is being read, and costs next to nothing.
  call(record_.running, entries[first], timed.period);
  std::uint64_t now = counter.ticks();
  std::uint64_t took = now - last;
  last = now;
  for (std::size_t i = first + 1; i < end; ++i) {
    fetch_times(record_of(entries[std::min(i + kAhead, end - 1)]));
    call(record_.running, entries[i], timed.period);
    now = counter.ticks();
    book(i - 1, took);
    took = now - last;
    last = now;
  }
  book(end - 1, took);
  timed.last = last;
}

void ThreadRunner::time_together(Timed& timed, std::size_t first, std::size_t end,
                                 std::uint64_t& usual16) noexcept {
  const RunEntry* const entries = timed.list.entries;
  call_all(record_.running, entries + first, entries + end, timed.period);
  const std::uint64_t now = counter_.ticks();
  const std::uint64_t took = now - timed.last;
  timed.last = now;
  const std::uint64_t usual = usual16 >> 4U;
  if (took > usual + timed.suspect.excess) [[unlikely]]
    timed.suspect = {took - usual, took, usual, static_cast<std::uint32_t>(end - first), first};
  usual16 = moved(usual16, took);
}

void ThreadRunner::note_overrun(const RunList& list, const Suspect& suspect, rtapi::Nanos took,
                                rtapi::Nanos woken_late) noexcept {
  record_.timing.blame();
  watched_until_ = record_.cycles.get() + 1 + kWatchedCycles;
  Overrun overrun;
  overrun.cycle = record_.cycles.get() + 1;
  overrun.took_ns = took;
  overrun.woken_late_ns = woken_late;
  if (suspect.functions > 0 && counter_.ns(suspect.excess) > woken_late) {
    auto* record = segment_.at<FunctionRecord>(list.entries[suspect.first].record_offset);
    overrun.function = list.entries[suspect.first].record_offset;
    overrun.last_function = list.entries[suspect.first + suspect.functions - 1].record_offset;
    overrun.functions = suspect.functions;
    overrun.function_ns = static_cast<std::uint32_t>(clamped_ns(counter_.ns(suspect.took)));
    overrun.function_usual_ns = static_cast<std::uint32_t>(clamped_ns(counter_.ns(suspect.usual)));
    if (suspect.functions == 1) {
      record->timing.follow(root_.timing_epoch.get());
      record->timing.blame();
    }
  }
  record_.overrun.write(overrun);
}

}  // namespace kerf::hal
