// axis.L.eoffset-*: what may be where, and that the sum of path and offsets keeps all limits.
#include <gtest/gtest.h>

#include "property/motion/random_program.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Oracle;
using test::Random;
using test::Rig;

constexpr std::size_t kZ = 2;

struct Offsets {
  explicit Offsets(double ratio = 0.2, double jerk = 0) {
    for (AxisConfig& a : rig.config.axis) a.offset_av_ratio = ratio;
    for (JointConfig& j : rig.config.joint) j.max_jerk = jerk;
    rig.config.axis[kZ].min_limit = -50;
    rig.config.axis[kZ].max_limit = 50;
    rig.apply_config();
    for (OffsetInputs& o : rig.in.offset) o.enable = true, o.per_count = 0.01;
    rig.ready();
  }
  void ask(double mm, std::size_t axis = kZ) {
    rig.in.offset[axis].counts += static_cast<std::int32_t>(std::lround(mm * 100));
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      rig.cycle();
      oracle.watch(rig);
    }
  }
  template <class F>
  bool until(F&& done, int limit = 100000) {
    for (int i = 0; i < limit; ++i) {
      run(1);
      if (done()) return true;
    }
    return false;
  }
  bool settles() {
    run(2);
    return until([&] { return rig.controller->offsets().at_rest(); });
  }
  bool finishes() {
    return until([&] { return rig.status().executed_seq >= rig.seq && rig.status().path_empty; });
  }
  [[nodiscard]] double joint() const { return rig.status().joint[kZ].pos_cmd; }
  [[nodiscard]] double offset() const { return rig.controller->offsets().pose().z; }
  [[nodiscard]] bool limited() const { return rig.controller->offsets().limited(); }
  void expect_limits_kept() const {
    EXPECT_LE(oracle.vel, 1.0001);
    EXPECT_LE(oracle.acc, 1.001);
    EXPECT_LE(oracle.jerk, 1.01);
    EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults[0].fault);
  }
  Rig rig;
  Oracle oracle;
};

TEST(ExternalOffsets, CountsMoveTheAxisByTheScaleAndNotThePath) {
  Offsets o;
  o.run(3);
  o.ask(3);
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.joint(), 3, 1e-9);
  EXPECT_NEAR(o.offset(), 3, 1e-9);
  EXPECT_NEAR(o.rig.status().pos_cmd.z, 0, 1e-12);
  EXPECT_TRUE(o.rig.controller->offsets().active());
  EXPECT_FALSE(o.limited());
  o.rig.line({.x = 10, .z = 5}, 50);
  EXPECT_TRUE(o.finishes());
  EXPECT_NEAR(o.joint(), 8, 1e-9);
  o.rig.in.offset[kZ].clear = true;
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.joint(), 5, 1e-9);
  EXPECT_FALSE(o.rig.controller->offsets().active());
  o.expect_limits_kept();
}

TEST(ExternalOffsets, TakeTheirShareOfTheLimits) {
  for (const double ratio : {0.1, 0.5, 0.9}) {
    Offsets o(ratio);
    o.run(3);
    o.ask(30);
    double peak = 0;
    EXPECT_TRUE(o.until([&] {
      peak = std::max(peak, std::abs(o.rig.status().joint[kZ].vel_cmd));
      return std::abs(o.joint() - 30) < 1e-9;
    }));
    EXPECT_NEAR(peak, ratio * 100, 1e-6);
    // And the path the rest.
    o.rig.line({.x = 0, .z = -40}, 0, MotionKind::traverse);
    peak = 0;
    EXPECT_TRUE(o.until([&] {
      peak = std::max(peak, std::abs(o.rig.status().joint[kZ].vel_cmd));
      return o.rig.status().executed_seq >= o.rig.seq;
    }));
    EXPECT_NEAR(peak, (1 - ratio) * 100, 1e-6);
    o.expect_limits_kept();
  }
}

TEST(ExternalOffsets, WithoutARatioOrEnableOrHomingNothingMoves) {
  Offsets none(0);
  none.run(3);
  none.ask(3);
  none.run(500);
  EXPECT_EQ(none.joint(), 0);
  EXPECT_EQ(none.rig.controller->offsets().request(kZ), 0);
  Offsets off;
  off.rig.in.offset[kZ].enable = false;
  off.run(3);
  off.ask(3);
  off.run(500);
  off.rig.in.offset[kZ].enable = true;
  off.run(500);
  EXPECT_EQ(off.joint(), 0) << "counts while it was not enabled are lost";
  off.ask(1);
  EXPECT_TRUE(off.settles());
  EXPECT_NEAR(off.joint(), 1, 1e-9);
  Rig rig;
  rig.config.axis[kZ].offset_av_ratio = 0.2;
  rig.config.no_force_homing = true;
  rig.apply_config();
  rig.in.offset[kZ] = {true, false, 0, 0.01};
  rig.enable();
  rig.intent.mode = MotionMode::coordinated;
  rig.run(5);
  ASSERT_EQ(rig.status().mode, MotionMode::coordinated);
  rig.in.offset[kZ].counts = 100;
  rig.run(500);
  EXPECT_EQ(rig.status().joint[kZ].pos_cmd, 0) << "not homed";
}

TEST(ExternalOffsets, DisabledByItsPinTheOffsetIsKept) {
  Offsets o;
  o.run(3);
  o.ask(3);
  EXPECT_TRUE(o.settles());
  o.rig.in.offset[kZ].enable = false;
  o.run(100);
  EXPECT_NEAR(o.joint(), 3, 1e-9);
  o.rig.in.offset[kZ].clear = true;
  o.run(1);
  o.rig.in.offset[kZ].clear = false;
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.joint(), 0, 1e-9);
  o.expect_limits_kept();
}

TEST(ExternalOffsets, OffAndOnKeepsThePlaceAndForgetsTheOffset) {
  Offsets o;
  o.run(3);
  o.ask(3);
  EXPECT_TRUE(o.settles());
  o.rig.orders.enable = false;
  o.run(3);
  EXPECT_NEAR(o.joint(), 3, 1e-9);
  EXPECT_NEAR(o.offset(), 3, 1e-9);
  o.rig.orders.enable = true;
  o.run(5);
  EXPECT_NEAR(o.joint(), 3, 1e-9);
  EXPECT_EQ(o.offset(), 0);
  EXPECT_EQ(o.rig.controller->offsets().request(kZ), 0);
  EXPECT_NEAR(o.rig.status().pos_cmd.z, 3, 1e-9);
}

TEST(ExternalOffsets, ModesChangeWithoutAStep) {
  Offsets o;
  o.run(3);
  o.ask(3);
  EXPECT_TRUE(o.settles());
  for (const MotionMode mode : {MotionMode::teleop, MotionMode::coordinated}) {
    o.rig.intent.mode = mode;
    o.run(5);
    ASSERT_EQ(o.rig.status().mode, mode);
    EXPECT_NEAR(o.joint(), 3, 1e-9);
    EXPECT_NEAR(o.offset(), 3, 1e-9);
  }
  o.rig.intent.mode = MotionMode::free;
  o.run(5);
  EXPECT_NEAR(o.joint(), 3, 1e-9);
  EXPECT_EQ(o.offset(), 0) << "joints know no offsets: it became position";
  EXPECT_NEAR(o.rig.status().pos_cmd.z, 3, 1e-9);
  o.expect_limits_kept();
}

TEST(ExternalOffsets, AnAbortStopsThePathAndNotTheOffset) {
  Offsets o;
  o.run(3);
  o.rig.line({.z = -30}, 50);
  o.run(100);
  o.ask(5);
  o.run(50);
  o.rig.abort();
  EXPECT_TRUE(o.until([&] { return o.rig.status().acked_epoch == o.rig.orders.abort_epoch; }, 200));
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.offset(), 5, 1e-9);
  EXPECT_NEAR(o.joint(), o.rig.status().pos_cmd.z + 5, 1e-9);
  o.expect_limits_kept();
}

TEST(ExternalOffsets, StandAtTheSoftLimitAndComeBack) {
  Offsets o;
  o.run(3);
  o.ask(70);
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.joint(), 50, 1e-6);
  EXPECT_TRUE(o.limited());
  EXPECT_NEAR(o.rig.controller->offsets().request(kZ), 70, 1e-9);
  // The path needs room: the offset gives way, and gets it back.
  o.rig.line({.z = 20}, 90);
  EXPECT_TRUE(o.until([&] {
    EXPECT_LE(o.joint(), 50 + 1e-6);
    return o.rig.status().executed_seq >= o.rig.seq;
  }));
  EXPECT_NEAR(o.rig.status().pos_cmd.z, 20, 1e-9);
  EXPECT_NEAR(o.offset(), 30, 1e-6);
  o.rig.line({.z = -30}, 90);
  EXPECT_TRUE(o.finishes());
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.offset(), 70, 1e-6);
  EXPECT_FALSE(o.limited());
  o.ask(-70);
  EXPECT_TRUE(o.settles());
  EXPECT_NEAR(o.joint(), -30, 1e-6);
  o.expect_limits_kept();
}

TEST(ExternalOffsets, JogsStopWhereTheSumMeetsTheLimit) {
  for (const double jerk : {0.0, 20000.0}) {
    Offsets o(0.2, jerk);
    o.run(3);
    o.ask(10);
    EXPECT_TRUE(o.settles());
    o.rig.intent.mode = MotionMode::teleop;
    o.run(5);
    JogIntent& jog = o.rig.intent.axis_jog[kZ];
    jog = {jog.seq + 1, JogIntent::Kind::continuous, 100, 0};
    EXPECT_TRUE(o.until(
        [&] {
          EXPECT_LE(o.joint(), 50 + 1e-6);
          return o.rig.status().jogging;
        },
        10));
    EXPECT_TRUE(o.until([&] {
      EXPECT_LE(o.joint(), 50 + 1e-6);
      return !o.rig.status().jogging;
    }));
    EXPECT_GT(o.joint(), 20) << "stopped far before the limit";
    o.expect_limits_kept();
  }
}

/// Random programs under random counts: limits hold for the sum in every cycle, and the program reaches its end.
TEST(ExternalOffsets, AnyCountsUnderAnyProgram) {
  const int count = test::property_count(60);
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random r(static_cast<unsigned>(seed));
    const bool jerks = r.chance(0.4);
    Offsets o(r.uniform(0.1, 0.9), jerks ? 20000 : 0);
    o.run(3);
    Pose at;
    for (int i = 0; i < 6; ++i) {
      at = {.x = r.uniform(-40, 40), .y = r.uniform(-40, 40), .z = r.uniform(-45, 45)};
      o.rig.line(at, r.log(5, 150), r.chance(0.3) ? MotionKind::traverse : MotionKind::feed);
    }
    bool meddle = true;
    int cycle = 0;
    const bool reached = o.until([&] {
      if (++cycle == 20000) meddle = false;
      if (meddle && r.chance(0.02))
        o.ask(r.uniform(-8, 8), static_cast<std::size_t>(r.integer(0, 2)));
      if (meddle && r.chance(0.002)) o.rig.in.offset[kZ].clear = !o.rig.in.offset[kZ].clear;
      if (meddle && r.chance(0.005)) o.rig.in.offset[kZ].enable = !o.rig.in.offset[kZ].enable;
      EXPECT_LE(std::abs(o.joint()), 50 + 1e-6);
      return o.rig.status().executed_seq >= o.rig.seq || testing::Test::HasFailure();
    });
    EXPECT_TRUE(reached) << "stalled";
    EXPECT_NEAR(o.rig.status().pos_cmd.z, at.z, 1e-9);
    o.expect_limits_kept();
    if (testing::Test::HasFailure()) break;
  }
}

}  // namespace
}  // namespace kerf::motion
