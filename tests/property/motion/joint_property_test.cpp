// Jogs at random: joint and axis limits hold, soft limits are never crossed, everything comes to rest.
#include <gtest/gtest.h>

#include "property/motion/random_program.hpp"

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

}  // namespace
}  // namespace kerf::motion
