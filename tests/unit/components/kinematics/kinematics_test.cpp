// Kinematics modules: there and back again, and against joint positions that LinuxCNC's own modules gave for the same poses.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "motion/api/kinematics.hpp"

#define KERF_KINEMATICS(id) extern "C" const kerf::hal::Module kerf_hal_module_##id
KERF_KINEMATICS(5axiskins);
KERF_KINEMATICS(corexykins);
KERF_KINEMATICS(genserkins);
KERF_KINEMATICS(lineardeltakins);
KERF_KINEMATICS(pumakins);
KERF_KINEMATICS(rotarydeltakins);
KERF_KINEMATICS(scarakins);
KERF_KINEMATICS(tripodkins);

namespace kerf::motion {
namespace {

using Values = std::vector<double>;

struct Machine {
  std::string name;
  const hal::Module* module;
  std::string coordinates;             ///< coordinates=, "" none
  std::map<std::string, double> pins;  ///< set after loading
  Values low, high;                    ///< joints, for the way there and back
};

const std::map<std::string, double> kPuma560{{"A-2", 17},
                                             {"ALPHA-1", M_PI / 2},
                                             {"ALPHA-3", M_PI / 2},
                                             {"ALPHA-4", -M_PI / 2},
                                             {"ALPHA-5", M_PI / 2},
                                             {"D-0", 26.45},
                                             {"D-1", -5.5},
                                             {"D-3", 17.05},
                                             {"D-5", 2.2},
                                             {"A-3", 0},
                                             {"D-2", 0}};
const std::map<std::string, double> kMelfa{{"A-1", 85},
                                           {"A-2", 380},
                                           {"A-3", 100},
                                           {"ALPHA-1", -M_PI / 2},
                                           {"ALPHA-3", -M_PI / 2},
                                           {"ALPHA-4", M_PI / 2},
                                           {"ALPHA-5", -M_PI / 2},
                                           {"D-0", 350},
                                           {"D-2", 0},
                                           {"D-3", 425},
                                           {"D-5", 235}};

const std::vector<Machine>& machines() {
  static const std::vector<Machine> all{
      {"5axiskins",
       &kerf_hal_module_5axiskins,
       "xyzbcwy",
       {{"pivot-length", 250}},
       {-100, -100, -100, -60, -180, -5, 0},
       {100, 100, 100, 60, 180, 5, 0}},
      {"corexykins",
       &kerf_hal_module_corexykins,
       "",
       {},
       {-50, -50, -50, -9, -9, -9, -9, -9, -9},
       {50, 50, 50, 9, 9, 9, 9, 9, 9}},
      {"genserkins",
       &kerf_hal_module_genserkins,
       "",
       kPuma560,
       {-60, -60, 20, -60, -80, -60},
       {60, 60, 80, 60, -20, 60}},
      {"lineardeltakins",
       &kerf_hal_module_lineardeltakins,
       "",
       {{"L", 269}, {"R", 130.25}},
       {200, 200, 200},
       {260, 260, 260}},
      {"pumakins",
       &kerf_hal_module_pumakins,
       "",
       {},
       {-60, -60, -30, -60, 20, -60},
       {60, 20, 30, 60, 80, 60}},
      {"rotarydeltakins",
       &kerf_hal_module_rotarydeltakins,
       "",
       {{"platformradius", 10}, {"thighlength", 10}, {"shinlength", 18}, {"footradius", 5}},
       {-20, -20, -20},
       {30, 30, 30}},
      {"scarakins",
       &kerf_hal_module_scarakins,
       "",
       {},
       {-80, 10, 0, -90, 0, 0},
       {80, 120, 100, 90, 0, 0}},
      {"tripodkins",
       &kerf_hal_module_tripodkins,
       "",
       {{"Bx", 10}, {"Cx", 5}, {"Cy", 7.071}},
       {7, 7, 7},
       {9, 9, 9}}};
  return all;
}

class Loaded {
 public:
  explicit Loaded(const Machine& machine, std::map<std::string, double> other = {}) {
    if (!machine.coordinates.empty()) hal_.set_arg("coordinates", machine.coordinates);
    EXPECT_TRUE(hal_.create(*machine.module, machine.name)) << hal_.error();
    for (const auto& [pin, value] : other.empty() ? machine.pins : other)
      hal_.set(machine.name + "." + pin, value);
    kinematics_ = static_cast<Kinematics*>(hal_.find_service(kKinematicsService));
    EXPECT_NE(kinematics_, nullptr);
  }
  Kinematics& operator*() const { return *kinematics_; }
  Kinematics* operator->() const { return kinematics_; }

 private:
  hal::TestBuilder hal_;
  Kinematics* kinematics_{nullptr};
};

const Machine& machine(const std::string& name) {
  for (const Machine& m : machines())
    if (m.name == name) return m;
  throw std::logic_error(name);
}

class EachKinematics : public testing::TestWithParam<std::string> {};

TEST_P(EachKinematics, ForwardAndInverseAreTheSameWay) {
  const Machine& m = machine(GetParam());
  const Loaded kinematics(m);
  std::mt19937 random(42);
  for (int n = 0; n < 2000; ++n) {
    JointVector joint{}, back{};
    for (std::size_t j = 0; j < m.low.size(); ++j)
      joint[j] = std::uniform_real_distribution<double>(m.low[j], m.high[j])(random);
    if (m.name == "5axiskins") joint[6] = joint[1];  // the second joint of Y
    Pose world;
    ASSERT_TRUE(kinematics->forward(joint, world)) << n;
    back = joint;
    for (std::size_t j = 0; j < m.low.size(); ++j)
      back[j] += m.name == "genserkins" || m.name == "pumakins" ? 0.2 : 0.0;
    ASSERT_TRUE(kinematics->inverse(world, back)) << n;
    for (std::size_t j = 0; j < m.low.size(); ++j)
      ASSERT_NEAR(back[j], joint[j], 1e-6) << n << " joint " << j;
    Pose again = world;
    ASSERT_TRUE(kinematics->forward(back, again));
    for (std::size_t axis = 0; axis < rtapi::kAxes; ++axis)
      ASSERT_NEAR(again[axis], world[axis], 1e-6);
  }
}

TEST_P(EachKinematics, OutOfReachIsNoSolutionAndNoCrash) {
  const Machine& m = machine(GetParam());
  const Loaded kinematics(m);
  if (m.name == "corexykins" || m.name == "5axiskins" || m.name == "tripodkins")
    GTEST_SKIP() << "reaches everywhere";
  JointVector joint{};
  Pose far;
  far.x = 1e5;
  EXPECT_FALSE(kinematics->inverse(far, joint));
  far.x = NAN;
  EXPECT_FALSE(kinematics->inverse(far, joint));
}

INSTANTIATE_TEST_SUITE_P(All, EachKinematics,
                         testing::Values("5axiskins", "corexykins", "genserkins", "lineardeltakins",
                                         "pumakins", "rotarydeltakins", "scarakins", "tripodkins"),
                         [](const auto& test) { return "k_" + test.param; });

/// Poses and joints as LinuxCNC 2.9 had them, in a running machine.
struct Row {
  const char* name;
  Values joints;
  Values world;  ///< X Y Z A B C
  double w{0};
  const std::map<std::string, double>* pins{nullptr};
};

TEST(Kinematics, AgreesWithLinuxcnc) {
  const std::vector<Row> rows{
      {"5axiskins", {-48.9779, 3, -2.4631, 12, 0, 0, 3}, {3, 3, 3, 0, 12, 0}},
      {"5axiskins", {-48.4522, -7.9365, 0.4713, 12, 12, 3, -7.9365}, {3, 3, 3, 0, 12, 12}, 3},
      {"5axiskins",
       {-144.0001, 43.8729, -37.8906, 34.8, -14.4, 10.5, 43.8729},
       {0, 6.9, -1.8, 0, 34.8, -14.4},
       10.5},
      {"lineardeltakins", {270, 270, 270}, {0, 0, 34.6366, 0, 0, 0}},
      {"lineardeltakins", {269.9809, 268.5386, 271.4144}, {3, 0, 34.6366, 0, 0, 0}},
      {"lineardeltakins", {266.7240, 253.6257, 259.4724}, {6, 12.3, 25.0366, 0, 0, 0}},
      {"rotarydeltakins", {1, 1, 1}, {0, 0, -10.1267, 0, 0, 0}},
      {"rotarydeltakins", {3.4997, -19.6773, 22.8311}, {3, 0, -10.1267, 0, 0, 0}},
      {"rotarydeltakins", {27.4891, -30.8802, 14.4740}, {3, 3, -10.1267, 0, 0, 0}},
      {"tripodkins", {9.8029, 6.0081, 4.8653}, {8, 4.7677, 3.0604, 0, 0, 0}},
      {"genserkins", {0, 0, 0, 0, 0.1, 0}, {17.0038, 5.5, 7.2, 180, -0.1, 0}},
      {"genserkins",
       {8.3650, -1.6290, 15.3034, -0.0620, -13.5754, 8.4252},
       {20.0038, 8.5, 7.2, 180, -0.1, 0}},
      {"genserkins",
       {7.2192, 7.7342, 7.7378, 22.2329, -30.2086, -24.2211},
       {20.0038, 8.5, 10.2, 192, 11.9, 12}},
      {"genserkins",
       {-13.6075, -74.0470, -5.2069, 38.5932, 114.5341, -38.5557},
       {515.9893, 12.3041, 588.4, -128.399, 0.001, 29.999},
       0,
       &kMelfa},
      {"pumakins", {0, 0, 0, 0, 0, 0}, {350, 70, -470, 180, 0, 0}},
      {"scarakins", {0, 0, 25, 0, 0, 0}, {640, 0, 465, 0, 0, 0}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(std::string(row.name) + " joint 0 " + std::to_string(row.joints[0]));
    const Loaded kinematics(machine(row.name),
                            row.pins != nullptr ? *row.pins : std::map<std::string, double>{});
    JointVector joint{};
    for (std::size_t j = 0; j < row.joints.size(); ++j) joint[j] = row.joints[j];
    Pose world;
    ASSERT_TRUE(kinematics->forward(joint, world));
    for (std::size_t axis = 0; axis < 6; ++axis) {
      double off = world[axis] - row.world[axis];
      if (rtapi::is_rotary(axis)) off -= 360.0 * std::round(off / 360.0);
      EXPECT_NEAR(off, 0, 1e-3) << rtapi::kAxisLetters[axis];
    }
    EXPECT_NEAR(world.w, row.w, 1e-9);
  }
}

TEST(Kinematics, LengthsOfPinsAreInTheUnitOfTheMachine) {
  const Loaded kinematics(machine("5axiskins"), {{"pivot-length", 10}});
  kinematics->use_unit(25.4);
  JointVector joint{};
  Pose world;
  world.b = 90;
  ASSERT_TRUE(kinematics->inverse(world, joint));
  EXPECT_NEAR(joint[0], -254, 1e-9);
  EXPECT_NEAR(joint[2], -254, 1e-9);
}

TEST(Kinematics, AnArmFindsItsWayFromWhereItStands) {
  const Loaded kinematics(machine("genserkins"), kMelfa);
  JointVector joint{0, -90.001, 0.001, 0.001, 90.001, 0.001};
  Pose world;
  ASSERT_TRUE(kinematics->forward(joint, world));
  JointVector nothing{};
  ASSERT_TRUE(kinematics->inverse(world, nothing));
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(nothing[j], joint[j], 1e-6) << j;
}

}  // namespace
}  // namespace kerf::motion
