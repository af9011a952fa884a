#include "soak/watch.hpp"

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

void Watch::look_at_joint(const motion::MotionStatus& s, std::size_t j) {
  const motion::JointStatus& joint = s.joint[j];
  const std::string name = "joint " + std::to_string(j);
  // Homing gives the place another name; a drive that is off has no commanded motion.
  if (!s.enabled || s.homing_active || joint.homing) {
    known_[j] = moved_[j] = pushed_[j] = false;
    last_[j] = joint.pos_cmd;
    if (s.homing_active)
      offset_known_[j] =
          offset_known_[j] && std::fabs(joint.motor_offset - offset_[j]) < kHomeRepeats;
    return;
  }
  if (known_[j]) {
    const double v = (joint.pos_cmd - last_[j]) / kPeriod;
    if (std::fabs(v) > kMaxVel[j] * kVelocityAllowance)
      complain(s, name + " moves at " + number(v) + " mm/s");
    const double a = (v - vel_[j]) / kPeriod;
    if (moved_[j] && std::fabs(a) > kMaxAcc[j] * kAccelerationAllowance)
      complain(s, name + " accelerates with " + number(a) + " mm/s2");
    if (max_jerk_ > 0 && pushed_[j] &&
        std::fabs(a - acc_[j]) / kPeriod > max_jerk_ * kJerkAllowance)
      complain(s, name + " has a jerk of " + number((a - acc_[j]) / kPeriod) + " mm/s3");
    pushed_[j] = moved_[j];
    acc_[j] = a;
    travelled_mm += std::fabs(joint.pos_cmd - last_[j]);
    vel_[j] = v;
    moved_[j] = true;
  }
  known_[j] = true;
  last_[j] = joint.pos_cmd;
  if (joint.homed &&
      (joint.pos_cmd < kLow[j] - kPlaceAllowance || joint.pos_cmd > kHigh[j] + kPlaceAllowance))
    complain(s, name + " is at " + number(joint.pos_cmd) + ", beyond its limits");
  if (!joint.homed) return;
  if (offset_known_[j] && std::fabs(joint.motor_offset - offset_[j]) > kHomeRepeats)
    complain(s, name + " has drifted: its motor offset was " + number(offset_[j]) + " and is " +
                    number(joint.motor_offset));
  if (!offset_known_[j]) offset_[j] = joint.motor_offset, offset_known_[j] = true;
}

void Watch::look(const motion::MotionStatus& s) {
  ++cycles;
  for (std::size_t j = 0; j < 3; ++j) look_at_joint(s, j);
  off_cycles_ = s.enabled ? 0 : off_cycles_ + 1;
  if (off_cycles_ > 1 && s.spindle[0].on) complain(s, "the spindle is on while the machine is off");
  if (!rest_) return;
  for (std::size_t j = 0; j < 3; ++j) {
    if (rest_known_ && s.joint[j].pos_cmd != rest_at_[j])
      complain(s, "joint " + std::to_string(j) + " moves at rest by " +
                      number(s.joint[j].pos_cmd - rest_at_[j]));
    rest_at_[j] = s.joint[j].pos_cmd;
  }
  rest_known_ = true;
  if (s.spindle[0].on) complain(s, "the spindle turns at rest");
}

}  // namespace kerf::soak
