// The machines of machines.tsv, loaded.
#pragma once

#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "motion/api/kinematics.hpp"

namespace kerf::motion::test {

/// A joint's or an axis' range.
struct Range {
  double low{0}, high{0};
  bool degrees{false};
  int same_as{-1};  ///< the joint that it stands beside
};

struct Machine {
  std::string name, module;
  std::int32_t kind{0};
  std::vector<std::pair<std::string, std::string>> args;
  std::vector<std::pair<std::string, double>> pins;
  std::vector<Range> joints;  ///< or, for machines whose inverse is the plain one:
  std::vector<std::pair<std::size_t, Range>> axes;  ///< index of XYZABCUVW
  double size_mm{0};
  std::vector<std::pair<std::size_t, double>> out_of_reach;
  // NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
  friend void PrintTo(const Machine& m, std::ostream* out) { *out << m.name; }
};

const std::vector<Machine>& machines();
const Machine& machine(const std::string& name);
/// All modules of components/kinematics.
std::vector<std::string> modules();

class Loaded {
 public:
  explicit Loaded(const Machine& machine);
  Kinematics& operator*() const { return *kinematics_; }
  Kinematics* operator->() const { return kinematics_; }
  [[nodiscard]] hal::TestBuilder& hal() { return hal_; }

 private:
  hal::TestBuilder hal_;
  Kinematics* kinematics_{nullptr};
};

/// Joints and the pose that they mean. False: a test failed.
bool random_pose(const Machine& machine, const Kinematics& kinematics, std::mt19937_64& random,
                 JointVector& joint, Pose& world);

/// Of --count and --seed.
inline unsigned poses = 100'000, seed = 1;

}  // namespace kerf::motion::test
