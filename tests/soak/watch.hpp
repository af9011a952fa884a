// Watch: looks at every servo cycle of a soak.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/status.hpp"
#include "soak/mills.hpp"

namespace kerf::soak {

class Watch {
 public:
  /// `mill` must outlive it.
  explicit Watch(const Mill& mill);
  void look(const motion::MotionStatus& s);
  /// From now on nothing may move and no spindle may turn.
  void expect_rest(bool on) { rest_ = on, rest_known_ = false; }
  /// What was broken since the last call, a line each.
  [[nodiscard]] std::vector<std::string> take_complaints();

  double seconds{0};
  double travelled_mm{0};

 private:
  /// A place that moves, seen in one cycle after the other.
  struct Mover {
    double at{0}, vel{0}, acc{0};
    int seen{0};  ///< cycles without a gap, up to 3
    bool was_inside{false};
  };

  void complain(const motion::MotionStatus& s, const std::string& what);
  void look_at(const motion::MotionStatus& s, const std::string& name, Mover& mover,
               const MotionLimits& limits, double at);
  void look_at_joint(const motion::MotionStatus& s, std::size_t j);
  void look_at_axis(const motion::MotionStatus& s, std::size_t a, double at);

  const Mill& mill_;
  std::vector<std::string> complaints_;
  std::vector<Mover> joint_;
  std::array<Mover, 3> axis_;
  struct Home {
    double offset{0};
    bool known{false};
  };
  std::vector<Home> home_;
  std::vector<double> rest_at_;
  double period_s_{0.001};
  bool rest_{false}, rest_known_{false};
  int off_cycles_{0};
};

}  // namespace kerf::soak
