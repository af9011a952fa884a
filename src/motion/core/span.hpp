// Span: what the planner hands to the servo cycle, in path order; and what the servo tells the planner.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>

#include "motion/api/kinematics.hpp"
#include "motion/api/shared.hpp"
#include "motion/core/laws.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/tolerance.hpp"
#include "motion/core/plan_gate.hpp"

namespace kerf::motion {

/// What decides the speed that is wanted on a stretch. x is (dsigma/dt)^2.
struct SpeedBounds {
  double cap{0};       ///< of x, by the axes: no override passes it
  double feed_cap{0};  ///< of x, as programmed, at override 1
  double slope{0};    ///< largest |q'| in the axes that the speed is measured in; 0: no linear axis
  double rps{0};      ///< speed of spindle `per_rev` at which feed_cap counts
  bool rapid{false};  ///< follows the rapid override
  bool sync{false};   ///< follows a spindle: neither feeds nor overrides count
  std::int8_t per_rev{-1};  ///< the spindle that carries the feed (G95); -1: none
  bool reserved[5]{};
};

/// How a stretch follows its spindle (G33, G76). All moves of a thread have the same sigma a revolution, so their reference is one
/// straight line over the spindle's angle.
struct SyncBounds {
  double per_rev{0};  ///< sigma in one revolution; 0: the stretch follows no spindle
  double acc{0};      ///< of the whole move in sigma/s2, for planning how to come into step
  double jerk{0};     ///< the same in sigma/s3; 0: not limited
  double speed{0};    ///< what the axes can do along the move in sigma/s, whatever corners ask for
  double mm{1};       ///< of one sigma
  double to_end{0};   ///< sigma from the start of the stretch to the end of the thread
  std::int32_t spindle{0};
  bool first{false};  ///< its move begins a thread: the path waits for at-speed and index
  bool reserved[3]{};
};

/// A stretch of path with everything the servo cycle needs to run it in O(1).
struct PathSpan {
  path::Piece piece;
  double from{0}, length{0};  ///< the stretch [from, from + length] of the piece
  SpeedBounds speed;
  SyncBounds sync;
  double even_acc{
      0};  ///< above 0: |dx/dsigma|/2 is bounded by this all along (a straight); else by rows of the piece
  /// Their rows count besides, where kinematics mix axes. Plain memory of the planner: written before the span is pushed (release; the servo pops with
  /// acquire), and not again while the span, or the history that it becomes, can be driven.
  const path::JointCurve* joints{nullptr};
  double turned_at{0};      ///< above 0: driven backwards, from there in `joints`
  double even_jerk{0};      ///< above 0: with jerk limits, and even_acc bounds the stretch too
  double requested{0};      ///< mm/s (deg/s) as programmed; rapids: what the axes can do
  double to_move_end{0};    ///< sigma from the end of this stretch to the end of its move
  double heading{0};        ///< of the stretch where it begins, in XY (rad)
  Pose end;                 ///< of its move, as programmed
  std::uint64_t number{0};  ///< place in PlanSlots
  std::uint64_t done_seq{
      0};  ///< all items up to this one are done at its end; 0: none more than before
  MotionKind kind{MotionKind::feed};
  bool stop_at_end{false};     ///< the machine stands there
  bool at_end_exactly{false};  ///< it ends at `end` itself
  bool probe{false}, probe_until_open{false}, probe_fail_is_error{false};
  bool point{false};   ///< nothing moves
  bool by_law{false};  ///< driven by a time law (laws.hpp)
  bool reserved{false};
  std::uint32_t blocks{
      0};  ///< PlanSlots::block: those that begin within it, its own first; 0: it is of one block
  std::uint64_t first_block{0};  ///< their number
};

/// Where within a span a block begins, which is where the one before it ends: blocks that G64 Q has joined, and such as are shorter than a span.
struct BlockStart {
  double left{0};             ///< of the span (sigma)
  std::uint64_t done_seq{0};  ///< all items up to this one are done there; 0: none more than before
  std::uint64_t seq{0};       ///< of the item that begins
  SourceTag tag;
};

/// G33.1. Positions along it are in mm from where it begins; the spindle takes it beyond both ends.
struct TapSpan {
  Pose begin;
  path::Vec direction;  ///< of one mm
  double depth{0}, per_rev{0}, return_factor{1};
  double speed{0}, acc{0};  ///< limits along it
  double jerk{0};           ///< the same; 0: none
  double low{0}, high{0};   ///< how far it may be carried
  std::int32_t spindle{0};
  std::int32_t reserved{0};
};

/// Before and behind the move of a locking indexer: the path stands until joint.N.is-unlocked says so.
struct IndexerSpan {
  std::int32_t joint{0};
  bool unlock{false};  ///< else it locks
  bool reserved[3]{};
};

/// Everything else keeps its place between the moves.
struct Span {
  using Body = std::variant<PathSpan, Dwell, OutputChange, SpindleChange, PathControl,
                            OverrideEnable, ToolOffset, Marker, TapSpan, IndexerSpan>;
  std::uint32_t epoch{0};
  std::uint32_t reserved{0};
  std::uint64_t seq{0};  ///< of the item that it belongs to
  SourceTag tag;
  Body body{Marker{}};
};

/// The acceleration rows of [s0, s1] of its piece; those of joints for a share of their limits.
void rows_of(const PathSpan& span, double s0, double s1, const path::AxisLimits& limits,
             path::Rows& out, double joint_share = 1) noexcept;
/// Of all of it, for who looks at it as a whole.
void rows_of(const PathSpan& span, const path::AxisLimits& limits, path::Rows& out) noexcept;

inline constexpr std::size_t kSpans = 2048;
/// Planner -> servo. Both ends live in the realtime host.
using SpanRing = rtapi::SpscRing<Span, kSpans>;
/// Planner -> servo: items that were refused. The servo numbers and publishes them.
using FaultRing = rtapi::SpscRing<FaultRecord, 16>;

/// A move as it was programmed, for PathOracle.
struct ProgrammedMove {
  path::Piece piece;
  path::Tolerance tolerance;  ///< at most, of both of its corners
};

/// Planner -> servo: the last kSlots moves, numbered from 1. Older ones are overwritten, whoever still wants them.
class ProgrammedMoves {
 public:
  static constexpr std::uint64_t kSlots = 4096;

  /// Planner side.
  void add(const ProgrammedMove& move, std::uint64_t seq) noexcept {
    const std::uint64_t n = newest_.get() + 1;
    slot_[n % kSlots].write(move);
    seq_[n % kSlots].set(seq);
    newest_.publish(n);
  }
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_.observe(); }
  /// Of the item that the move was.
  [[nodiscard]] std::uint64_t seq(std::uint64_t number) const noexcept {
    return seq_[number % kSlots].get();
  }
  /// False: it is overwritten.
  [[nodiscard]] bool read(std::uint64_t number, ProgrammedMove& out) const noexcept {
    return slot_[number % kSlots].read(out, 2) && newest_.observe() < number + kSlots;
  }

 private:
  rtapi::SeqCell<ProgrammedMove> slot_[kSlots];
  rtapi::Word<std::uint64_t> seq_[kSlots];
  rtapi::Word<std::uint64_t> newest_{0};
};

/// How fast a span may be at its end: written by the planner, also while the span waits in the ring, whenever more path has come.
///
/// `hard` is the largest x from which everything behind, up to the stop that ends the path, can be driven within the limits of the axes. It
/// only grows. The planner raises it from the last span to the first with release stores, and the servo reads with acquire: who sees the
/// new value of one span sees the new values of all behind it. So whatever mixture the servo meets, it can always stop in time.
/// `soft` is the same with programmed feeds at the override in force; it may change either way, and nothing depends on it but the feed.
///
/// With jerk limits (ahead.hpp) `hard` is 0 where the path stands, the largest x with acceleration 0 where the limits along the path change, and
/// only above 0 elsewhere. `soft` is 0 where it is to stand, in single step the largest x from which that can be done where the limits change, and
/// kNoLimit elsewhere. `ahead` says of each span what the servo needs to look ahead. It is written before the `hard` of the span before it rises above 0.
struct PlanSlots {
  /// A cache line: the servo reads many of them in one look ahead.
  struct alignas(64) Ahead {
    rtapi::Word<double> length, acc, jerk, cap, feed_cap, slope, rps;
    rtapi::Word<std::int32_t> rapid, per_rev;
  };
  Ahead ahead[kSpans];
  rtapi::Word<double> hard[kSpans];
  rtapi::Word<double> soft[kSpans];
  /// 1 while `soft` and the laws stand at the ends of blocks (single step). Published behind them; no step begins before it is seen (acquire).
  rtapi::Word<std::uint32_t> steps{0};
  /// By number. Plain memory: written before the span that names them is pushed (release; the servo pops with acquire), and not again before the
  /// servo has popped that span (release; the planner looks at the count with acquire).
  static constexpr std::size_t kBlocks = 8192;
  BlockStart block[kBlocks];
  /// 1 while the planner holds items that are in neither ring. Published before an item leaves the path ring, and taken back after
  /// its spans are in theirs; so who looks at path ring, this word and span ring in that order sees every item somewhere.
  rtapi::Word<std::uint32_t> pending{0};
  ProgrammedMoves programmed;  ///< only with MachineConfig::path_check
  Laws laws;
  PlanGate gate;
};

/// What scales the programmed feeds.
struct FeedScale {
  double feed{1}, rapid{1};
  double max_vel{1e99};        ///< the operator's limit [mm/s]
  double rps[kMaxSpindles]{};  ///< measured speeds, in steps of a hundredth (G95)
  friend bool operator==(const FeedScale&, const FeedScale&) = default;
};

/// The x that is wanted at a scale; 0 stands.
[[nodiscard]] double wanted_x(const SpeedBounds& speed, const FeedScale& scale) noexcept;
/// Of x, 1e-3 mm/s. Laws from rest to less lose seconds at their start: what they gain there is nothing beside all that they last.
inline constexpr double kLeastFromRest = 1e-6;
/// With jerk limits a feed that overrides hold below that is waited for at rest.
[[nodiscard]] inline bool awaits_feed(const SpeedBounds& speed, double x) noexcept {
  return x < kLeastFromRest && std::min(speed.cap, speed.feed_cap) >= kLeastFromRest;
}

/// Servo -> planner, once a cycle.
struct ServoView {
  std::uint32_t acked_epoch{0};
  std::uint32_t void_epoch{
      0};  ///< items of this epoch and older ones are void: the machine was disabled, or a move failed
  std::uint64_t executed_seq{0};
  std::uint64_t place{
      0};     ///< raised whenever the machine came to stand elsewhere than where the path led
  Pose pose;  ///< commanded position; what a path that begins now begins from
  std::uint64_t config_version{0};  ///< of the limits that the servo goes by; the shell knows it
  std::uint64_t config_wish{
      0};  ///< not 0: the servo wants to change its limits; the planner stands still meanwhile
  /// Of a joint from its place by the inverse kinematics: a leg of a gantry that stands beside its partner.
  double skew[kMaxJoints]{};
  JointVector
      joint{};  ///< where the joints stand, without that: which of several solutions the kinematics are in
  Pose shift;  ///< of the machine from the path's coordinates, which `pose` and all moves are in
  FeedScale scale;
  LawPlace law;
  std::uint64_t cycle{0};
  bool takes_moves{false};  ///< enabled, in coordinated mode
  bool single_step{false};
  bool reserved[6]{};
};

}  // namespace kerf::motion
