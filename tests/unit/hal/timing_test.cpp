// What functions and threads cost, on a counter that the functions themselves move.
#include "hal/core/timing.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "hal/cmd/timing_table.hpp"
#include "rtapi/clock/cycle_counter.hpp"
#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

using testing::HasSubstr;

rtapi::Word<std::uint64_t> ticks;

/// Runs for `cost` ns.
class Worker final : public Component<Worker> {
 public:
  static constexpr Info kInfo{.name = "worker", .summary = "Takes its time"};
  using Component::Component;

 private:
  Param<std::int32_t> cost_{param<Param<std::int32_t>>("cost", "Time of a run [ns]", 100)};
  void update(const Period&) noexcept { ticks.add(static_cast<std::uint64_t>(cost_.get())); }
  Function update_{function<&Worker::update>("", "Runs")};
};

class TimingTest : public testing::Test {
 protected:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  TimingTest() {
    ticks.set(1'000'000);
    host_->set_cycle_counter(rtapi::CycleCounter::manual(ticks));
    ok({"loadrt", "test-threads", "name1=t", "period1=" + std::to_string(kPeriodNs)});
    ok({"start"});
  }
  void load(int count) {
    ok({"loadrt", "worker", "count=" + std::to_string(count)});
    for (int i = 0; i < count; ++i) ok({"addf", "worker." + std::to_string(i), "t"});
  }
  void ok(std::initializer_list<std::string> argv) {
    const Reply reply = host_->command(argv);
    EXPECT_TRUE(reply.ok()) << reply.text;
  }
  void cycle(rtapi::Nanos late = 0) {
    now_ += kPeriodNs;
    host_->threads().at(0)->run_cycle(now_, now_ + late);
  }
  [[nodiscard]] std::string value(const std::string& name) const { return *view_.value(name); }
  [[nodiscard]] ThreadTiming timing() const { return view_.timings().at(0); }
  [[nodiscard]] FunctionStats stats(std::size_t i) const { return timing().functions.at(i).stats; }
  /// How many functions have been timed so far, each run counted.
  [[nodiscard]] std::uint64_t samples() const {
    std::uint64_t n = 0;
    for (const auto& f : timing().functions) n += f.stats.count;
    return n;
  }

  static std::span<const StaticModule> modules() {
    static const Module worker = module_of<Worker>();
    static const Module threads = module_of<TestThreads>();
    static const StaticModule table[] = {{"worker", &worker}, {"test_threads", &threads}};
    return table;
  }
  std::unique_ptr<rtapi::Segment> segment_ = rtapi::Segment::in_memory();
  ManualClock clock_;
  StaticSource modules_{modules()};
  std::unique_ptr<Host> host_ = std::move(Host::create(*segment_, clock_, modules_)).value();
  View view_{*segment_};
  rtapi::Nanos now_{0};
};

template <class Record>
void every_time_has_its_bin() {
  for (std::size_t bin = 0; bin + 1 < Record::kBins; ++bin) {
    const auto begin = Record::bin_begin(bin);
    const auto next = Record::bin_begin(bin + 1);
    ASSERT_LT(begin, next) << bin;
    EXPECT_EQ(Record::bin_of(begin), bin);
    EXPECT_EQ(Record::bin_of(next - 1), bin);
  }
}

TEST(TimingRecord, EveryTimeHasItsBin) {
  every_time_has_its_bin<TimingRecord>();
  every_time_has_its_bin<ThreadTimingRecord>();
}

TEST(TimingRecord, PercentilesAreCloseToTheTruth) {
  TimingRecord record;
  std::mt19937 random(7);
  std::lognormal_distribution<double> times(9, 0.7);
  std::vector<std::uint32_t> all;
  for (int i = 0; i < 50'000; ++i) {
    all.push_back(static_cast<std::uint32_t>(times(random)));
    record.add(all.back());
  }
  std::sort(all.begin(), all.end());
  const FunctionStats stats = record.stats(0);
  const auto near = [&](std::int64_t ns, double share, double error) {
    const double truth = all[static_cast<std::size_t>(share * static_cast<double>(all.size()))];
    EXPECT_NEAR(static_cast<double>(ns), truth, error * truth) << share;
  };
  EXPECT_EQ(stats.count, all.size());
  EXPECT_EQ(stats.max_ns, all.back());
  near(stats.p50_ns, 0.5, 0.02);
  near(stats.p99_ns, 0.99, 0.05);
  near(stats.p999_ns, 0.999, 0.1);
  EXPECT_NEAR(static_cast<double>(stats.mean_ns), std::exp(9 + 0.7 * 0.7 / 2), 500);
}

TEST(TimingRecord, TheLongestTimesCountAsTheLastBin) {
  TimingRecord record;
  record.add(UINT32_MAX);
  EXPECT_EQ(record.stats(0).max_ns, TimingRecord::kLongestNs);
  EXPECT_EQ(record.stats(0).count, 1U);
}

TEST_F(TimingTest, EveryTimesEachFunctionInEachCycle) {
  load(3);
  ok({"setp", "worker.1.cost", "250"});
  ok({"timing", "every"});
  for (int i = 0; i < 10; ++i) cycle();
  EXPECT_EQ(value("worker.0.time"), "100");
  EXPECT_EQ(value("worker.1.time"), "250");
  EXPECT_EQ(value("worker.1.tmax"), "250");
  EXPECT_EQ(value("worker.2.time"), "100");
  EXPECT_EQ(value("worker.2.tmax-increased"), "FALSE");
  EXPECT_EQ(value("t.time"), "450");
  EXPECT_EQ(value("t.tmax"), "450");
  EXPECT_EQ(samples(), 30U);
  EXPECT_EQ(timing().stats.count, 10U);
  ok({"setp", "worker.2.cost", "700"});
  cycle();
  EXPECT_EQ(value("worker.2.tmax"), "700");
  EXPECT_EQ(value("worker.2.tmax-increased"), "TRUE");
  cycle();
  EXPECT_EQ(value("worker.2.tmax-increased"), "FALSE");
  EXPECT_EQ(stats(2).max_ns, 700);
  EXPECT_NEAR(static_cast<double>(stats(1).p50_ns), 250, 32);  // the width of its bin
}

TEST_F(TimingTest, SampledTimesEachFunctionOnceInSixteenCyclesAndTheThreadAlways) {
  for (const int count : {1, 5, 16, 40, 100, 1000, 5000}) {
    SCOPED_TRACE(count);
    load(std::min(count, 4096));
    const auto functions = timing().functions.size();
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < 16; ++i) {
        const auto before = samples();
        cycle();
        EXPECT_LE(samples() - before, (functions + 15) / 16);  // one chunk
      }
    }
    EXPECT_EQ(samples(), 2 * functions);
    for (const auto& f : timing().functions) ASSERT_EQ(f.stats.count, 2U) << f.name;
    EXPECT_EQ(timing().stats.count, 32U);
    EXPECT_EQ(value("worker.0.time"), "100");
    ok({"unloadrt", "worker"});
    ok({"timing", "reset"});
  }
}

TEST_F(TimingTest, OffReadsNoClock) {
  load(3);
  ok({"timing", "off"});
  for (int i = 0; i < 20; ++i) cycle();
  EXPECT_EQ(value("worker.0.time"), "0");
  EXPECT_EQ(value("t.time"), "0");
  EXPECT_EQ(samples(), 0U);
  EXPECT_EQ(timing().stats.count, 0U);
  EXPECT_EQ(value("t.threadbeat"), "20");
}

TEST_F(TimingTest, TheModeIsSwitchedAtRunTime) {
  EXPECT_EQ(view_.timing_mode(), TimingMode::sampled);
  ok({"timing", "every"});
  EXPECT_EQ(view_.timing_mode(), TimingMode::every);
  const Reply refused = host_->command({"timing", "always"});
  EXPECT_THAT(refused.text, HasSubstr("known are every, sampled, off, reset"));
}

TEST_F(TimingTest, ResetStartsAnew) {
  load(2);
  ok({"timing", "every"});
  for (int i = 0; i < 10; ++i) cycle();
  ok({"timing", "reset"});
  EXPECT_EQ(samples(), 0U);
  EXPECT_EQ(timing().stats.count, 0U);
  ok({"setp", "worker.0.cost", "40"});
  cycle();
  EXPECT_EQ(stats(0).count, 1U);
  EXPECT_EQ(stats(0).max_ns, 40);
}

TEST_F(TimingTest, AnOverrunNamesItsFunctionAndByHowMuch) {
  load(5);
  ok({"timing", "every"});
  ok({"setp", "worker.1.cost", "600000"});  // always long: not to blame for what comes
  for (int i = 0; i < 200; ++i) cycle();
  EXPECT_FALSE(timing().last_overrun.has_value());
  ok({"setp", "worker.3.cost", "500000"});
  cycle();
  ok({"setp", "worker.3.cost", "100"});
  cycle();
  const auto last = timing().last_overrun;
  ASSERT_TRUE(last.has_value());
  EXPECT_EQ(last->cycle, 201U);
  EXPECT_EQ(last->function, "worker.3");
  EXPECT_EQ(last->last_function, "worker.3");
  EXPECT_EQ(last->function_ns, 500'000);
  EXPECT_EQ(last->function_usual_ns, 100);
  EXPECT_EQ(last->took_ns, 1'100'300);
  EXPECT_EQ(timing().stats.overruns, 1U);
  EXPECT_EQ(stats(3).overruns, 1U);
  EXPECT_EQ(stats(1).overruns, 0U);
  ok({"timing", "reset"});
  EXPECT_FALSE(timing().last_overrun.has_value());
}

TEST_F(TimingTest, SampledNamesTheFunctionAtOnceInAShortList) {
  load(12);
  for (int i = 0; i < 53; ++i) cycle();
  ok({"setp", "worker.7.cost", "2000000"});
  cycle();
  EXPECT_EQ(timing().last_overrun->function, "worker.7");
  EXPECT_EQ(timing().last_overrun->last_function, "worker.7");
  EXPECT_EQ(stats(7).overruns, 1U);
}

TEST_F(TimingTest, SampledNamesAFewFunctionsOfALongListThenTheFunction) {
  load(320);
  for (int i = 0; i < 200; ++i) cycle();
  const auto spike = [&] {
    ok({"setp", "worker.100.cost", "2000000"});
    cycle();
    ok({"setp", "worker.100.cost", "100"});
    for (int i = 0; i < 20; ++i) cycle();
  };
  cycle();  // the chunk of 100, number 5, is timed in every 16th cycle: not now
  spike();
  EXPECT_EQ(timing().last_overrun->function, "worker.100");
  EXPECT_EQ(timing().last_overrun->last_function, "worker.119");
  EXPECT_NEAR(static_cast<double>(timing().last_overrun->function_usual_ns), 2000, 2);
  EXPECT_EQ(stats(100).overruns, 0U);
  EXPECT_EQ(timing().stats.overruns, 1U);
  spike();
  EXPECT_EQ(timing().last_overrun->function, "worker.100");
  EXPECT_EQ(timing().last_overrun->last_function, "worker.100");
  EXPECT_EQ(stats(100).overruns, 1U);
  EXPECT_EQ(timing().stats.overruns, 2U);
}

TEST_F(TimingTest, ALateWakeUpIsNoFunctionsFault) {
  load(3);
  for (int i = 0; i < 40; ++i) cycle();
  cycle(kPeriodNs + 5000);
  const auto last = timing().last_overrun;
  ASSERT_TRUE(last.has_value());
  EXPECT_EQ(last->function, "");
  EXPECT_EQ(last->woken_late_ns, kPeriodNs + 5000);
  EXPECT_EQ(timing().wake_up.max_ns, kPeriodNs + 5000);
  EXPECT_LE(timing().wake_up.p50_ns, 1);
}

TEST_F(TimingTest, TheTableHasARowEachAndTheLastOverrun) {
  load(3);
  ok({"timing", "every"});
  for (int i = 0; i < 100; ++i) cycle();
  ok({"setp", "worker.1.cost", "3000000"});
  cycle();
  const std::string text = *timing_text(view_, {}, false);
  EXPECT_THAT(text, HasSubstr("Timing is every"));
  EXPECT_THAT(text, HasSubstr("t               (cycle)"));
  EXPECT_THAT(text, HasSubstr("t               (wake-up)"));
  EXPECT_THAT(text, HasSubstr("t               worker.2"));
  EXPECT_THAT(text,
              HasSubstr("thread t overran its period of 1000000 ns in cycle 101, which took "
                        "3000200 ns: function worker.1 took 3000000 ns, usually 100 ns (p99 "));
  const std::vector<std::string> patterns{"worker.2"};
  const std::string rows = *timing_text(view_, patterns, true);
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1);
  EXPECT_THAT(rows, HasSubstr("worker.2"));
  const auto json = nlohmann::json::parse(*timing_json(view_, {}));
  EXPECT_EQ(json["mode"], "every");
  EXPECT_EQ(json["threads"][0]["last_overrun"]["function"], "worker.1");
  EXPECT_EQ(json["functions"].size(), 3U);
  EXPECT_EQ(json["functions"][1]["overruns"], 1);
}

TEST_F(TimingTest, VirtualTimeHasNoCounter) {
  ok({"unloadrt", "all"});
  host_->set_cycle_counter({});
  ok({"loadrt", "test-threads", "name1=t", "period1=1000000"});
  load(3);
  ok({"timing", "every"});
  for (int i = 0; i < 20; ++i) cycle();
  EXPECT_EQ(samples(), 0U);
  EXPECT_EQ(value("t.time"), "0");
}

}  // namespace
}  // namespace kerf::hal::test
