#include "motion/core/path/time_law_rows.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

constexpr double kArcStep = 0.05;  ///< rad
/// Largest ratio of the steps of neighbouring cubics, and into how many steps one is divided at most.
constexpr double kCubicRatio = 4;
constexpr int kMostPerCubic = 16;
/// Steps next to a stop: share of the way on which acceleration builds up, and of the piece: a later window is to have the same.
constexpr double kRestShare = 0.1, kRestOfPiece = 1.0 / 40;
/// And of the way on which jerk makes the speed that is wished, or a slow feed is reached much later than it could be; finer by whole powers of this, as
/// the wish changes with each override.
constexpr double kRestOfWish = 0.5, kCoarser = 8;
/// A node nearer than this share of a step to the end of a stretch is left out.
constexpr double kTooNear = 0.3, kNearHead = 0.03;
/// At the start from a moving state x may change by this share within the first step; steps are divided there (and from rest, where the first stretch is
/// short), from fine to wide across the ends of stretches, so that an older law
/// stays one that the new grid can express. None is finer than rounding (mm).
constexpr double kFirstChange = 0.25, kFineGrowth = 0.5, kFinest = 1e-11;

/// A jerk row in which b2 counts less than that beside b1 bounds u, not w.
constexpr double kNoW = 1e-3;

/// Of one interval: accelerations at four, jerks at three coefficients.
constexpr std::size_t kMostRows = 7 * LawRows::kMostJerks;

/// So many steps before the end of a stretch are equal.
constexpr double kEvenParts = 3;

/// A stop may be so many steps long on which joints bend evenly.
constexpr double kMostBends = 2;
/// Of a stretch.
constexpr double kSamePlace = 1e-9;
/// Of q' and of q'', relative to its largest component.
constexpr double kSameSlope = 1e-6;

/// By how much steps grow per length on straights and arcs, and how many there are at least.
double growth_of(int fineness) noexcept { return fineness >= 4 ? 0.2 : fineness >= 2 ? 0.35 : 0.5; }
double least_steps(int fineness) noexcept { return fineness >= 4 ? 12 : fineness >= 2 ? 8 : 5; }

bool is_even(const LawStretch& s) noexcept {
  return s.piece.shape == Piece::Shape::cubic && !s.piece.straight();
}

/// It bends nowhere: neither in the axes nor in the joints.
bool is_straight(const LawStretch& s) noexcept { return s.piece.straight() && s.joints == nullptr; }

struct Derivatives {
  Vec p0, p1, p2, e0, e1, c0, c1, c2;
};

Derivatives derivatives(const Piece& piece, double s0, double s1) noexcept {
  Derivatives d;
  const double sm = (s0 + s1) / 2;
  d.p0 = piece.first(s0);
  d.p2 = piece.first(s1);
  d.e0 = piece.second(s0);
  d.e1 = piece.second(s1);
  if (piece.shape == Piece::Shape::arc) {
    d.p1 = piece.first(sm) * 2.0 - (d.p0 + d.p2) * 0.5;
    d.c0 = piece.third(s0);
    d.c2 = piece.third(s1);
    d.c1 = piece.third(sm) * 2.0 - (d.c0 + d.c2) * 0.5;
  } else {
    d.p1 = d.p0;
    d.p1.add((s1 - s0) / 2, d.e0);
    d.c0 = d.c1 = d.c2 = piece.d;
  }
  return d;
}

/// f(what it does, its limits) of each joint.
template <class F>
void for_each_joint(const LawStretch& s, double s0, double s1, F&& f) noexcept {
  for (std::size_t i = 0; s.joints != nullptr && i < s.joints->count; ++i)
    f(part_of(*s.joints, i, s0, s1), s.joints->row[i]);
}

/// The way on which a start reaches the largest acceleration.
double rise(double acc, double jerk) noexcept {
  return acc < kNoLimit && jerk < kNoLimit ? acc * acc * acc / (6 * jerk * jerk) : kNoLimit;
}

}  // namespace

double way_from_rest(double x, double jerk) noexcept {
  return x < kNoLimit ? std::sqrt(2 * x * std::sqrt(x) / (9 * jerk)) : kNoLimit;
}

void straight_limits(const LawStretch& stretch, double s, const AxisLimits& limits, double& acc,
                     double& jerk) noexcept {
  straight_limits(stretch.piece, s, limits, acc, jerk);
  for (std::size_t i = 0; stretch.joints != nullptr && i < stretch.joints->count; ++i) {
    const double steep = std::abs(place_on(*stretch.joints, i, s).rate);
    if (steep <= 0) continue;
    acc = std::min(acc, stretch.joints->row[i].acc / steep);
    jerk = std::min(jerk, stretch.joints->row[i].jerk / steep);
  }
}

void straight_limits(const Piece& piece, double s, const AxisLimits& limits, double& acc,
                     double& jerk) noexcept {
  acc = jerk = kNoLimit;
  const Vec p = piece.first(s);
  for (std::size_t j = 0; j < kAxes; ++j) {
    const double steep = std::abs(p[j]);
    if (steep <= 0) continue;
    acc = std::min(acc, limits.acc[j] / steep);
    jerk = std::min(jerk, limits.jerk[j] / steep);
  }
  const double xyz = norm3(p, 0);
  if (xyz <= 0) return;
  if (piece.straight()) acc = std::min(acc, limits.path_acc / xyz);
  if (limits.path_jerk >= kNoLimit) return;
  const double slope = jerk_slope(piece);
  if (slope > 0) jerk = std::min(jerk, limits.path_jerk / slope);
}

bool LawRows::create(Memory& memory, std::size_t intervals,
                     std::size_t rows_per_interval) noexcept {
  most_rows_ = intervals * rows_per_interval;
  const std::size_t rows = most_rows_ + kMostRows;
  return stretches_.create(memory, intervals) && intervals_.create(memory, intervals) &&
         nodes_.create(memory, intervals) && a0.create(memory, rows) && a1.create(memory, rows) &&
         a2.create(memory, rows) && mid0.create(memory, rows) && mid1.create(memory, rows) &&
         half.create(memory, rows);
}

void LawRows::begin(const AxisLimits& limits) noexcept {
  limits_ = limits;
  stretches_.clear();
  intervals_.clear();
  expected_ = 0;
  way_ = widest_ = kNoLimit;
}

bool LawRows::add(const LawStretch& stretch) noexcept {
  LawStretch s = stretch;
  const double whole = s.piece.length;
  s.end = s.to;
  s.fineness = std::clamp(s.fineness, 1, kMostPerCubic);
  double least = s.fineness;
  if (s.joints != nullptr) s.bends = even_step(*s.joints, even_x(*s.joints, s.cap));
  if (is_even(s)) {
    s.widest = std::min(whole / s.fineness, s.bends);
    least = std::max(least, std::min(std::ceil((s.to - s.from) / s.widest), double{kMostPerCubic}));
  } else {
    s.widest = whole / least_steps(s.fineness);
    if (s.piece.shape == Piece::Shape::arc && s.piece.rate != 0)
      s.widest = std::min(s.widest, kArcStep / std::abs(s.piece.rate));
    s.widest = std::min(s.widest, s.bends);
    least = (s.to - s.from) / s.widest + least_steps(s.fineness);
  }
  const auto more = static_cast<std::size_t>(std::min(std::ceil(least), 1e6));
  if (expected_ + more > intervals_.size() + intervals_.room() || stretches_.full()) return false;
  expected_ += more;
  return stretches_.push_back(s);
}

void LawRows::push(std::size_t k, double from, double to) noexcept {
  const LawStretch& s = stretches_[k];
  LawInterval in;
  in.length = to - from;
  in.cap = s.joints != nullptr ? velocity_cap(*s.joints, from, to, s.cap) : s.cap;
  in.wish = s.wish < s.cap ? s.wish : kNoLimit;
  in.from = from;
  in.stretch = k;
  straight_limits(s, from + in.length / 2, limits_, in.straight_acc, in.straight_jerk);
  room_ = intervals_.push_back(in) && room_;
}

bool LawRows::push_node(double at) noexcept {
  room_ = nodes_.push_back(at) && room_;
  return room_;
}

/// `gone`: the way before it.
void LawRows::divide(std::size_t k, double gone) noexcept {
  const LawStretch& s = stretches_[k];
  // Backwards from the end, so that a later window gets the same nodes; then forwards up to where the backward steps have come.
  const double g = growth_of(s.fineness);
  nodes_.clear();
  double back = s.to;
  for (;;) {
    const double h = std::min(s.step, s.last + g * (s.to - back));
    const double ahead = std::min(s.step, s.first + g * (back - s.from));
    if (back - h < s.from + (k == 0 ? kNearHead : kTooNear) * h || (ahead < h && back < s.to))
      break;
    if (!push_node(back)) return;
    back -= h;
  }
  if (nodes_.empty() && !push_node(s.to)) return;
  back = nodes_.back();
  const std::size_t behind = nodes_.size();
  double at = s.from;
  for (;;) {
    const double h = std::min(s.step, s.first + g * (at - s.from));
    if (at + (1 + kTooNear) * h > back) break;
    at += h;
    if (!push_node(at)) return;
  }
  at = s.from;
  const auto next = [&](double node) {
    // The last one ends in even jerk, of which a part is nothing that the grid expresses.
    const bool stops = k + 1 == used_ && node == s.to;
    while (!stops && room_) {
      const double most = fine_ + kFineGrowth * (gone + at - s.from),
                   parts = std::ceil((node - at) / most - 1e-9);
      if (parts <= 1) break;
      const double to = at + (parts <= kEvenParts ? (node - at) / parts : most);
      push(k, at, to);
      at = to;
    }
    push(k, at, node);
    at = node;
  };
  for (std::size_t i = behind; i < nodes_.size(); ++i) next(nodes_[i]);
  for (std::size_t i = behind; i-- > 0;) next(nodes_[i]);
}

void LawRows::choose_steps(double x0, double u0) noexcept {
  const std::size_t n = used_;
  double acc = 0, jerk = 0;
  for (LawStretch& s : stretches_) s.step = std::min(s.widest, is_even(s) ? kNoLimit : widest_);
  const auto beside = [&](std::size_t k, double otherwise) {
    const double before = k > 0 ? stretches_[k - 1].widest : otherwise;
    return std::min(before, k + 1 < n ? stretches_[k + 1].widest : otherwise);
  };
  for (std::size_t k = 0; k < n; ++k) {
    LawStretch& s = stretches_[k];
    if (is_even(s)) {
      const double whole = s.piece.length, want = std::min(s.widest, kCubicRatio * beside(k, 1e99));
      s.step = whole / std::clamp(std::ceil(whole / want - 1e-9), 1.0, double{kMostPerCubic});
    }
    s.first = s.last = s.step;
  }
  // Straights and arcs: at their joints as fine as their neighbours, or where the neighbour is of the same kind as a start from rest.
  for (std::size_t k = 0; k < n; ++k) {
    LawStretch& s = stretches_[k];
    if (is_even(s)) continue;
    straight_limits(s, s.from, limits_, acc, jerk);
    const double fine = std::max(kRestShare * rise(acc, jerk), s.step / 8);
    const auto joint = [&](const LawStretch& other) {
      const double neighbour = is_even(other) ? std::min(other.step, other.end - other.from)
                                              : std::min(fine, other.step);
      return std::min(s.step, neighbour);
    };
    if (k > 0) s.first = joint(stretches_[k - 1]);
    if (k + 1 < n) s.last = joint(stretches_[k + 1]);
  }
  fine_ = kNoLimit;
  LawStretch &head = stretches_[0], &tail = stretches_[n - 1];
  const auto at_rest = [&](const LawStretch& s, double at) {
    straight_limits(s, at, limits_, acc, jerk);
    double h = std::min({s.step, kRestShare * rise(acc, jerk), kRestOfPiece * s.piece.length});
    const double slow = kRestOfWish * way_from_rest(std::min(s.wish, s.cap), jerk);
    while (h > std::max(slow, kFinest)) h /= kCoarser;
    return h;
  };
  if (x0 <= 0) {
    fine_ = head.first = at_rest(head, head.from);
  } else {
    // Where it is slow for what jerk can do, the way on which jerk makes that speed: beyond it x grows by a power 4/3 of the way.
    straight_limits(head, head.from, limits_, acc, jerk);
    const double change = kFirstChange * x0 / std::max(2 * std::abs(u0), 1e-99);
    fine_ = std::max(std::min(change, way_from_rest(x0, jerk)), kFinest);
  }
  tail.last = at_rest(tail, tail.to);
}

bool LawRows::make(double x0, double u0, std::size_t least) noexcept {
  a0.clear();
  a1.clear();
  a2.clear();
  room_ = true;
  double before = 0;
  used_ = 0;
  for (LawStretch& s : stretches_) {
    const double way = s.end - s.from;
    s.to = std::min(s.end, s.from + (way_ - before));
    before += way;
    ++used_;
    if (before >= way_) break;
  }
  choose_steps(x0, u0);
  for (;;) {
    intervals_.clear();
    double gone = 0;
    for (std::size_t k = 0; k < used_; ++k) {
      divide(k, gone);
      gone += stretches_[k].to - stretches_[k].from;
    }
    if (!room_) return false;
    if (intervals_.size() >= least) break;
    for (LawStretch& s : stretches_) s.step /= 2, s.first /= 2, s.last /= 2;
  }
  for (std::size_t i = 0; i < intervals_.size(); ++i)
    if (!make_rows(i)) return false;
  return true;
}

void LawRows::make_stepwise(double way) noexcept {
  a0.clear();
  a1.clear();
  a2.clear();
  intervals_.clear();
  room_ = true;
  used_ = 0;
  while (used_ < stretches_.size()) {
    LawStretch& s = stretches_[used_++];
    s.to = s.end;
    at_ = s.from + std::max(way, 0.0);
    const double whole = s.end - s.from;
    way -= whole;
    // Rounding leaves no sliver of a stretch.
    if (way < -kSamePlace * whole) break;
  }
}

bool LawRows::add_step(double most) noexcept {
  if (used_ == 0 || !(at_ < stretches_[used_ - 1].to)) {
    if (used_ == stretches_.size()) return false;
    LawStretch& next = stretches_[used_++];
    next.to = next.end;
    at_ = next.from;
  }
  const LawStretch& s = stretches_[used_ - 1];
  if (s.piece.shape == Piece::Shape::arc && s.piece.rate != 0)
    most = std::min(most, kArcStep / std::abs(s.piece.rate));
  most = std::min(most, s.bends);
  const double left = s.to - at_, parts = std::ceil(left / most - 1e-9);
  const double to = parts <= 1 ? s.to : at_ + (parts <= kEvenParts ? left / parts : most);
  push(used_ - 1, at_, to);
  at_ = to;
  if (!room_ || !make_rows(intervals_.size() - 1)) return false;
  turn_rows(intervals_.back());
  return true;
}

/// Its rows, the last ones, as bounds of b2.
void LawRows::turn_rows(LawInterval& in) noexcept {
  for (Buffer<double>* b : {&mid0, &mid1, &half}) b->truncate(in.row);
  const std::size_t count = a2.size() - in.row, accs = static_cast<std::size_t>(in.accs);
  const double *k0 = a0.begin() + in.row, *k1 = a1.begin() + in.row, *k2 = a2.begin() + in.row;
  double *m0 = mid0.end(), *m1 = mid1.end(), *h = half.end();
  in.bounds_u = false;
  for (std::size_t r = 0; r < count; ++r) {
    const bool none = r < accs ? k2[r] == 0 : std::abs(k2[r]) < kNoW * std::abs(k1[r]);
    const double over = none ? 0 : 1 / k2[r];
    in.bounds_u = in.bounds_u || (none && r >= accs);
    m0[r] = -k0[r] * over;
    m1[r] = -k1[r] * over;
    h[r] = none ? kNoLimit : std::abs(over);
  }
  // As much room as the rows have themselves.
  for (Buffer<double>* b : {&mid0, &mid1, &half}) b->grow(count);
}

void LawRows::take_back(std::size_t i) noexcept {
  const LawInterval& first = intervals_[i];
  used_ = first.stretch + 1;
  at_ = first.from;
  for (Buffer<double>* a : {&a0, &a1, &a2}) a->truncate(first.row);
  intervals_.truncate(i);
}

/// Whether interval i, which is no straight, begins with the derivatives with which the one before it ends.
bool LawRows::goes_on(std::size_t i, const Vec& first, const Vec& second) const noexcept {
  const LawInterval& before = intervals_[i - 1];
  if (before.stretch == intervals_[i].stretch) return true;
  const Piece& piece = stretches_[before.stretch].piece;
  if (piece.straight()) return false;
  const double end = before.from + before.length;
  const Vec p = piece.first(end), e = piece.second(end);
  double bends = 0;
  for (std::size_t j = 0; j < kAxes; ++j) bends = std::max(bends, std::abs(second[j]));
  for (std::size_t j = 0; j < kAxes; ++j)
    if (std::abs(p[j] - first[j]) > kSameSlope || std::abs(e[j] - second[j]) > kSameSlope * bends)
      return false;
  return true;
}

bool LawRows::make_rows(std::size_t i) noexcept {
  LawInterval& in = intervals_[i];
  const LawStretch& stretch = stretches_[in.stretch];
  const Piece& piece = stretch.piece;
  in.row = a0.size();
  const double over = 1 / in.length;
  // There is room for one more interval than fits.
  double *k0s = a0.end(), *k1s = a1.end(), *k2s = a2.end();
  std::size_t count = 0;
  const auto row = [&](double k0, double k1, double k2, double share) {
    k0s[count] = k0 * share;
    k1s[count] = k1 * share;
    k2s[count] = k2 * share;
    ++count;
  };
  const auto keep = [&] {
    if (in.row + count > most_rows_) return false;
    for (Buffer<double>* a : {&a0, &a1, &a2}) a->grow(count);
    return true;
  };
  if (is_straight(stretch)) {
    double acc = 0, jerk = 0;
    straight_limits(stretch, in.from, limits_, acc, jerk);
    // Within a straight the acceleration at its start is that at the end of the interval before.
    const bool same = i > 0 && intervals_[i - 1].stretch == in.stretch;
    if (!same) row(-over, over, 0, 1 / acc);
    row(0, -over, over, 1 / acc);
    in.accs = same ? 1 : 2;
    in.jerks = jerk < kNoLimit ? 1 : 0;
    for (int k = 0; k < 3 && in.jerks > 0; ++k)
      row(over * over, -2 * over * over, over * over, 1 / jerk);
    return keep();
  }
  const Derivatives d = derivatives(piece, in.from, in.from + in.length);
  in.accs = in.jerks = 0;
  // Where q' and q'' go on the acceleration at its start is that at the end of the interval before.
  const bool same = i > 0 && goes_on(i, d.p0, d.e0);
  const auto acc_rows = [&](double p0, double p1, double p2, double e0, double e1, double limit,
                            bool begins) {
    const double share = 1 / limit;
    p0 *= over, p1 *= over, p2 *= over;
    if (begins) row(e0 - p0, p0, 0, share);
    row((e1 - 2 * p1) / 3, (2 * p1 - p0 + 2 * e0) / 3, p0 / 3, share);
    row(-p2 / 3, (p2 - 2 * p1 + 2 * e1) / 3, (2 * p1 + e0) / 3, share);
    row(0, -p2, p2 + e1, share);
    in.accs += begins ? 4 : 3;
  };
  std::size_t axis[kAxes], axes = 0;
  for (std::size_t j = 0; j < kAxes; ++j)
    if (d.p0[j] != 0 || d.p2[j] != 0 || d.e0[j] != 0 || d.e1[j] != 0) axis[axes++] = j;
  for (std::size_t n = 0; n < axes; ++n) {
    const std::size_t j = axis[n];
    if (limits_.acc[j] >= kNoLimit) continue;
    acc_rows(d.p0[j], d.p1[j], d.p2[j], d.e0[j], d.e1[j], limits_.acc[j], !same);
  }
  const double along = piece.straight() ? norm3(piece.b, 0) : 0.0;
  if (along > 0 && limits_.path_acc < kNoLimit)
    acc_rows(along, along, along, 0, 0, limits_.path_acc,
             i == 0 || intervals_[i - 1].stretch != in.stretch);
  // What has a jerk limit, with e over the length.
  struct Bend {
    double p[3], e0, e1, c[3], share;
  };
  Bend bend[kMostJerks];
  std::size_t bends = 0;
  for (std::size_t n = 0; n < axes; ++n) {
    const std::size_t j = axis[n];
    if (limits_.jerk[j] < kNoLimit)
      bend[bends++] = {{d.p0[j], d.p1[j], d.p2[j]},
                       d.e0[j] * over,
                       d.e1[j] * over,
                       {d.c0[j], d.c1[j], d.c2[j]},
                       1 / limits_.jerk[j]};
  }
  JointPart joint[kMostJoints];
  std::size_t joints = 0;
  for_each_joint(
      stretch, in.from, in.from + in.length, [&](const JointPart& p, const JointCurve::Row& limit) {
        joint[joints++] = p;
        acc_rows(p.p0, p.p1, p.p2, p.e0, p.e1, limit.acc, !same);
        if (limit.jerk < kNoLimit)
          bend[bends++] = {
              {p.p0, p.p1, p.p2}, p.e0 * over, p.e1 * over, {p.c0, p.c1, p.c2}, 1 / limit.jerk};
      });
  const double slope = limits_.path_jerk < kNoLimit ? jerk_slope(piece) : 0.0, ww = over * over;
  in.jerks = static_cast<std::int32_t>(bends) + (slope > 0 ? 1 : 0);
  for (int k = 0; k < 3; ++k) {
    for (std::size_t n = 0; n < bends; ++n) {
      const auto& [p, e0, e1, c, share] = bend[n];
      const double w = p[k] * ww;
      if (k == 0)
        row(w - 3 * e0 + c[0], -2 * w + 3 * e0, w, share);
      else if (k == 1)
        row(w - 1.5 * e1, -2 * w + 1.5 * (e1 - e0) + c[1], w + 1.5 * e0, share);
      else
        row(w, -2 * w - 3 * e1, w + 3 * e1 + c[2], share);
    }
    if (slope > 0) row(slope * ww, -2 * slope * ww, slope * ww, 1 / limits_.path_jerk);
  }
  in.acc_rest = in.jerk_rest_u = in.jerk_rest_b = 0;
  if (piece.shape == Piece::Shape::arc) {
    const double turn = piece.rate * in.length, rest = turn * turn / 8;
    for (std::size_t j = 0; j < kAxes; ++j) {
      const double e = std::max(std::abs(d.e0[j]), std::abs(d.e1[j]));
      in.acc_rest = std::max(in.acc_rest, rest * e / limits_.acc[j]);
      in.jerk_rest_u = std::max(in.jerk_rest_u, 3 * rest * e / limits_.jerk[j]);
      in.jerk_rest_b = std::max(in.jerk_rest_b, std::abs(d.c2[j] - d.c0[j]) / 3 / limits_.jerk[j]);
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    const JointPart& p = joint[j];
    const JointCurve::Row& limit = stretch.joints->row[j];
    in.acc_rest = std::max(in.acc_rest, p.e_off / limit.acc);
    in.acc_rest_u = std::max(in.acc_rest_u, p.p_off / limit.acc);
    in.jerk_rest = std::max(in.jerk_rest, p.c_off / limit.jerk);
    in.jerk_rest_u = std::max(in.jerk_rest_u, 3 * p.e_off / limit.jerk);
    in.jerk_rest_b = std::max(in.jerk_rest_b, std::abs(p.c2 - p.c0) / 3 / limit.jerk);
    in.jerk_rest_w = std::max(in.jerk_rest_w, p.p_off / limit.jerk);
  }
  return keep();
}

double LawRows::rest_cap(std::size_t i, double way, bool start) const noexcept {
  // s = length r^3 from rest: with y = r^3 jerk is (c y^2 + 3 e y 2/(3 length) + p 2/(9 length^2)) x^(3/2), and acceleration at most
  // (e y + p 2/(3 length)) x. A stop is the same backwards: p and c change their signs.
  const LawInterval& in = intervals_[i];
  const Derivatives d = derivatives(stretches_[in.stretch].piece, in.from, in.from + way);
  double cap = in.cap, acc = 0, jerk = 0;
  const double sign = start ? 1 : -1;
  const auto take = [&](double p0, double p1, double p2, double e0, double e1, double c,
                        double acc_limit, double jerk_limit) {
    if (p0 == 0 && p2 == 0 && e0 == 0 && e1 == 0) return;
    const double ka = 2 / (3 * way), kj = 2 / (9 * way * way);
    const double a =
        std::max({std::abs(p0 * ka), std::abs(p1 * ka + e0 / 2), std::abs(p2 * ka + e1)});
    const double k = std::max(
        {std::abs(p0 * kj), std::abs(p1 * kj + e0 / way), std::abs(p2 * kj + 2 * e1 / way + c)});
    acc = std::max(acc, a / acc_limit);
    jerk = std::max(jerk, k / jerk_limit);
  };
  for (std::size_t j = 0; j < kAxes; ++j)
    take(sign * (start ? d.p0[j] : d.p2[j]), sign * d.p1[j], sign * (start ? d.p2[j] : d.p0[j]),
         start ? d.e0[j] : d.e1[j], start ? d.e1[j] : d.e0[j], sign * (start ? d.c2[j] : d.c0[j]),
         limits_.acc[j], limits_.jerk[j]);
  const LawStretch& stretch = stretches_[in.stretch];
  for_each_joint(stretch, in.from, in.from + way,
                 [&](const JointPart& p, const JointCurve::Row& limit) {
                   take(sign * (start ? p.p0 : p.p2), sign * p.p1, sign * (start ? p.p2 : p.p0),
                        start ? p.e0 : p.e1, start ? p.e1 : p.e0, sign * (start ? p.c2 : p.c0),
                        limit.acc, limit.jerk);
                 });
  const Piece& piece = stretch.piece;
  double acc_path = 0, jerk_path = 0;
  straight_limits(stretch, in.from, limits_, acc_path, jerk_path);
  if (piece.straight()) acc = std::max(acc, 2 / (3 * way) / acc_path);
  if (limits_.path_jerk < kNoLimit && jerk_slope(piece) > 0)
    jerk = std::max(jerk, 2 / (9 * way * way) / jerk_path);
  // What arcs leave out: see kArcStep.
  const double reserve =
      piece.shape == Piece::Shape::arc || stretch.joints != nullptr ? 0.995 : 1.0;
  if (acc > 0) cap = std::min(cap, reserve / acc);
  if (jerk > 0) cap = std::min(cap, reserve / std::cbrt(jerk * jerk));
  return cap;
}

double LawRows::start_cap() const noexcept { return rest_cap(0, intervals_[0].length, true); }
double LawRows::stop_cap() const noexcept {
  return rest_cap(intervals_.size() - 1, intervals_.back().length, false);
}

double LawRows::stop_cap(std::size_t i, double way) const noexcept {
  const LawStretch& s = stretches_[intervals_[i].stretch];
  if (intervals_[i].from + way > s.to) return 0;
  // The rows of an arc hold for short parts of it.
  if (s.piece.shape == Piece::Shape::arc && std::abs(s.piece.rate) * way > kArcStep) return 0;
  if (way > kMostBends * s.bends) return 0;
  return rest_cap(i, way, false);
}

void LawRows::most_on(std::size_t i, double& acc, double& jerk) const noexcept {
  const LawInterval& in = intervals_[i];
  const LawStretch& stretch = stretches_[in.stretch];
  straightest(i, acc, jerk);
  if (is_straight(stretch)) return;
  for (const double s : {in.from, in.from + in.length}) {
    double a = 0, j = 0;
    straight_limits(stretch, s, limits_, a, j);
    acc = std::max(acc, a);
    jerk = std::max(jerk, j);
  }
}

double LawRows::even_cap(std::size_t i) const noexcept {
  const LawInterval& in = intervals_[i];
  const LawStretch& stretch = stretches_[in.stretch];
  const Piece& piece = stretch.piece;
  double x = in.cap;
  for_each_joint(stretch, in.from, in.from + in.length,
                 [&](const JointPart& p, const JointCurve::Row& limit) {
                   const double e = std::max(std::abs(p.e0), std::abs(p.e1)),
                                third = std::max(std::abs(p.c0), std::abs(p.c2));
                   if (e > 0) x = std::min(x, 0.6 * limit.acc / e);
                   if (third > 0) {
                     const double v = std::cbrt(0.5 * limit.jerk / third);
                     x = std::min(x, v * v);
                   }
                 });
  if (piece.straight()) return x;
  const Vec e0 = piece.second(in.from), e1 = piece.second(in.from + in.length),
            c = piece.third(in.from + in.length / 2);
  for (std::size_t j = 0; j < kAxes; ++j) {
    const double e = std::max(std::abs(e0[j]), std::abs(e1[j])), third = std::abs(c[j]);
    if (e > 0) x = std::min(x, 0.6 * limits_.acc[j] / e);
    if (third > 0) {
      const double v = std::cbrt(0.5 * limits_.jerk[j] / third);
      x = std::min(x, v * v);
    }
  }
  return x;
}

LawExcess LawRows::excess(std::size_t i, const double b[3], bool given) const noexcept {
  const LawInterval& in = intervals_[i];
  LawExcess out;
  const double top = std::max({b[0], b[1], b[2]});
  out.vel = std::sqrt((given ? std::max(b[1], b[2]) : top) / in.cap) - 1;
  std::size_t r = in.row;
  double acc = 0;
  for (std::int32_t k = 0; k < in.accs; ++k, ++r)
    if (!given || a2[r] != 0)
      acc = std::max(acc, std::abs(a0[r] * b[0] + a1[r] * b[1] + a2[r] * b[2]));
  const double u = std::max(std::abs(b[1] - b[0]), std::abs(b[2] - b[1]));
  out.acc = acc + in.acc_rest * top + in.acc_rest_u * u / in.length - 1;
  out.jerk = jerk_excess(i, b);
  return out;
}

double LawRows::jerk_excess(std::size_t i, const double b[3]) const noexcept {
  const LawInterval& in = intervals_[i];
  const double top = std::max({b[0], b[1], b[2]}),
               u = std::max(std::abs(b[1] - b[0]), std::abs(b[2] - b[1]));
  const double xm = (b[0] + 2 * b[1] + b[2]) / 4, v = std::sqrt(xm);
  const double rest = in.jerk_rest * top + in.jerk_rest_u * u / in.length + in.jerk_rest_b * u +
                      in.jerk_rest_w * std::abs(b[0] - 2 * b[1] + b[2]) / (in.length * in.length);
  double jerk = -1;
  std::size_t r = in.row + static_cast<std::size_t>(in.accs);
  for (int k = 0; k < 3 && in.jerks > 0; ++k) {
    double most = 0;
    for (std::int32_t j = 0; j < in.jerks; ++j, ++r)
      most = std::max(most, std::abs(a0[r] * b[0] + a1[r] * b[1] + a2[r] * b[2]));
    // Without anything left on the right no speed is slow enough.
    const double right = (1.5 - b[k] / (2 * xm)) / v;
    jerk = std::max(jerk, right > 0 ? (most + rest) / right - 1 : kNoLimit);
  }
  return jerk;
}

}  // namespace kerf::motion::path
