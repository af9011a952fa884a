// PathOracle: checks in every servo cycle that the machine is within G64 P of what was programmed. @rt.
//
// The planner notes each move as it was programmed, before lines are merged and corners blended; the servo cycle looks how far its
// commanded place is from the nearest of the moves around the one in execution. Nothing else of the planner's work is relied on.
// [KERF]PATH_CHECK switches it on.
#pragma once

#include <cstdint>

#include "motion/core/io.hpp"
#include "motion/core/joint.hpp"
#include "motion/core/span.hpp"

namespace kerf::motion {

class PathOracle {
 public:
  /// Rounding of places and sums (mm, degrees).
  static constexpr double kRounding = 1e-6;

  /// Forgets the latched break.
  void reset() noexcept { broken_ = false; }
  /// `pose`: on the path of the move with the number `seq`. The first break is reported, and nothing more until reset().
  void check(const ProgrammedMoves& moves, const Pose& pose, std::uint64_t seq,
             const SourceTag& tag, FaultList& faults) noexcept;
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  [[nodiscard]] bool within(const ProgrammedMoves& moves, std::uint64_t number,
                            const path::Vec& place, bool carefully) noexcept;
  void follow(const ProgrammedMoves& moves, std::uint64_t newest, std::uint64_t seq) noexcept;

  std::uint64_t at_{0};    ///< the last noted move that is not behind the one in execution
  std::uint64_t near_{0};  ///< that the machine was near to in the last cycle
  std::uint64_t held_{0};  ///< move_ is that one
  ProgrammedMove move_;
  double least_{0};                ///< the smallest share of the tolerance seen in this cycle ...
  path::Vec off_;                  ///< ... the way from there ...
  path::Tolerance least_allowed_;  ///< ... and what was allowed
  bool broken_{false};
};

/// A distance from the move as a share of its tolerance. `carefully`: where mm and degrees count against each other the nearest place by both
/// together is not always that of the least share; this one is sought, which takes some microseconds. `off`: the way from there.
[[nodiscard]] double share_of(const ProgrammedMove& move, const path::Vec& place, bool carefully,
                              path::Vec& off) noexcept;

}  // namespace kerf::motion
