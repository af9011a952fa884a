// Ahead: how fast the path may be driven now, with jerk limits. Pure arithmetic, @rt.
//
// Each stretch has a box: a speed, an acceleration and a jerk along the path that keep all axes within their limits there
// (path/boxes.hpp). Neighbours with the same acceleration and jerk are a group. Within a group a ramp (ramp.hpp) to any lower
// speed may begin at any moment, so what has to hold is only that the ramps to the caps ahead, each seen by itself, still fit; the lowest
// of their peaks is the speed to aim at. A group whose limits are other ones is entered in one of two ways: with acceleration 0 at no more
// than the speed that the planner has found for that place, with the limits of the group that is left; or with the least limits
// of both all the way to the end of the second one, and so on for some groups. One of the ways is always open, since braking never
// leaves it; so hold, abort and override act in the cycle in which they come.
#pragma once

#include <cstdint>

#include "motion/core/ramp.hpp"
#include "motion/core/span.hpp"

namespace kerf::motion {

struct Course {
  RampLimits limits;
  double target{0};     ///< speed that the ramp leads to
  double cruise{0};     ///< way at `target` before the next ramp has to begin, once it is reached
  double brake_to{0};   ///< what that ramp leads to
  double known{1e99};   ///< way for which all that bears on the course has been seen
  bool feasible{true};  ///< false: no way is open any more; never seen but for a fault of ours
};

/// Finds the course between bounds that are added from the nearest to the farthest, all with the same limits.
class CourseFinder {
 public:
  /// The course is for `dt` seconds from `state`, at speeds of at most `cap`.
  CourseFinder(RampState state, double cap, double dt, const RampLimits& limits) noexcept;
  /// `hard`: the speed that is needed there; bound.speed may be a lower one that is only wanted. False: no farther one bears on the course.
  bool add(const RampBound& bound, double hard) noexcept;
  [[nodiscard]] const Course& course() const noexcept { return course_; }
  /// What lies farther bears on nothing.
  [[nodiscard]] double horizon() const noexcept { return horizon_; }

 private:
  Course course_;
  RampState state_;
  double fastest_{0}, horizon_{0};
  double released_{0};                  ///< speed when the acceleration is let go
  double first_{0}, first_target_{-1};  ///< way of the ramp to that target
  double none_;
  double lowest_, lowest_hard_;  ///< a cap behind a lower one bears on nothing
};

/// What to do at `left` before the end of span `number`, at `state`, at speeds of at most `cap` on this span, for the next `dt` seconds.
/// `stops_where_wanted`: it has to stand where that is wanted, which is feasible for who came from rest like that.
[[nodiscard]] Course course_ahead(const PlanSlots& slots, std::uint64_t number, double left,
                                  RampState state, double cap, const FeedScale& scale, double dt,
                                  bool stops_where_wanted = false) noexcept;

/// The highest speed with acceleration 0 at the start of span `number` from which all behind can be driven to the stop; with `wanted` to where
/// it is to stand (PlanSlots::soft), if that is nearer.
[[nodiscard]] double highest_level_speed(const PlanSlots& slots, std::uint64_t number,
                                         bool wanted = false) noexcept;

}  // namespace kerf::motion
