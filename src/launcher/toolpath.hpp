// The tool path of a program run, thinned out while it is recorded.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "motion/api/joint_log.hpp"

namespace kerf::launcher {

using Point3 = std::array<double, 3>;  ///< X Y Z in mm, machine coordinates

/// A piece of path of one kind and one programmed feed. At least two points; a piece begins where the one before ends.
struct PathPiece {
  bool rapid{false};
  double feed_mm_min{0};  ///< programmed; 0 for rapids
  std::vector<Point3> points;
};

/// Keeps as few points as the tolerance allows (Douglas and Peucker 1973: the line is split at its farthest point until
/// none is farther than the tolerance). The ends stay.
[[nodiscard]] std::vector<Point3> simplify(const std::vector<Point3>& points, double tolerance_mm);

class ToolpathRecorder {
 public:
  static constexpr double kToleranceMm = 0.002;
  /// Points of one piece before they are thinned out; bounds memory.
  static constexpr std::size_t kChunk = 4096;

  void add(const motion::JointSample& sample);
  /// Ends the piece in progress.
  void finish();
  [[nodiscard]] const std::vector<PathPiece>& pieces() const { return pieces_; }

 private:
  void thin(PathPiece& piece);
  std::vector<PathPiece> pieces_;
  std::size_t thinned_{0};  ///< points of the last piece that are final
  Point3 last_{};
  bool started_{false};
};

}  // namespace kerf::launcher
