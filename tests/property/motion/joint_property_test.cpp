// Jogs at random: joint and axis limits hold, soft limits are never crossed, everything comes to rest.
#include <gtest/gtest.h>

#include "bench/motion/table_kinematics.hpp"
#include "property/motion/random_program.hpp"
#include "unit/motion/polar_kinematics.hpp"

namespace kerf::motion {
namespace {

using test::Oracle;
using test::Random;
using test::Rig;

void run_jogs(unsigned seed, MotionMode mode, bool jerks) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  Rig rig;
  test::random_limits(rig, r, jerks);
  for (std::size_t j = 0; j < 3; ++j) {
    rig.config.joint[j].min_limit = rig.config.axis[j].min_limit = -r.log(0.01, 50);
    rig.config.joint[j].max_limit = rig.config.axis[j].max_limit = r.log(0.01, 50);
  }
  rig.apply_config();
  rig.ready();
  rig.intent.mode = mode;
  rig.run(3);
  ASSERT_EQ(rig.status().mode, mode);
  Oracle oracle;
  oracle.watch(rig);
  for (int cycle = 0; cycle < 4000; ++cycle) {
    if (cycle < 3000 && r.chance(0.02)) {
      const int j = r.integer(0, 2);
      JogIntent& jog = mode == MotionMode::free ? rig.intent.joint_jog[j] : rig.intent.axis_jog[j];
      ++jog.seq;
      jog.kind = static_cast<JogIntent::Kind>(r.integer(0, 3));
      jog.vel = r.uniform(-400, 400);
      jog.target = r.uniform(-60, 60);
    }
    if (r.chance(0.002)) rig.abort();
    rig.cycle();
    oracle.watch(rig);
    for (std::size_t j = 0; j < 3; ++j) {
      ASSERT_GE(rig.status().joint[j].pos_cmd, rig.config.joint[j].min_limit - 1e-9);
      ASSERT_LE(rig.status().joint[j].pos_cmd, rig.config.joint[j].max_limit + 1e-9);
    }
  }
  for (std::size_t j = 0; j < 3; ++j) {
    ++rig.intent.joint_jog[j].seq;
    ++rig.intent.axis_jog[j].seq;
    rig.intent.joint_jog[j].kind = rig.intent.axis_jog[j].kind = JogIntent::Kind::none;
  }
  EXPECT_GT(rig.run_until([&] { return rig.status().in_position; }, 8000), 0);
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
  for (const FaultRecord& f : rig.faults)
    EXPECT_TRUE(f.fault == Fault::jog_beyond_limit || f.fault == Fault::jog_while_not_ready)
        << static_cast<int>(f.fault);  // the second: while an abort is carried out
}

TEST(JogProperty, JointsKeepTheirLimits) {
  for (int i = 1; i <= test::property_count(100) && !HasFailure(); ++i)
    run_jogs(static_cast<unsigned>(i), MotionMode::free, i % 2 == 0);
}

TEST(JogProperty, AxesKeepTheirLimits) {
  for (int i = 1; i <= test::property_count(100) && !HasFailure(); ++i)
    run_jogs(static_cast<unsigned>(i), MotionMode::teleop, i % 2 == 0);
}

/// Jogs of axes of a machine whose joints mix them, some of them several at a time and with wheels.
void run_mixed_jogs(unsigned seed, const Kinematics& kinematics, bool jerks) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  Rig rig{test::RigKinematics(kinematics)};
  test::random_limits(rig, r, jerks);
  const double speed = r.log(5, 400), acc = r.log(50, 5000);
  for (AxisConfig& a : rig.config.axis) {
    a.max_vel = speed * r.log(0.5, 2);
    a.max_acc = acc * r.log(0.5, 2);
    if (r.chance(0.3)) a.max_jerk = a.max_acc / r.log(0.01, 0.3);
    a.min_limit = -r.log(20, 200);
    a.max_limit = r.log(20, 200);
  }
  rig.apply_config();
  rig.ready();
  rig.intent.mode = MotionMode::teleop;
  rig.run(3);
  ASSERT_EQ(rig.status().mode, MotionMode::teleop);
  Oracle oracle;
  oracle.watch(rig);
  int far = 0;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    if (r.chance(cycle < 4000 ? 0.003 : 0.02)) {
      const auto a = static_cast<std::size_t>(r.integer(0, 8));
      if ((kinematics.axis_mask() >> a & 1U) == 0) continue;
      JogIntent& jog = rig.intent.axis_jog[a];
      ++jog.seq;
      jog.kind = static_cast<JogIntent::Kind>(r.integer(0, 3));
      jog.vel = r.uniform(-1, 1) * 2 * speed;
      jog.target = r.uniform(-60, 60);
    }
    if (r.chance(0.001)) rig.abort();
    rig.cycle();
    oracle.watch(rig);
    far += rig.status().jogging ? 1 : 0;
  }
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    ++rig.intent.axis_jog[a].seq;
    rig.intent.axis_jog[a].kind = JogIntent::Kind::none;
  }
  EXPECT_GT(rig.run_until([&] { return rig.status().in_position; }, 8000), 0);
  EXPECT_GT(far, 100);
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
  for (const FaultRecord& f : rig.faults)
    EXPECT_TRUE(f.fault == Fault::jog_beyond_limit || f.fault == Fault::jog_while_not_ready)
        << static_cast<int>(f.fault) << " joint " << f.index << ": " << f.value << " of "
        << f.limit;
}

TEST(JogProperty, AxesKeepTheLimitsOfJointsThatMixThem) {
  const bench::TableKinematics table;
  test::RigKinematics core_xy({0, 1, 2});
  core_xy.core_xy = true;
  const test::PolarKinematics polar(220);
  const Kinematics* kinds[] = {&table, &core_xy, &polar};
  for (int i = 1; i <= test::property_count(90) && !HasFailure(); ++i)
    run_mixed_jogs(static_cast<unsigned>(i), *kinds[i % 3], i % 2 == 0);
}

/// Along X of a CoreXY both motors do what the axis does: nothing is lost but a reserve. A second axis halves what there is.
TEST(Jog, OfAxesThatJointsMixIsFast) {
  test::RigKinematics core_xy({0, 1, 2});
  core_xy.core_xy = true;
  for (const double jerk : {0.0, 20'000.0}) {
    const auto seconds = [&](bool both) {
      Rig rig(core_xy);
      for (auto& j : rig.config.joint) j.max_jerk = jerk;
      rig.ready();
      rig.intent.mode = MotionMode::teleop;
      rig.run(3);
      for (std::size_t i = 0; i < (both ? 2U : 1U); ++i)
        rig.intent.axis_jog[i] = {1, JogIntent::Kind::incremental, 100, 30};
      const int cycles = rig.run_until(
          [&] { return rig.status().pos_cmd.x == 30 && !rig.status().jogging; }, 5000);
      EXPECT_TRUE(rig.faults.empty());
      return cycles * Rig::kPeriod;
    };
    // 100 mm/s and 1000 mm/s2; both: 50 and 500.
    EXPECT_LT(seconds(false), 1.1 * (jerk > 0 ? 0.45 : 0.4));
    EXPECT_LT(seconds(true), 1.1 * (jerk > 0 ? 0.75 : 0.7));
  }
}

/// Through the pole of a turntable the table would have to turn by half a turn in no time.
TEST(Jog, EndsBeforeAPoleAndGoesBackFromIt) {
  const test::PolarKinematics polar;
  Rig rig{test::RigKinematics(polar)};
  rig.ready();
  rig.intent.mode = MotionMode::teleop;
  rig.run(3);
  const auto jog = [&rig](double vel) {
    JogIntent& x = rig.intent.axis_jog[0];
    x = {x.seq + 1, JogIntent::Kind::continuous, vel, 0};
    return rig.run_until([&] { return !rig.status().jogging; }, 1000);
  };
  for (int time = 0; time < 3; ++time) {
    EXPECT_GT(jog(-20), 0) << "it ends by itself";
    EXPECT_LT(rig.status().pos_cmd.x, -6) << time;
    EXPECT_GT(rig.status().pos_cmd.x, -8) << time;
    const double near = rig.status().pos_cmd.x;
    EXPECT_EQ(jog(20), -1);
    EXPECT_GT(rig.status().pos_cmd.x, near + 10) << "it goes on";
    ++rig.intent.axis_jog[0].seq;
    rig.intent.axis_jog[0].kind = JogIntent::Kind::none;
    rig.run(500);
    rig.intent.axis_jog[0] = {rig.intent.axis_jog[0].seq + 1, JogIntent::Kind::absolute, 20, 0};
    rig.run(3000);
  }
  EXPECT_TRUE(rig.faults.empty());
}

}  // namespace
}  // namespace kerf::motion
