// Coarser moves: what is small against the tolerance, as longer straight lines near it.
//
// A blend takes at most half of a move, so a short arc or line between two others, a fillet or a chamfer, would keep blends narrower than the
// tolerance allows. As lines the moves can be smoothed together (smoothing.hpp). Whatever stays within what is left of the tolerance from them is
// within the tolerance of what is programmed. Each takes as much of sigma as the moves that it stands for.
#pragma once

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/tolerance.hpp"

namespace kerf::motion::path {

/// A line of the feed's path: `sigma` long, from `from`.
struct CoarseLine {
  Vec from, way;
  double sigma{0};
  Feed feed;
};

/// Lines along the tangents of an arc, at most kMostTangents + 1 of them, that are off it by `most` of the tolerance at the same sigma at most.
/// Gives that share; below 0: the arc is not small enough, and nothing is appended.
inline constexpr int kMostTangents = 4;
double tangents_of(const Piece& arc, const Tolerance& tolerance, double most,
                   Buffer<CoarseLine>& out) noexcept;

/// Chords of an arc, as few as do and at most `parts`, likewise: shorter than the arc, and where arcs meet at angles less bent.
double chords_of(const Piece& arc, const Tolerance& tolerance, double most, int parts,
                 Buffer<CoarseLine>& out) noexcept;

/// Lines that go on in one direction become one; short lines between two longer ones whose directions differ go: the longer ones lead on to where
/// they meet. Off by `most` of the tolerance at most; gives that share. The first and the last line begin and end where they did.
double join_lines(const Tolerance& tolerance, double most, Buffer<CoarseLine>& lines) noexcept;

/// Of lines [first, last) two whose common end is off by little become one. So straighten_lines() gets farther with rows of short and long ones. Gives
/// what is off.
double join_pairs(const Tolerance& tolerance, std::size_t first, std::size_t last,
                  Buffer<CoarseLine>& lines) noexcept;

/// Moves the places where lines meet so that they bend as little as they can, or with `taut` so that they are as short as they can be, by `most` of the
/// tolerance at most: for lines that wind to and fro within it. Gives that share; 0: nothing is moved. The first and the last line stay as they are. `work`: for
/// its own use. By successive over-relaxation, each place within its ball.
double straighten_lines(const Tolerance& tolerance, double most, bool taut,
                        Buffer<CoarseLine>& lines, Buffer<Vec>& work) noexcept;

/// The least time from one end to the other limited in acceleration, beginning and ending as fast as may be; `x` is for its own use. kNoLimit: x
/// is too small.
[[nodiscard]] double least_seconds(const Piece* pieces, std::size_t count, const AxisLimits& limits,
                                   Buffer<double>& x) noexcept;

}  // namespace kerf::motion::path
