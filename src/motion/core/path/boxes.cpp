#include "motion/core/path/boxes.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/ramp.hpp"

namespace kerf::motion::path {
namespace {

/// Shares of what a straight could do that a region leaves to speeding up and braking, of acceleration and of jerk. The rest is for
/// turning. The pair with the least estimated time is taken.
struct Share {
  double acc, jerk;
};
constexpr Share kShares[] = {{0.06, 0.08}, {0.12, 0.16}, {0.2, 0.25},
                             {0.32, 0.35}, {0.5, 0.5},   {0.75, 0.7}};
/// A straight on which full acceleration can just be reached and left again is this long at least (times acc^3 / jerk^2); a good part
/// of it is worth a region of its own.
constexpr double kOwnRegion = 0.25;
/// Rounding, and the error of the quadratics on arcs.
constexpr double kReserve = 1.0 - 1e-5;
constexpr double kArcShares[] = {0.06, 0.15, 0.3, 0.5, 0.7, 0.9};
/// What a time law gains on passing a blend evenly, as a share of the time that takes: acceleration builds up within it, the more where the
/// path turns back. Fitted to the times of laws over 225 corners of 10 to 179 degrees, P 0.003 to 0.2 mm, jerk 20 000 to 200 000 mm/s3:
/// 215 are decided right, the others cost 0.1 of acc/jerk at most.
constexpr double kRampShare = 0.22, kTurnShare = 0.75;
constexpr int kSteps = 24;
constexpr int kEstimateStretches = 8;

/// Largest |q'|, |q''| and |q'''| of an axis on a stretch.
struct Bends {
  Vec p, e, c;
};

Bends bends_of(const Piece& piece, double s0, double s1) noexcept {
  Bends out;
  const double sm = (s0 + s1) / 2;
  const auto hull = [](const Vec& a, const Vec& m, const Vec& b) {
    Vec top;
    for (std::size_t i = 0; i < kAxes; ++i)
      top[i] = std::max({std::abs(a[i]), std::abs(2 * m[i] - 0.5 * (a[i] + b[i])), std::abs(b[i])});
    return top;
  };
  if (piece.straight()) {
    for (std::size_t i = 0; i < kAxes; ++i) out.p[i] = std::abs(piece.b[i]);
    return out;
  }
  out.p = hull(piece.first(s0), piece.first(sm), piece.first(s1));
  if (piece.shape == Piece::Shape::arc) {
    out.e = hull(piece.second(s0), piece.second(sm), piece.second(s1));
    out.c = hull(piece.third(s0), piece.third(sm), piece.third(s1));
    return out;
  }
  const Vec e0 = piece.second(s0), e1 = piece.second(s1);
  for (std::size_t i = 0; i < kAxes; ++i) {
    out.e[i] = std::max(std::abs(e0[i]), std::abs(e1[i]));
    out.c[i] = std::abs(piece.d[i]);
  }
  return out;
}

/// The largest v with c v^3 + 3 e a v <= room, or `most` where that is less: Newton from above on a convex function stays above the root, so a hair is
/// taken off.
double jerk_speed(double c, double ea, double room, double most) noexcept {
  if (!(room > 0)) return 0;
  const double high = most * (1 + 1e-8);
  if (high * (c * high * high + 3 * ea) <= room) return most;
  double v = kNoLimit;
  if (c > 0) v = std::cbrt(room / c);
  if (ea > 0) v = std::min(v, room / (3 * ea));
  if (!(c > 0) || !(ea > 0)) return std::min(most, v);
  for (int i = 0; i < kSteps; ++i) {
    const double off = v * (c * v * v + 3 * ea) - room;
    if (off <= 1e-12 * room) break;
    v -= off / (3 * (c * v * v + ea));
  }
  return std::min(most, v * (1 - 1e-9));
}

/// Largest |q'| on a whole piece, however far an arc turns.
Vec steepest(const Piece& piece) noexcept {
  if (piece.shape != Piece::Shape::arc) return bends_of(piece, 0, piece.length).p;
  const double end = piece.radius + piece.growth * piece.rate * piece.length;
  const double begin = piece.radius + piece.growth * piece.phi0;
  const double radius = std::max({std::abs(piece.radius), std::abs(end), std::abs(begin),
                                  std::abs(end + piece.growth * piece.phi0)});
  Vec out;
  for (std::size_t i = 0; i < kAxes; ++i)
    out[i] = std::abs(piece.rate) * (std::abs(piece.b[i]) + std::hypot(piece.c[i], piece.d[i]) *
                                                                std::hypot(radius, piece.growth));
  return out;
}

/// What a box allows all along an arc, by some stretches of it.
double arc_cap(const Piece& p, const Box& box, const AxisLimits& limits) noexcept {
  const int all = divisions(p), n = std::min(all, kEstimateStretches);
  const double step = p.length / all;
  double cap = kNoLimit;
  for (int i = 0; i < n; ++i) {
    const double from = (p.length - step) * i / std::max(1, n - 1);
    cap = std::min(cap, box_cap(p, from, from + step, box, limits));
  }
  return cap;
}

/// Of the angle between both directions, in accelerations that the axes can do.
double cosine_between(const Vec& t1, const Vec& t2, const AxisLimits& limits) noexcept {
  double dot = 0, square1 = 0, square2 = 0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (t1[i] == 0 && t2[i] == 0) continue;
    const double a = t1[i] / limits.acc[i], b = t2[i] / limits.acc[i];
    dot += a * b;
    square1 += a * a;
    square2 += b * b;
  }
  return dot / std::sqrt(square1 * square2);
}

}  // namespace

Box straight_box(const Piece& piece, const AxisLimits& limits) noexcept {
  Box out{straight_acc(piece, limits), kNoLimit};
  for (std::size_t i = 0; i < kAxes; ++i)
    if (piece.b[i] != 0) out.jerk = std::min(out.jerk, limits.jerk[i] / std::abs(piece.b[i]));
  const double xyz = norm3(piece.b, 0);
  if (xyz > 0) out.jerk = std::min(out.jerk, limits.path_jerk / xyz);
  return out;
}

double box_cap(const Piece& piece, double s0, double s1, const Box& box,
               const AxisLimits& limits) noexcept {
  if (piece.straight()) return kNoLimit;
  const Bends b = bends_of(piece, s0, s1);
  double v = kNoLimit;
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (b.e[i] > 0) {
      const double room = limits.acc[i] * kReserve - b.p[i] * box.acc;
      v = room > 0 ? std::min(v, std::sqrt(room / b.e[i])) : 0.0;
    }
    if (limits.jerk[i] < kNoLimit && (b.e[i] > 0 || b.c[i] > 0))
      v = jerk_speed(b.c[i], b.e[i] * box.acc, limits.jerk[i] * kReserve - b.p[i] * box.jerk, v);
  }
  return v < 1e49 ? v * v : kNoLimit;
}

double box_cap(const JointBends& joints, const Box& box) noexcept {
  double v = kNoLimit;
  for (std::size_t i = 0; i < joints.count; ++i) {
    const JointBends::Row& b = joints.row[i];
    if (b.e > 0) {
      const double room = b.acc * kReserve - b.p * box.acc;
      v = room > 0 ? std::min(v, std::sqrt(room / b.e)) : 0.0;
    }
    if (b.jerk < kNoLimit && (b.e > 0 || b.c > 0))
      v = jerk_speed(b.c, b.e * box.acc, b.jerk * kReserve - b.p * box.jerk, v);
  }
  return v < 1e49 ? v * v : kNoLimit;
}

void JointBends::join(const JointBends& other) noexcept {
  for (std::size_t i = count; i < other.count; ++i) row[i] = other.row[i];
  count = std::max(count, other.count);
  for (std::size_t i = 0; i < other.count; ++i) {
    row[i].p = std::max(row[i].p, other.row[i].p);
    row[i].e = std::max(row[i].e, other.row[i].e);
    row[i].c = std::max(row[i].c, other.row[i].c);
  }
}

double even_speed(const Piece* pieces, std::size_t count, const AxisLimits& limits,
                  bool by_law) noexcept {
  double cap = kNoLimit;
  for (std::size_t k = 0; k < count; ++k) {
    const Piece& p = pieces[k];
    Box box;
    if (!by_law) {
      box = straight_box(straight_piece(p.a, p.first(p.length / 2), p.length, p.feed), limits);
      box.acc *= kShares[0].acc;
      box.jerk *= kShares[0].jerk;
    }
    cap = std::min({cap, axis_cap(p, 0, p.length, limits), feed_cap(p, 0, p.length),
                    box_cap(p, 0, p.length, box, limits)});
  }
  return std::sqrt(cap);
}

bool faster_to_stop(const Piece& a, const Piece& b, double l, double speed,
                    const AxisLimits& limits, bool by_law) noexcept {
  double stop = 0, blend = 2 * l / std::max(speed, 1e-9);
  if (by_law) {
    const double cosine = cosine_between(a.first(a.length), b.first(0), limits);
    blend *= 1 - kRampShare - kTurnShare * std::max(0.0, -cosine);
  }
  for (const Piece* p : {&a, &b}) {
    const Vec direction = p->first(p->length / 2);
    const Box box = straight_box(straight_piece(p->a, direction, p->length, p->feed), limits);
    const RampLimits ramp{box.acc, box.jerk};
    double cap = std::min(axis_cap(*p, 0, p->length, limits), feed_cap(*p, 0, p->length));
    if (p->shape == Piece::Shape::arc)
      cap = std::min(cap, arc_cap(*p, {0.15 * box.acc, 0.15 * box.jerk}, limits));
    const double most = std::sqrt(cap), rest = p->length - 2 * l;
    stop += 0.5 * level_time(p->length, 0, 0, most, ramp);
    if (rest > 0) blend += 0.5 * level_time(rest, speed, speed, most, ramp);
  }
  return stop < blend;
}

/// What all pieces of a region could do if they were straight.
Box Boxes::straightest(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                       const AxisLimits& limits) const noexcept {
  Box out{kNoLimit, kNoLimit};
  for (std::size_t k = begin; k < end; ++k) {
    const Piece& piece = pieces[k];
    const Vec p = steepest(piece);
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (p[i] <= 0) continue;
      out.acc = std::min(out.acc, limits.acc[i] / p[i]);
      out.jerk = std::min(out.jerk, limits.jerk[i] / p[i]);
    }
    const double xyz = norm3(p, 0);
    if (xyz > 0) {
      out.acc = std::min(out.acc, limits.path_acc / xyz);
      out.jerk = std::min(out.jerk, limits.path_jerk / xyz);
    }
    for (std::size_t i = 0; joints_ != nullptr && i < joints_[k].count; ++i) {
      const JointBends::Row& row = joints_[k].row[i];
      if (row.p <= 0) continue;
      out.acc = std::min(out.acc, row.acc / row.p);
      out.jerk = std::min(out.jerk, row.jerk / row.p);
    }
  }
  return out;
}

/// Estimate: speeds by acceleration alone; each end of the region costs a ramp of acceleration.
double Boxes::seconds(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                      const Box& box, const AxisLimits& limits) noexcept {
  for (std::size_t k = begin; k < end; ++k) {
    const Piece& p = pieces[k];
    double cap =
        std::min({axis_cap(p, 0, p.length, limits), feed_cap(p, 0, p.length), joint_cap(k, box)});
    if (p.shape == Piece::Shape::arc) {
      cap_[k] = std::min(cap, arc_cap(p, box, limits));
      continue;
    }
    const int n = p.straight() ? 1 : divisions(p);
    for (int i = 0; i < n; ++i)
      cap = std::min(cap, box_cap(p, p.length * i / n, p.length * (i + 1) / n, box, limits));
    cap_[k] = cap;
  }
  double total = 0, x = cap_[end - 1];
  if (pieces[end - 1].stop_at_end) x = 0;
  for (std::size_t k = end; k-- > begin;) {
    x = std::min(cap_[k], x + 2 * box.acc * pieces[k].length);
    cap_[k] = x;
  }
  x = begin == 0 ? 0.0 : cap_[begin];
  for (std::size_t k = begin; k < end; ++k) {
    const double next =
        std::min(k + 1 < end ? cap_[k + 1] : cap_[k], x + 2 * box.acc * pieces[k].length);
    const double sum = std::sqrt(x) + std::sqrt(std::max(next, 0.0));
    if (sum > 0) total += 2 * pieces[k].length / sum;
    x = next;
  }
  return total + 2 * box.acc / box.jerk;
}

void Boxes::make_region(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                        const AxisLimits& limits) noexcept {
  const Box whole = straightest(pieces, begin, end, limits);
  // Straights leave nothing to turning: a short one between two stops is such a region.
  const bool straight = std::all_of(pieces.begin() + begin, pieces.begin() + end,
                                    [](const Piece& p) { return p.straight(); }) &&
                        joints_ == nullptr;
  Box best = straight ? whole : Box{};
  double least = 0;
  for (const Share& share : kShares) {
    if (straight) break;
    const Box box{whole.acc * share.acc, whole.jerk * share.jerk};
    const double t = seconds(pieces, begin, end, box, limits);
    if (best.acc > 0 && t >= least) continue;
    best = box;
    least = t;
  }
  for (std::size_t k = begin; k < end; ++k) box_[k] = best;
  (void)seconds(pieces, begin, end, best, limits);  // leaves its speeds in cap_
}

/// A long arc (or a straight along which joints bend) by itself: sped up on and braked on as its neighbours' speeds ask.
void Boxes::make_arc(const Buffer<Piece>& pieces, std::size_t k,
                     const AxisLimits& limits) noexcept {
  const Piece& piece = pieces[k];
  const Box whole = straightest(pieces, k, k + 1, limits);
  const double from = k == 0 || pieces[k - 1].stop_at_end ? 0.0 : std::sqrt(cap_[k - 1]);
  const double to = k + 1 >= pieces.size() || piece.stop_at_end ? 0.0 : std::sqrt(cap_[k + 1]);
  const double axes =
      std::min(axis_cap(piece, 0, piece.length, limits), feed_cap(piece, 0, piece.length));
  double least = 0;
  for (const double acc : kArcShares)
    for (const double jerk : kArcShares) {
      const Box box{whole.acc * acc, whole.jerk * jerk};
      const double cap =
          std::sqrt(std::min({axes, arc_cap(piece, box, limits), joint_cap(k, box)}));
      const double t = level_time(piece.length, from, to, cap, {box.acc, box.jerk});
      if (box_[k].acc > 0 && t >= least) continue;
      box_[k] = box;
      least = t;
    }
}

void Boxes::make(const Buffer<Piece>& pieces, const AxisLimits& limits,
                 const JointBends* joints) noexcept {
  joints_ = joints;
  box_.assign(pieces.size(), Box{});
  // Nothing is known yet of neighbours that have no cap: they are what straights are.
  cap_.assign(pieces.size(), kNoLimit);
  const auto own = [&](std::size_t k) {
    const Piece& piece = pieces[k];
    const bool arc = piece.shape == Piece::Shape::arc;
    if (!arc && !piece.straight()) return false;
    const Box box = arc || joints_ != nullptr ? straightest(pieces, k, k + 1, limits)
                                              : straight_box(piece, limits);
    return piece.length >= kOwnRegion * box.acc * box.acc * box.acc / (box.jerk * box.jerk);
  };
  std::size_t begin = 0;
  for (std::size_t k = 0; k <= pieces.size(); ++k) {
    const bool alone = k < pieces.size() && own(k);
    if (k < pieces.size() && !alone && !(k > begin && pieces[k - 1].stop_at_end)) continue;
    if (k > begin) make_region(pieces, begin, k, limits);
    begin = alone ? k + 1 : k;
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (box_[k].acc > 0) continue;
    if (pieces[k].straight() && joints_ == nullptr)
      box_[k] = straight_box(pieces[k], limits);
    else
      make_arc(pieces, k, limits);
  }
}

}  // namespace kerf::motion::path
