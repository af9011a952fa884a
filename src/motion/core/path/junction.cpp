#include "motion/core/path/junction.hpp"

#include <algorithm>
#include <array>

namespace kerf::motion::path {
namespace {

constexpr double kShrinkStep = 0.9;
/// Half-width of the middle span as a share of the whole: nearly the least acceleration that a blend can have.
constexpr double kPlateau = 0.5;
constexpr int kMaxRounds = 150;
constexpr int kSamples = 6;  ///< of the deviation, in each of the four pieces
/// Between samples the deviation may be larger by this share (a cubic against an arc, eight samples a side).
constexpr double kAim = 0.98;
constexpr double kOutside = 1.5;  ///< a share that only makes the blend smaller

/// The pieces for half-width l, from u = -l to +l.
std::array<Piece, 4> three_spans(const Piece& a, const Piece& b, double l) noexcept {
  const double sa = a.length - l;
  const Vec q0 = a.point(sa), t0 = a.first(sa), c0 = a.second(sa);
  const Vec q1 = b.point(l), t1 = b.first(l), c1 = b.second(l);
  const double s1 = (1.0 - kPlateau) * l, s2 = 2.0 * kPlateau * l;
  // q'' is c0, m1, m2, c1 at the knots and linear between them. Unknown m1, m2 from
  //   area:   integral of q'' = t1 - t0
  //   moment: integral of (l - u) q'' = q1 - q0 - 2 l t0
  const double area0 = s1 / 2, area1 = (s1 + s2) / 2;
  const double w0 = 2 * l, w1 = 2 * l - s1, w2 = s1;  // l - u at the knots; the last is 0
  const double mom0 = s1 / 6 * (2 * w0 + w1);
  const double mom1 = s1 / 6 * (w0 + 2 * w1) + s2 / 6 * (2 * w1 + w2);
  const double mom2 = s2 / 6 * (w1 + 2 * w2) + s1 / 6 * (2 * w2);
  const double mom3 = s1 / 6 * w2;
  const double det = area1 * (mom2 - mom1);
  Vec m1, m2;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double area = t1[i] - t0[i] - area0 * (c0[i] + c1[i]);
    const double moment = q1[i] - q0[i] - 2 * l * t0[i] - mom0 * c0[i] - mom3 * c1[i];
    m1[i] = (area * mom2 - moment * area1) / det;
    m2[i] = (moment * area1 - area * mom1) / det;
  }
  std::array<Piece, 4> out;
  const auto span = [](const Vec& q, const Vec& t, const Vec& c, const Vec& next, double length) {
    Piece p;
    p.length = length;
    p.a = q;
    p.b = t;
    p.c = c;
    p.d = (next - c) * (1.0 / length);
    return p;
  };
  out[0] = span(q0, t0, c0, m1, s1);
  const Piece middle = span(out[0].point(s1), out[0].first(s1), m1, m2, s2);
  out[1] = part_of(middle, 0, s2 / 2);
  out[2] = part_of(middle, s2 / 2, s2);
  out[3] = span(middle.point(s2), middle.first(s2), m2, c1, s1);
  return out;
}

bool outside(const Vec& q, const JunctionSettings& settings) noexcept {
  for (std::size_t i = 0; i < kAxes; ++i)
    if (q[i] > settings.high[i] || q[i] < settings.low[i]) return true;
  return false;
}

double worst_share(const std::array<Piece, 4>& blend, const Piece& a, const Piece& b, double l,
                   const JunctionSettings& settings) noexcept {
  double worst = 0, u = -l;
  for (const Piece& p : blend) {
    for (int i = 1; i <= kSamples; ++i) {
      const double s = p.length * i / kSamples, at = u + s;
      const Vec programmed = at < 0 ? a.point(a.length + at) : b.point(at);
      const Vec q = p.point(s);
      worst = std::max(worst, settings.tolerance.share(q - programmed));
      if (outside(q, settings)) return kOutside;
    }
    u += p.length;
  }
  return worst;
}

}  // namespace

double blend_junction(const Piece& a, const Piece& b, const JunctionSettings& settings,
                      Buffer<Piece>& out) noexcept {
  double l = std::min(settings.reach_a, settings.reach_b);
  for (int round = 0; round < kMaxRounds && l > 1e-9; ++round, l *= kShrinkStep) {
    auto blend = three_spans(a, b, l);
    const double share = worst_share(blend, a, b, l, settings);
    if (share > kAim) {
      // The deviation grows with l to l^2: the root is never too far.
      if (share > 2) l *= std::max(0.3, std::sqrt(1.0 / share)) / kShrinkStep;
      continue;
    }
    for (std::size_t i = 0; i < blend.size(); ++i) {
      blend[i].feed = i < 2 ? a.feed : b.feed;
      out.push_back(blend[i]);
    }
    return l;
  }
  return 0;
}

}  // namespace kerf::motion::path
