// Positions as LinuxCNC's own modules compute them (peer.tsv, made by compare_with_peer).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "machines.hpp"

namespace kerf::motion::test {
namespace {

constexpr double kSame = 1e-6;  ///< mm, degrees
/// LinuxCNC's search for the joints of an arm ends when it is this near; its forward kinematics are exact.
constexpr double kSearched = 2e-5;

std::vector<double> numbers(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> out;
  for (double value = 0; in >> value;) out.push_back(value);
  return out;
}
JointVector joints_of(const std::string& text) {
  const auto values = numbers(text);
  JointVector out{};
  std::copy_n(values.begin(), std::min(values.size(), out.size()), out.begin());
  return out;
}
Pose pose_of(const std::string& text) {
  const auto values = numbers(text);
  Pose out;
  for (std::size_t i = 0; i < std::min(values.size(), rtapi::kAxes); ++i) out[i] = values[i];
  return out;
}

double apart(double a, double b, bool turns) {
  const double d = a - b;
  return std::fabs(turns ? d - 360.0 * std::round(d / 360.0) : d);
}

TEST(Agreement, WithLinuxcnc) {
  std::ifstream in(KERF_SOURCE_DIR "/tests/property/components/kinematics/peer.tsv");
  std::map<std::string, std::unique_ptr<Loaded>> loaded;
  double worst = 0;
  int rows = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> field;
    std::istringstream parts(line);
    for (std::string part; std::getline(parts, part, '\t');) field.push_back(part);
    ASSERT_EQ(field.size(), 5U) << line;
    const Machine& m = machine(field[0]);
    auto& k = loaded[m.name];
    if (!k) k = std::make_unique<Loaded>(m);
    ++rows;
    SCOPED_TRACE(line);
    double row = 0;
    if (field[1] == "F") {
      Pose world = pose_of(field[3]);
      const Pose theirs = pose_of(field[4]);
      ASSERT_TRUE((*k)->forward(joints_of(field[2]), world));
      for (std::size_t axis = 0; axis < rtapi::kAxes; ++axis)
        row = std::fmax(row, apart(world[axis], theirs[axis], rtapi::is_rotary(axis)));
    } else {
      JointVector joint = joints_of(field[3]);
      const JointVector theirs = joints_of(field[4]);
      ASSERT_TRUE((*k)->inverse(pose_of(field[2]), joint));
      const std::size_t n = m.axes.empty() ? m.joints.size() : m.axes.size();
      for (std::size_t j = 0; j < n; ++j)
        row = std::fmax(row, apart(joint[j], theirs[j], m.axes.empty() && m.joints[j].degrees));
    }
    EXPECT_LT(row, field[1] == "I" && m.module == "genserkins" ? kSearched : kSame);
    worst = std::fmax(worst, row);
  }
  std::printf("%d rows of %zu machines, worst %.1e mm or degrees\n", rows, loaded.size(), worst);
  EXPECT_GE(loaded.size(), 26U);
}

}  // namespace
}  // namespace kerf::motion::test
