#include "soak/watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kerf::soak {
namespace {
/// As the guard's: for rounding only.
constexpr double kVelocityAllowance = 1.0001, kAccelerationAllowance = 1.001, kJerkAllowance = 1.01;
constexpr double kPlaceAllowance = 1e-6;
/// The switch is seen once a cycle, at the latch speed of 5 mm/s.
constexpr double kHomeRepeats = 0.006;
constexpr std::size_t kMostComplaints = 20;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", v);
  return text;
}
}  // namespace

Watch::Watch(const Mill& mill)
    : mill_(mill),
      joint_(mill.joints.size()),
      home_(mill.joints.size()),
      rest_at_(mill.joints.size()) {}

void Watch::complain(const motion::MotionStatus& s, const std::string& what) {
  if (complaints_.size() >= kMostComplaints) return;
  complaints_.push_back("cycle " + std::to_string(s.cycle) + " line " +
                        std::to_string(s.current.line) + ": " + what);
}

std::vector<std::string> Watch::take_complaints() {
  std::vector<std::string> out;
  out.swap(complaints_);
  return out;
}

void Watch::look_at(const motion::MotionStatus& s, const std::string& name, Mover& mover,
                    const MotionLimits& limits, double at) {
  const double v = (at - mover.at) / period_s_, a = (v - mover.vel) / period_s_,
               j = (a - mover.acc) / period_s_;
  // Positions are numbers of 1e-13 of their own size.
  const double rounding = 1e-12 / (period_s_ * period_s_ * period_s_);
  if (mover.seen > 0 && std::fabs(v) > limits.vel * kVelocityAllowance)
    complain(s,
             name + " moves at " + number(v) + " per second, " + number(limits.vel) + " allowed");
  if (mover.seen > 1 && std::fabs(a) > limits.acc * kAccelerationAllowance)
    complain(s, name + " accelerates with " + number(a) + ", " + number(limits.acc) + " allowed");
  if (mover.seen > 2 && limits.jerk > 0 && std::fabs(j) > limits.jerk * kJerkAllowance + rounding)
    complain(s, name + " has a jerk of " + number(j) + ", " + number(limits.jerk) + " allowed");
  mover.at = at;
  mover.vel = mover.seen > 0 ? v : 0;
  mover.acc = mover.seen > 1 ? a : 0;
  mover.seen = std::min(mover.seen + 1, 3);
}

void Watch::look_at_joint(const motion::MotionStatus& s, std::size_t j) {
  const motion::JointStatus& joint = s.joint[j];
  const MotionLimits& limits = mill_.joints[j];
  const std::string name = "joint " + std::to_string(j);
  Mover& mover = joint_[j];
  Home& home = home_[j];
  // Homing gives the place another name; a drive that is off has no commanded motion.
  if (!s.enabled || s.homing_active || joint.homing) {
    mover.seen = 0;
    if (s.homing_active)
      home.known = home.known && std::fabs(joint.motor_offset - home.offset) < kHomeRepeats;
    return;
  }
  if (mover.seen > 0) travelled_mm += std::fabs(joint.pos_cmd - mover.at);
  look_at(s, name, mover, limits, joint.pos_cmd);
  if (!joint.homed) return;
  if (joint.pos_cmd < limits.low - kPlaceAllowance || joint.pos_cmd > limits.high + kPlaceAllowance)
    complain(s, name + " is at " + number(joint.pos_cmd) + ", beyond its limits");
  if (!mill_.has_switches) return;
  if (home.known && std::fabs(joint.motor_offset - home.offset) > kHomeRepeats)
    complain(s, name + " has drifted: its motor offset was " + number(home.offset) + " and is " +
                    number(joint.motor_offset));
  if (!home.known) home = {joint.motor_offset, true};
}

/// Axes have limits where they are what is commanded. A jog of joints may have left their bounds; from within nothing does.
void Watch::look_at_axis(const motion::MotionStatus& s, std::size_t a, double at) {
  const MotionLimits& limits = mill_.axes[a];
  const std::string name = std::string("axis ") + "XYZ"[a];
  Mover& mover = axis_[a];
  if (!s.enabled || s.homing_active || s.mode == motion::MotionMode::free) {
    mover.seen = 0;
    mover.was_inside = false;
    return;
  }
  look_at(s, name, mover, limits, at);
  const bool inside = at >= limits.low - kPlaceAllowance && at <= limits.high + kPlaceAllowance;
  if (mover.was_inside && !inside && s.all_homed)
    complain(s, name + " has left its limits, it is at " + number(at));
  mover.was_inside = inside;
}

void Watch::look(const motion::MotionStatus& s) {
  period_s_ = static_cast<double>(s.servo_period_ns) * 1e-9;
  seconds += period_s_;
  for (std::size_t j = 0; j < joint_.size(); ++j) look_at_joint(s, j);
  const std::array<double, 3> axes{s.pos_cmd.x, s.pos_cmd.y, s.pos_cmd.z};
  for (std::size_t a = 0; a < axes.size(); ++a) look_at_axis(s, a, axes[a]);
  off_cycles_ = s.enabled ? 0 : off_cycles_ + 1;
  if (off_cycles_ > 1 && s.spindle[0].on) complain(s, "the spindle is on while the machine is off");
  if (!rest_) return;
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    if (rest_known_ && s.joint[j].pos_cmd != rest_at_[j])
      complain(s, "joint " + std::to_string(j) + " moves at rest by " +
                      number(s.joint[j].pos_cmd - rest_at_[j]));
    rest_at_[j] = s.joint[j].pos_cmd;
  }
  rest_known_ = true;
  if (s.spindle[0].on) complain(s, "the spindle turns at rest");
}

}  // namespace kerf::soak
