#include <gtest/gtest.h>

#include "rtapi/clock/cycle_counter.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/real_clock.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/thread/cyclic_thread.hpp"

namespace kerf::rtapi {
namespace {

TEST(Timing, Histogram) {
  Timing t;
  t.add(500);
  t.add(3000);
  t.add(1'000'000'000);
  EXPECT_EQ(t.count, 3U);
  EXPECT_EQ(t.min_ns, 500);
  EXPECT_EQ(t.max_ns, 1'000'000'000);
  EXPECT_EQ(t.bins[0], 1U);
  EXPECT_EQ(t.bins[1], 1U);
  EXPECT_EQ(t.bins[15], 1U);
}

struct Counter {
  Word<std::uint64_t> cycles{0};
  Word<std::uint32_t> slow{0};
};

void cycle(void* self, Nanos, Nanos actual) noexcept {
  auto* counter = static_cast<Counter*>(self);
  // All cycles from the fifth on, so that the last overrun is one of them: a busy machine may wake a quick one too late.
  if (counter->cycles.add(1) < 5) return;
  while (monotonic_now() - actual < 5 * kMillisecond) {
  }
  counter->slow.set(1);
}

TEST(CyclicThread, RunsAndCountsAnOverrun) {
  Counter counter;
  CyclicThread::Config config;
  config.name = "test";
  config.period_ns = kMillisecond;
  config.cycle = &cycle;
  config.self = &counter;
  CyclicThread thread(config);
  ASSERT_TRUE(thread.start().ok());
  auto clock = make_real_clock();
  // Up to 20 s: only a machine that does not run the thread at all fails here.
  for (int i = 0; i < 20000 && (counter.slow.get() == 0 || counter.cycles.get() < 8); ++i) {
    WaitSpec spec;
    spec.until = clock->now() + kMillisecond;
    clock->wait(spec);
  }
  thread.stop();
  const ThreadStats stats = thread.stats();
  EXPECT_GE(stats.execution.count, 8U);
  EXPECT_GE(stats.overruns, 1U);
  EXPECT_GE(stats.last_overrun_ns, 5 * kMillisecond);
  EXPECT_GE(stats.execution.max_ns, 5 * kMillisecond);
  const auto cycles = counter.cycles.get();
  EXPECT_EQ(cycles, stats.execution.count);
}

TEST(CycleCounter, KeepsPaceWithTheClock) {
  for (const auto& counter : {CycleCounter::calibrated(), CycleCounter::monotonic()}) {
    ASSERT_TRUE(static_cast<bool>(counter));
    auto clock = make_real_clock();
    const Nanos before = clock->now();
    const std::uint64_t begin = counter.ticks();
    const Nanos after_begin = clock->now();
    WaitSpec spec;
    spec.until = after_begin + 50 * kMillisecond;
    clock->wait(spec);
    const Nanos before_end = clock->now();
    const std::uint64_t end = counter.ticks();
    const Nanos after = clock->now();
    // What is read stands between two readings of the clock, however long each takes.
    const auto counted = static_cast<double>(counter.ns(end - begin));
    EXPECT_LE(counted, static_cast<double>(after - before) * 1.002);
    EXPECT_GE(counted, static_cast<double>(before_end - after_begin) * 0.998);
  }
}

TEST(CycleCounter, IsNothingAtFirstAndManualInTests) {
  EXPECT_FALSE(static_cast<bool>(CycleCounter()));
  Word<std::uint64_t> word{7};
  const auto counter = CycleCounter::manual(word);
  EXPECT_EQ(counter.ticks(), 7U);
  EXPECT_EQ(counter.ns(1000), 1000);
  EXPECT_EQ(counter.ns(UINT64_MAX), UINT32_MAX);
  EXPECT_FALSE(counter.is_processors());
}

TEST(Rights, SaysWhatIsMissing) {
  const RightsReport report = acquire_realtime_rights();
  EXPECT_EQ(report.text.empty(), report.scheduler && report.locked_memory && report.preempt_rt);
}

}  // namespace
}  // namespace kerf::rtapi
