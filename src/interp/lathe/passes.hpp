// Passes: the moves of a roughing cycle along a path that leaves the allowance (profile.hpp). Pure geometry.
#pragma once

#include <cstdint>

#include "interp/lathe/profile.hpp"

namespace kerf::interp::lathe {

/// More moves than this are a typing mistake in I that would fill the memory.
inline constexpr int kMostMoves = 200000;

/// Receives the moves of a cycle, in order.
class Tool {
 public:
  virtual ~Tool() = default;
  virtual void rapid(Point to) = 0;
  virtual void feed(Point to) = 0;
  virtual void arc(const Move& move) = 0;
};

enum class Pockets : std::uint8_t {
  all,   ///< G71, G72
  none,  ///< G71.1, G72.1: the tool goes straight across them
  only,  ///< G71.2, G72.2: what the former left
};

struct Roughing {
  Point
      start;  ///< where the cycle begins: surface of the stock, on the free side of the profile's beginning
  double cut{1};        ///< I > 0: difference in height of the passes
  double retract{0.5};  ///< R >= 0: lift off in both directions
  Pockets pockets{Pockets::all};
};

/// Makes the moves. What they keep to, when nothing but stock below `start.h` lies between the entry line (from start to
/// the path's beginning) and the path's end: no move is below the path, no rapid goes through stock, no feed takes a
/// layer higher than `cut`. False: more than kMostMoves, the tool has got a part of them.
[[nodiscard]] bool rough(const Path& path, const Roughing& cycle, Tool& tool);

/// The straight way from a to b stays above the path. May say no where an arc of the path bulges towards a slope.
[[nodiscard]] bool clear_of(const Path& path, Point a, Point b);

[[nodiscard]] double highest(const Path& path);

/// Follows the path from its beginning, where the tool stands.
void follow(const Path& path, Tool& tool);

}  // namespace kerf::interp::lathe
