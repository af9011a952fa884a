// Where coarser moves (coarse.hpp) are faster: tried part by part, between moves whose middles have nothing to do with what is beside them.
#include <algorithm>

#include "motion/core/path/program_path.hpp"

namespace kerf::motion::path {
namespace {

/// So many moves are tried at once (of what winds more, as all curves go through the places where parts meet), and taken where that saves this share of
/// the time: what is coarse may be outside of programmed corners.
constexpr std::size_t kTogether = 48, kTogetherWinding = 200;
constexpr double kWorthIt = 0.02, kAnything = 0.001;
/// Of the tolerance: what arcs may be off as lines, and lines as corners that meet.
constexpr double kMostOff = 0.3, kMostOffChord = 0.6;
/// Rows of lines are straightened by so much of the tolerance, chords of arcs included, where so many moves of a part wind within it.
constexpr double kStraightened = 0.5, kMostStraightened = 0.85, kMostOffChords = 0.12;
constexpr int kMostChords = 4;
constexpr std::size_t kLeastWinding = 4;
/// Lines longer than this many of the widest blends keep their middle; and what they are as wide as that by, in tolerances.
constexpr double kLongLine = 4, kWide = 12;
/// Kinks of dense lines are smaller.
constexpr double kCorner = 0.1;
/// A short line is no longer than this many tolerances.
constexpr double kShortLine = 4;
/// Lines that an arc becomes at most, and so a part.
constexpr std::size_t kMostLines = kMostTangents + 1, kLines = kMostLines * kTogetherWinding;
constexpr std::size_t kTrialPieces = 6 * kLines + 64;
/// Whole chains are looked at too; longer ones are not.
constexpr std::size_t kInsidePieces = 2 * kTrialPieces, kTrialStretches = 4 * kInsidePieces;

/// A bound that costs nothing: the sagitta of its tangents.
bool may_be_lines(const Move& move) noexcept {
  const Piece& p = move.piece;
  if (p.shape != Piece::Shape::arc || p.feed.sync) return false;
  const double turn = p.rate * p.length / kMostTangents;
  return std::abs(p.radius) * turn * turn / 8 <= kMostOff * move.mode.tolerance.mm;
}

/// Within the tolerance, nearly.
bool is_short_line(const Move& move) noexcept {
  return move.piece.straight() && !move.piece.feed.sync &&
         move.piece.length <= kShortLine * move.mode.tolerance.mm;
}

bool may_be_joined(const Move& before, const Move& move, const Move& behind) noexcept {
  return is_short_line(move) && before.piece.straight() && behind.piece.straight() &&
         move.piece.length < before.piece.length && move.piece.length < behind.piece.length;
}

bool is_corner(const Move& a, const Move& b) noexcept {
  return a.piece.straight() && b.piece.straight() && max_abs(b.piece.b - a.piece.b) > kCorner;
}

Move line_of(const CoarseLine& line, const PathMode& mode) noexcept {
  Move move;
  move.piece = straight_piece(line.from, line.way * (1 / line.sigma), line.sigma, line.feed);
  move.mode = mode;
  return move;
}

}  // namespace

bool ProgramPath::create(Memory& memory, std::size_t moves) noexcept {
  const std::size_t lines = 2 * moves;
  return blend_.create(memory, kJunctionPieces) && chain_.create(memory, lines) &&
         smoother_.create(memory, lines) && relaxer_.create(memory, lines) &&
         lead_.create(memory, moves) && rest_.create(memory, moves) &&
         work_.create(memory, lines) && part_.create(memory, kLines) &&
         coarse_.create(memory, kLines) && best_.create(memory, kLines) &&
         lines_.create(memory, kLines) && ends_.create(memory, kLines + 1) &&
         trial_.create(memory, kTrialPieces) && inside_.create(memory, kInsidePieces) &&
         over_.create(memory, kJunctionPieces) && ahead_.create(memory, kJunctionPieces) &&
         apart_.create(memory, 2 * kJunctionPieces + 4) && x_.create(memory, kTrialStretches);
}

/// What is before it and what is behind it do not meet.
bool ProgramPath::keeps_its_middle(const Move& move) const noexcept {
  if (!move.mode.blends() || !(move.mode.tolerance.mm > 0)) return true;
  if (move.piece.straight())
    return move.piece.length > kLongLine * std::min(widest_of(move, Move::Width::of_feed),
                                                    kWide * move.mode.tolerance.mm);
  return !may_be_lines(move);
}

bool ProgramPath::may_be_wide(const Move& a, const Move& b) const noexcept {
  if (!a.piece.straight() || !b.piece.straight() || a.piece.feed.sync || !a.mode.blends() ||
      kWide * a.mode.tolerance.mm <= settings_.widest)
    return false;
  return is_corner(a, b);
}

bool ProgramPath::coarsen(const Move* moves, std::size_t count, std::size_t from,
                          std::size_t to) noexcept {
  if (to < from + 2) return false;
  const auto small = [&](std::size_t k) {
    return !keeps_its_middle(moves[k]) &&
           (may_be_lines(moves[k]) || may_be_joined(moves[k - 1], moves[k], moves[k + 1]));
  };
  bool any = false;
  work_.clear();
  for (std::size_t k = 0; k <= from; ++k) work_.push_back(moves[k]);
  for (std::size_t begin = from; begin + 1 < to;) {
    std::size_t end = begin + 1;
    bool smalls = false, wide = may_be_wide(moves[begin], moves[end]);
    std::size_t arcs = 0, turns = 0;
    while (end + 1 < to && !keeps_its_middle(moves[end])) {
      if (end - begin >= (turns >= kLeastWinding ? kTogetherWinding : kTogether)) break;
      smalls = smalls || small(end);
      wide = wide || may_be_wide(moves[end], moves[end + 1]);
      if (is_short_line(moves[end])) {
        turns += is_corner(moves[end], moves[end + 1]) ? 1 : 0;
      } else if (may_be_lines(moves[end])) {
        ++arcs;
        ++turns;
      }
      ++end;
    }
    const std::size_t behind = end - begin;
    if (work_.room() < kMostLines * arcs + behind + 1 + (count - end)) return false;
    const bool winding = turns >= kLeastWinding;
    if ((smalls || wide || winding) &&
        coarsen_part(moves + begin, behind + 1, smalls, wide, winding)) {
      any = true;
    } else {
      for (std::size_t k = begin + 1; k <= end; ++k) work_.push_back(moves[k]);
    }
    begin = end;
  }
  for (std::size_t k = to; k < count; ++k) work_.push_back(moves[k]);
  return any;
}

/// Moves [0, count), the first of which is the last in work_; some are small, corners between them may be wide, or they wind within the tolerance. True: work_
/// goes on with what is faster.
bool ProgramPath::coarsen_part(const Move* moves, std::size_t count, bool small, bool wide,
                               bool winds) noexcept {
  part_.clear();
  part_.push_back(work_.back());
  for (std::size_t k = 1; k < count; ++k) part_.push_back(moves[k]);
  const auto outside = [&](const Vec& q) {
    for (std::size_t i = 0; i < kAxes; ++i)
      if (q[i] > settings_.high[i] || q[i] < settings_.low[i]) return true;
    return false;
  };
  const double as_it_was = seconds(part_);
  double least = as_it_was;
  bool found = false;
  const auto compare = [&](double worth) {
    for (const Move& move : coarse_)
      if (outside(move.piece.point(0))) return;
    const double taken = seconds(coarse_);
    if (!(taken < std::min(least, (1 - worth) * as_it_was))) return;
    least = taken;
    found = true;
    best_.clear();
    for (const Move& move : coarse_) best_.push_back(move);
  };
  // As wide as the feed needs; then as wide as the tolerance leaves it, which is shorter.
  const auto widen = [&](double worth) {
    for (const Move::Width width : {Move::Width::of_feed, Move::Width::any}) {
      for (std::size_t k = 0; k + 1 < coarse_.size(); ++k) coarse_[k].width = width;
      compare(worth);
    }
  };
  if (wide) {
    coarse_.clear();
    for (const Move& move : part_) coarse_.push_back(move);
    widen(kAnything);
  }
  const auto compare_joined = [&] {
    compare(kWorthIt);
    bool corners = false;
    for (std::size_t k = 0; k + 1 < coarse_.size(); ++k)
      corners = corners || may_be_wide(coarse_[k], coarse_[k + 1]);
    if (corners) widen(kWorthIt);
  };
  for (const Coarser& way : {Coarser{0, kMostOff}, {1, kMostOffChord}})
    if (small && join_part(way)) compare_joined();
  const auto straighten = [&](double most, bool taut, bool pairs) {
    if (join_part({kMostChords, kMostOffChords, most, taut, pairs})) compare_joined();
  };
  if (winds) {
    straighten(kStraightened, false, true);
    for (const bool pairs : {false, true})
      for (const bool taut : {false, true}) straighten(kMostStraightened, taut, pairs);
  }
  if (!found) return false;
  work_.back() = best_.front();
  for (std::size_t k = 1; k < best_.size(); ++k) work_.push_back(best_[k]);
  return true;
}

double ProgramPath::seconds(const Buffer<Move>& moves) noexcept {
  trial_.clear();
  make_run(moves.begin(), moves.size(), false, trial_);
  return trial_.full() ? kNoLimit
                       : least_seconds(trial_.begin(), trial_.size(), settings_.limits, x_);
}

/// part_ with its arcs as lines, in coarse_; `share`: how far off they are, 0 where no arc is small enough. False: there are too many.
bool ProgramPath::lines_of_part(const Coarser& way, double& share) noexcept {
  share = 0;
  coarse_.clear();
  for (std::size_t k = 0; k < part_.size(); ++k) {
    const Move& move = part_[k];
    lines_.clear();
    double off = -1;
    if (k > 0 && k + 1 < part_.size() && may_be_lines(move))
      off = way.chords > 0
                ? chords_of(move.piece, move.mode.tolerance, way.arcs, way.chords, lines_)
                : tangents_of(move.piece, move.mode.tolerance, way.arcs, lines_);
    if (off < 0) {
      if (!coarse_.push_back(move)) return false;
      continue;
    }
    share = std::max(share, off);
    for (const CoarseLine& line : lines_)
      if (!coarse_.push_back(line_of(line, move.mode))) return false;
  }
  return true;
}

/// The same with lines joined or straightened, and what is left of the tolerance. False: nothing is coarser.
bool ProgramPath::join_part(const Coarser& way) noexcept {
  double arcs = 0, joined = 0;
  if (!lines_of_part(way, arcs)) return false;
  std::size_t done = 0;
  for (std::size_t i = 0; i < coarse_.size();) {
    // A row of lines, which keeps the least tolerance of them: ends of some are within the joined ones.
    std::size_t j = i;
    PathMode mode = coarse_[i].mode;
    lines_.clear();
    for (; j < coarse_.size() && coarse_[j].piece.straight() && !coarse_[j].piece.feed.sync; ++j) {
      const Piece& p = coarse_[j].piece;
      lines_.push_back({p.a, p.b * p.length, p.length, p.feed});
      mode.tolerance.mm = std::min(mode.tolerance.mm, coarse_[j].mode.tolerance.mm);
      mode.tolerance.deg = std::min(mode.tolerance.deg, coarse_[j].mode.tolerance.deg);
    }
    const std::size_t were = lines_.size();
    const bool straightens = way.straightened > 0;
    double off = 0;
    if (straightens && way.straightened > arcs) {
      // The first and the last move have corners outside of the part, which know nothing of what is off.
      if (way.pairs)
        off = join_pairs(mode.tolerance, i == 0 ? 1 : 0, j == coarse_.size() ? were - 1 : were,
                         lines_);
      off +=
          straighten_lines(mode.tolerance, way.straightened - arcs - off, way.taut, lines_, ends_);
    }
    if (!straightens && were > 1) off = join_lines(mode.tolerance, kMostOff, lines_);
    if (lines_.size() < were || (straightens && off > 0)) {
      joined = std::max(joined, off);
      const Move last = coarse_[j - 1];
      for (const CoarseLine& line : lines_) coarse_[done++] = line_of(line, mode);
      coarse_[done - 1].mode.corners = last.mode.corners;
      coarse_[done - 1].stop_at_end = last.stop_at_end;
    } else {
      for (const std::size_t end = std::max(j, i + 1); i < end; ++i) coarse_[done++] = coarse_[i];
    }
    i = std::max(j, i);
  }
  coarse_.truncate(done);
  const double share = arcs + joined;
  for (std::size_t k = 0; k + 1 < done; ++k) {
    coarse_[k].mode.tolerance.mm *= 1 - share;
    coarse_[k].mode.tolerance.deg *= 1 - share;
  }
  return share > 0 || done < part_.size();
}

}  // namespace kerf::motion::path
