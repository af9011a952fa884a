#include <gtest/gtest.h>

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
  const char* running{"slow-function"};
};

void cycle(void* self, Nanos, Nanos actual) noexcept {
  auto* counter = static_cast<Counter*>(self);
  if (counter->cycles.add(1) == 5) {
    while (monotonic_now() - actual < 5 * kMillisecond) {
    }
    counter->slow.set(1);
  }
}

TEST(CyclicThread, RunsAndReportsAnOverrunWithItsFunction) {
  Counter counter;
  CyclicThread::Config config;
  config.name = "test";
  config.period_ns = kMillisecond;
  config.cycle = &cycle;
  config.self = &counter;
  config.breadcrumb = &counter.running;
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
  EXPECT_STREQ(stats.last_overrun_in, "slow-function");
  EXPECT_GE(stats.execution.max_ns, 5 * kMillisecond);
  const auto cycles = counter.cycles.get();
  EXPECT_EQ(cycles, stats.execution.count);
}

TEST(Rights, SaysWhatIsMissing) {
  const RightsReport report = acquire_realtime_rights();
  EXPECT_EQ(report.text.empty(), report.scheduler && report.locked_memory && report.preempt_rt);
}

}  // namespace
}  // namespace kerf::rtapi
