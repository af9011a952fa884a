// There and back again over each machine's workspace; both Jacobians; what cannot be reached.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "machines.hpp"

namespace kerf::motion::test {
namespace {

constexpr double kWorst = 1e-9;  ///< of the workspace, or of a turn

class EachMachine : public testing::TestWithParam<Machine> {
 public:
  static void TearDownTestSuite() {
    if (turned.empty()) return;
    std::printf(
        "result: %zu modules, %zu machines, %u random poses each, worst round-trip error %.1e of "
        "the "
        "workspace\n",
        turned.size(), machines_turned, poses, worst_of_all);
  }

 protected:
  static inline std::set<std::string> turned;  ///< modules
  static inline std::size_t machines_turned{0};
  static inline double worst_of_all{0};
};

/// The joint's error as a part of the workspace or of a turn.
double part_of(const Machine& m, std::size_t j, double difference) {
  const bool degrees = m.axes.empty() && m.joints[j].degrees;
  return std::fabs(difference) / (degrees ? 360.0 : m.size_mm);
}

std::size_t joints_of(const Machine& m) { return m.axes.empty() ? m.joints.size() : m.axes.size(); }

TEST_P(EachMachine, InverseOfForwardIsTheSame) {
  const Machine& m = GetParam();
  const Loaded kinematics(m);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> little(-1, 1);
  double worst = 0;
  for (unsigned n = 0; n < poses; ++n) {
    JointVector joint, back;
    Pose world;
    ASSERT_TRUE(random_pose(m, *kinematics, random, joint, world)) << "pose " << n;
    // From near by, as a machine in motion asks.
    back = joint;
    for (std::size_t j = 0; j < joints_of(m); ++j) back[j] += little(random);
    if (!m.axes.empty()) {
      Pose near = world;
      for (const auto& [axis, range] : m.axes) near[axis] += little(random);
      ASSERT_TRUE(kinematics->forward(joint, near)) << "pose " << n;
      world = near;
    }
    ASSERT_TRUE(kinematics->inverse(world, back)) << "pose " << n;
    for (std::size_t j = 0; j < joints_of(m); ++j) {
      const double error = part_of(m, j, back[j] - joint[j]);
      ASSERT_LT(error, kWorst) << "seed " << seed << " pose " << n << " joint " << j << ": "
                               << joint[j] << " became " << back[j];
      worst = std::fmax(worst, error);
    }
    if (m.axes.empty()) continue;
    // Their inverse is the plain one, so the pose must be the same too.
    JointVector first = joint;
    Pose again = world;
    ASSERT_TRUE(kinematics->inverse(world, first) && kinematics->forward(first, again));
    for (std::size_t axis = 0; axis < rtapi::kAxes; ++axis)
      ASSERT_NEAR(again[axis], world[axis], 1e-7) << "pose " << n;
  }
  std::printf("%-24s %8u poses, worst round trip %.1e of the workspace\n", m.name.c_str(), poses,
              worst);
  turned.insert(m.module);
  ++machines_turned;
  worst_of_all = std::fmax(worst_of_all, worst);
}

/// The axes that the machine has.
std::vector<std::size_t> axes_of(const Kinematics& k) {
  std::vector<std::size_t> out;
  for (std::size_t axis = 0; axis < rtapi::kAxes; ++axis)
    if ((k.axis_mask() >> axis & 1U) != 0) out.push_back(axis);
  return out;
}

TEST_P(EachMachine, JacobiansAreEachOthersInverse) {
  const Machine& m = GetParam();
  const Loaded kinematics(m);
  const auto axes = axes_of(*kinematics);
  std::mt19937_64 random(seed + 1);
  for (int n = 0; n < 200; ++n) {
    JointVector joint;
    Pose world;
    ASSERT_TRUE(random_pose(m, *kinematics, random, joint, world));
    // For each axis: a small way there, which joints make it, and where they lead.
    for (const std::size_t axis : axes) {
      if (axis >= 6 && kinematics->axis_mask() == 0x1FFU && joints_of(m) <= 6) continue;
      constexpr double kStep = 1e-4;
      Pose up = world, down = world;
      up[axis] += kStep;
      down[axis] -= kStep;
      JointVector high = joint, low = joint;
      ASSERT_TRUE(kinematics->inverse(up, high) && kinematics->inverse(down, low));
      Pose there = world, back = world;
      ASSERT_TRUE(kinematics->forward(high, there) && kinematics->forward(low, back));
      for (const std::size_t other : axes) {
        const double slope = (there[other] - back[other]) / (2 * kStep);
        ASSERT_NEAR(slope, other == axis ? 1.0 : 0.0, 1e-5)
            << "pose " << n << ": " << rtapi::kAxisLetters[axis] << " moves "
            << rtapi::kAxisLetters[other];
      }
      // Smooth: no joint jumps to another solution.
      for (std::size_t j = 0; j < joints_of(m); ++j)
        ASSERT_LT(std::fabs(high[j] - low[j]), 1.0) << "pose " << n << " joint " << j;
    }
  }
}

TEST_P(EachMachine, WhatCannotBeReachedIsReported) {
  const Machine& m = GetParam();
  if (m.out_of_reach.empty()) GTEST_SKIP() << "reaches everywhere";
  const Loaded kinematics(m);
  std::mt19937_64 random(seed + 2);
  JointVector joint;
  Pose world;
  ASSERT_TRUE(random_pose(m, *kinematics, random, joint, world));
  for (const auto& [axis, value] : m.out_of_reach) world[axis] = value;
  JointVector back = joint;
  EXPECT_FALSE(kinematics->inverse(world, back));
  world.x = NAN;
  back = joint;
  EXPECT_FALSE(kinematics->inverse(world, back));
}

TEST_P(EachMachine, SwitchingShowsTheKindAndRefusesOthers) {
  const Machine& m = GetParam();
  Loaded kinematics(m);
  const std::int32_t kinds = kinematics->kinds(), before = kinematics->kind();
  EXPECT_EQ(before, m.kind);
  EXPECT_FALSE(kinematics->switch_to(-1));
  EXPECT_FALSE(kinematics->switch_to(kinds));
  EXPECT_EQ(kinematics->kind(), before);
  if (kinds == 1) return;
  std::mt19937_64 random(seed + 3);
  for (std::int32_t kind = 0; kind < kinds; ++kind) {
    ASSERT_TRUE(kinematics->switch_to(kind));
    for (std::int32_t other = 0; other < kinds; ++other)
      EXPECT_EQ(kinematics.hal().get<bool>("kinstype.is-" + std::to_string(other)), other == kind);
  }
}

std::string test_name(const testing::TestParamInfo<Machine>& info) {
  std::string name = "k_" + info.param.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, EachMachine, testing::ValuesIn(machines()), test_name);

TEST(Kinematics, EveryModuleHasAMachine) {
  std::set<std::string> tested;
  for (const Machine& m : machines()) tested.insert(m.module);
  for (const std::string& module : modules()) EXPECT_EQ(tested.count(module), 1U) << module;
  std::printf("%zu modules, %zu machines\n", modules().size(), machines().size());
}

TEST(Kinematics, AMatrixThatCannotBeInvertedHasNoPosition) {
  Machine m = machine("matrixkins");
  m.pins = {{"C_xx", 0.0}};
  const Loaded kinematics(m);
  Pose world;
  EXPECT_FALSE(kinematics->forward({1, 2, 3}, world));
}

TEST(Kinematics, AnArmThatIsStretchedIsStillFound) {
  for (const char* name : {"pumakins", "three21kins", "genserkins"}) {
    const Loaded kinematics(machine(name));
    // The wrist is straight: two of its joints turn about the same axis.
    JointVector joint{20, -30, -20, 40, 0, 10}, back = joint;
    Pose world, again;
    ASSERT_TRUE(kinematics->forward(joint, world));
    ASSERT_TRUE(kinematics->inverse(world, back));
    ASSERT_TRUE(kinematics->forward(back, again));
    for (std::size_t axis = 0; axis < 6; ++axis) EXPECT_NEAR(again[axis], world[axis], 1e-6);
  }
}

TEST(Kinematics, AHexapodFindsItselfWithoutAStart) {
  for (const char* name : {"genhexkins", "pentakins"}) {
    const Machine& m = machine(name);
    const Loaded kinematics(m);
    std::mt19937_64 random(seed + 4);
    for (int n = 0; n < 1000; ++n) {
      JointVector joint;
      Pose world, found;
      ASSERT_TRUE(random_pose(m, *kinematics, random, joint, world));
      ASSERT_TRUE(kinematics->forward(joint, found)) << name << " pose " << n;
      JointVector back{};
      ASSERT_TRUE(kinematics->inverse(found, back));
      for (std::size_t j = 0; j < 6; ++j) ASSERT_NEAR(back[j], joint[j], 1e-6) << name << n;
      for (std::size_t axis = 0; axis < 6; ++axis)
        ASSERT_NEAR(found[axis], world[axis], 1e-6) << name << " pose " << n;
    }
  }
}

}  // namespace
}  // namespace kerf::motion::test
