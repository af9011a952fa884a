// motmod as loadrt sees it: parameters, pins, and one move from the path ring to motor-pos-cmd.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "hal/switch_off.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/api/shared.hpp"
#include "motion/motmod/read_orders.hpp"
#include "rtapi/clock/clock.hpp"

extern "C" const kerf::hal::Module kerf_hal_module_motmod;
extern "C" const kerf::hal::Module kerf_hal_module_trivkins;

namespace kerf::motion {
namespace {

struct Shell {
  hal::TestBuilder hal;
  std::uint64_t seq{0};

  explicit Shell(const std::string& coordinates = "xyz", int joints = 3) {
    hal.set_arg("coordinates", coordinates);
    EXPECT_TRUE(hal.create(kerf_hal_module_trivkins, "trivkins")) << hal.error();
    hal.set_arg("num_joints", std::to_string(joints));
  }
  bool load() { return hal.create(kerf_hal_module_motmod, "motmod"); }
  MotionShared& shared() { return *reinterpret_cast<MotionShared*>(hal.block(kMotionBlock)); }
  MotionStatus status() {
    MotionStatus s;
    EXPECT_TRUE(shared().status.read(s));
    return s;
  }
  void configure(double units_per_mm = 1, std::vector<int> axes = {0, 1, 2}) {
    MachineConfig c;
    c.joints = 3;
    c.axis_mask = 0;
    for (std::size_t j = 0; j < axes.size(); ++j) {
      c.axis_mask |= 1U << static_cast<unsigned>(axes[j]);
    }
    c.traj_max_ang_vel_deg_s = 1000;
    c.linear_units_per_mm = units_per_mm;
    c.traj_max_vel_mm_s = 1000;
    for (auto& j : c.joint) {
      j = JointConfig{.min_limit = -500, .max_limit = 500, .max_vel = 100, .max_acc = 1000};
      j.ferror = j.min_ferror = 10;
    }
    for (std::size_t j = 0; j < axes.size(); ++j) c.joint[j].rotary = axes[j] > 2 && axes[j] < 6;
    for (auto& a : c.axis)
      a = AxisConfig{.min_limit = -500, .max_limit = 500, .max_vel = 100, .max_acc = 1000};
    shared().config.write(c);
  }
  void plan() {
    for (rtapi::Participant* p : hal.participants()) {
      rtapi::WaitSpec next;
      do {
        next = {};
        p->step(hal.clock().now(), next);
      } while (next.until <= hal.clock().now());
    }
  }
  /// One instant: participants, then the servo functions; motors follow. `between`: the planner has its turn between these, as it
  /// may when it runs beside them.
  void cycle(bool between = false) {
    shared().intent.heartbeat.add(1);
    if (!between) plan();
    hal.run("motion-command-handler");
    if (between) plan();
    hal.run("motion-controller");
    for (int j = 0; j < 3; ++j) {
      const std::string joint = "joint." + std::to_string(j) + ".";
      hal.set(joint + "motor-pos-fb", hal.get<double>(joint + "motor-pos-cmd"));
    }
  }
  void run(int n) {
    for (int i = 0; i < n; ++i) cycle();
  }
  void push(PathItems::Variant body) {
    PathItem item;
    item.epoch = shared().intent.abort_epoch.get();
    item.seq = ++seq;
    item.tag.line = static_cast<int>(seq);
    item.body = body;
    ASSERT_TRUE(shared().path.push(item));
    shared().path_cell.notify();
  }
  void ready() {
    Intent i;
    shared().intent.enable.set(1);
    run(2);
    i.home_seq = 1;
    for (int j = 0; j < 3; ++j) i.home_joint = -1;
    shared().intent.values.write(i);
    run(10);
    i.mode = MotionMode::coordinated;
    shared().intent.values.write(i);
    run(3);
  }
};

/// Whenever the planner runs: a move is watched by the limits that it was planned with.
TEST(Motmod, NewLimitsMeetNoMoveOfTheOldOnes) {
  for (const bool between : {false, true}) {
    Shell s;
    ASSERT_TRUE(s.load()) << s.hal.error();
    s.configure();
    s.ready();
    MachineConfig slow;
    ASSERT_TRUE(s.shared().config.read(slow));
    for (auto& j : slow.joint) j.max_vel = 10, j.max_acc = 100;
    for (auto& a : slow.axis) a.max_vel = 10, a.max_acc = 100;
    const auto peak_to = [&](double x) {
      double peak = 0;
      s.push(LinearMove{.end = {.x = x}, .vel_mm_s = 1000});
      for (int i = 0; i < 8000; ++i) {
        s.cycle(between);
        peak = std::max(peak, std::abs(s.status().joint[0].vel_cmd));
      }
      EXPECT_NEAR(s.status().pos_cmd.x, x, 1e-9);
      return peak;
    };
    s.shared().config.write(slow);
    const double first = peak_to(30);
    EXPECT_TRUE(std::abs(first - 10) < 0.01 || std::abs(first - 100) < 0.1) << first;
    EXPECT_NEAR(peak_to(0), 10, 0.01);
    EXPECT_EQ(s.status().faults, 0U) << "planner " << (between ? "between" : "before");
  }
}

TEST(Motmod, NeedsKinematics) {
  hal::TestBuilder hal;
  EXPECT_FALSE(hal.create(kerf_hal_module_motmod, "motmod"));
  EXPECT_NE(hal.error().find("loadrt trivkins"), std::string::npos) << hal.error();
}

TEST(Motmod, RefusesParametersOutOfRange) {
  const auto error = [](const char* name, const char* value, const char* name2 = nullptr,
                        const char* value2 = nullptr) {
    Shell s;
    s.hal.set_arg(name, value);
    if (name2 != nullptr) s.hal.set_arg(name2, value2);
    EXPECT_FALSE(s.load());
    return s.hal.error();
  };
  EXPECT_EQ(error("num_dio", "65"), "MOTION: num_dio is 65, must be between 1 and 64");
  EXPECT_EQ(error("num_joints", "17"), "MOTION: num_joints is 17, must be between 1 and 16");
  EXPECT_EQ(error("num_dio", "3", "names_din", "a,b"),
            "MOTION: Can't specify both names and number for digital pins");
  EXPECT_EQ(error("num_aio", "3", "names_aout", "a"),
            "MOTION: Can't specify both names and number for analog pins");
  EXPECT_EQ(error("num_extrajoints", "1"),
            "MOTION: nonzero num_extrajoints requires KINEMATICS_BOTH");
  EXPECT_NE(error("num_spindles", "x").find("not an integer"), std::string::npos);
}

TEST(Motmod, MakesThreads) {
  Shell s;
  s.hal.set_arg("base_period_nsec", "50000");
  s.hal.set_arg("servo_period_nsec", "1000000");
  ASSERT_TRUE(s.load()) << s.hal.error();
  ASSERT_EQ(s.hal.threads().size(), 2U);
  EXPECT_EQ(s.hal.threads()[0].name, "base-thread");
  EXPECT_EQ(s.hal.threads()[1].name, "servo-thread");
  Shell one;
  ASSERT_TRUE(one.load());
  EXPECT_EQ(one.hal.threads().size(), 1U);
}

TEST(Motmod, PinsHaveTheirDocumentedNamesAndDefaults) {
  Shell s;
  ASSERT_TRUE(s.load()) << s.hal.error();
  for (const char* name :
       {"motion.enable", "motion.digital-in-00", "motion.digital-out-03", "motion.analog-in-03",
        "motion.analog-out-00", "motion.interp.arc-center-z", "motion.tooloffset.w",
        "motion.servo.last-period", "spindle.0.speed-out-rps-abs", "spindle.0.index-enable",
        "joint.2.motor-pos-cmd", "joint.0.wheel-jog-active", "axis.w.eoffset-request",
        "axis.x.teleop-vel-lim", "motion.debug-bit-1", "tc.3.vel", "traj.active_tc"})
    EXPECT_TRUE(s.hal.has(name)) << name;
  EXPECT_FALSE(s.hal.has("motion.digital-in-04"));
  EXPECT_FALSE(s.hal.has("joint.3.pos-cmd"));
  EXPECT_FALSE(s.hal.has("spindle.1.on"));
  EXPECT_TRUE(s.hal.get<bool>("motion.enable"));
  EXPECT_TRUE(s.hal.get<bool>("spindle.0.at-speed"));
  EXPECT_EQ(s.hal.get<double>("motion.adaptive-feed"), 1);
  EXPECT_EQ(s.hal.get<double>("joint.1.jog-accel-fraction"), 1);
  for (const std::string& name : s.hal.items()) EXPECT_GT(s.hal.doc(name).size(), 5U) << name;
}

TEST(Motmod, NamedInputsComeFirstAndNumbersFillUp) {
  Shell s;
  s.hal.set_arg("names_din", "a,b,c");
  s.hal.set_arg("names_dout", "x");
  s.hal.set_arg("names_misc_errors", "hot");
  s.hal.set_arg("unlock_joints_mask", "0x2");
  ASSERT_TRUE(s.load()) << s.hal.error();
  for (const char* name :
       {"motion.din-a", "motion.din-c", "motion.dout-x", "motion.digital-out-00",
        "motion.digital-out-01", "motion.err-hot", "joint.1.unlock", "joint.1.is-unlocked"})
    EXPECT_TRUE(s.hal.has(name)) << name;
  EXPECT_FALSE(s.hal.has("motion.digital-in-00"));
  EXPECT_FALSE(s.hal.has("motion.digital-out-02"));
}

TEST(Motmod, RunsAMoveFromTheRingToTheMotor) {
  Shell s;
  ASSERT_TRUE(s.load()) << s.hal.error();
  s.configure(1 / 25.4);  // an inch machine
  s.ready();
  EXPECT_TRUE(s.hal.get<bool>("motion.motion-enabled"));
  EXPECT_TRUE(s.hal.get<bool>("motion.coord-mode"));
  EXPECT_TRUE(s.hal.get<bool>("joint.0.amp-enable-out"));
  LinearMove m;
  m.end = {.x = 25.4, .y = 12.7};
  m.vel_mm_s = 25.4;
  s.push(OutputChange{.index = 1, .synchronised = true, .value = 1});
  s.push(m);
  s.run(300);
  EXPECT_TRUE(s.hal.get<bool>("motion.digital-out-01"));
  EXPECT_NEAR(s.hal.get<double>("motion.current-vel"), 1, 1e-9);
  EXPECT_NEAR(s.hal.get<double>("motion.feed-mm-per-second"), 25.4, 1e-9);
  EXPECT_EQ(s.hal.get<std::int32_t>("motion.motion-type"), 2);
  EXPECT_EQ(s.hal.get<std::int32_t>("motion.program-line"), 2);
  const std::uint64_t told = s.shared().status_cell.count();
  s.run(1000);
  EXPECT_NEAR(s.hal.get<double>("joint.0.motor-pos-cmd"), 1.0, 1e-12)
      << "pins are in machine units";
  EXPECT_NEAR(s.hal.get<double>("axis.y.pos-cmd"), 0.5, 1e-12);
  EXPECT_EQ(s.status().executed_seq, 2U);
  EXPECT_GT(s.shared().status_cell.count(), told);
  EXPECT_LT(s.shared().status_cell.count(), told + 5) << "told of changes, not of cycles";
}

TEST(Motmod, WhoWaitsForALaterItemIsNotToldOfEach) {
  constexpr int kMoves = 200;
  std::uint64_t told[2];
  for (const bool awaits : {false, true}) {
    Shell s;
    ASSERT_TRUE(s.load()) << s.hal.error();
    s.configure();
    s.ready();
    for (int i = 1; i <= kMoves; ++i) {
      LinearMove m;
      m.end = {.x = 0.1 * i};
      m.vel_mm_s = 50;  // 2 ms each
      s.push(m);
    }
    s.shared().awaited_seq.set(awaits ? kMoves - 10 : 0);
    told[awaits ? 1 : 0] = s.shared().status_cell.count();
    bool in_time = false;
    for (int i = 0; i < 2000 && s.status().executed_seq < kMoves; ++i) {
      const std::uint64_t before = s.shared().status_cell.count(), done = s.status().executed_seq;
      s.cycle();
      if (done < kMoves - 10 && s.status().executed_seq >= kMoves - 10)
        in_time = s.shared().status_cell.count() > before;
    }
    told[awaits ? 1 : 0] = s.shared().status_cell.count() - told[awaits ? 1 : 0];
    EXPECT_TRUE(in_time) << "of the end of what it waits for at once";
    EXPECT_EQ(s.status().executed_seq, static_cast<std::uint64_t>(kMoves));
  }
  EXPECT_GT(told[0], 150U);
  EXPECT_LT(told[1], 120U);
}

TEST(Motmod, DegreesOfAnInchMachineAreDegrees) {
  Shell s("xya");
  ASSERT_TRUE(s.load()) << s.hal.error();
  s.configure(1 / 25.4, {0, 1, 3});
  s.ready();
  LinearMove m;
  m.end = {.a = 90};
  m.vel_mm_s = 30;
  s.push(m);
  s.run(300);
  EXPECT_NEAR(s.hal.get<double>("motion.current-vel"), 30, 1e-9);
  EXPECT_NEAR(s.hal.get<double>("motion.requested-vel"), 30, 1e-9);
  EXPECT_NEAR(s.hal.get<double>("motion.feed-upm"), 1800, 1e-9);
  EXPECT_NEAR(s.hal.get<double>("motion.interp.feedrate"), 1800, 1e-9);
  EXPECT_NEAR(s.hal.get<double>("motion.distance-to-go"), 90 - s.hal.get<double>("axis.a.pos-cmd"),
              1e-9);
}

/// The status has room for more than most machines have; what is there is told up to the last one.
TEST(Motmod, TellsOfAllJointsSpindlesAndOutputs) {
  for (const bool most : {false, true}) {
    const int joints = most ? 16 : 3, spindles = most ? 8 : 1, io = most ? 64 : 4;
    Shell s("xyz", joints);
    s.hal.set_arg("num_spindles", std::to_string(spindles));
    s.hal.set_arg("num_aio", std::to_string(io));
    ASSERT_TRUE(s.load()) << s.hal.error();
    s.configure();
    for (int j = 0; j < joints; ++j)
      s.hal.set("joint." + std::to_string(j) + ".motor-pos-fb", 1.0 + j);
    for (int n = 0; n < spindles; ++n)
      s.hal.set("spindle." + std::to_string(n) + ".revs", 100.0 + n);
    for (int i = 0; i < io; ++i)
      s.hal.set(std::string("motion.analog-in-") + (i < 10 ? "0" : "") + std::to_string(i),
                200.0 + i);
    Intent intent;
    intent.wishes = 1;
    for (int i = 0; i < io; ++i) intent.analog_out[i].wish(300.0 + i);
    s.shared().intent.values.write(intent);
    s.hal.run("motion-command-handler");
    s.hal.run("motion-controller");
    s.hal.run("motion-controller");
    const MotionStatus status = s.status();
    EXPECT_EQ(status.cycle, 2U);
    for (int j = 0; j < static_cast<int>(kMaxJoints); ++j) {
      EXPECT_EQ(status.joint[j].pos_fb, j < joints ? 1.0 + j : 0.0) << j;
      EXPECT_TRUE(status.joint[j].active);
    }
    for (int n = 0; n < static_cast<int>(kMaxSpindles); ++n) {
      EXPECT_EQ(status.spindle[n].revs, n < spindles ? 100.0 + n : 0.0) << n;
      EXPECT_TRUE(status.spindle[n].brake);
    }
    for (int i = 0; i < static_cast<int>(kMaxAnalog); ++i) {
      EXPECT_EQ(status.analog_in[i], i < io ? 200.0 + i : 0.0) << i;
      EXPECT_EQ(status.analog_out[i], i < io ? 300.0 + i : 0.0) << i;
    }
    EXPECT_EQ(status.joints, joints);
    EXPECT_EQ(status.analog_count, io);
  }
}

TEST(Motmod, FaultsGoToTheLog) {
  Shell s;
  ASSERT_TRUE(s.load());
  s.configure();
  s.ready();
  LinearMove m;
  m.end = {.x = 501};
  m.vel_mm_s = 10;
  s.push(m);
  s.run(5);
  EXPECT_EQ(s.shared().faults.newest.observe(), 1U);
  FaultRecord r;
  ASSERT_TRUE(s.shared().faults.slot[1].read(r));
  EXPECT_EQ(r.fault, Fault::axis_soft_limit_max);
  EXPECT_TRUE(s.hal.get<bool>("motion.coord-error"));
  s.shared().intent.abort_epoch.add(1);
  s.run(3);
  EXPECT_FALSE(s.hal.get<bool>("motion.coord-error"));
}

TEST(Motmod, ThePlannerSleepsWhenThereIsNothingToDo) {
  Shell s;
  ASSERT_TRUE(s.load());
  s.configure();
  s.ready();
  LinearMove m;
  m.end = {.x = 100};
  m.vel_mm_s = 10;
  s.push(m);
  s.run(10);
  // In the middle of a move no cell that the planner watches changes.
  rtapi::WaitSpec next;
  s.hal.participants().at(0)->step(s.hal.clock().now(), next);
  EXPECT_EQ(next.until, rtapi::kForever);
  for (int i = 0; i < 100; ++i) {
    s.shared().intent.heartbeat.add(1);
    s.hal.run("motion-command-handler");
    s.hal.run("motion-controller");
    for (const char* j : {"joint.0.motor-pos-"})
      s.hal.set(std::string(j) + "fb", s.hal.get<double>(std::string(j) + "cmd"));
  }
  for (const rtapi::CellWatch& w : next.cells) EXPECT_EQ(w.cell->count(), w.seen);
}

/// An intent cell in which task aborts between the reader's first word of the three and the next.
struct AbortingCell {
  struct Word {
    const AbortingCell* cell;
    std::uint32_t before, after;
    [[nodiscard]] std::uint32_t get() const { return cell->aborted++ == 0 ? before : after; }
    [[nodiscard]] std::uint32_t observe() const { return get(); }
  };
  struct Beat {
    [[nodiscard]] std::uint64_t get() const { return 0; }
    [[nodiscard]] std::uint64_t observe() const { return 0; }
  };
  mutable int aborted{0};
  struct Epoch {
    const AbortingCell* cell;
    [[nodiscard]] std::uint32_t get() const { return cell->aborted++ == 0 ? 1 : 2; }
    [[nodiscard]] std::uint32_t observe() const { return get(); }
  };
  Beat heartbeat;
  Word hold{this, 1, 0}, enable{this, 1, 0};
  Epoch abort_epoch{this};
};

TEST(Motmod, AnAbortIsSeenByWhoeverSeesTheHoldTakenAway) {
  Orders orders;
  const AbortingCell cell;
  read_orders(cell, orders);
  EXPECT_TRUE(orders.hold || orders.abort_epoch == 2) << "the old path would run on for a cycle";
  EXPECT_EQ(orders.abort_epoch, 2U);
}

TEST(Motmod, StaysOffOnceItsSupervisorIsDead) {
  Shell s;
  ASSERT_TRUE(s.load()) << s.hal.error();
  s.configure();
  s.shared().intent.enable.set(1);
  s.run(5);
  ASSERT_TRUE(s.status().enabled);
  const auto* off = static_cast<const hal::SwitchOff*>(s.hal.find_service(hal::kSwitchOff));
  ASSERT_NE(off, nullptr);
  off->now(off->machine);
  s.cycle();
  EXPECT_FALSE(s.status().enabled) << "in the very next cycle";
  // Task may live on for a moment, and somebody may press its button.
  for (std::uint32_t request = 2; request < 6; ++request) {
    s.shared().intent.enable.set(request);
    s.run(5);
    EXPECT_FALSE(s.status().enabled) << "request " << request;
  }
}

/// The handshakes of homing by their pins: unlock, index-enable, lock.
TEST(Motmod, HomesAnIndexerToTheIndexOfItsEncoder) {
  Shell s;
  s.hal.set_arg("unlock_joints_mask", "0x2");
  ASSERT_TRUE(s.load()) << s.hal.error();
  s.configure();
  MachineConfig c;
  ASSERT_TRUE(s.shared().config.read(c));
  c.joint[1].home_flags = home_use_index | home_unlock_first;
  c.joint[1].home_latch_vel = 5;
  c.joint[1].home_offset = c.joint[1].home = 3;
  s.shared().config.write(c);
  s.shared().intent.enable.set(1);
  s.run(2);
  Intent i;
  i.home_seq = 1;
  i.home_joint = 1;
  s.shared().intent.values.write(i);
  s.run(3);
  EXPECT_TRUE(s.hal.get<bool>("joint.1.unlock"));
  EXPECT_FALSE(s.hal.get<bool>("joint.1.index-enable"));
  EXPECT_EQ(s.hal.get<double>("joint.1.motor-pos-cmd"), 0) << "locked";
  s.hal.set("joint.1.is-unlocked", true);
  s.run(100);
  EXPECT_TRUE(s.hal.get<bool>("joint.1.index-enable"));
  EXPECT_GT(s.hal.get<double>("joint.1.motor-pos-cmd"), 0.1);
  s.hal.set("joint.1.index-enable", false);
  s.hal.set("joint.1.motor-pos-fb", 0.004);
  s.run(400);
  EXPECT_FALSE(s.hal.get<bool>("joint.1.unlock"));
  EXPECT_FALSE(s.hal.get<bool>("joint.1.homed")) << "before it is locked";
  s.hal.set("joint.1.is-unlocked", false);
  s.run(2);
  EXPECT_TRUE(s.hal.get<bool>("joint.1.homed"));
  EXPECT_NEAR(s.hal.get<double>("joint.1.motor-pos-cmd"), 0, 1e-9) << "on its index";
  EXPECT_FALSE(s.hal.get<bool>("joint.1.index-enable"));
}

TEST(Trivkins, LettersMayComeAgain) {
  Shell s("xyyz", 4);
  const auto* k = static_cast<const Kinematics*>(s.hal.find_service(kKinematicsService));
  ASSERT_NE(k, nullptr);
  EXPECT_EQ(k->joints(), 4);
  EXPECT_EQ(k->axis_of_joint(2), 1);
  EXPECT_EQ(k->axis_mask(), 7U);
  JointVector q{};
  ASSERT_TRUE(k->inverse({.x = 1, .y = 2, .z = 3}, q));
  EXPECT_EQ(q[2], 2);
  EXPECT_EQ(q[3], 3);
  Pose p{.a = 9};
  ASSERT_TRUE(k->forward(q, p));
  EXPECT_EQ(p, (Pose{.x = 1, .y = 2, .z = 3, .a = 9}));
}

TEST(Trivkins, TypesAndErrors) {
  const auto type = [](const char* text) {
    hal::TestBuilder hal;
    hal.set_arg("kinstype", text);
    if (!hal.create(kerf_hal_module_trivkins, "trivkins")) return -1;
    return static_cast<int>(
        static_cast<const Kinematics*>(hal.find_service(kKinematicsService))->type());
  };
  EXPECT_EQ(type("1"), 1);
  EXPECT_EQ(type("B"), 4);
  EXPECT_EQ(type("both"), 4);
  EXPECT_EQ(type("f"), 2);
  EXPECT_EQ(type("I"), 3);
  EXPECT_EQ(type("q"), -1);
  hal::TestBuilder hal;
  hal.set_arg("coordinates", "xyq");
  EXPECT_FALSE(hal.create(kerf_hal_module_trivkins, "trivkins"));
  EXPECT_NE(hal.error().find("XYZABCUVW"), std::string::npos);
}

}  // namespace
}  // namespace kerf::motion
