// Executor: runs spans in the servo cycle. O(1) a cycle, pure arithmetic, @rt.
//
// The planner says how fast each span may be left (PlanSlots); within that the servo decides anew in every cycle, so overrides and stops
// act at once: x at the end of the span is what is wanted, but not less than the hardest braking on the path and not more
// than the hardest speeding up (path/reach.hpp).
//
// With jerk limits the planner makes time laws ahead (laws.hpp), and the servo follows them; where there is none it looks ahead itself.
//
// A negative adaptive feed runs the path backwards (retrace.cpp): the machine comes to rest, and then the stretch it stands on and those
// of path::PathHistory are driven like any other, each turned round. Back to the last dwell, spindle change, probe move or wait of the
// program at most. Forwards again, nothing of what the program did there is done twice.
#pragma once

#include <cstdint>

#include "motion/api/step.hpp"
#include "motion/core/ahead.hpp"
#include "motion/core/io.hpp"
#include "motion/core/path/history.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/span.hpp"
#include "motion/core/spindles.hpp"
#include "motion/core/synchronised.hpp"

namespace kerf::motion {

/// What bears on the path in this cycle.
struct PathInputs {
  bool stand{false};  ///< brake on the path and stay: hold, abort, lost heartbeat
  bool stop{false};   ///< the same, but for a hold: what follows a spindle stops for nothing else
  bool single_step{false};  ///< Intent::single_step
  bool backwards{false};    ///< Intent::backwards
  bool may_move{true};      ///< coordinated mode; else moves wait and only events are carried out
  bool probe{false}, feed_hold{false}, feed_inhibit{false};
  double feed_override{1}, rapid_override{1}, adaptive_feed{1};
  double max_vel_mm_s{1e99};
  Pose pose_fb;                   ///< what a probe contact latches
  std::int32_t unseen_joint{-1};  ///< its feedback is extrapolated, or was in the last cycle
  Pose shift;                     ///< of the machine from the path's coordinates
  const SpindleInputs* spindle{nullptr};         ///< kMaxSpindles of them
  std::uint32_t unlocked{0};                     ///< joints with is-unlocked, a bit each
  std::uint64_t plan_passes{~std::uint64_t{0}};  ///< Inputs::plan_passes
};

class Executor {
 public:
  Executor(SpanRing& spans, const PlanSlots& slots, Spindles& spindles,
           OutputBank& outputs) noexcept
      : spans_(spans),
        slots_(slots),
        spindles_(spindles),
        outputs_(outputs),
        sync_(spindles),
        laws_(slots.laws) {}

  /// Overrides are bounded by max_feed_override ([DISPLAY]MAX_FEED_OVERRIDE, never below 1); limits as the planner's.
  /// Adaptive feed is bounded by it too, or by 1 when it may only slow; below 0 it counts when it may reverse.
  void configure(double max_feed_override, bool adaptive_only_slows, bool adaptive_reverses,
                 const path::AxisLimits& limits) noexcept {
    max_override_ = max_feed_override > 1 ? max_feed_override : 1;
    max_adaptive_ = adaptive_only_slows ? 1 : max_override_;
    adaptive_reverses_ = adaptive_reverses;
    limits_ = limits;
    if (!track_.on) history_.clear();
  }
  /// Puts the machine at `pose`, at rest, outside any span.
  void place(const Pose& pose) noexcept;
  /// The machine stands beside its path with another tool: what was driven before is not driven back over.
  void forget_way_back() noexcept {
    history_.clear();
    const PathSpan* under_way = move();
    no_way_back_ = under_way != nullptr ? under_way->number : kNoSpan;
  }
  /// The path's coordinates are from now on those of the machine, which were `shift` beside them.
  void fold(const Pose& shift) noexcept;
  /// Begins to fetch what the next step() will look at: all of it was written by the planner, or a second ago, and is in no near cache.
  void fetch() const noexcept;
  /// One cycle of `dt` seconds.
  void step(const PathInputs& in, double dt, FaultList& faults) noexcept;

  /// At rest: forgets the span in execution and all spans of epochs before `epoch`.
  void drop_before(std::uint32_t epoch) noexcept;
  /// Forgets everything of `epoch` and older, wherever it is, until a newer epoch comes.
  void void_epoch(std::uint32_t epoch) noexcept;

  [[nodiscard]] const Pose& pose() const noexcept { return pose_; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] bool at_rest() const noexcept { return sigma_speed_ == 0 && !laws_.on(); }
  /// Nothing in execution and nothing that waits.
  [[nodiscard]] bool idle() const noexcept {
    return slots_.pending.observe() == 0 && !started_ && spans_.empty();
  }
  /// Single stepping stands at the end of a block until hold is given and released again.
  [[nodiscard]] bool step_done() const noexcept {
    return waiting_ == PathWait::hold && (!started_ || between_blocks_);
  }
  /// joint.N.unlock, as far as the path wants it.
  [[nodiscard]] bool unlocks(std::int32_t joint) const noexcept { return indexer_ == joint; }
  [[nodiscard]] bool moving_item() const noexcept { return started_ && kind_ != MotionKind::none; }
  /// A spindle decides how fast it goes (threads, taps).
  [[nodiscard]] bool follows_spindle() const noexcept;
  /// Drives what lies behind the newest move: backwards, or forwards again.
  [[nodiscard]] bool retraces() const noexcept { return track_.on; }
  [[nodiscard]] std::uint64_t current_seq() const noexcept { return current_seq_; }
  [[nodiscard]] std::uint64_t executed_seq() const noexcept { return executed_seq_; }
  [[nodiscard]] std::uint32_t voided() const noexcept { return void_epoch_; }
  [[nodiscard]] std::uint64_t place_number() const noexcept { return place_number_; }
  [[nodiscard]] const OverrideEnable& enables() const noexcept { return enables_; }
  /// The operator's word; the program's next one counts again.
  void set_enables(const OverrideEnable& enables) noexcept { enables_ = enables; }
  [[nodiscard]] const Pose& tool_offset() const noexcept { return tool_offset_; }
  /// Fills in what the path knows of MotionStatus.
  void fill(MotionStatus& status) const noexcept;
  /// The stretch of path in execution, or nullptr.
  [[nodiscard]] const PathSpan* move() const noexcept;
  /// Of it, sigma.
  [[nodiscard]] double left() const noexcept { return left_; }
  /// What scales feeds now; the planner goes by it too.
  [[nodiscard]] const FeedScale& scale() const noexcept { return scale_; }
  /// For the planner.
  [[nodiscard]] LawPlace law_place() const noexcept;
  /// Signed and unsigned feed in force, for the feed pins: programmed speed times overrides; 0 while held.
  [[nodiscard]] double commanded_feed() const noexcept { return commanded_feed_; }

  /// At rest, for the flight record: rest_state.hpp.
  struct Rest;
  void save(Rest& r) const noexcept;
  void restore(const Rest& r) noexcept;

 private:
  enum class Outcome { done, busy, blocked };
  Outcome begin(const Span& span, const PathInputs& in, FaultList& faults) noexcept;
  Outcome begin_move(const Span& span, const PathSpan& move, const PathInputs& in,
                     FaultList& faults) noexcept;
  Outcome begin_spindle(const SpindleChange& change) noexcept;
  [[nodiscard]] bool run_orient(const Span& span, const SpindleChange& change, const PathInputs& in,
                                double dt, FaultList& faults) noexcept;
  // executor_sync.cpp: what follows a spindle
  [[nodiscard]] Outcome join_thread(const Span& span, const PathSpan& move, const PathInputs& in,
                                    FaultList& faults) noexcept;
  [[nodiscard]] double wanted_in_thread(const Span& span, const PathSpan& move,
                                        const PathInputs& in, FaultList& faults) noexcept;
  void foresee_thread() noexcept;
  [[nodiscard]] double thread_jerk(const Span& span, const PathSpan& move, double done, double dt,
                                   FaultList& faults) noexcept;
  double run_thread(const Span& span, const PathSpan& move, const PathInputs& in, double dt,
                    FaultList& faults) noexcept;
  [[nodiscard]] bool held_before_sync(const PathInputs& in) noexcept;
  [[nodiscard]] Outcome wait_for_spindle(const Span& span, const Synchroniser::Wish& wish,
                                         FaultList& faults) noexcept;
  /// As near as specks of path that were too short to be driven leave it.
  [[nodiscard]] bool stands_at(const Pose& place) const noexcept;
  Outcome begin_tap(const Span& span, const TapSpan& tap, const PathInputs& in,
                    FaultList& faults) noexcept;
  void run_tap(const Span& span, const TapSpan& tap, const PathInputs& in, double dt,
               FaultList& faults) noexcept;
  // indexer.cpp: locking rotary joints
  Outcome begin_indexer(const Span& span, const IndexerSpan& order) noexcept;
  [[nodiscard]] bool run_indexer(const Span& span, const IndexerSpan& order,
                                 const PathInputs& in) noexcept;
  [[nodiscard]] bool waits_for_lock() noexcept;
  void watch_indexer(const Span& span, const PathSpan& move, const PathInputs& in,
                     FaultList& faults) noexcept;
  void lock_again() noexcept;
  void output(const OutputChange& change) noexcept;
  void fire_synchronised() noexcept;
  void set_scale(const PathInputs& in) noexcept;
  /// x that is wanted on the stretch now; 0 and the reason when it has to stand.
  [[nodiscard]] double wanted(const PathSpan& move, const PathInputs& in) noexcept {
    return wanted(move, in, scale_);
  }
  [[nodiscard]] double wanted(const PathSpan& move, const PathInputs& in,
                              const FeedScale& scale) noexcept;
  /// The same for a stretch in execution, which the spindle may hold up.
  [[nodiscard]] double wanted_under_way(const PathSpan& move, const PathInputs& in,
                                        const FeedScale& scale) noexcept;
  Outcome probe_is_there(const Span& span, const PathSpan& move, const PathInputs& in,
                         FaultList& faults) noexcept;
  void end_probe(const Span& span, const PathSpan& move) noexcept;
  bool pass_over_probe() noexcept;
  void watch_probe(const Span& span, const PathSpan& move, const PathInputs& in,
                   FaultList& faults) noexcept;
  /// Gives the time used.
  double run_move(const Span& span, const PathSpan& move, const PathInputs& in, double dt,
                  FaultList& faults) noexcept;
  /// x at the end of a stretch: what can be met there at most, and what is wanted.
  struct Ends {
    double hard{0}, soft{0};
  };
  [[nodiscard]] Ends ends_of(const PathSpan& move) const noexcept;
  [[nodiscard]] double run_even(const PathSpan& move, const Ends& ends, double x_wanted,
                                double dt) noexcept;
  [[nodiscard]] double half_way_x(const PathSpan& move, double end_x,
                                  double x_wanted) const noexcept;
  [[nodiscard]] double run_curved(const PathSpan& move, const Ends& ends, double x_wanted,
                                  double dt) noexcept;
  double drive(const PathSpan& move, const Ends& ends, double x_wanted, double dt) noexcept;
  /// Pose and speed from what is left of the stretch.
  void show_place(const PathSpan& move) noexcept;
  // executor_jerk.cpp: with jerk limits
  [[nodiscard]] double run_ramps(const PathSpan& move, double x_wanted, double dt) noexcept;
  [[nodiscard]] bool law_drives(const PathSpan& move, double x_wanted) noexcept;
  [[nodiscard]] double run_law(const PathSpan& move, double x_wanted, double dt) noexcept;
  [[nodiscard]] bool keeps_leg(RampState state, double x_wanted, double cap) const noexcept;
  [[nodiscard]] bool begin_leg(const PathSpan& move, RampState state, double x_wanted, double cap,
                               double dt) noexcept;
  [[nodiscard]] Course step_course(const PathSpan& move, RampState state, double cap,
                                   double dt) const noexcept;
  [[nodiscard]] Course track_course(RampState state, double cap, double dt) const noexcept;
  [[nodiscard]] double stop_within(const PathSpan& move, double low, double distance,
                                   double dt) noexcept;

  // retrace.cpp
  /// An adaptive feed below 0 would turn back.
  [[nodiscard]] bool reverses() const noexcept { return enables_.adaptive && adaptive_reverses_; }
  void ready_way_back(std::size_t most) noexcept {
    if (reverses() || back_scale_.feed > 0) history_.bound(limits_, most);
  }
  [[nodiscard]] bool may_turn_back(const PathInputs& in) noexcept;
  void turn_back() noexcept;
  [[nodiscard]] double run_track(const PathInputs& in, double dt, FaultList& faults) noexcept;
  [[nodiscard]] Ends track_ends() noexcept;
  void show_track() noexcept;
  void turn_track() noexcept;
  void end_of_track() noexcept;
  void leave_track() noexcept;
  void forget_track() noexcept;

  void end_span(const Span& span, const PathSpan& move, FaultList& faults) noexcept;
  void finish(const Span& span, std::uint64_t done_seq) noexcept;
  void fail_path(const Span& span) noexcept;
  [[nodiscard]] const Span* next() noexcept;
  // executor_step.cpp: blocks, and single step
  void begin_step(const PathInputs& in) noexcept;
  [[nodiscard]] bool step_allows(const Span& span, bool single_step) noexcept;
  [[nodiscard]] const BlockStart* next_block(const PathSpan& move) const noexcept;
  void begin_blocks(const PathSpan& move) noexcept;
  void begin_block(const BlockStart& block, const PathSpan& move) noexcept;
  [[nodiscard]] bool pass_blocks(const PathSpan& move, const PathInputs& in) noexcept;
  [[nodiscard]] double step_within(const PathSpan& move, const PathInputs& in, double x) noexcept;
  void blocked(PathWait why, std::int32_t index = -1) noexcept;

  SpanRing& spans_;
  const PlanSlots& slots_;
  Spindles& spindles_;
  OutputBank& outputs_;
  Synchroniser sync_;
  std::uint64_t thread_seq_{0};  ///< the item that began the thread in execution
  double thread_yields_s_{0};    ///< above 0: the path ahead decides, not the spindle
  double thread_level_{0};       ///< x that is wanted meanwhile
  path::AxisLimits limits_;
  double max_override_{1}, max_adaptive_{1};
  bool adaptive_reverses_{true};
  FeedScale scale_;
  FeedScale
      back_scale_;  ///< the same for driving backwards; all 0 while the factor is not negative

  /// Off the front of the ring: driving what lies behind.
  struct Track {
    PathSpan move;          ///< as it is driven now
    std::size_t behind{0};  ///< which: 0 the front of the ring, n: history_.last(n)
    bool on{false}, back{false};
  };
  path::PathHistory history_;
  Track track_;
  static constexpr std::uint64_t kNoSpan = ~std::uint64_t{0};
  std::uint64_t no_way_back_{kNoSpan};  ///< the span within which the path cannot be turned round

  /// One phase of a ramp, or cruising, that is gone on with for some cycles without looking ahead anew.
  struct Leg {
    Ramp ramp;          ///< what is left of it
    double seconds{0};  ///< what is left of it
    double target{0};   ///< where the ramp leads
    double way{0};      ///< it may be driven that far
    double cap{0};      ///< of the stretch where it began
    double keep{0};     ///< seconds until the next look ahead
    RampState state;    ///< where it was left
    FeedScale scale;
    bool on{false}, stands{false};
    bool last{false};  ///< of the ramp: it ends at the target with acceleration 0
  };
  Leg leg_;
  LawRunner laws_;
  bool law_stands_{false};  ///< the path has to stand in this cycle
  bool law_lost_{false};

  Pose pose_;
  double sigma_speed_{0};  ///< dsigma/dt, never negative; kept from span to span
  double sigma_acc_{0};    ///< with jerk limits; signed
  double period_{0};       ///< of the servo cycle
  double left_{0};         ///< of the span in execution (sigma)
  double half_way_{0};   ///< above 0: the stretch ends slowly; it speeds up until this much is left
  double speed_{0};      ///< in mm/s (deg/s)
  bool started_{false};  ///< the span at the ring's front is in execution
  bool probing_{false};  ///< a probe move has begun
  bool ending_{false};   ///< it ends where it comes to rest: probe contact
  bool failing_{false};  ///< the same, and the path behind it is void
  bool probe_before_{false};
  bool after_traverse_{false};
  bool arriving_{false};  ///< the machine moves from one span into the next
  Step step_;
  bool step_brakes_{false};     ///< a step waits for rest, or for the planner
  bool between_blocks_{false};  ///< it stands where a block within the span ends
  std::uint32_t block_{0};      ///< of PathSpan::blocks, the next to begin
  double cut_{0};   ///< above 0: single step drives from rest to where so much of the span is left
  Pose block_end_;  ///< of the block in execution, on the path
  double dwell_left_{0}, orient_left_s_{0}, distance_{0};
  MotionKind kind_{MotionKind::none};
  PathWait waiting_{PathWait::none};
  std::int32_t waiting_index_{-1};
  std::int32_t indexer_{-1};  ///< the joint that the path has unlocked
  std::uint32_t locking_{0};  ///< joints that it locks, until is-unlocked is false
  std::uint32_t min_epoch_{0}, void_epoch_{0};
  std::uint64_t executed_seq_{0}, current_seq_{0}, place_number_{1};
  SourceTag current_;
  OverrideEnable enables_;
  Pose tool_offset_, probed_;
  bool probe_tripped_{false};
  double requested_{0}, commanded_feed_{0};

  std::uint64_t sync_digital_mask_{0}, sync_digital_{0}, sync_analog_mask_{0};
  double sync_analog_[kMaxAnalog]{};
};

}  // namespace kerf::motion
