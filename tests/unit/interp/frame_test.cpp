#include <gtest/gtest.h>

#include <random>

#include "interp/canon_frame.hpp"

namespace kerf::interp {
namespace {

Pose random_pose(std::mt19937& rng) {
  std::uniform_real_distribution<double> d(-500, 500);
  Pose p;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) p[i] = d(rng);
  return p;
}

TEST(CanonFrame, OrderIsG92ThenRotationThenWorkAndTool) {
  CanonFrame f;
  Pose g5x, g92, tool, p;
  g5x.x = 100;
  g92.x = 10;
  tool.x = 1, tool.z = 5;
  f.set_g5x_offset(g5x);
  f.set_g92_offset(g92);
  f.use_tool_length_offset(tool);
  f.set_xy_rotation(90);
  p.x = 2, p.z = 3;
  const Pose m = f.to_machine(p);
  EXPECT_NEAR(m.x, 101, 1e-12);
  EXPECT_NEAR(m.y, 12, 1e-12);
  EXPECT_NEAR(m.z, 8, 1e-12);
}

TEST(CanonFrame, IsItsOwnInverse) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> angle(-360, 360);
  for (int i = 0; i < 2000; ++i) {
    CanonFrame f;
    f.set_g5x_offset(random_pose(rng));
    f.set_g92_offset(random_pose(rng));
    f.use_tool_length_offset(random_pose(rng));
    f.set_xy_rotation(angle(rng));
    const Pose p = random_pose(rng), back = f.to_program(f.to_machine(p));
    for (std::size_t k = 0; k < rtapi::kAxes; ++k)
      ASSERT_NEAR(back[k], p[k], 1e-9) << "seed 7, case " << i;
  }
}

TEST(CanonFrame, DirectionsAndNormalsTurnWithTheRotation) {
  CanonFrame f;
  f.set_xy_rotation(90);
  const Vector3 d = f.direction_to_machine({1, 0, 2});
  EXPECT_NEAR(d[0], 0, 1e-12);
  EXPECT_NEAR(d[1], 1, 1e-12);
  EXPECT_NEAR(d[2], 2, 1e-12);
  EXPECT_NEAR(f.normal(Plane::yz)[1], 1, 1e-12);
  EXPECT_NEAR(f.normal(Plane::xz)[0], -1, 1e-12);
  EXPECT_NEAR(f.normal(Plane::xy)[2], 1, 1e-12);
}

TEST(CanonFrame, NoRotationIsExact) {
  CanonFrame f;
  Pose g5x;
  g5x.x = 0.1;
  f.set_g5x_offset(g5x);
  f.set_xy_rotation(30);
  f.set_xy_rotation(0);
  Pose p;
  p.x = 0.2;
  EXPECT_EQ(f.to_machine(p).x, 0.2 + 0.1);
}

}  // namespace
}  // namespace kerf::interp
