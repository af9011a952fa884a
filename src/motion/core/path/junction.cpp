#include "motion/core/path/junction.hpp"

#include <algorithm>
#include <array>

#include "motion/core/path/boxes.hpp"
#include "motion/core/path/junction_shapes.hpp"
#include "motion/core/path/reach.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kShrinkStep = 0.9;
/// What has the least jerk is looked for near to the width that was foretold.
constexpr double kFirstReach = 1.06, kFineStep = 0.98;
/// Beside a straight only kinks that are less of the tolerance on the whole reach count as none.
constexpr double kTangent = 0.02;
/// Of three spans: the half-width of the middle one as a share of the whole; and how much of the kink is taken from both of its ends to the vertex,
/// times l. The latter lets the blend swing out before and behind the vertex, with jerk as even as in a triangle.
///
/// With a core the kink itself is spread over this share of the half-width only, and turns by more than it has to; what is too much is taken back
/// all the way to both ends, so that the blend is outside of the vertex before and behind it by as much as inside at it.
struct Shape {
  double plateau{0}, swing{0}, core{0};
  const JunctionShape* least_jerk{nullptr};  ///< instead of all that
};
/// Nearly the least acceleration that a blend can have.
constexpr Shape kEven{0.5, 0};
/// The last ones need 0.6 and 0.3 of a triangle's jerk, and 0.9 and 0.7 of the acceleration of an even one.
constexpr Shape kShapes[] = {{0.1, 0}, {0.3, 0}, {0.88, 0.751}, {0.82, 1.071}};
/// For sharp kinks, which are passed much slower than what is before and behind them: half the acceleration of an even one.
constexpr Shape kCoreShapes[] = {{0.5, 0, 0.15}, {0.5, 0, 0.25}, {0.5, 0, 0.35}};
/// They need this much room, in kinks over tolerance; with less they are no wider at the vertex than an even one.
constexpr double kCoreRoom = 12;
/// The core: the plateau of its trapezoid, and how far that is off at the vertex, as a share of core times kink.
constexpr double kCorePlateau = 0.8;
constexpr double kCoreOff =
    (1 + kCorePlateau + kCorePlateau * kCorePlateau) / (6 * (1 + kCorePlateau));
constexpr int kMaxRounds = 150;
constexpr int kSamples =
    12;  ///< of the deviation, in each of the pieces; at first only at their ends
/// Between samples the deviation may be larger by this share (a cubic against an arc).
constexpr double kAim = 0.98;
constexpr double kLeastOver = 0.5;  ///< of half of the move that a blend goes over
constexpr double kOutside = 1.5;    ///< a share that only makes the blend smaller

/// What is looked at of arcs beside a blend, and how finely blends and they are divided.
constexpr std::size_t kPerPiece = 2, kPerSide = 4;
constexpr std::size_t kMostBlendPieces = kJunctionPieces;

/// Pieces from -l to +l, as many before the vertex as behind it.
struct Blend {
  std::array<Piece, kMostBlendPieces> piece;
  std::size_t count{0};
  [[nodiscard]] const Piece* begin() const noexcept { return piece.data(); }
  [[nodiscard]] const Piece* end() const noexcept { return piece.data() + count; }
};

/// q'' per kink and 1/l at places from the vertex on, as shares of l; the same before it. Linear between them. `turn`: per jump of q'', the other way before it.
struct Profile {
  std::array<double, kMostBlendPieces / 2 + 1> at{}, bend{}, turn{};
  std::size_t last{0};
};

double half_over(const JunctionSettings& settings) noexcept {
  return settings.over != nullptr ? settings.over->length / 2 : 0.0;
}

Profile profile_of(const Shape& shape) noexcept {
  if (const JunctionShape* least = shape.least_jerk)
    return {kJunctionKnots, least->even, least->odd, kJunctionKnots.size() - 1};
  if (!(shape.core > 0))
    return {{0, shape.plateau, 1}, {shape.swing / shape.plateau, -shape.swing, 0}, {}, 2};
  const double r = shape.core, back = shape.plateau;
  // What is taken back on each side, about its middle: off outside at the ends of the core as much as inside at the vertex.
  const double middle = (r + back + 1) / 3;
  const double taken = kCoreOff * r / (2 * middle - r - 2 * kCoreOff * r);
  const double high = (1 + 2 * taken) / (r * (1 + kCorePlateau));
  return {{0, kCorePlateau * r, r, back, 1}, {high, high, 0, -2 * taken / (1 - r), 0}, {}, 4};
}

/// Takes `reach` of both.
void make_blend(const Piece& a, const Piece& b, double reach, const Shape& shape,
                const JunctionSettings& settings, Blend& out) noexcept {
  const double l = reach + half_over(settings);  // its half-width
  const double sa = a.length - reach;
  const Vec q0 = a.point(sa), t0 = a.first(sa);
  const Vec q1 = b.point(reach), t1 = b.first(reach);
  Vec c0 = a.second(sa), c1 = b.second(reach);
  const Vec kink = b.first(0) - a.first(a.length);
  Vec jump;
  if (shape.least_jerk != nullptr) {
    jump = b.second(0) - a.second(a.length);
    c0.add(0.5, jump);
    c1.add(-0.5, jump);
  }
  const double s1 = (1.0 - shape.plateau) * l, s2 = 2.0 * shape.plateau * l;
  // q'' is c0, m1, m2, c1 at the knots of three spans and linear between them. Unknown m1, m2 from
  //   area:   integral of q'' = t1 - t0
  //   moment: integral of (l - u) q'' = q1 - q0 - 2 l t0
  // where a core (or what has the least jerk) has taken the kink on itself, and the jump, from what is left of both.
  const double cored = shape.core > 0 || shape.least_jerk != nullptr ? 1.0 : 0.0;
  const double area0 = s1 / 2, area1 = (s1 + s2) / 2;
  const double w0 = 2 * l, w1 = 2 * l - s1, w2 = s1;  // l - u at the knots; the last is 0
  const double mom0 = s1 / 6 * (2 * w0 + w1);
  const double mom1 = s1 / 6 * (w0 + 2 * w1) + s2 / 6 * (2 * w1 + w2);
  const double mom2 = s2 / 6 * (w1 + 2 * w2) + s1 / 6 * (2 * w2);
  const double mom3 = s1 / 6 * w2;
  const double det = area1 * (mom2 - mom1);
  Vec m1, m2;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double area = t1[i] - t0[i] - cored * kink[i] - area0 * (c0[i] + c1[i]);
    const double moment = q1[i] - q0[i] - 2 * l * t0[i] - cored * l * kink[i] +
                          l * l / 2 * jump[i] - mom0 * c0[i] - mom3 * c1[i];
    m1[i] = (area * mom2 - moment * area1) / det;
    m2[i] = (moment * area1 - area * mom1) / det;
  }
  const Profile profile = profile_of(shape);
  const auto bend_at = [&](std::size_t k, bool behind) {
    const double at = profile.at[k];
    const Vec& end = behind ? c1 : c0;
    const Vec& knot = behind ? m2 : m1;
    Vec bend;
    if (at >= shape.plateau)
      bend = knot + (end - knot) * ((at - shape.plateau) / (1 - shape.plateau));
    else
      bend = (m1 + m2) * 0.5 + (knot - (m1 + m2) * 0.5) * (at / shape.plateau);
    bend.add(profile.bend[k] / l, kink);
    bend.add(behind ? profile.turn[k] : -profile.turn[k], jump);
    return bend;
  };
  out.count = 2 * profile.last;
  Vec q = q0, t = t0, bend = bend_at(profile.last, false);
  for (std::size_t i = 0; i < out.count; ++i) {
    const bool behind = i >= profile.last;
    const std::size_t from = behind ? i - profile.last : profile.last - i;
    const std::size_t to = behind ? from + 1 : from - 1;
    const Vec next = bend_at(to, behind);
    Piece& p = out.piece[i];
    p = Piece{};
    p.length = std::abs(profile.at[to] - profile.at[from]) * l;
    p.a = q;
    p.b = t;
    p.c = bend;
    p.d = (next - bend) * (1.0 / p.length);
    q = p.point(p.length);
    t = p.first(p.length);
    bend = next;
  }
}

bool outside(const Vec& q, const JunctionSettings& settings) noexcept {
  for (std::size_t i = 0; i < kAxes; ++i)
    if (q[i] > settings.high[i] || q[i] < settings.low[i]) return true;
  return false;
}

double worst_share(const Blend& blend, const Piece& a, const Piece& b, double l, int samples,
                   const JunctionSettings& settings) noexcept {
  const double middle = half_over(settings);
  double worst = 0, u = -l - middle;
  const auto look = [&](const Piece& p, double s) {
    const double at = u + s;
    const Vec programmed = at < -middle  ? a.point(a.length + at + middle)
                           : at < middle ? settings.over->point(at + middle)
                                         : b.point(at - middle);
    const Vec q = p.point(s);
    worst = std::max(worst, settings.tolerance.share(q - programmed));
    return !outside(q, settings);
  };
  for (const Piece& p : blend) {
    for (int i = 1; i <= samples; ++i)
      if (!look(p, p.length * i / samples)) return kOutside;
    // Where the move begins and ends that it goes over, the deviation has a corner.
    for (const double vertex : {-middle, middle})
      if (vertex > u && vertex < u + p.length && !look(p, vertex - u)) return kOutside;
    u += p.length;
  }
  return worst;
}

void set_feeds(Blend& blend, const Piece& a, const Piece& b) noexcept {
  for (std::size_t i = 0; i < blend.count; ++i)
    blend.piece[i].feed = i < blend.count / 2 ? a.feed : b.feed;
}

/// Seconds from `reach` before the vertex to `reach` behind it, coming and going as fast as may be.
double passing_time(const Piece& a, const Piece& b, const Blend& blend, double l, double reach,
                    const AxisLimits& limits) noexcept {
  constexpr std::size_t kMost = kMostBlendPieces * kPerPiece + 2 * kPerSide;
  struct Stretch {
    const Piece* piece{nullptr};
    double from{0}, to{0};
  };
  std::array<Stretch, kMost> at;
  std::array<double, kMost + 1> x;
  x.fill(kNoLimit);
  std::size_t n = 0;
  const auto add = [&](const Piece& p, double from, double to, std::size_t parts) {
    if (!(to - from > 1e-9)) return;
    const double step = (to - from) / static_cast<double>(parts);
    for (std::size_t i = 0; i < parts; ++i, ++n) {
      at[n].piece = &p;
      at[n].from = from + step * static_cast<double>(i);
      at[n].to = at[n].from + step;
      const double cap =
          std::min(axis_cap(p, at[n].from, at[n].to, limits), feed_cap(p, at[n].from, at[n].to));
      x[n] = std::min(x[n], cap);
      x[n + 1] = cap;
    }
  };
  add(a, a.length - reach, a.length - l, kPerSide);
  for (const Piece& p : blend) add(p, 0, p.length, kPerPiece);
  add(b, l, reach, kPerSide);
  Rows rows;
  const auto rows_at = [&](std::size_t i) {
    rows_of(*at[i].piece, at[i].from, at[i].to, limits, rows);
    return rows.all();
  };
  for (std::size_t i = n; i-- > 0;) x[i] = std::min(x[i], largest_x0(rows_at(i), x[i + 1]));
  double seconds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    x[i + 1] = std::clamp(range_of_x1(rows_at(i), x[i]).high, 0.0, x[i + 1]);
    seconds += 2 * (at[i].to - at[i].from) / (std::sqrt(x[i]) + std::sqrt(x[i + 1]) + 1e-9);
  }
  return seconds;
}

/// From l on, `step` nearer in each round.
double widest_blend(const Piece& a, const Piece& b, const Shape& shape, double l, double step,
                    const JunctionSettings& settings, Blend& out) noexcept {
  // With nothing of its neighbours it could not go over a move.
  const double least = std::max(1e-9, kLeastOver * half_over(settings));
  for (int round = 0; round < kMaxRounds && l > least; ++round, l *= step) {
    make_blend(a, b, l, shape, settings, out);
    double share = worst_share(out, a, b, l, 1, settings);
    if (share <= kAim) share = worst_share(out, a, b, l, kSamples, settings);
    if (share <= kAim) {
      set_feeds(out, a, b);
      return l;
    }
    // The deviation grows with l to l^2: the root is never too far.
    if (share > 2) l *= std::max(0.3, std::sqrt(1.0 / share)) / step;
  }
  return 0;
}

JunctionNeeds needs_of(const Piece& a, const Piece& b, double reach,
                       const JunctionSettings& settings) noexcept {
  const AxisLimits& limits = settings.limits;
  const Vec kink = b.first(0) - a.first(a.length), before = a.second(a.length),
            behind = b.second(0), jump = behind - before;
  const auto share = [](const Vec& v, const Vec& limit) {
    double most = 0;
    for (std::size_t i = 0; i < kAxes; ++i) most = std::max(most, std::abs(v[i]) / limit[i]);
    return most;
  };
  JunctionNeeds needs;
  needs.kink_off = settings.tolerance.share(kink) / kAim;
  needs.jump_off = settings.tolerance.share(jump) / kAim;
  needs.kink_acc = share(kink, limits.acc);
  needs.jump_acc = share(jump, limits.acc);
  needs.bend_acc = share((before + behind) * 0.5, limits.acc);
  needs.kink_jerk = share(kink, limits.jerk);
  needs.jump_jerk = share(jump, limits.jerk);
  needs.reach = reach;
  return needs;
}

}  // namespace

double blend_junction(const Piece& a, const Piece& b, const JunctionSettings& settings,
                      Buffer<Piece>& out) noexcept {
  // Without jerk limits the time that it takes to come, pass and go counts, with them the speed (boxes are passed evenly).
  const double reach = std::min(settings.reach_a, settings.reach_b);
  const auto cost = [&](const Blend& blend, double l) {
    return settings.limits.jerks
               ? -even_speed(blend.begin(), blend.count, settings.limits, settings.by_law)
               : passing_time(a, b, blend, l, reach, settings.limits);
  };
  Blend best;
  double l = widest_blend(a, b, kEven, reach, kShrinkStep, settings, best);
  double least = l > 0 ? cost(best, l) : kNoLimit;
  const auto compare = [&](const Shape& shape, double from, double step = kShrinkStep) {
    Blend blend;
    const double taken = widest_blend(a, b, shape, from, step, settings, blend);
    if (!(taken > 0)) return;
    const double found = cost(blend, taken);
    if (found >= least) return;
    least = found;
    best = blend;
    l = taken;
  };
  for (const Shape& shape : kShapes) compare(shape, reach);
  const double turn = settings.tolerance.share(b.first(0) - a.first(a.length));
  // Straight legs stay where they are programmed, as between two lines.
  const bool curved = !a.straight() && !b.straight();
  if (!settings.limits.jerks && curved && reach * turn > kCoreRoom)
    for (const Shape& shape : kCoreShapes) compare(shape, reach);
  if (settings.limits.jerks && settings.over == nullptr && (curved || turn * reach < kTangent)) {
    const JunctionChoice choice = choose_junction_shape(needs_of(a, b, reach, settings));
    compare({kEven.plateau, 0, 0, &choice.shape}, std::min(reach, kFirstReach * choice.l),
            kFineStep);
  }
  if (l > 0)
    for (const Piece& p : best) out.push_back(p);
  return l;
}

}  // namespace kerf::motion::path
