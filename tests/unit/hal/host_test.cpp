#include "hal/loader/host.hpp"

#include <sched.h>

#include <thread>

#include "hal/client/user_component.hpp"
#include "hal/loader/realtime_host.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> pin_names(const View& view) {
  std::vector<std::string> out;
  for (const auto& p : view.pins()) out.push_back(p.name);
  return out;
}

TEST_F(HostTest, CountNamesAndDefaultMakeInstances) {
  ok({"loadrt", "adder"});
  EXPECT_THAT(pin_names(*view_), ElementsAre("adder.0.in", "adder.0.out", "adder.0.time"));
  ok({"unloadrt", "adder"});
  EXPECT_TRUE(pin_names(*view_).empty());
  ok({"loadrt", "adder", "count=2"});
  EXPECT_EQ(pin_names(*view_).size(), 6U);
  ok({"unloadrt", "adder"});
  ok({"loadrt", "adder", "names=a,b"});
  EXPECT_THAT(pin_names(*view_), ElementsAre("a.in", "a.out", "a.time", "b.in", "b.out", "b.time"));
}

TEST_F(HostTest, PersonalityGoesToEachInstance) {
  ok({"loadrt", "adder", "count=3", "personality=0x2,1"});
  EXPECT_TRUE(view_->find_pin("adder.0.x-01").has_value());
  EXPECT_TRUE(view_->find_pin("adder.1.x-00").has_value());
  EXPECT_FALSE(view_->find_pin("adder.1.x-01").has_value());
  EXPECT_FALSE(view_->find_pin("adder.2.x-00").has_value());
}

TEST_F(HostTest, TimingItemsStandBesideEachFunction) {
  ok({"loadrt", "adder"});
  EXPECT_EQ(view_->find_pin("adder.0.time")->type, Type::s32);
  EXPECT_EQ(view_->find_pin("adder.0.time")->dir, Dir::out);
  EXPECT_EQ(view_->find_param("adder.0.tmax")->dir, Dir::rw);
  EXPECT_EQ(view_->find_param("adder.0.tmax-increased")->dir, Dir::ro);
  EXPECT_EQ(view_->find_param("adder.0.tmax-increased")->type, Type::bit);
}

TEST_F(HostTest, BadLoadsSayWhatIsWrongAndLeaveNothing) {
  EXPECT_EQ(refused({"loadrt", "addr"}), "no component 'addr'; did you mean 'adder'?");
  EXPECT_EQ(refused({"loadrt", "adder", "count=1", "names=a"}),
            "adder: count= and names= are mutually exclusive");
  EXPECT_EQ(refused({"loadrt", "adder", "cuont=2"}),
            "adder: Unknown parameter `cuont=2'; did you mean 'count'?");
  EXPECT_THAT(refused({"loadrt", "adder", "count=x"}),
              HasSubstr("`x' invalid for parameter `count=x'"));
  EXPECT_THAT(refused({"loadrt", "adder", "count=-1"}), HasSubstr("count=-1"));
  EXPECT_THAT(refused({"loadrt", "adder", "names=a,,b"}), HasSubstr("empty name"));
  EXPECT_EQ(refused({"loadrt", "adder", "names=q,q"}), "adder: duplicate pin 'q.in'");
  EXPECT_THAT(refused({"loadrt", "adder", "nonsense"}), HasSubstr("Unknown parameter `nonsense'"));
  EXPECT_THAT(refused({"loadrt", "adder", "personality=9"}),
              HasSubstr("more pins than the component has room for"));
  EXPECT_THAT(refused({"loadrt", "provider", "count=1"}),
              HasSubstr("provider has one instance only"));
  EXPECT_THAT(refused({"loadrt", "faulty"}), HasSubstr("faulty"));
  EXPECT_TRUE(view_->pins().empty());
  EXPECT_TRUE(view_->params().empty());
  EXPECT_TRUE(view_->components().empty());
  EXPECT_TRUE(view_->functions().empty());
  ok({"loadrt", "faulty", "count=1"});  // the block of the failed load is free again
  ok({"loadrt", "adder"});
  EXPECT_EQ(refused({"loadrt", "adder"}), "adder: already exists");
}

// Task looks for motion's block while the HAL files are read: found half made, what it wrote there was constructed over.
TEST_F(HostTest, ABlockIsFoundOnceItsComponentIsReady) {
  bool early = true;
  BlockMaker::while_made = [&] { early = view_->find_memory("half-made").has_value(); };
  ok({"loadrt", "block_maker"});
  BlockMaker::while_made = nullptr;
  EXPECT_FALSE(early);
  EXPECT_TRUE(view_->find_memory("half-made").has_value());
  ok({"unloadrt", "block_maker"});
  EXPECT_FALSE(view_->find_memory("half-made").has_value());
}

TEST_F(HostTest, ServicesKeepTheirProviderLoaded) {
  EXPECT_EQ(refused({"loadrt", "consumer"}), "consumer: no number: load provider first");
  ok({"loadrt", "provider"});
  ok({"loadrt", "consumer"});
  EXPECT_EQ(value("consumer.value"), "42");
  EXPECT_EQ(refused({"unloadrt", "provider"}), "component 'provider' is in use by 'consumer'");
  ok({"unloadrt", "consumer"});
  ok({"unloadrt", "provider"});
  EXPECT_EQ(refused({"unloadrt", "provider"}), "component 'provider' is not loaded");
}

class ThreadTest : public HostTest {
 protected:
  ThreadTest() {
    ok({"loadrt", "test-threads", "name1=fast", "period1=1000000", "name2=slow",
        "period2=4000000"});
    ok({"loadrt", "adder", "names=a,b,c"});
    // A chain whose result shows in which order its parts run.
    ok({"net", "ab", "a.out", "b.in"});
    ok({"net", "bc", "b.out", "c.in"});
  }
  std::vector<std::string> list(const char* thread) {
    return view_->find_thread(thread)->functions;
  }
};

TEST_F(ThreadTest, FunctionsRunInTheOrderOfTheirPositions) {
  ok({"addf", "b", "fast"});
  ok({"addf", "a", "fast", "1"});
  ok({"addf", "c", "fast", "-1"});
  EXPECT_THAT(list("fast"), ElementsAre("a", "b", "c"));
  cycle();
  EXPECT_EQ(value("c.out"), "0");  // not started
  ok({"start"});
  cycle();
  EXPECT_EQ(value("c.out"), "3");
  ok({"delf", "a", "fast"});
  ok({"addf", "a", "fast", "-2"});
  EXPECT_THAT(list("fast"), ElementsAre("b", "a", "c"));
  ok({"setp", "a.in", "10"});
  cycle();
  EXPECT_EQ(value("c.out"), "3");  // b ran before a
  cycle();
  EXPECT_EQ(value("c.out"), "13");
  ok({"stop"});
  ok({"setp", "a.in", "20"});
  cycle();
  EXPECT_EQ(value("c.out"), "13");
}

TEST_F(ThreadTest, BadFunctionCommandsSayWhy) {
  EXPECT_EQ(refused({"addf", "aa", "fast"}), "function 'aa' not found; did you mean 'a'?");
  EXPECT_EQ(refused({"addf", "a", "fats"}), "thread 'fats' not found; did you mean 'fast'?");
  EXPECT_EQ(refused({"addf", "a", "fast", "0"}), "bad position: 0");
  EXPECT_EQ(refused({"addf", "a", "fast", "2"}), "position '2' is too high");
  EXPECT_EQ(refused({"addf", "a", "fast", "-2"}), "position '-2' is too low");
  EXPECT_EQ(refused({"delf", "a", "fast"}), "function 'a' is not in use");
  ok({"addf", "a", "fast"});
  EXPECT_EQ(refused({"addf", "a", "slow"}), "function 'a' may only be added to one thread");
  EXPECT_EQ(refused({"delf", "a", "slow"}), "thread 'slow' doesn't use a");
}

TEST_F(ThreadTest, UnloadingTakesFunctionsOut) {
  ok({"addf", "a", "fast"});
  ok({"start"});
  cycle();
  ok({"unloadrt", "adder"});
  EXPECT_TRUE(list("fast").empty());
  cycle();
  ok({"loadrt", "adder", "names=a"});
  ok({"addf", "a", "slow"});
  ok({"unloadrt", "all"});
  EXPECT_TRUE(host_->threads().empty());
  EXPECT_TRUE(view_->components().empty());
  EXPECT_FALSE(view_->find_pin("fast.time").has_value());
}

TEST_F(ThreadTest, ThreadsStandOnTheirOwn) {
  ok({"addf", "a", "slow"});
  ok({"start"});
  ok({"unloadrt", "test-threads"});
  EXPECT_THAT(list("slow"), ElementsAre("a"));
  cycle(1);
  EXPECT_EQ(value("a.out"), "1");
  EXPECT_EQ(value("slow.threadbeat"), "1");
  // More of them, as often as one likes, but none that is faster.
  EXPECT_EQ(refused({"loadrt", "test-threads", "name1=fast", "period1=5000000"}),
            "test-threads: duplicate component '__fast'");
  EXPECT_THAT(refused({"loadrt", "test-threads", "name1=x", "period1=500000"}),
              HasSubstr("new thread period 500000 is less than the period"));
  ok({"loadrt", "test-threads", "name1=x", "period1=5000000"});
  EXPECT_EQ(host_->threads().size(), 3U);
  // The thread's own component ends it; its functions are free again.
  EXPECT_EQ(refused({"unloadrt", "__slov"}),
            "component '__slov' is not loaded; did you mean '__slow'?");
  ok({"unloadrt", "__slow"});
  EXPECT_FALSE(view_->find_thread("slow").has_value());
  EXPECT_FALSE(view_->find_component("__slow").has_value());
  ok({"addf", "a", "x"});
  EXPECT_TRUE(host_->registry().check_invariants().ok());
}

TEST_F(ThreadTest, AThreadOfAComponentWithFunctionsGoesWithIt) {
  ok({"loadrt", "adder-thread"});
  ok({"addf", "a", "own"});
  ok({"unloadrt", "adder-thread"});
  EXPECT_FALSE(view_->find_thread("own").has_value());
  ok({"addf", "a", "fast"});
}

/// Never ends a cycle: as a function that waits for what never comes.
class HungDriver final : public HostDriver {
 public:
  bool wait_for_threads(int attempt) override { return attempt < 5; }
};

TEST_F(ThreadTest, AHungFunctionIsNamedAndNothingIsTakenFromUnderIt) {
  HungDriver driver;
  ok({"unloadrt", "test-threads"});
  host_->set_driver(&driver);
  ok({"addf", "a", "fast"});
  auto& record = host_->threads().at(0)->record();
  record.ticking.publish(1);
  record.running.set(segment_->offset_of(host_->registry().find_function("a")));
  for (const char* what : {"adder", "__fast", "all"}) {
    EXPECT_EQ(refused({"unloadrt", what}),
              "thread 'fast' does not end its cycle; it is in function 'a'");
    EXPECT_TRUE(view_->find_component("adder").has_value());
    EXPECT_FALSE(view_->functions().empty());
  }
  EXPECT_TRUE(view_->find_thread("fast").has_value());
  record.ticking.publish(0);
  ok({"unloadrt", "all"});
  host_->set_driver(nullptr);
}

TEST_F(ThreadTest, ManyInstancesAndFunctions) {
  constexpr int kMany = 10'000;
  ok({"unloadrt", "adder"});
  ok({"loadrt", "adder", "count=" + std::to_string(kMany)});
  for (int i = 0; i < kMany; ++i) ok({"addf", "adder." + std::to_string(i), "fast"});
  ok({"start"});
  cycle();
  EXPECT_EQ(value("adder.9999.out"), "1");
  EXPECT_TRUE(host_->registry().check_invariants().ok());
  ok({"unloadrt", "adder"});
  EXPECT_TRUE(list("fast").empty());
  EXPECT_THAT(refused({"loadrt", "adder", "count=100001"}), HasSubstr("between 0 and 100000"));
}

TEST_F(ThreadTest, VirtualTimeCostsNothingAndShowsNothing) {
  ok({"addf", "a", "fast"});
  ok({"start"});
  for (int i = 0; i < 5; ++i) cycle();
  EXPECT_EQ(value("a.time"), "0");
  EXPECT_EQ(value("a.tmax"), "0");
  EXPECT_EQ(value("fast.time"), "0");
  EXPECT_EQ(value("fast.threadbeat"), "5");
  EXPECT_EQ(view_->find_thread("fast")->cycles, 5U);
}

/// Runs the first thread's cycles without pause, as a realtime thread beside the commands would.
class Spinner final : public HostDriver {
 public:
  void start(ThreadRunner& runner) {
    runner_ = &runner;
    runner.record().ticking.publish(1);
    thread_ = std::thread([this] {
      for (rtapi::Nanos t = 0; !stop_.requested(); t += runner_->period_ns()) {
        runner_->run_cycle(t, t);
        ::sched_yield();
      }
    });
  }
  void stop() {
    stop_.request();
    thread_.join();
    runner_->record().ticking.publish(0);
  }
  /// Returns after two more cycles have begun and one of them has ended.
  void let_run() const {
    const auto before = runner_->record().cycles.observe();
    while (runner_->record().cycles.observe() < before + 2) ::sched_yield();
  }
  bool wait_for_threads(int attempt) override {
    ::sched_yield();
    return attempt < 10'000'000;
  }

 private:
  ThreadRunner* runner_{nullptr};
  rtapi::StopWord stop_;
  std::thread thread_;
};

TEST_F(ThreadTest, ListsAreSwappedUnderARunningThread) {
  Spinner spinner;
  host_->set_driver(&spinner);
  ok({"addf", "a", "fast"});
  ok({"start"});
  spinner.start(*host_->threads().at(0));
  for (int i = 0; i < 300; ++i) {
    ok({"addf", "b", "fast", i % 2 == 0 ? "1" : "-1"});
    ok({"addf", "c", "fast", "-2"});
    ok({"unlinkp", "b.in"});
    ok({"net", "ab", "b.in"});
    ok({"delf", "b", "fast"});
    ok({"delf", "c", "fast"});
    if (i % 3 == 0) spinner.let_run();
    if (i % 10 != 0) continue;
    ok({"loadrt", "provider"});
    ok({"unloadrt", "provider"});
    ok({"unloadrt", "adder"});  // while `a` runs
    ok({"loadrt", "adder", "names=a,b,c"});
    ok({"net", "ab", "a.out", "b.in"});
    ok({"addf", "a", "fast"});
  }
  spinner.let_run();
  spinner.stop();
  host_->set_driver(nullptr);
  EXPECT_EQ(value("a.out"), "1");
}

TEST_F(ThreadTest, ThreadsShowAsComponentsOfTheirOwn) {
  EXPECT_EQ(view_->find_pin("fast.time")->owner, "__fast");
  EXPECT_EQ(view_->find_pin("fast.threadbeat")->type, Type::s64);
  EXPECT_TRUE(view_->find_component("__slow")->ready);
}

TEST_F(HostTest, SlowerThreadsComeAfterFasterOnes) {
  EXPECT_THAT(refused({"loadrt", "test-threads", "name1=a", "period1=2000000", "name2=b",
                       "period2=1000000"}),
              HasSubstr("new thread period 1000000 is less than the period 2000000 of thread 'a'"));
  EXPECT_THAT(refused({"loadrt", "test-threads", "name1=a", "period1=10"}),
              HasSubstr("period 10 ns"));
  EXPECT_TRUE(view_->components().empty());
  EXPECT_TRUE(view_->threads().empty());
}

TEST_F(ThreadTest, TheParticipantRunsCyclesOnTime) {
  rtapi::LocalScheduler scheduler;
  RealtimeHost participant(*host_);
  scheduler.add(participant);
  ok({"addf", "a", "fast"});
  scheduler.run_until(10 * rtapi::kMillisecond);
  EXPECT_EQ(view_->find_thread("fast")->cycles, 0U);
  ok({"start"});
  scheduler.run_until(20 * rtapi::kMillisecond);
  EXPECT_EQ(value("fast.threadbeat"), "10");
  EXPECT_EQ(value("slow.threadbeat"), "3");  // at 12, 16 and 20 ms
  ok({"stop"});
  scheduler.run_until(30'500'000);
  ok({"start"});
  scheduler.run_until(31 * rtapi::kMillisecond);
  EXPECT_EQ(value("fast.threadbeat"), "11");
  scheduler.remove(participant);
}

TEST_F(HostTest, LockForbidsAndUnlockAllows) {
  ok({"loadrt", "adder"});
  ok({"lock", "all"});
  EXPECT_THAT(refused({"net", "s", "adder.0.in"}), HasSubstr("HAL is locked"));
  EXPECT_THAT(refused({"setp", "adder.0.in", "1"}), HasSubstr("HAL is locked"));
  EXPECT_THAT(refused({"loadrt", "provider"}), HasSubstr("HAL is locked"));
  EXPECT_THAT(refused({"start"}), HasSubstr("HAL is locked"));
  ok({"unlock", "tune"});
  ok({"setp", "adder.0.in", "1"});
  EXPECT_THAT(refused({"net", "s", "adder.0.in"}), HasSubstr("HAL is locked"));
  ok({"unlock"});
  ok({"net", "s", "adder.0.in"});
}

TEST_F(HostTest, UnlockTuneUndoesLockTune) {
  ok({"loadrt", "adder"});
  ok({"lock", "tune"});
  EXPECT_THAT(refused({"net", "s", "adder.0.in"}), HasSubstr("HAL is locked"));
  ok({"unlock", "tune"});
  ok({"net", "s", "adder.0.in"});
  ok({"unlock", "tune"});
  ok({"unlinkp", "adder.0.in"});
}

TEST_F(HostTest, WordsAreCounted) {
  EXPECT_EQ(refused({"setp", "x"}), "setp requires 2 arguments, 1 given");
  EXPECT_EQ(refused({"loadrt"}), "loadrt requires at least 1 arguments, 0 given");
  EXPECT_EQ(refused({"addf", "a", "b", "c", "d"}), "addf requires at most 3 arguments, 4 given");
  EXPECT_EQ(refused({"lodart"}), "Unknown command 'lodart'; did you mean 'loadrt'?");
  EXPECT_EQ(refused({"newsig", "s", "int"}),
            "Unknown signal type 'int'; known are bit, float, s32, u32, s64, u64, port");
}

TEST_F(HostTest, UserComponentsComeAndGoWithTheirClient) {
  ok({"loadrt", "adder"});
  LocalSession session(*host_, 7);
  {
    UserComponent comp(session, "iocontrol.0");
    auto in = comp.pin<LinkIn<std::int32_t>>("in");
    auto out = comp.pin<LinkOut<double>>("out", 2.5);
    auto param = comp.param<LinkParam<bool>>("flag", true);
    EXPECT_FALSE(view_->find_component("iocontrol.0")->ready);
    ASSERT_TRUE(comp.ready().ok());
    EXPECT_TRUE(view_->find_component("iocontrol.0")->ready);
    EXPECT_EQ(value("iocontrol.0.out"), "2.5");
    EXPECT_EQ(value("iocontrol.0.flag"), "TRUE");
    ok({"net", "s", "adder.0.out", "iocontrol.0.in"});
    ok({"loadrt", "test-threads", "name1=t", "period1=1000000"});
    ok({"addf", "adder.0", "t"});
    ok({"start"});
    cycle();
    EXPECT_EQ(in.get(), 1);
    out = 3;
    EXPECT_EQ(value("iocontrol.0.out"), "3");
    (void)comp.pin<LinkIn<bool>>("late");
    EXPECT_TRUE(comp.failed());
    (void)param;
  }
  EXPECT_FALSE(view_->find_component("iocontrol.0").has_value());
  EXPECT_EQ(view_->find_signal("s")->readers, 0U);

  UserComponent second(session, "u");
  (void)second.pin<LinkIn<bool>>("x");
  UserComponent clash(session, "u");
  EXPECT_EQ(clash.ready().error().message(), "duplicate component name 'u'");
  LocalSession stranger(*host_, 8);
  EXPECT_FALSE((*stranger.request({"pin-new", "u", "u.y", "bit", "IN"})).ok());
  host_->client_gone(7);
  EXPECT_TRUE(view_->find_pin("adder.0.in").has_value());
  EXPECT_FALSE(view_->find_pin("u.x").has_value());
}

}  // namespace
}  // namespace kerf::hal::test
