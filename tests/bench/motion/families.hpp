// Families: generated programs for the planner's benchmark. Seeded; the same seed gives the same moves everywhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/config.hpp"
#include "motion/api/path_items.hpp"

namespace kerf::bench {

struct Program {
  std::string name;
  double p_mm{0};  ///< G64 P
  std::vector<motion::PathItems::Variant> items;
};

/// Writes moves one after another, as an interpreter would.
class ProgramWriter {
 public:
  ProgramWriter(std::string name, double p_mm, double feed);
  void line(const motion::Pose& to);
  void rapid(const motion::Pose& to);
  /// In the XY plane about (cx, cy), counterclockwise for sweep > 0 [rad]; Z and A go along.
  void arc(double cx, double cy, double sweep, double dz = 0, double da = 0);
  void feed(double mm_s) { feed_ = mm_s; }
  [[nodiscard]] const motion::Pose& at() const { return at_; }
  [[nodiscard]] Program done() { return std::move(program_); }

 private:
  Program program_;
  motion::Pose at_;
  double feed_;
};

/// The machine on which LinuxCNC's figures were taken: X Y 200 mm/s, Z 150 mm/s, XYZ 1750 mm/s2, A 90 deg/s and 1200 deg/s2.
void reference_machine(motion::MachineConfig& config);

[[nodiscard]] Program freeform(int segments, double p_mm, double feed, std::uint64_t seed);
[[nodiscard]] Program arc_spiral(double p_mm, double feed);
[[nodiscard]] Program helical_arcs(double p_mm, double feed);
[[nodiscard]] Program zigzag(double p_mm, double feed);
[[nodiscard]] Program corner(double degrees, double leg, double p_mm, double feed);
[[nodiscard]] Program fractal(int order, double step, double p_mm, double feed);
[[nodiscard]] Program four_axis(int moves, double p_mm, double feed, bool reversing,
                                std::uint64_t seed);
[[nodiscard]] Program mixture(int moves, std::uint64_t seed);

}  // namespace kerf::bench
