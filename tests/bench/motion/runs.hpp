// Runs: a program driven through planner and servo cycle without HAL, one millisecond a cycle, and what was measured on the way.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/motion/families.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/planner/law_maker.hpp"
#include "motion/core/span.hpp"

namespace kerf::bench {

struct RunOptions {
  double jerk{0};         ///< of every joint [mm/s3, deg/s3]; 0: limited in acceleration only
  bool overrides{false};  ///< the feed override changes at random, 5 to 200 %
  std::uint64_t seed{1};
  bool deviation{false};  ///< measure it too, which costs time
  bool record{false};     ///< keep the commanded positions
  double path_jerk{0};    ///< along the path too [mm/s3]; 0: not limited
  bool swings{false};     ///< the feed changes in every cycle, 40 to 100 %, as adaptive feed does
};

struct RunResult {
  double seconds{0};  ///< from the first movement to the last
  double length{0};   ///< driven in XYZ [mm]
  double vel{0}, acc{0},
      jerk{0};  ///< largest share of a joint limit, by differences of the commanded positions
  double deviation{0};  ///< from the programmed path in XYZ [mm]
  double planner_s{0};
  double stops_s{0};  ///< of it, for stops that are kept ready
  double servo_s{
      0};  ///< of `timed` cycles; those in which the system took the processor away are left out
  double slowest{0};  ///< mm/s, the least speed in the middle half of the run
  std::size_t moves{0}, cycles{0}, timed{0}, faults{0};
  motion::LawMaker::Counts laws;    ///< what was made
  std::uint64_t hash{0};            ///< of all commanded positions
  std::vector<motion::Pose> track;  ///< one of each cycle, where recorded
};

[[nodiscard]] RunResult run(const Program& program, const RunOptions& options);

/// The curve that the planner makes of the program, stretch by stretch, and the limits of the axes; `jerk` 0: none.
[[nodiscard]] std::vector<motion::PathSpan> curve_of(const Program& program, double jerk,
                                                     motion::path::AxisLimits& limits);
/// Largest (dsigma/dt)^2 by the axes' velocities and the feed where q' is `slope`.
[[nodiscard]] double speed_cap(const motion::path::Piece& piece, const motion::path::Vec& slope,
                               const motion::path::AxisLimits& limits);

/// The least time on the very curve that the planner has made of the program, by velocity and acceleration limits and feeds: a grid eight
/// times finer than the planner's, limits at its nodes only, one backward and one forward pass. 0: a lathe, whose spindle is the bound.
[[nodiscard]] double optimum(const Program& program);

struct LeastTime {
  double seconds{0};
  double gap_s{0};  ///< by which the method may still be off
  /// An independent look at the motion that was found: samples of its positions, largest share of a joint's limit by differences.
  double acc{0}, jerk{0};
  /// Samples, and those of them at which some joint uses nearly all of a limit, or the feed is reached: a motion that takes the least time does
  /// so all along.
  std::size_t samples{0}, saturated{0};
  int iterations{0};  ///< of the longest run
};
/// Steps of its grid on a stretch of a curve (a corner has some sixteen). Four times as many find up to 0.7 % more where q''' jumps between stretches.
inline constexpr int kLeastTimeSteps = 4;
/// The same with jerk limits, on the curve that the planner makes with them (jerk_optimum.hpp).
[[nodiscard]] LeastTime least_time(const Program& program, double jerk,
                                   int curve_steps = kLeastTimeSteps);

/// Length of all moves over their feeds; rapids over what the axes can do.
[[nodiscard]] double feed_floor(const Program& program);

struct RetraceResult {
  double off{
      0};  ///< the largest distance from the curve that was driven forwards, in any axis [mm, deg]
  double length{0};  ///< driven backwards, in XYZ [mm]
  std::size_t faults{0};
};

/// Drives most of a program, then backwards (adaptive feed -1) to where the machine stands.
[[nodiscard]] RetraceResult retrace(const Program& program, double jerk);

/// The program as G-code that LinuxCNC reads too. False: the file cannot be written.
[[nodiscard]] bool write_gcode(const Program& program, const std::string& file);

/// The sum of the closed forms of all moves driven from stop to stop; straight moves only.
[[nodiscard]] double stops_closed_form(const Program& program, double jerk);

}  // namespace kerf::bench
