// External offsets where joints mix axes: the joints keep their limits too, whatever path and offsets do at once.
#include <gtest/gtest.h>

#include <cstdio>

#include "bench/motion/table_kinematics.hpp"
#include "property/motion/random_program.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Oracle;
using test::Random;
using test::Rig;

struct Result {
  double vel{0}, acc{0}, jerk{0};
  double way{0};  ///< of the offsets, as a share of the largest that was asked for
};

/// Lines in all axes under counts that change by up to some millimetres.
Result run(unsigned seed, const Kinematics& kinematics, bool jerks) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  Rig rig{test::RigKinematics(kinematics)};
  test::random_limits(rig, r, jerks);
  const double ratio = r.uniform(0.1, 0.8);
  for (AxisConfig& a : rig.config.axis) {
    a.max_vel = r.log(20, 500);
    a.max_acc = a.max_vel * r.log(3, 30);
    a.offset_av_ratio = r.chance(0.7) ? ratio : 0;
  }
  rig.apply_config();
  for (OffsetInputs& o : rig.in.offset) o.enable = true, o.per_count = 0.01;
  rig.ready();
  rig.run(3);
  const std::uint32_t mask = kinematics.axis_mask();
  const double size = r.log(0.3, 6);
  Oracle oracle;
  double asked = 0, reached = 0;
  int lines = 0;
  for (int cycle = 0; cycle < 6000 && rig.faults.empty(); ++cycle) {
    while (lines < 400) {
      Pose at;
      for (std::size_t i = 0; i < rtapi::kAxes; ++i)
        if ((mask >> i & 1U) != 0) at[i] = r.uniform(-30, 30);
      if (!rig.line(at, r.log(5, 150), r.chance(0.3) ? MotionKind::traverse : MotionKind::feed))
        break;
      ++lines;
    }
    if (r.chance(0.01)) {
      const auto axis = static_cast<std::size_t>(r.integer(0, 5));
      rig.in.offset[axis].counts = static_cast<std::int32_t>(r.uniform(-100, 100) * size);
      if ((mask >> axis & 1U) != 0 && rig.config.axis[axis].offset_av_ratio > 0) asked = size;
    }
    rig.cycle();
    oracle.watch(rig);
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      reached = std::max(reached, std::abs(rig.controller->offsets().pose()[i]));
  }
  for (const FaultRecord& f : rig.faults)
    ADD_FAILURE() << static_cast<int>(f.fault) << " joint " << f.index << ": " << f.value << " of "
                  << f.limit;
  return {oracle.vel, oracle.acc, oracle.jerk, asked > 0 ? reached / asked : 1};
}

TEST(OffsetProperty, KeepTheLimitsOfJointsThatMixAxes) {
  const bench::TableKinematics table;
  test::RigKinematics core_xy({0, 1, 2});
  core_xy.core_xy = true;
  const Kinematics* kinds[] = {&table, &core_xy};
  double worst[3]{};
  for (int i = 1; i <= test::property_count(60); ++i) {
    const Result got = run(static_cast<unsigned>(i), *kinds[i % 2], i % 4 < 2);
    EXPECT_LE(got.vel, 1.0001) << "seed " << i;
    EXPECT_LE(got.acc, 1.001) << "seed " << i;
    EXPECT_LE(got.jerk, 1.01) << "seed " << i;
    EXPECT_GT(got.way, 0.02) << "seed " << i << ": offsets hardly move";
    worst[0] = std::max(worst[0], got.vel);
    worst[1] = std::max(worst[1], got.acc);
    worst[2] = std::max(worst[2], got.jerk);
  }
  std::printf("at most %.5f of velocity, %.5f of acceleration, %.5f of jerk\n", worst[0], worst[1],
              worst[2]);
}

}  // namespace
}  // namespace kerf::motion
