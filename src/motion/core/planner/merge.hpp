// Merging of short lines (G64 Q): a row of feed lines that is nearly straight becomes one line. Pure arithmetic.
//
// What is merged stays within Q of the line that takes its place, and within a fifth of P, so that both together, merging and the blends at
// the corners that are left, stay within P. It saves work, and with jerk limits time (docs/planner.md). The ends of the lines stay known: where the
// machine can stand in single step, and where another line is shown.
#pragma once

#include <cstddef>

#include "motion/core/path/tolerance.hpp"

namespace kerf::motion {

class Merge {
 public:
  /// Of P: what merging may take of it.
  static constexpr double kShareOfTolerance = 0.2;
  static constexpr std::size_t kMost = 32;  ///< lines in one
  /// mm: points so near to a line are on it, in exact path mode and without Q too.
  static constexpr double kSameLine = 1e-7;

  /// Nothing can be added any more until begin().
  void end() noexcept { count_ = 0; }
  /// A line from `from` to `to`, which the next ones may be merged with.
  void begin(const path::Vec& from, const path::Vec& to) noexcept;
  /// Whether the lines so far and one more to `to` are within `within_mm` of one line, all of them leading forwards. If so, they are one.
  [[nodiscard]] bool add(const path::Vec& to, double within_mm) noexcept;
  [[nodiscard]] const path::Vec& start() const noexcept { return point_[0]; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// How far along the line the end of the n-th of them is, as a share of it.
  [[nodiscard]] double share(std::size_t n) const noexcept {
    return n + 1 < count_ ? share_[n] : 1.0;
  }
  /// How far the merged points are from the line at most.
  [[nodiscard]] double off_mm() const noexcept { return off_mm_; }

 private:
  path::Vec point_[kMost + 1];
  double share_[kMost]{};
  std::size_t count_{0};  ///< lines; 0: none
  double off_mm_{0};
};

}  // namespace kerf::motion
