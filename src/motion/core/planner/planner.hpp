// Planner: path items in, one smooth and certified path out. Pure arithmetic in memory that it got at load time; the shell gives it its turn and
// its waits.
//
// Moves gather until a stop is due, enough of them have come, or none comes any more while the machine would run dry. Then they become
// pieces of path (path/program_path.hpp), divided into spans with their limits, and a pass from the end writes into PlanSlots how fast each
// span may be left. Every plan ends in a stop, and what the servo has been given stays true when more comes: speeds only grow.
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/geometry.hpp"
#include "motion/core/path/boxes.hpp"
#include "motion/core/path/program_path.hpp"
#include "motion/core/path/reach.hpp"
#include "motion/core/planner/joint_bounds.hpp"
#include "motion/core/planner/law_maker.hpp"
#include "motion/core/planner/merge.hpp"
#include "motion/core/span.hpp"

namespace kerf::motion {

/// Two places on the path nearer than this are one (sigma).
inline constexpr double kOnePlace = 1e-7;

class Planner {
 public:
  /// What must change before run() can do more.
  enum class Waits : std::int32_t {
    items = 0,
    room = 1,
    servo = 2,
    turn = 3, /**< nothing: call again */
    time = 4  /**< new items, or `wake_ns` */
  };

  Planner(const Kinematics& kinematics, SpanRing& spans, PlanSlots& slots,
          FaultRing& faults) noexcept
      : kinematics_(kinematics),
        spans_(spans),
        slots_(slots),
        faults_(faults),
        joint_bounds_(kinematics),
        laws_(slots.laws, slots.gate) {}
  /// Before anything else. False: no memory.
  [[nodiscard]] bool create(path::Memory& memory) noexcept;

  /// Limits for the items taken from now on.
  void configure(const MachineConfig& config) noexcept;
  /// How many outputs and spindles the shell has; larger numbers in items are refused.
  void set_counts(std::int32_t digital, std::int32_t analog, std::int32_t spindles) noexcept {
    digital_ = digital;
    analog_ = analog;
    spindles_ = spindles;
  }
  /// The joints with unlock pins, a bit each.
  void set_unlock_pins(std::uint32_t joints) noexcept { unlock_pins_ = joints; }

  /// Takes items from `in` while that is possible. Items older than `abort_epoch`, void ones and those behind a refused one
  /// are dropped. Moves are taken only while `view.takes_moves`. `now_ns` is the instance's time; `passes` those of the gate before
  /// the look at `view`, for the tap.
  Waits run(PathRing& in, const ServoView& view, std::uint32_t abort_epoch, std::int64_t now_ns,
            std::uint64_t passes = 0) noexcept;
  /// The servo follows time laws, or feeds far ahead are those of a moment ago: the next turn has to come within kSoon.
  [[nodiscard]] bool comes_back_soon() const noexcept { return laws_.busy() || far_feed_old_; }
  [[nodiscard]] const LawMaker::Counts& law_counts() const noexcept { return laws_.counts(); }
  static constexpr std::int64_t kSoon = 4'000'000;  ///< ns
  /// A ring that is full waits until so many spans have room: however few are new, the pass from the end goes over all that it takes to stop.
  static constexpr std::size_t kRoomWorthSending = kSpans / 4;
  [[nodiscard]] std::int64_t wake_ns() const noexcept { return wake_ns_; }

  /// What earlier items have set for those behind them; all that matters of the past while nothing is pending.
  struct Modal {
    path::PathMode mode;
    double speed_rpm[kMaxSpindles]{};
    bool css[kMaxSpindles]{};
    FeedPerRev per_rev;
    double merge_mm{0}, thread_per_rev{0};
    double law_lead_s{0};
    std::int32_t thread_spindle{-1};
    std::uint32_t epoch{0}, refused_epoch{0};
    bool thread_first{false};
    bool refusing{false}, after_traverse{false}, spindle_changed{false};
  };
  [[nodiscard]] Modal modal() const noexcept;
  void set_modal(const Modal& modal) noexcept;
  /// Called with each item that is taken, before it is; and whether anything was pending then.
  class Tap {
   public:
    /// At the start of each run(), with what it was given.
    virtual void turn(std::int64_t now_ns, std::uint64_t passes, std::uint32_t abort_epoch,
                      std::uint64_t view_cycle) noexcept = 0;
    virtual void taken(const PathItem& item, const Modal& before, bool idle) noexcept = 0;

   protected:
    ~Tap() = default;
  };
  void set_tap(Tap* tap) noexcept { tap_ = tap; }

 private:
  enum class Take { done, wait_room, wait_servo, wait_answers };
  /// What of a commit() waits for answers about joints.
  enum class Committing { nothing, reach, bends };
  /// What the path does not know of a move.
  struct Meta {
    double even_acc{0}, even_jerk{0},
        cap{0};           ///< above 0: limits for the whole move (kinematics that mix axes)
    double sigma_end{0};  ///< while it is being sent: from the start of what is sent
    MotionKind kind{MotionKind::feed};
    SyncBounds sync;          ///< per_rev above 0: it follows a spindle
    std::uint32_t blocks{1};  ///< of blocks_: more than one where lines were joined (G64 Q)
    double tolerance_mm{0};   ///< G64 P
    double merged_off_mm{
        0};  ///< of the programmed points from the line that took their place (G64 Q)
    bool probe{false}, probe_until_open{false}, probe_fail_is_error{false};
  };
  /// A move as it was programmed. Where it ends the machine can stand (single step), and the line that is shown changes.
  struct Block {
    std::uint64_t seq{0};
    SourceTag tag;
    Pose end;
    double way{0};        ///< from the start of its move to its end (sigma)
    double sigma_end{0};  ///< while it is being sent: from the start of what is sent
  };
  /// Something between the moves: behind the first `after` of them.
  struct Event {
    Span span;
    std::uint32_t after{0};
  };
  /// What the pass from the end needs of a span that was sent.
  struct Sent {
    double length{0}, even_acc{0}, even_jerk{0};
    SpeedBounds speed;
    std::uint64_t place{0};  ///< in the ring
    std::uint64_t group{
        0};  ///< the first of the spans before it that share its even_acc and even_jerk
    path::Rows rows;
    std::uint64_t last_block{0};  ///< PlanSlots::block: behind those of all spans up to this one
    bool stop_at_end{false}, block_end{false}, begins{false};
    bool blocks{false};  ///< blocks begin within it
  };

  // planner.cpp: items
  void run_laws(const ServoView& view, std::int64_t now_ns) noexcept;
  Waits take_items(PathRing& in, const ServoView& view, std::uint32_t abort_epoch,
                   std::int64_t now_ns) noexcept;
  Take take(const PathItem& item, const ServoView& view) noexcept;
  /// What follows from a move's kind, before it is taken into the path.
  struct Order {
    double speed{0};
    MotionKind kind{MotionKind::feed};
    const ProbeMove* probe{nullptr};
    const SyncMove* sync{nullptr};
  };
  Take take_move(const PathItem& item, const Curve& curve, bool shaped,
                 const Order& order) noexcept;
  [[nodiscard]] bool limits_of(const PathItem& item, const Curve& curve, double speed,
                               bool traverse, Meta& meta, JointVector& joint,
                               FaultRecord& fault) noexcept;
  /// The joint that a move of kind index_rotary unlocks, -1 for a move that turns no indexer; false: refused.
  [[nodiscard]] bool indexer_of(const Curve& curve, MotionKind kind, std::int32_t& joint,
                                FaultRecord& fault) const noexcept;
  [[nodiscard]] bool may_move(const ServoView& view) noexcept;
  [[nodiscard]] bool stands_for(const PathItem& item) const noexcept;
  Take event(const PathItem& item, const Span::Body& body) noexcept;
  Take refuse(const PathItem& item, FaultRecord record) noexcept;
  Take bad_item(const PathItem& item, double value) noexcept;
  Take output_change(const PathItem& item, const OutputChange& change) noexcept;
  Take spindle_change(const PathItem& item, const SpindleChange& change) noexcept;
  void stop_here() noexcept;
  [[nodiscard]] path::AxisLimits guide() const noexcept;
  void forget() noexcept;
  /// The line becomes a part of the last pending one. False: it is one of its own.
  [[nodiscard]] bool merge_line(const Block& block, const path::Piece& line,
                                const Meta& meta) noexcept;
  [[nodiscard]] bool joins_within_limits(const Pose& end) const noexcept;
  void share_tolerance() noexcept;
  void note(const path::Move& move, std::uint64_t seq) noexcept;
  [[nodiscard]] path::PathMode mode_of(const PathControl& control) const noexcept;

  // sync_items.cpp: what follows a spindle
  Take take_sync(const PathItem& item, const SyncMove& move, const ServoView& view) noexcept;
  Take take_tap(const PathItem& item, const TapMove& tap, const ServoView& view) noexcept;
  Take feed_per_rev(const PathItem& item, const FeedPerRev& mode) noexcept;
  /// Makes the piece part of the thread; false: the pitch is too much for the axes at the spindle's speed.
  [[nodiscard]] bool join_thread(const SyncMove& sync, path::Piece& piece, Meta& meta,
                                 FaultRecord& fault) noexcept;
  [[nodiscard]] double commanded_rps(std::int32_t spindle) const noexcept;
  void bound_sync(PathSpan& body, const Meta& meta, double begin) noexcept;

  // commit.cpp: pending moves become pieces
  void commit_if_due(bool more_items, std::int64_t now_ns) noexcept;
  void commit(std::size_t moves, bool hand_over) noexcept;
  void make_path() noexcept;
  /// False: answers about joints are awaited. Nothing is sent and no item taken until they have come.
  [[nodiscard]] bool go_on_committing() noexcept;
  [[nodiscard]] bool reach_is_known() noexcept;
  [[nodiscard]] bool bends_are_known() noexcept;
  void make_pieces(std::size_t moves, path::ProgramPath::End end) noexcept;
  void make_halved(std::size_t moves, path::ProgramPath::End end) noexcept;
  [[nodiscard]] bool ends_in_short_lines() const noexcept;
  void find_out_of_reach(std::size_t first, std::size_t end) noexcept;
  [[nodiscard]] bool stop_out_of_reach(std::size_t moves, bool everywhere) noexcept;
  [[nodiscard]] std::size_t hand_over_at() const noexcept;
  [[nodiscard]] double stop_seconds() const noexcept;
  [[nodiscard]] double seconds_ahead(double enough) const noexcept;
  [[nodiscard]] double seconds_pending(double enough) const noexcept;

  // send.cpp: spans and the pass from the end
  [[nodiscard]] bool send() noexcept;
  [[nodiscard]] bool send_events(double sigma) noexcept;
  [[nodiscard]] bool next_curve(const path::Piece& piece, double from, double& to) noexcept;
  [[nodiscard]] bool mixed_end(const path::Piece& piece, double from, double& to) noexcept;
  void bound_mixed(PathSpan& body, double from, double to) noexcept;
  [[nodiscard]] bool send_stretch(const path::Piece& piece, double from, double to) noexcept;
  [[nodiscard]] bool room_for_blocks(std::size_t count) noexcept;
  [[nodiscard]] bool send_blocks(double begin, double end, std::size_t& done, Span& span,
                                 PathSpan& body, Sent& sent) noexcept;
  void drop_blocks(std::size_t gone) noexcept;
  [[nodiscard]] bool steps_end_behind(std::uint64_t n) const noexcept;
  void finish_sending() noexcept;
  /// What has changed: spans have come (only where they make more possible), the feed (near: what is far waits until no other comes), or anything.
  enum class Plan : std::int32_t { more, near_feed, feed, all };
  void plan(Plan what) noexcept;
  [[nodiscard]] std::uint64_t near_end() noexcept;
  [[nodiscard]] std::uint64_t first_ahead() noexcept;
  [[nodiscard]] bool plan_ramps(std::uint64_t n, int& unchanged) noexcept;

  const Kinematics& kinematics_;
  SpanRing& spans_;
  PlanSlots& slots_;
  FaultRing& faults_;
  MachineConfig config_{};
  path::AxisLimits limits_;
  path::AxisLimits guide_;  ///< by which the path gets its shape and its sigma
  double stop_s_{0};        ///< what a stop takes at most
  bool plain_{true};        ///< each joint is one axis: limits along the path; else ...
  bool mixed_{
      false};  ///< ... joint_bounds_ of each stretch; if this is false too, each move by itself
  bool asks_{
      false};  ///< mixed_, of kinematics that answer later: everything is asked until that was answered
  bool rough_{false};  ///< ... and differences tell nothing: each move by itself
  bool felt_{false};   ///< whether they do was asked here
  JointBounds joint_bounds_;
  path::JointCurve curve_;  ///< of what is being sent
  bool foretold_{false};    ///< it tells how joints move there
  bool curved_{false};      ///< it was made for the piece that is being sent
  std::int32_t digital_{static_cast<std::int32_t>(kMaxDigital)},
      analog_{static_cast<std::int32_t>(kMaxAnalog)};
  std::int32_t spindles_{static_cast<std::int32_t>(kMaxSpindles)};
  std::uint32_t unlock_pins_{~0U};

  // where the path leads
  Pose end_;                   ///< where the path taken so far leads
  double skew_[kMaxJoints]{};  ///< ServoView::skew there
  JointVector joint_{};        ///< the joints at end_: which of several solutions
  std::uint64_t place_{0};     ///< ServoView::place for which end_ is true
  std::uint32_t epoch_{0};     ///< of what is pending
  std::uint32_t refused_epoch_{0};
  bool placed_{false}, refusing_{false};
  bool probing_{false};  ///< moves behind a probe move wait until it has ended, wherever that is
  path::PathMode mode_;
  double merge_mm_{
      Merge::kSameLine};  ///< G64 Q, or what counts as one line without it; 0: lines are not merged
  path::Tolerance noted_tolerance_;  ///< of the move noted last
  Merge merge_;                      ///< the last pending move, while more may be merged with it
  double speed_rpm_
      [kMaxSpindles]{};  ///< as the last item left it: unchanged S words never stop the path
  bool css_[kMaxSpindles]{};
  bool after_traverse_{false}, spindle_changed_{false};
  std::int32_t thread_spindle_{-1};  ///< the thread that the path taken so far ends in; -1: none
  double thread_per_rev_{0};         ///< its sigma in one revolution
  bool thread_first_{false};         ///< the next stretch begins it
  FeedPerRev per_rev_;
  path::Vec low_, high_;  ///< soft limits

  // pending
  path::Buffer<path::Move> moves_;
  path::Buffer<Meta> meta_;
  path::Buffer<Block> blocks_;  ///< of the moves, one after another
  path::Buffer<Event> events_;
  std::int64_t last_item_ns_{0}, wake_ns_{0};
  std::int64_t pending_since_ns_{0};  ///< when the planner first waited for more; 0: not yet
  bool due_{false};                   ///< the path has to stand at the end of what is pending

  // being sent
  Committing committing_{Committing::nothing};
  std::size_t committed_{0};               ///< moves that commit() was told
  int rounds_{0};                          ///< of path::ProgramPath::make
  path::Buffer<std::uint32_t> unreached_;  ///< pieces that joints cannot follow
  JointBounds::Cursor asked_;
  path::Buffer<JointBounds::Told> told_;
  bool forgotten_{false};  ///< some of what was told had no room
  std::size_t next_told_{0};
  JointBounds::Creep creep_;
  bool awaits_answers_{false};
  path::ProgramPath program_path_;
  path::Buffer<path::Piece> pieces_;
  path::Boxes boxes_;                     ///< of the pieces, with jerk limits
  path::Buffer<path::JointBends> bends_;  ///< of the pieces, where joints mix axes besides
  /// Of spans by number: of those that the servo has, and of its history.
  static constexpr std::size_t kCurves = 2 * kSpans;
  path::Buffer<path::JointCurve> curves_;
  std::size_t sending_{0};  ///< moves of which pieces_ were made; 0: none
  std::size_t events_sending_{0}, events_sent_{0};
  std::size_t piece_{0}, stretch_{0}, move_{0};
  std::size_t blocks_sending_{0}, blocks_done_{0};
  double sigma_{0}, piece_sigma_{0};
  std::size_t thread_end_move_{
      0};                 ///< of the thread that is being sent, if it reaches beyond move_
  double thread_end_{0};  ///< its sigma there
  bool handed_over_{false}, begins_{true};
  bool halved_{
      false};  ///< of the last of the moves that are being sent the second half comes later

  // sent
  path::Buffer<Sent> sent_;
  std::uint64_t next_number_{0}, first_new_{0};
  std::uint64_t next_block_{0}, oldest_block_{0};  ///< PlanSlots::block; those before are free
  std::uint64_t oldest_span_{0};                   ///< the servo has not popped it
  LawMaker laws_;
  bool far_feed_old_{false};  ///< behind near_end() feeds are those of before the last change
  std::int64_t feed_changed_ns_{0};
  std::uint64_t first_ahead_{0};  ///< the servo has not driven it to its end
  FeedScale scale_;
  bool single_step_{false};
  Tap* tap_{nullptr};
  Pose shift_;  ///< of the machine from what is planned
};

}  // namespace kerf::motion
