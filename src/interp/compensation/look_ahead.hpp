// LookAhead: gouges between moves that are no neighbours ([RS274NGC]COMPENSATION_LOOK_AHEAD).
//
// CompPath sees two moves at a time. A slot narrower than the tool, or a wall that comes back after a few short moves, shows only
// when the tool's way along one move is held against the contour of others. This does so for the last `depth` moves of one plane.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "interp/compensation/path.hpp"

namespace kerf::interp {

/// A stretch of a path: a line, or an arc about `center`.
struct FlatPiece {
  Flat start, end;
  bool is_arc{false};
  Flat center{};
  double sweep{0};  ///< radians, > 0 counter-clockwise
};

/// The least distance between points of the two.
[[nodiscard]] double distance(const FlatPiece& p, const FlatPiece& q);

/// What look-ahead knows of one move.
struct GuardedMove {
  FlatPiece programmed;
  FlatPiece tool;                   ///< the way of the tool's centre
  std::optional<FlatPiece> corner;  ///< its way around the corner before
  int line{0};
  bool wall{true};         ///< the programmed path bounds the part: no G0
  double low{0}, high{0};  ///< across the plane
};

class LookAhead {
 public:
  struct Gouge {
    int tool_line, wall_line;
    double distance;
  };

  /// The first place where the tool of `radius` comes too near to the contour, between `next` and the moves before it.
  [[nodiscard]] std::optional<Gouge> gouge(const GuardedMove& next, double radius) const;
  /// `next` is one of the moves before from now on; those more than `depth` back are forgotten.
  void take(const GuardedMove& next, std::size_t depth);
  void clear() noexcept { moves_.clear(); }

 private:
  std::deque<GuardedMove> moves_;
};

}  // namespace kerf::interp
