// Pending moves become pieces of path: when, how many of them, and where the joints let them.
#include <algorithm>
#include <cmath>

#include "motion/core/planner/planner.hpp"

namespace kerf::motion {
namespace {

/// No new item for this long: whoever makes them may have no more.
constexpr std::int64_t kSettle = 5'000'000;  // ns
/// What the machine still has to drive when the path is ended for want of more.
constexpr double kLeastAhead = 0.1;  // s
/// With less than this and its stopping time ahead of the machine, and that much pending, the path is handed over while more moves come: who
/// makes them just as fast as they are driven never fills the buffer.
constexpr double kShortAhead = 0.2, kWorthHandingOver = 0.05;  // s
constexpr std::int64_t kSteady = 5 * kSettle;                  ///< and they have come for this long
/// Machines that stop even slower begin to brake before they get the next part of a path.
constexpr double kLongestStop = 2;  // s
/// Of the pending moves, the last ones stay when the path is handed over: they may still be joined with what comes.
constexpr double kHandOverFrom = 0.5;
/// Half of such a line is more than any kink is spread over.
constexpr double kLongLine = 2 * path::PathSettings{}.widest;
/// With fewer pending moves a hand-over gives no room worth having.
constexpr std::size_t kHandOverLeast = 16;
/// Joints that cannot follow blends may make so many more of them stops.
constexpr int kRounds = 4;
/// Pieces that are looked at together, when whether joints reach them is answered later.
constexpr std::size_t kReachTogether = 128;

}  // namespace

void Planner::commit_if_due(bool more_items, std::int64_t now_ns) noexcept {
  if (moves_.empty()) {
    if (!events_.empty()) commit(0, false);
    return;
  }
  if (due_) {
    // Up to the last place where the path has to stand; what is behind may still grow.
    std::size_t n = moves_.size();
    while (n > 0 && !moves_[n - 1].stop_at_end) --n;
    if (n > 0) return commit(n, false);
    due_ = false;
  }
  // Many outputs on the path fill the events before the moves.
  const bool events_full = events_.full() && moves_.size() >= kHandOverLeast;
  if (moves_.full() || blocks_.full() || events_full) return commit(moves_.size(), true);
  if (pending_since_ns_ == 0) pending_since_ns_ = now_ns;
  if (more_items) return;
  const double short_ahead = kShortAhead + stop_s_;
  if (now_ns - pending_since_ns_ >= kSteady && now_ns - last_item_ns_ < kSettle &&
      moves_.size() >= kHandOverLeast && seconds_pending(kWorthHandingOver) > kWorthHandingOver &&
      seconds_ahead(short_ahead) < short_ahead)
    return commit(moves_.size(), true);
  wake_ns_ = last_item_ns_ + kSettle;
  if (now_ns < wake_ns_) return;
  // What was handed over ends in the middle of a move, where nobody wants to brake.
  const double least = kLeastAhead + (handed_over_ ? stop_s_ : 0.0);
  if (seconds_ahead(least) > least) {
    wake_ns_ = now_ns + kSettle;
    return;
  }
  moves_.back().stop_at_end = true;
  commit(moves_.size(), false);
}

/// From the largest speed that is allowed, in the slowest axis.
double Planner::stop_seconds() const noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < path::kAxes; ++i) {
    if (!(limits_.acc[i] > 0)) continue;
    const double vel = std::min(limits_.vel[i], i < 3 ? limits_.path_vel : path::kNoLimit);
    if (!(vel < path::kNoLimit)) continue;
    // Axes that the machine does not have have no limits.
    const bool ramps = limits_.jerk[i] > 0 && limits_.acc[i] < path::kNoLimit;
    const double ramp = ramps ? limits_.acc[i] / limits_.jerk[i] : 0;
    longest = std::max(longest, vel / limits_.acc[i] + ramp);
  }
  return std::min(longest, kLongestStop);
}

/// Of the pending moves at their feeds; counts no farther than `enough`.
double Planner::seconds_pending(double enough) const noexcept {
  double seconds = 0;
  for (const path::Move& move : moves_) {
    seconds += move.piece.length / move.piece.feed.speed;
    if (seconds > enough) break;
  }
  return seconds;
}

/// Of what the servo has, at the speeds that are wanted; counts no farther than `enough`.
double Planner::seconds_ahead(double enough) const noexcept {
  const std::uint64_t popped = slots_.gate.pass([&] { return spans_.popped(); });
  double seconds = 0;
  for (std::uint64_t n = next_number_; n-- > 0 && next_number_ - n <= kSpans;) {
    const Sent& s = sent_[n % kSpans];
    if (s.place < popped) break;
    const double x = wanted_x(s.speed, scale_);
    if (!(x > 0)) return path::kNoLimit;
    seconds += s.length / std::sqrt(x);
    if (seconds > enough || s.begins) break;
  }
  return seconds;
}

/// Of the later pending moves the longest: half of it is driven straight, whatever follows.
std::size_t Planner::hand_over_at() const noexcept {
  const std::size_t n = moves_.size(), led = program_path_.led();
  const std::size_t first = std::max(
      static_cast<std::size_t>(static_cast<double>(n) * kHandOverFrom), led > 0 ? led - 1 : 0);
  std::size_t best = first;
  for (std::size_t i = first; i + 2 < n; ++i)
    if (moves_[i].piece.length > moves_[best].piece.length) best = i;
  return best;
}

/// Whether none of the later moves is so long, or an arc, that the curve may be cut in its middle as if it went on there.
bool Planner::ends_in_short_lines() const noexcept {
  const std::size_t first = hand_over_at();
  return limits_.jerks && !asks_ && moves_[first].piece.length < kLongLine &&
         std::all_of(moves_.begin() + first, moves_.end(),
                     [](const path::Move& m) { return m.piece.straight() && !m.piece.feed.sync; });
}

/// Makes pieces of the first `moves` pending moves. `hand_over`: of as many of them as have room behind them, for more moves will come.
void Planner::commit(std::size_t moves, bool hand_over) noexcept {
  pending_since_ns_ = 0;
  handed_over_ = hand_over;
  committed_ = moves;
  rounds_ = 0;
  make_path();
  committing_ = Committing::reach;
  (void)go_on_committing();
}

void Planner::make_path() noexcept {
  const std::size_t moves = committed_;
  pieces_.clear();
  halved_ = false;
  sending_ = moves;
  if (!handed_over_) {
    if (moves > 0) make_pieces(moves, path::ProgramPath::End::here);
    return;
  }
  // Where lines are short the curve bends all along. So it is cut where it bends, and what follows goes on from there.
  sending_ = 0;
  if (ends_in_short_lines()) {
    // The last one grows while more lines become part of it.
    const std::size_t known = merge_.count() > 0 ? moves - 1 : moves;
    make_halved(known, path::ProgramPath::End::cut);
    sending_ = program_path_.cut(
        moves_.begin(), known, static_cast<std::size_t>(static_cast<double>(known) * kHandOverFrom),
        pieces_);
  }
  if (sending_ == 0) {
    sending_ = hand_over_at() + 1;
    halved_ = true;
    make_halved(sending_, path::ProgramPath::End::part);
  }
}

bool Planner::go_on_committing() noexcept {
  if (asks_ && !rough_ && sending_ > 0 && !(reach_is_known() && bends_are_known())) return false;
  committing_ = Committing::nothing;
  if (sending_ > 0) {
    program_path_.settle();
    if (asks_ && rough_) bends_.assign(pieces_.size(), path::JointBends{});
    if (mixed_ && limits_.jerks && !asks_) joint_bounds_.bends_of(pieces_, bends_.begin());
    if ((plain_ || mixed_) && limits_.jerks)
      boxes_.make(pieces_, limits_, mixed_ ? bends_.begin() : nullptr);
    if (halved_) {
      path::Piece& last = moves_[sending_ - 1].piece;
      last = path::part_of(last, last.length / 2, last.length);
    }
  }
  if (sending_ >= moves_.size()) merge_.end();
  const std::size_t last = halved_ ? sending_ - 1 : sending_;
  events_sending_ = 0;
  while (events_sending_ < events_.size() && events_[events_sending_].after <= last)
    ++events_sending_;
  events_sent_ = piece_ = stretch_ = move_ = blocks_done_ = 0;
  sigma_ = piece_sigma_ = 0;
  thread_end_move_ = 0;
  curved_ = false;
  first_new_ = next_number_;
  next_told_ = 0;
  return true;
}

/// Where kinematics answer later: whether the path stops where joints could not follow its blends. It is made anew until that is so.
bool Planner::reach_is_known() noexcept {
  while (committing_ == Committing::reach) {
    if (asked_.piece == 0) unreached_.clear();
    const std::size_t end = std::min(asked_.piece + kReachTogether, pieces_.size());
    const std::size_t were = unreached_.size();
    find_out_of_reach(asked_.piece, end);
    if (!kinematics_.complete()) {
      unreached_.truncate(were);
      return false;
    }
    asked_.piece = end;
    if (end < pieces_.size()) continue;
    asked_ = {};
    told_.clear();
    if (rounds_ <= kRounds && stop_out_of_reach(sending_, rounds_ == kRounds)) {
      ++rounds_;
      make_path();
      continue;
    }
    bends_.assign(pieces_.size(), path::JointBends{});
    forgotten_ = false;
    committing_ = Committing::bends;
  }
  return true;
}

/// The same: how joints bend along the pieces, which the boxes need.
bool Planner::bends_are_known() noexcept {
  if (!limits_.jerks || committing_ == Committing::nothing) return true;
  while (asked_.piece < pieces_.size()) {
    // What cannot be kept until it is sent is asked for twice.
    if (told_.room() < JointBounds::kTogether) {
      told_.clear();
      forgotten_ = true;
    }
    const std::size_t known = told_.size();
    if (!joint_bounds_.tell(pieces_, asked_, told_)) return false;
    for (const JointBounds::Told* told = told_.begin() + known; told != told_.end(); ++told)
      if (told->foretold)
        bends_[told->piece].join(path::bends_of(told->curve, told->from, told->to));
  }
  if (forgotten_) {
    told_.clear();
    asked_ = {};
  }
  return true;
}

/// Pieces of the first `moves`, of the last of them only of its first half.
void Planner::make_halved(std::size_t moves, path::ProgramPath::End end) noexcept {
  const path::Piece whole = moves_[moves - 1].piece;
  moves_[moves - 1].piece = path::part_of(whole, 0, whole.length / 2);
  make_pieces(moves, end);
  moves_[moves - 1].piece = whole;
}

void Planner::make_pieces(std::size_t moves, path::ProgramPath::End end) noexcept {
  double sigma = 0;
  blocks_sending_ = 0;
  for (std::size_t i = 0; i < moves; ++i) {
    // What is handed over in its middle ends farther on.
    for (std::uint32_t n = 0; n < meta_[i].blocks; ++n, ++blocks_sending_)
      blocks_[blocks_sending_].sigma_end = sigma + blocks_[blocks_sending_].way;
    meta_[i].sigma_end = sigma += moves_[i].piece.length;
  }
  for (int round = 0;; ++round) {
    pieces_.clear();
    program_path_.make(moves_.begin(), moves, pieces_, end);
    if (!mixed_ || asks_ || round > kRounds) return;
    unreached_.clear();
    find_out_of_reach(0, pieces_.size());
    if (!stop_out_of_reach(moves, round == kRounds)) return;
  }
}

/// Which of the pieces [first, end) joints could not follow.
void Planner::find_out_of_reach(std::size_t first, std::size_t end) noexcept {
  for (std::size_t i = first; i < end; ++i) {
    const path::Piece& piece = pieces_[i];
    const bool blend = piece.shape == path::Piece::Shape::cubic && !piece.straight();
    if (blend && !joint_bounds_.reaches(piece, skew_))
      unreached_.push_back(static_cast<std::uint32_t>(i));
  }
}

/// Blends leave the programmed path, and where that is the end of what the joints reach, the path stops at the corner instead. True: at some.
bool Planner::stop_out_of_reach(std::size_t moves, bool everywhere) noexcept {
  double begin = 0;
  std::size_t i = 0;
  for (const std::uint32_t unreached : unreached_) {
    for (; i < unreached; ++i) begin += pieces_[i].length;
    const double end = begin + pieces_[i].length;
    // The corners within it, else the next one.
    bool found = false;
    for (std::size_t m = 0; m + 1 < moves; ++m) {
      const double corner = meta_[m].sigma_end;
      if (!everywhere && (corner < begin - kOnePlace || (corner > end && found))) continue;
      // Of what is driven already the rest goes on as it was looked at before.
      if (moves_[m].joined)
        program_path_.keep_lead();
      else
        moves_[m].stop_at_end = true;
      found = true;
    }
  }
  return !unreached_.empty();
}

}  // namespace kerf::motion
