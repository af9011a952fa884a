#include "motion/core/path/program_path.hpp"

#include <algorithm>
#include <utility>

#include "motion/core/path/boxes.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kNoPace = 1e6;  ///< mm/s: nothing holds it back
/// Directions this near to each other are one: the rounding of whoever computed the points.
constexpr double kTangent = 1e-9;
/// Nearly one: on an exact path a kink up to this one comes from points with three decimals, and is no corner to stop at.
constexpr double kNearlyTangent = 0.02;
/// With jerk limits sharper ones are passed at a crawl, if at all: a blend as small as that is shorter than what a law can tell from nothing.
constexpr double kNearlyTangentByJerk = 0.004;
/// With jerk limits curvature has to go on too (1/mm).
constexpr double kSameBend = 1e-9;
/// A move as short as this at the end of what is driven without a stop is driven by itself: no law is found over a blend within it (sigma).
constexpr double kTinyEnd = 2e-3;
/// What two blends leave of a move between them is at least so long: no law is found over less (sigma).
constexpr double kLeastMiddle = 5e-3;
/// Corners whose blends take less than this part of both lines are looked at alone.
constexpr double kAloneInLine = 4;

/// Of so few lines the curve inside is always tried too: that costs little.
constexpr std::size_t kFewLines = 64;

/// Where the path will be cut, so much at its end is not made coarser (sigma): what comes behind the cut is smoothed as it is.
constexpr double kBehindCut = 9;
constexpr std::size_t kLinesBehindCut = 16;

/// Of the tolerance: lines beside others that have one keep this at least, where they have none themselves.
constexpr double kLeastKept = 1e-9;

/// Curves that take no longer than this many times what their feeds ask for are not relaxed; and what is won by it is at least this share.
constexpr double kAtFeed = 1.03, kWorthRelaxing = 0.998;

/// A blend that takes this part of half of a move is kept narrow by it.
constexpr double kFills = 0.9;

/// A corner is as wide as lets a right angle be passed at the feed, in feed^2 / acceleration; but no wider than this (sigma).
constexpr double kWidthOfFeed = 0.8, kWidestEver = 20;

/// The rate at which sigma is meant to advance: the feed, or what the axes of its metric can do.
double pace(double feed, bool rapid, double measured, double own_time) noexcept {
  const double most = own_time > 0 ? measured / own_time : kNoPace;
  return rapid ? most : std::min(feed, most);
}

double slowest_time(const Vec& way, const Vec& max_vel, std::size_t first,
                    std::size_t last) noexcept {
  double t = 0;
  for (std::size_t i = first; i < last; ++i)
    if (way[i] != 0) t = std::max(t, std::abs(way[i]) / max_vel[i]);
  return t;
}

}  // namespace

Piece line_move(const Vec& from, const Vec& to, double feed, bool rapid,
                const Vec& max_vel) noexcept {
  const Vec way = to - from;
  Feed f;
  f.speed = feed;
  f.rapid = rapid;
  std::size_t first = 0;  // of the three axes that measure it: XYZ, else UVW, else ABC
  double measured = norm3(way, first);
  for (const std::size_t other : {std::size_t{6}, std::size_t{3}}) {
    if (measured > 0) break;
    first = other;
    measured = norm3(way, first);
  }
  f.metric = static_cast<std::int8_t>(first);
  if (!(measured > 0)) return straight_piece(from, Vec{}, 0, f);
  const double own = slowest_time(way, max_vel, first, first + 3);
  const double slowest = slowest_time(way, max_vel, 0, kAxes);
  // Only where other axes decide: straights of the metric's own axes keep sigma = length, so that all of them are alike.
  const double length =
      slowest > own ? std::max(measured, pace(feed, rapid, measured, own) * slowest) : measured;
  return straight_piece(from, way * (1.0 / length), length, f);
}

void scale_arc(Piece& arc, double sweep, double length, double feed, bool rapid,
               const Vec& max_vel) noexcept {
  arc.feed.speed = feed;
  arc.feed.rapid = rapid;
  arc.feed.metric = 0;
  double slowest = 0;
  for (std::size_t i = 3; i < kAxes; ++i)
    if (arc.b[i] != 0) slowest = std::max(slowest, std::abs(arc.b[i]) * sweep / max_vel[i]);
  const double own = length / std::max({max_vel[0], max_vel[1], max_vel[2]});
  arc.length = std::max(length, pace(feed, rapid, length, own) * slowest);
  arc.rate = sweep / arc.length;
}

/// Two lines whose corner would make a blend of its own, which is so narrow that standing takes less time.
bool ProgramPath::sharp(const Move& a, const Move& b) const noexcept {
  // A thread that stood in its middle would be out of step.
  if (a.piece.feed.sync) return false;
  const Vec kink = b.piece.first(0) - a.piece.first(a.piece.length);
  const double share = a.mode.tolerance.share(kink);
  if (!(share > 0)) return false;
  // A triangle of q'' with half-width l deviates by l/6 of the kink.
  const double l = std::min({6 / share, settings_.widest, a.piece.length / 2, b.piece.length / 2});
  if (l * kAloneInLine > std::min(a.piece.length, b.piece.length)) return false;
  Piece half = straight_piece(a.piece.a, a.piece.first(0), l, a.piece.feed);
  half.d = kink * (1 / (l * l));
  Piece other = half;
  other.b = half.first(l);
  other.c = half.second(l);
  other.d *= -1.0;
  const Piece blend[] = {half, other};
  return faster_to_stop(a.piece, b.piece, l,
                        even_speed(blend, 2, settings_.limits, settings_.by_law), settings_.limits,
                        settings_.by_law);
}

ProgramPath::Joint ProgramPath::joint_between(const Move& a, const Move& b) const noexcept {
  if (a.joined) return Joint::chain;
  if (a.stop_at_end || a.mode.corners == PathMode::Corners::exact_stop) return Joint::stop;
  const bool lines = a.piece.straight() && b.piece.straight();
  const double kink = max_abs(b.piece.first(0) - a.piece.first(a.piece.length));
  const bool tangent =
      kink < kTangent && (!settings_.limits.jerks ||
                          max_abs(b.piece.second(0) - a.piece.second(a.piece.length)) < kSameBend);
  const bool exact = a.mode.corners == PathMode::Corners::exact_path &&
                     kink > (settings_.limits.jerks ? kNearlyTangentByJerk : kNearlyTangent);
  if (!tangent && (exact || !(a.mode.tolerance.mm > 0))) return Joint::stop;
  if (lines) return settings_.limits.jerks && sharp(a, b) ? Joint::stop : Joint::chain;
  return tangent ? Joint::pass : Joint::blend;
}

/// Whether the path stands between move i and the next one; `first` is the last one before which it does.
bool ProgramPath::stands_behind(const Move* moves, std::size_t first, std::size_t i,
                                std::size_t count, bool goes_on) const noexcept {
  const Joint joint = joint_between(moves[i], moves[i + 1]);
  if (joint == Joint::stop || joint == Joint::pass || !settings_.limits.jerks || moves[i].joined)
    return joint == Joint::stop;
  const auto tiny = [&](std::size_t k) { return moves[k].piece.length < kTinyEnd; };
  // A stream of tiny lines is a curve like any other.
  if (tiny(i) && i == first && !tiny(i + 1)) return true;
  return tiny(i + 1) &&
         ((i + 2 == count && !goes_on) ||
          (i + 2 < count && joint_between(moves[i + 1], moves[i + 2]) == Joint::stop));
}

void ProgramPath::make(const Move* moves, std::size_t count, Buffer<Piece>& out, End end) noexcept {
  std::size_t first = 0;
  will_be_cut_ = end == End::cut;
  ends_in_move_ = end == End::part;
  rest_.on = false;
  for (std::size_t i = 0; i < count; ++i) {
    const bool last = i + 1 == count;
    if (!last && !stands_behind(moves, first, i, count, end != End::here)) continue;
    const std::size_t run = i + 1 - first;
    const bool leads = first == 0 && lead_.on;
    // What is part of a curve already stays, and so does what will be; and the halves of a move keep their direction.
    const std::size_t from = leads ? led() : first == 0 && in_move_ ? 1 : 0;
    std::size_t to = last && end == End::part ? run - 1 : run;
    if (last && end == End::cut) {
      double way = 0;
      while (to > from && (way < kBehindCut || run - to < kLinesBehindCut))
        way += moves[first + --to].piece.length;
      kept_ = run - to;
    }
    const bool coarser = coarsen(moves + first, run, from, to);
    will_be_driven_ = true;
    if (coarser)
      make_run(work_.begin(), work_.size(), leads, out);
    else
      make_run(moves + first, run, leads, out);
    will_be_driven_ = false;
    if (!last || moves[i].stop_at_end) out.back().stop_at_end = true;
    first = i + 1;
  }
}

double ProgramPath::widest_of(const Move& move, Move::Width width) const noexcept {
  if (width == Move::Width::usual) return settings_.widest;
  if (width == Move::Width::any) return std::max(settings_.widest, kWidestEver);
  double fastest = 0, acc = kNoLimit;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(settings_.limits.acc[i] > 0)) continue;
    acc = std::min(acc, settings_.limits.acc[i]);
    fastest = std::max(fastest, settings_.limits.vel[i]);
  }
  const double feed = std::min({move.piece.feed.speed, fastest, settings_.limits.path_vel});
  return std::clamp(kWidthOfFeed * feed * feed / acc, settings_.widest, kWidestEver);
}

std::size_t ProgramPath::cut(Move* moves, std::size_t count, std::size_t least,
                             Buffer<Piece>& out) noexcept {
  if (!ends_in_chain_ || !settings_.limits.jerks) return 0;
  const std::size_t most = std::min(count - least, kept_), lines = chain_.lines();
  const std::size_t at = smoother_.cut(chain_, lines > most ? lines - most : 1, out, rest_);
  if (at == 0) return 0;
  relax(smoother_.first_piece(), out);
  const std::size_t made = count - (lines - at);
  for (std::size_t i = made; i + 1 < count; ++i) moves[i].joined = true;
  return made;
}

void ProgramPath::settle() noexcept {
  std::swap(lead_, rest_);
  rest_.on = false;
  in_move_ = ends_in_move_;
}

/// chain_ as pieces. False: there is no curve; none that begins with the lead, if there is one.
bool ProgramPath::smooth_chain(const SmoothingSettings& settings, const Lead* lead,
                               Buffer<Piece>& out) noexcept {
  const std::size_t before = out.size();
  double share = smoother_.smooth(chain_, settings, out, lead);
  if (lead != nullptr) {
    if (share > 1.0) out.truncate(before);
    return share <= 1.0;
  }
  // Only what is inside is shorter than what is programmed: that counts where corners are wide.
  const bool any = std::any_of(chain_.widest.begin(), chain_.widest.end(),
                               [&](double widest) { return widest > settings_.widest; });
  if (share <= 1.0 && (any || smoother_.gave_way() || chain_.lines() <= kFewLines)) {
    inside_.clear();
    SmoothingSettings s = settings;
    s.inside = true;
    const double taken =
        least_seconds(out.begin() + before, out.size() - before, settings_.limits, x_);
    const bool faster =
        smoother_.smooth(chain_, s, inside_) <= 1.0 && !inside_.full() &&
        least_seconds(inside_.begin(), inside_.size(), settings_.limits, x_) < taken;
    if (faster && !will_be_cut_) {
      out.truncate(before);
      for (const Piece& piece : inside_) out.push_back(piece);
    } else if (will_be_cut_) {
      // The smoother cuts what it made last, where that is in `out`.
      out.truncate(before);
      share = smoother_.smooth(chain_, faster ? s : settings, out);
    }
  }
  if (share <= 1.0) return true;
  // Has never been seen; the programmed corners with stops are always right.
  out.truncate(before);
  for (std::size_t k = 0; k < chain_.lines(); ++k) {
    out.push_back(straight_piece(chain_.at[k], chain_.direction(k),
                                 chain_.sigma[k + 1] - chain_.sigma[k], chain_.feed[k]));
    out.back().stop_at_end = k + 1 < chain_.lines();
  }
  return false;
}

void ProgramPath::relax(std::size_t first, Buffer<Piece>& out) noexcept {
  if (!settings_.limits.jerks || !settings_.relaxes) return;
  const auto seconds = [&](const Piece* pieces, std::size_t count) {
    return least_seconds(pieces, count, settings_.limits, x_);
  };
  double at_feed = 0;
  for (std::size_t p = first; p < out.size(); ++p) at_feed += out[p].length / out[p].feed.speed;
  const double taken = seconds(out.begin() + first, out.size() - first);
  if (taken <= kAtFeed * at_feed ||
      !relaxer_.relax(chain_, chain_settings_, settings_.limits, out, first))
    return;
  const Buffer<Piece>& relaxed = relaxer_.relaxed();
  if (relaxed.size() > out.room() + out.size() - first ||
      !(seconds(relaxed.begin(), relaxed.size()) < kWorthRelaxing * taken))
    return;
  out.truncate(first);
  for (const Piece& piece : relaxed) out.push_back(piece);
}

double ProgramPath::join(const Move& a, const Move* over, const Move& b, double most,
                         Buffer<Piece>& out) noexcept {
  JunctionSettings s;
  s.tolerance = a.mode.tolerance;
  s.reach_a = std::min({a.piece.length / 2, settings_.widest_junction, most});
  s.reach_b = std::min(b.piece.length / 2, settings_.widest_junction);
  if (over != nullptr) s.over = &over->piece;
  s.low = settings_.low;
  s.high = settings_.high;
  s.limits = settings_.limits;
  s.by_law = settings_.by_law;
  return blend_junction(a.piece, b.piece, s, out);
}

double ProgramPath::join_over(const Move* moves, double l) noexcept {
  const Move &a = moves[0], &m = moves[1], &b = moves[2];
  const Joint first = joint_between(a, m), second = joint_between(m, b);
  const auto goes_on = [](Joint joint) { return joint == Joint::blend || joint == Joint::pass; };
  if (!goes_on(first) || !goes_on(second) || (first == Joint::pass && second == Joint::pass))
    return 0;
  if (!(m.piece.length < std::min(a.piece.length, b.piece.length)) ||
      !(a.piece.feed == m.piece.feed) || !(b.piece.feed == m.piece.feed) || m.piece.feed.sync)
    return 0;
  if (a.mode.tolerance.mm != m.mode.tolerance.mm || a.mode.tolerance.deg != m.mode.tolerance.deg)
    return 0;
  ahead_.clear();
  const double l2 = second == Joint::blend ? join(m, nullptr, b, kNoLimit, ahead_) : 0;
  ahead_of_ = second == Joint::blend ? &m : nullptr;
  ahead_l_ = l2;
  // Neither of them is kept narrow by the move between.
  const bool stands = (first == Joint::blend && !(l > 0)) || (second == Joint::blend && !(l2 > 0));
  if (!stands && std::max(l, l2) < kFills * m.piece.length / 2) return 0;
  const double reach_a = std::min(a.piece.length / 2, settings_.widest_junction),
               reach_b = std::min(b.piece.length / 2, settings_.widest_junction);
  const auto add = [&](const Piece& p, double from, double to) {
    if (to > from) apart_.push_back(part_of(p, from, to));
  };
  apart_.clear();
  add(a.piece, a.piece.length - reach_a, a.piece.length - l);
  for (const Piece& p : blend_) apart_.push_back(p);
  if (first == Joint::blend && !(l > 0) && !apart_.empty()) apart_.back().stop_at_end = true;
  add(m.piece, l, m.piece.length - l2);
  for (const Piece& p : ahead_) apart_.push_back(p);
  if (second == Joint::blend && !(l2 > 0)) apart_.back().stop_at_end = true;
  add(b.piece, l2, reach_b);
  const double apart = least_seconds(apart_.begin(), apart_.size(), settings_.limits, x_);
  over_.clear();
  const double taken = join(a, &m, b, kNoLimit, over_);
  if (!(taken > 0)) return 0;
  apart_.clear();
  add(a.piece, a.piece.length - reach_a, a.piece.length - taken);
  for (const Piece& p : over_) apart_.push_back(p);
  add(b.piece, taken, reach_b);
  return least_seconds(apart_.begin(), apart_.size(), settings_.limits, x_) < apart ? taken : 0;
}

/// `leads`: the first chain goes on where the path was cut.
void ProgramPath::make_run(const Move* moves, std::size_t count, bool leads,
                           Buffer<Piece>& out) noexcept {
  double taken = 0;  // of the start of move i by the blend before it
  ends_in_chain_ = false;
  ahead_of_ = nullptr;
  for (std::size_t i = 0; i < count;) {
    // A chain of lines, or one arc.
    std::size_t j = i;
    while (j + 1 < count && joint_between(moves[j], moves[j + 1]) == Joint::chain) ++j;
    const Move& tail = moves[j];
    const bool blended = j + 1 < count && joint_between(tail, moves[j + 1]) == Joint::blend;
    double l = 0;
    blend_.clear();
    if (blended) {
      if (ahead_of_ == &tail) {
        l = ahead_l_;
        for (const Piece& p : ahead_) blend_.push_back(p);
      } else {
        l = join(tail, nullptr, moves[j + 1], kNoLimit, blend_);
      }
      const bool stops = settings_.limits.jerks && l > 0 &&
                         faster_to_stop(tail.piece, moves[j + 1].piece, l,
                                        even_speed(blend_.begin(), blend_.size(), settings_.limits,
                                                   settings_.by_law),
                                        settings_.limits, settings_.by_law);
      if (stops) {
        blend_.clear();
        l = 0;
      }
    }
    std::size_t next = j + 1;
    if (j + 2 < count) {
      const double over = join_over(moves + j, l);
      if (over > 0) {
        l = over;
        ++next;
        blend_.clear();
        for (const Piece& p : over_) blend_.push_back(p);
      }
    }
    const double left = tail.piece.length - taken - l;
    if (settings_.limits.jerks && i == j && l > 0 && left > 0 && left < kLeastMiddle) {
      over_.clear();
      const double less = join(tail, next > j + 1 ? &moves[j + 1] : nullptr, moves[next],
                               tail.piece.length - taken - kLeastMiddle, over_);
      if (less > 0) {
        l = less;
        blend_.clear();
        for (const Piece& p : over_) blend_.push_back(p);
      }
    }
    if (i == j) {
      if (tail.piece.length - taken - l > 0)
        out.push_back(part_of(tail.piece, taken, tail.piece.length - l));
    } else {
      chain_.clear();
      SmoothingSettings s;
      s.tolerance = moves[i].mode.tolerance;
      for (std::size_t k = i; k < j; ++k) {
        s.tolerance.mm = std::max(s.tolerance.mm, moves[k].mode.tolerance.mm);
        s.tolerance.deg = std::max(s.tolerance.deg, moves[k].mode.tolerance.deg);
      }
      // That of the corners at both ends of a line counts.
      const auto share_of = [&](std::size_t k) {
        const Tolerance& t = moves[k].mode.tolerance;
        const double mm = s.tolerance.mm > 0 ? t.mm / s.tolerance.mm : 1.0,
                     deg = s.tolerance.deg > 0 ? t.deg / s.tolerance.deg : 1.0;
        return std::max(std::min(mm, deg), kLeastKept);
      };
      double sigma = 0;
      for (std::size_t k = i; k <= j; ++k) {
        const Piece& p = moves[k].piece;
        const double from = k == i ? taken : 0, to = k == j ? p.length - l : p.length;
        chain_.within.push_back(std::min(k > i ? share_of(k - 1) : 1.0, k < j ? share_of(k) : 1.0));
        chain_.at.push_back(p.point(from));
        chain_.sigma.push_back(sigma);
        chain_.feed.push_back(p.feed);
        chain_.widest.push_back(widest_of(moves[k], moves[k].width));
        sigma += to - from;
      }
      chain_.at.push_back(tail.piece.point(tail.piece.length - l));
      chain_.sigma.push_back(sigma);
      s.widest = settings_.widest;
      s.peaked = settings_.limits.jerks;
      s.low = settings_.low;
      s.high = settings_.high;
      chain_settings_ = s;
      const std::size_t before = out.size();
      const Lead* lead = leads ? &lead_ : nullptr;
      leads = false;
      if (lead != nullptr && (lead->only_whole || !smooth_chain(s, lead, out))) {
        smoother_.go_on(chain_, *lead, out);
        i += lead->lines() - 1;
        taken = lead->sigma.back() - chain_.sigma[lead->lines() - 1];
        continue;
      }
      const bool smooth = lead != nullptr || smooth_chain(s, nullptr, out);
      ends_in_chain_ = smooth && j + 1 == count;
      // What will be cut is relaxed up to there.
      if (smooth && will_be_driven_ && !(ends_in_chain_ && will_be_cut_)) relax(before, out);
    }
    for (const Piece& p : blend_) out.push_back(p);
    const bool stands = j + 1 < count && joint_between(tail, moves[j + 1]) == Joint::stop;
    if (stands || (blended && l <= 0)) out.back().stop_at_end = true;
    taken = l;
    i = next;
  }
}

}  // namespace kerf::motion::path
