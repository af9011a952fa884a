// Compensation: cutter radius compensation of one interpreter: the tool's path beside the programmed one, and the calls that
// wait for it.
//
// The end of a compensated move is known only with the next one. Until then the move and every call behind it wait here,
// each block with its own source line and modal state; they are delivered in the order of the program. Texts for the operator
// and calls that concern no motion overtake them (kOvertakes).
//
// With [RS274NGC]COMPENSATION_LOOK_AHEAD = N a move waits until N more have their ends, so that a gouge between moves that are no
// neighbours (LookAhead) is an error before the first of them begins. Nothing overtakes then, and a block that the machine must be
// waited for (M0, M100-M199) lets all before it go.
//
// Like everything of a block, what a handler asks for is staged: finish() does it, undo() forgets it.
#pragma once

#include <cstddef>
#include <list>
#include <optional>
#include <string>

#include "interp/canon_buffer.hpp"
#include "interp/compensation/look_ahead.hpp"
#include "interp/compensation/path.hpp"
#include "interp/interpreter.hpp"

namespace kerf::interp {

class Core;

class Compensation {
 public:
  explicit Compensation(Core& core) : core_(core) {}

  // --- for handlers; false: core.fail() was called ---
  /// Moves go through straight() and arc(). With G41 and a radius of 0 they need not.
  [[nodiscard]] bool bends() const noexcept { return current().bends; }
  /// The next move leads from the compensated path back to the programmed one; it must be straight.
  [[nodiscard]] bool leaving() const noexcept { return current().leaving; }
  void left() { edit().leaving = false; }
  /// Of the tool while compensation is on, else 0.
  [[nodiscard]] double radius_mm() const noexcept { return bends() ? current().radius_mm : 0; }
  /// G41, G42. `diameter_mm` < 0 changes the side. `orientation`: of a lathe tool, 0-9; its tip lies beside the centre.
  void turn_on(bool left_side, double diameter_mm, int orientation);
  /// G40: the open move ends as it stands.
  [[nodiscard]] bool turn_off();
  /// M2, M30 (`off`), the closing %: the open move ends as it stands; the program's position becomes that of the tool.
  [[nodiscard]] bool end_program(bool off);
  /// G0, G1. The caller then sets the programmed position.
  [[nodiscard]] bool straight(const Pose& end, bool traverse);
  /// G2, G3.
  [[nodiscard]] bool arc(const Arc& arc);
  /// Where the tool's centre is going to stand when `programmed` is the programmed position.
  [[nodiscard]] Pose tool_position(const Pose& programmed) const;

  // --- for Core ---
  /// The machine stands beside the programmed position.
  [[nodiscard]] bool beside() const noexcept { return state_.bends || state_.leaving; }
  [[nodiscard]] bool waits() const noexcept { return !waiting_.empty(); }
  /// Calls f with the modes behind each block that waits.
  template <class F>
  void each_waiting(F&& f) {
    for (Waiting& w : waiting_) f(w.modal);
  }
  /// This block must end by finish() instead of delivering its calls.
  [[nodiscard]] bool busy() const noexcept { return staged_ || waits(); }
  /// False, with the reason: this block would wait, and too many do already (kMostWaiting).
  [[nodiscard]] bool has_room() const;
  /// Delivers what no longer waits, of blocks before and of this one.
  void finish(const SourceLine& source);
  void undo() noexcept {
    staged_ = release_ = release_all_ = has_move_ = false;
    closing_.reset();
  }
  /// Compensation ends, nothing waits any more and nothing is delivered (abort).
  void drop();
  /// Something else moved the machine: the next move leads to the path again.
  void start_again();

 private:
  struct State {
    bool bends{false};
    bool leaving{false};
    CompPath path;
    double side{1}, radius_mm{0};
    std::size_t e1{0}, e2{1};  ///< axes of the plane
    Flat tip;                  ///< of a lathe tool: from its centre to where the axes are set
    GuardedMove open;          ///< the open move, without the end of the tool's way
    int moves{0};              ///< since the compensation began, as far as the first ones count
  };
  /// The one motion call of a block that waits.
  struct Move {
    bool is_arc{false}, traverse{false};
    Pose end;
    Arc arc;
  };
  /// A block that waits, or the rest of one.
  struct Waiting {
    SourceLine source;
    std::string file, text;
    ModalState modal;
    CanonBuffer calls;
    std::size_t from{0};   ///< calls before are made
    std::size_t split{0};  ///< the move comes before this call
    bool has_move{false};
    bool overtaken{false};  ///< its overtaking calls are made
    bool opens{false};      ///< its move has an end of its own, not that of the move before
    bool closed{false};     ///< the end of its move is known
    Move move;
    SyncReason sync{SyncReason::none};
  };

  [[nodiscard]] const State& current() const noexcept { return staged_ ? next_ : state_; }
  State& edit();
  [[nodiscard]] Flat flat(const Pose& p) const { return {p[current().e1], p[current().e2]}; }
  static void place(const State& s, Pose& p, Flat at);
  bool take(const CompStep& step, const Pose& corner_end, Flat corner);
  [[nodiscard]] bool too_narrow(const char* problem);
  /// The open move ends as `step` says: does it gouge one of those before, or the other way round?
  [[nodiscard]] bool close(const CompStep& step);
  void guard(const CompStep& step, Flat from, Flat to, Flat corner, double across_end);
  [[nodiscard]] Pose corner_pose(const Pose& end) const;
  [[nodiscard]] double slack() const;
  [[nodiscard]] bool end_open();
  void stage_move(const Move& move);
  void deliver(Waiting& w);
  void make(const Move& move);
  void wait(const SourceLine& source, std::size_t from, bool overtaken);
  void settle();
  /// Delivers what need not wait any longer.
  void release();
  void forget();

  Core& core_;
  State state_, next_;
  bool staged_{false};
  bool release_{false};        ///< what waits is delivered with this block
  bool release_all_{false};    ///< compensation ends with it
  std::size_t release_at_{0};  ///< before this call of the block
  CompStep open_;              ///< how the open move ends then
  bool has_move_{false};
  bool opens_{false};  ///< the move of this block has an open end
  Move move_;
  std::size_t split_{0};

  std::list<Waiting> waiting_,
      spare_;              ///< spare ones keep their memory. Never moved: calls point into them
  std::size_t closed_{0};  ///< moves that wait though their ends are known
  LookAhead look_ahead_;
  std::optional<GuardedMove> closing_;  ///< the open move with its end
  SyncReason sync_{SyncReason::none};
  std::optional<std::string_view> label_;  ///< of the block being finished
};

}  // namespace kerf::interp
