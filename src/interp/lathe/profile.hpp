// Profile: the shape that a lathe cycle (G70-G72) cuts, as a chain of lines and arcs. Pure geometry in mm.
//
//     auto rounded = round_corners(moves);          // A and C words
//     auto path    = allowance(rounded, 0.5);       // what the tool follows to leave 0.5 mm
//
// Coordinates: `s` runs along the profile (Z in G71, X in G72) and `h` is the height, growing from the part towards where
// the cycle starts. The part lies below its profile: a move at height h over s cuts the part when h is below the profile
// there. Manual: "G70 Lathe finishing cycle", "G71 G72 Lathe roughing cycles".
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace kerf::interp::lathe {

/// mm. Lengths below this are none.
inline constexpr double kNothing = 1e-9;

struct Point {
  double s{0}, h{0};
  friend bool operator==(const Point&, const Point&) = default;
};

/// A straight or circular move. `corner` > 0: a fillet (or chamfer) of this size between its end and the next move.
struct Move {
  Point from, to;
  bool arc{false};
  bool ccw{false};  ///< turning from s towards h
  Point center{};
  double corner{0};
  bool chamfer{false};
};

/// Moves in travel order, each beginning where the one before ends.
using Path = std::vector<Move>;

/// Puts the fillets and chamfers in. Nothing: a corner is too large for its moves.
[[nodiscard]] std::optional<Path> round_corners(const Path& moves);

/// s never runs backwards, arcs do not bulge backwards, and the whole has some length in s.
[[nodiscard]] bool runs_forward(const Path& moves);

/// The way of a tool that leaves `distance` (not negative) on the profile, as a path that runs forward. `moves` must run
/// forward. Where the profile is too narrow for the distance, the way stays outside; it begins and ends
/// beside the ends of the profile. Empty: the profile is too narrow for the distance everywhere.
[[nodiscard]] Path allowance(const Path& moves, double distance);

/// Height of a path that runs forward at s: the highest point where it is vertical.
[[nodiscard]] double height_at(const Path& path, double s);

}  // namespace kerf::interp::lathe
