// Families: generated programs for the planner's benchmark. Seeded; the same seed gives the same moves everywhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/config.hpp"
#include "motion/api/path_items.hpp"

namespace kerf::bench {

/// What a program runs on.
enum class Machine {
  mill,  ///< reference_machine(): XYZA
  table,  ///< XYZAC, the work on a table that turns about Z on one that tilts about X (tilting_table.hpp)
  lathe,  ///< the same with a spindle that is followed
};

struct Program {
  std::string name;
  double p_mm{0};  ///< G64 P
  Machine machine{Machine::mill};
  bool inverse_time{false};  ///< every block has its own time (G93)
  bool merges{true};         ///< G64 Q is P, as in G64 without Q; false: Q0
  std::vector<motion::PathItems::Variant> items;
};

/// Writes moves one after another, as an interpreter would.
class ProgramWriter {
 public:
  ProgramWriter(std::string name, double p_mm, double feed, bool merges = true);
  void line(const motion::Pose& to);
  void rapid(const motion::Pose& to);
  /// In the XY plane about (cx, cy), counterclockwise for sweep > 0 [rad]; Z and A go along.
  void arc(double cx, double cy, double sweep, double dz = 0, double da = 0);
  void thread(const motion::Pose& to, double pitch);
  void turn(double rpm);
  void feed(double mm_s) { feed_ = mm_s; }
  [[nodiscard]] const motion::Pose& at() const { return at_; }
  [[nodiscard]] Program done() { return std::move(program_); }
  [[nodiscard]] Program& program() { return program_; }

 private:
  Program program_;
  motion::Pose at_;
  double feed_;
};

/// The machine on which LinuxCNC's figures were taken: X Y 200 mm/s, Z 150 mm/s, XYZ 1750 mm/s2, A 90 deg/s and 1200 deg/s2.
void reference_machine(motion::MachineConfig& config);

[[nodiscard]] Program freeform(int segments, double p_mm, double feed, std::uint64_t seed,
                               bool merges = true);
/// A smooth curve, which leaves room for the feed in all of it, in lines of `step` mm: a circle of R40, or bends of at most 0.08/mm to both sides.
[[nodiscard]] Program dense_lines(double length, double step, double p_mm, double feed, bool merges,
                                  bool circle);
/// Rows over a surface with waves of `detail` to 6 times as long, each with slopes of up to `slope`, in chords of 0.05 to 0.2 mm with three decimals: what CAM makes of a relief.
[[nodiscard]] Program relief(int segments, double p_mm, double feed, bool merges,
                             std::uint64_t seed, double detail = 4, double slope = 0.25);
/// Short arcs to the left and to the right in turns along a spiral, meeting nearly in one direction.
[[nodiscard]] Program short_arcs(double p_mm, double feed);
/// Arcs that meet at any angle.
[[nodiscard]] Program arc_spiral(double p_mm, double feed);
/// Arcs that meet almost in one direction: kinks of at most `kink` rad.
[[nodiscard]] Program arc_wave(double p_mm, double feed, double kink);
[[nodiscard]] Program helical_arcs(double p_mm, double feed);
/// Upwards in quarter turns that meet nearly in one direction.
[[nodiscard]] Program helix(double p_mm, double feed);
[[nodiscard]] Program zigzag(double p_mm, double feed, double leg = 13);
/// A contour of lines with fillets and chamfers of 0.02 to 1 mm.
[[nodiscard]] Program contour(int corners, double p_mm, double feed, std::uint64_t seed);
[[nodiscard]] Program corner(double degrees, double leg, double p_mm, double feed);
[[nodiscard]] Program fractal(int order, double step, double p_mm, double feed);
[[nodiscard]] Program four_axis(int moves, double p_mm, double feed, bool reversing,
                                std::uint64_t seed);
/// G93: XYZ and A in blocks of 0.3 to 6 mm, each with its own time.
[[nodiscard]] Program inverse_time(int moves, double p_mm, std::uint64_t seed);
/// Passes of a thread in Z (G33) with rapids back, deeper in X each time.
[[nodiscard]] Program threading(int passes, double pitch, double rpm);
/// Short five-axis moves along a wall that leans to all sides, on a tilting table.
[[nodiscard]] Program swarf(int moves, double p_mm, double feed, std::uint64_t seed = 3);
/// Lines, arcs and cubics that go on in one direction, with jumps of curvature where they meet; with P or on an exact path (G61). `rounded`: points with
/// three decimals, so that they meet at small angles.
[[nodiscard]] Program tangent_moves(int moves, bool exact, bool rounded, std::uint64_t seed);
[[nodiscard]] Program mixture(int moves, std::uint64_t seed);
/// Rows of lines of one length, straight, bending to either side or noisy, with corners, single tiny or long moves, small arcs and other feeds between
/// them: what the planner cuts, of every kind.
[[nodiscard]] Program wander(int moves, std::uint64_t seed);

}  // namespace kerf::bench
