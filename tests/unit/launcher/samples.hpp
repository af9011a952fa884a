// Records as joint-logger makes them, for tests.
#pragma once

#include "motion/api/joint_log.hpp"

namespace kerf::launcher::test {

/// Cycle `cycle` of a 1 kHz servo thread with three joints at x, y, z.
inline motion::JointSample sample(std::uint64_t cycle, double x, double y = 0, double z = 0) {
  motion::JointSample s;
  s.cycle = cycle;
  s.time_ns = static_cast<std::int64_t>(cycle) * 1'000'000;
  s.period_ns = 1'000'000;
  s.joints = 3;
  s.kind = motion::MotionKind::feed;
  s.block = 1;
  s.requested_vel_mm_s = 10;
  s.position[0] = s.joint[0] = x;
  s.position[1] = s.joint[1] = y;
  s.position[2] = s.joint[2] = z;
  return s;
}

}  // namespace kerf::launcher::test
