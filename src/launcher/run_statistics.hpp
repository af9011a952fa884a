// What a program run made of the machine, computed from the record of every servo cycle.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "motion/api/joint_log.hpp"

namespace kerf::launcher {

/// Velocities and accelerations are differences of the commanded positions, so they check the planner from outside.
class RunStatistics {
 public:
  struct Joint {
    double peak_vel{0};  ///< mm/s or deg/s
    double peak_acc{0};  ///< mm/s^2 or deg/s^2
    double min{std::numeric_limits<double>::infinity()};
    double max{-std::numeric_limits<double>::infinity()};
  };

  /// Cycles in order. After a gap (dropped records) differences begin anew.
  void add(const motion::JointSample& sample);

  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  [[nodiscard]] double feed_length_mm() const { return feed_mm_; }
  [[nodiscard]] double rapid_length_mm() const { return rapid_mm_; }
  [[nodiscard]] std::uint64_t cycles() const { return cycles_; }
  [[nodiscard]] std::uint64_t missing_cycles() const { return missing_; }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Blocks during which the machine moved.
  [[nodiscard]] std::uint64_t moving_blocks() const { return moving_blocks_; }

 private:
  void add_joints(const motion::JointSample& sample);
  void add_path(const motion::JointSample& sample);

  std::vector<Joint> joints_;
  motion::JointSample before_;
  double velocity_[motion::kMaxJoints]{};
  int in_row_{0};  ///< consecutive cycles so far, at most 2 matter
  std::uint64_t cycles_{0}, missing_{0}, moving_blocks_{0}, last_block_{0};
  bool block_counted_{false};
  double feed_mm_{0}, rapid_mm_{0}, seconds_{0};
};

/// A joint's configured limits and unit.
struct JointLimits {
  double max_vel{0}, max_acc{0};
  bool rotary{false};
};

struct SummaryInput {
  std::string program;    ///< name to show
  int program_lines{0};   ///< of the main file
  int lines_executed{0};  ///< how far it came
  std::uint64_t dropped{0};
  std::vector<JointLimits> limits;
};

/// The text that follows a run: several lines, each ended.
[[nodiscard]] std::string format_summary(const RunStatistics& run, const SummaryInput& input);

/// "1 h 02 min 03 s", "2 min 03.4 s", "3.4 s".
[[nodiscard]] std::string format_duration(double seconds);

}  // namespace kerf::launcher
