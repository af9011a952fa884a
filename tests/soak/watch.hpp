// Watch: looks at every servo cycle of a soak.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/status.hpp"

namespace kerf::soak {

/// Of configs/sim/mill.
inline constexpr std::array<double, 3> kMaxVel{100, 100, 60}, kMaxAcc{1000, 1000, 600};
inline constexpr std::array<double, 3> kLow{-0.01, -0.01, -120}, kHigh{300, 200, 0.01};

class Watch {
 public:
  /// `max_jerk`: of all joints, 0 none.
  explicit Watch(double max_jerk) : max_jerk_(max_jerk) {}
  void look(const motion::MotionStatus& s);
  /// From now on nothing may move and no spindle may turn.
  void expect_rest(bool on) { rest_ = on, rest_known_ = false; }
  /// What was broken since the last call, a line each.
  [[nodiscard]] std::vector<std::string> take_complaints();

  std::uint64_t cycles{0};
  double travelled_mm{0};

 private:
  void complain(const motion::MotionStatus& s, const std::string& what);
  void look_at_joint(const motion::MotionStatus& s, std::size_t j);

  static constexpr double kPeriod = 0.001;
  std::vector<std::string> complaints_;
  double max_jerk_;
  std::array<double, 3> last_{}, vel_{}, acc_{}, offset_{};
  std::array<bool, 3> known_{}, moved_{}, pushed_{}, offset_known_{};
  std::array<double, 3> rest_at_{};
  bool rest_{false}, rest_known_{false};
  int off_cycles_{0};
};

}  // namespace kerf::soak
