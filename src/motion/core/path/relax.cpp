#include "motion/core/path/relax.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

/// Straights that are longer, in tolerances, stay where they are programmed: what they win is not worth that they bend.
constexpr double kLongStraight = 30;
/// Pieces are divided into parts as long as so many tolerances, and no shorter than what is driven in this time (s).
constexpr double kPart = 2, kPartTime = 5e-4;
constexpr std::size_t kMostParts = 4;
/// The speed that is expected is evened out over this way (sigma); it is no more than twice what the piece itself lets expect.
constexpr double kEven = 0.5, kOwn = 0.5;
/// Of the tolerance: what is used where the curve has not used more.
constexpr double kAim = 0.985;
/// Of the way to what may be used more where it has.
constexpr double kMore = 0.1;
/// The barrier begins at this share of what is made least, over the number of coefficients, and falls in each step that goes this far.
constexpr double kBarrier = 0.1, kFall = 0.25, kFarEnough = 0.3;
/// A step goes so far towards the next coefficient's bound.
constexpr double kTowards = 0.9;
constexpr int kSteps = 9;
constexpr std::size_t kLeastStretches = 6;
constexpr double kNothing = 1e-9;
/// Of a stretch: where Gauss's rule of two looks.
constexpr std::array<double, 2> kLooks = {0.2113248654051871, 0.7886751345948129};

template <std::size_t N>
void add(std::array<double, N>& to, double k, const std::array<double, N>& v) noexcept {
  for (std::size_t i = 0; i < N; ++i) to[i] += k * v[i];
}

using Place = std::array<double, 3>;
using Block = std::array<double, 9>;

/// out -= a b'
void take_product(Block& out, const Block& a, const Block& b) noexcept {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out[3 * i + j] -=
          a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] + a[3 * i + 2] * b[3 * j + 2];
}

/// a b, b symmetric
Block product(const Block& a, const Block& b) noexcept {
  Block out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out[3 * i + j] =
          a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] + a[3 * i + 2] * b[3 * j + 2];
  return out;
}

/// to -= a v
void take(Place& to, const Block& a, const Place& v) noexcept {
  for (std::size_t i = 0; i < 3; ++i)
    to[i] -= a[3 * i] * v[0] + a[3 * i + 1] * v[1] + a[3 * i + 2] * v[2];
}

/// to -= a' v
void take_turned(Place& to, const Block& a, const Place& v) noexcept {
  for (std::size_t i = 0; i < 3; ++i) to[i] -= a[i] * v[0] + a[3 + i] * v[1] + a[6 + i] * v[2];
}

/// Of a symmetric matrix, by its factors L D L'. False: it is not positive.
bool invert(const Block& a, Block& out) noexcept {
  const double d0 = a[0];
  if (!(d0 > 0)) return false;
  const double l1 = a[3] / d0, l2 = a[6] / d0, d1 = a[4] - l1 * a[3];
  if (!(d1 > 0)) return false;
  const double m = (a[7] - l2 * a[3]) / d1, d2 = a[8] - l2 * a[6] - m * m * d1;
  if (!(d2 > 0)) return false;
  // Columns of L^-1: (1, -l1, l1 m - l2), (0, 1, -m), (0, 0, 1).
  const double e0 = 1 / d0, e1 = 1 / d1, e2 = 1 / d2, k = l1 * m - l2;
  out = {e0 + l1 * l1 * e1 + k * k * e2,
         -l1 * e1 - k * m * e2,
         k * e2,
         -l1 * e1 - k * m * e2,
         e1 + m * m * e2,
         -m * e2,
         k * e2,
         -m * e2,
         e2};
  return true;
}

}  // namespace

std::array<double, 3> Relaxer::Hat::place(std::size_t r, double s) const noexcept {
  const std::array<double, 3> a = r == 0 ? std::array<double, 3>{} : at[r - 1];
  const double t = third[r];
  return {a[0] + s * (a[1] + s * (a[2] / 2 + s * t / 6)), a[1] + s * (a[2] + s * t / 2),
          a[2] + s * t};
}

bool Relaxer::create(Memory& memory, std::size_t lines) noexcept {
  // Dense lines have three each; where corners of short legs have more, the curve stays as it is.
  const std::size_t pieces = 5 * lines + 64;
  return made_.create(memory, pieces) && were_.create(memory, pieces) &&
         knot_.create(memory, pieces + 1) && slow_.create(memory, pieces) &&
         hat_.create(memory, pieces) && site_.create(memory, 3 * (pieces + lines)) &&
         move_.create(memory, pieces) && step_.create(memory, pieces) &&
         slope_.create(memory, pieces) && band_.create(memory, kOrder * pieces) &&
         inverse_.create(memory, pieces);
}

bool Relaxer::relax(const Chain& chain, const SmoothingSettings& settings, const AxisLimits& limits,
                    const Buffer<Piece>& out, std::size_t first) noexcept {
  tolerance_ = settings.tolerance;
  fastest_ = 0;
  for (std::size_t i = 0; i < kMoved; ++i) {
    by_jerk_[i] = limits.jerk[i] > 0 ? 1 / (limits.jerk[i] * limits.jerk[i]) : 0;
    by_acc_[i] = limits.acc[i] > 0 ? 1 / (limits.acc[i] * limits.acc[i]) : 0;
    fastest_ = std::max(fastest_, limits.vel[i]);
  }
  fastest_ = std::min(fastest_, limits.path_vel);
  if (!may_move(chain, settings, out, first)) return false;
  divide(out, first);
  if (made_.full()) return false;
  bool any = false;
  for (std::size_t from = 0; from < made_.size();) {
    std::size_t to = from;
    while (to < made_.size() && !stays(made_[to])) ++to;
    if (to >= from + kLeastStretches && relax_part(chain, from, to)) any = true;
    from = to + 1;
  }
  return any;
}

/// Whether there is a tolerance, and room for it within the soft limits; threads stay as they are.
bool Relaxer::may_move(const Chain& chain, const SmoothingSettings& settings,
                       const Buffer<Piece>& out, std::size_t first) const noexcept {
  if (!(tolerance_.mm > 0 && fastest_ > 0)) return false;
  if (!std::all_of(by_jerk_.begin(), by_jerk_.end(), [](double by) { return by > 0; }))
    return false;
  // What does not bend is not moved.
  Vec bends;
  for (std::size_t p = first; p < out.size(); ++p)
    for (std::size_t i = 0; i < kMoved; ++i)
      bends[i] = std::max({bends[i], std::abs(out[p].c[i]), std::abs(out[p].d[i])});
  return room_outside(chain, settings, bends) &&
         std::none_of(chain.feed.begin(), chain.feed.end(), [](const Feed& f) { return f.sync; });
}

bool Relaxer::stays(const Piece& piece) const noexcept {
  return piece.straight() && piece.length > kLongStraight * tolerance_.mm;
}

/// Seconds for a unit of sigma, by jerk, acceleration and feed of the piece alone.
double Relaxer::slowness(const Piece& piece) const noexcept {
  double jerk = 0, acc = 0;
  const Vec end = piece.second(piece.length);
  for (std::size_t i = 0; i < kMoved; ++i) {
    jerk += by_jerk_[i] * piece.d[i] * piece.d[i];
    acc += by_acc_[i] * (piece.c[i] * piece.c[i] + end[i] * end[i]) / 2;
  }
  return std::max({1 / std::min(piece.feed.speed, fastest_), std::cbrt(std::sqrt(jerk)),
                   std::sqrt(std::sqrt(acc))});
}

void Relaxer::divide(const Buffer<Piece>& out, std::size_t first) noexcept {
  made_.clear();
  knot_.clear();
  double sigma = 0;
  for (std::size_t p = first; p < out.size(); ++p) {
    const Piece& piece = out[p];
    const double shortest = std::max(kPart * tolerance_.mm, kPartTime / slowness(piece));
    const double parts =
        stays(piece) ? 1.0
                     : std::clamp(std::ceil(piece.length / shortest), 1.0, double{kMostParts});
    const double length = piece.length / parts;
    for (double k = 0; k < parts; ++k) {
      made_.push_back(parts > 1 ? part_of(piece, k * length, (k + 1) * length) : piece);
      knot_.push_back(sigma + k * length);
    }
    sigma += piece.length;
  }
  knot_.push_back(sigma);
}

bool Relaxer::relax_part(const Chain& chain, std::size_t from, std::size_t to) noexcept {
  splines_ = to - from - (kOrder - 1);
  expect_speeds(from, to);
  make_hats(from);
  find_sites(chain, from, to);
  if (site_.empty() || site_.full()) return false;
  were_.clear();
  for (std::size_t p = from; p < to; ++p) were_.push_back(made_[p]);
  solve(from);
  apply(from);
  if (within(chain, from, to)) return true;
  std::copy(were_.begin(), were_.end(), made_.begin() + from);
  return false;
}

void Relaxer::expect_speeds(std::size_t from, std::size_t to) noexcept {
  slow_.clear();
  for (std::size_t p = from; p < to; ++p) slow_.push_back(slowness(made_[p]));
  // Forwards, then backwards.
  const auto even = [&](double level, std::size_t k) {
    level += (slow_[k] - level) * std::min(1.0, made_[from + k].length / kEven);
    slow_[k] = std::max(level, kOwn * slow_[k]);
    return level;
  };
  double level = slow_.front();
  for (std::size_t k = 0; k < slow_.size(); ++k) level = even(level, k);
  level = slow_.back();
  for (std::size_t k = slow_.size(); k-- > 0;) level = even(level, k);
}

/// B = (t4 - t0) sum of (t_k - s)_+^3 / w'(t_k), w the product of (s - t_k): de Boor's normalised spline as a divided difference.
void Relaxer::make_hats(std::size_t from) noexcept {
  hat_.clear();
  for (std::size_t j = 0; j < splines_; ++j) {
    const double* t = knot_.begin() + from + j;
    Hat hat;
    std::array<double, 3> at{};
    double sum = 0;  // from the left: all of them add up to 0
    for (std::size_t r = 0; r < kOrder; ++r) {
      double product = 1;
      for (std::size_t l = 0; l <= kOrder; ++l)
        if (l != r) product *= t[r] - t[l];
      sum += 1 / product;
      hat.third[r] = 6 * (t[kOrder] - t[0]) * sum;
      if (r + 1 == kOrder) break;
      if (r > 0) hat.at[r - 1] = at;
      at = hat.place(r, t[r + 1] - t[r]);
      hat.at[r] = at;
    }
    hat_.push_back(hat);
  }
}

template <class F>
void Relaxer::each_along(const Chain& chain, std::size_t from, std::size_t to,
                         F&& f) const noexcept {
  std::size_t line = 0;
  for (std::size_t p = from; p < to; ++p) {
    const double end = knot_[p + 1];
    for (double at = knot_[p]; at < end;) {
      while (line + 1 < chain.lines() && chain.sigma[line + 1] <= at) ++line;
      double next = line + 1 < chain.lines() ? std::min(end, chain.sigma[line + 1]) : end;
      if (!(next > at)) next = end;
      f(p, line, at, next);
      at = next;
    }
  }
}

void Relaxer::find_sites(const Chain& chain, std::size_t from, std::size_t to) noexcept {
  site_.clear();
  each_along(chain, from, to, [&](std::size_t p, std::size_t line, double begin, double end) {
    const double third = (end - begin) / 3, keeps = chain.keeps(line);
    const bool vertex = line + 1 < chain.lines() && end == chain.sigma[line + 1];
    const Apart apart = apart_on(chain, line, made_[p], knot_[p], begin, end);
    add_site(p - from, begin - knot_[p], third, apart.off[1], keeps);
    add_site(p - from, end - knot_[p], -third, apart.off[2], keeps);
    add_site(p - from, end - knot_[p], 0, apart.off[3], vertex ? chain.keeps_at(line + 1) : keeps);
  });
}

/// The coefficient that is reached from the curve by going `ahead` along its tangent, s behind the beginning of a stretch.
void Relaxer::add_site(std::size_t stretch, double s, double ahead, const Vec& off,
                       double keeps) noexcept {
  Site site;
  site.stretch = stretch;
  bool any = false;
  each_on(stretch, [&](std::size_t j, std::size_t r) {
    const std::array<double, 3> place = hat_[j].place(r, s);
    site.by[r] = place[0] + ahead * place[1];
    any = any || std::abs(site.by[r]) > kNothing;
  });
  if (!any) return;
  for (std::size_t i = 0; i < kMoved; ++i) site.off[i] = off[i];
  const double far = norm3(off, 0), p = tolerance_.mm * keeps;
  site.most = std::max(kAim * p, far + kMore * std::max(p - far, 0.0) + kNothing * p);
  site_.push_back(site);
}

void Relaxer::solve(std::size_t from) noexcept {
  double ask = 0;
  for (std::size_t k = 0; k < splines_ + kOrder - 1; ++k) {
    const Vec third = made_[from + k].d;
    const double v = 1 / slow_[k];
    for (std::size_t i = 0; i < kMoved; ++i)
      ask += by_jerk_[i] * third[i] * third[i] * made_[from + k].length * (v * v) * (v * v) * v / 2;
  }
  double mu = kBarrier * ask / static_cast<double>(site_.size());
  move_.assign(splines_, Place{});
  step_.assign(splines_, Place{});
  for (int n = 0; n < kSteps && mu > 0; ++n) {
    band_.assign(kOrder * splines_, Block{});
    slope_.assign(splines_, Place{});
    add_bends(from);
    add_barrier(mu);
    if (!find_step()) return;
    const double far = reach_of_step();
    for (std::size_t j = 0; j < splines_; ++j) add(move_[j], far, step_[j]);
    for (Site& site : site_) add(site.off, far, site.step);
    if (far > kFarEnough) mu *= kFall;
  }
}

/// Slope and curvature of the integral.
void Relaxer::add_bends(std::size_t from) noexcept {
  for (std::size_t k = 0; k < splines_ + kOrder - 1; ++k) {
    const Piece& piece = made_[from + k];
    const double length = piece.length, v = 1 / slow_[k], for_acc = length * v * v * v,
                 for_jerk = for_acc * v * v;
    // Of the jerk, and of the acceleration at two places: what it is, and by the splines there.
    const auto add_look = [&](const Place& share, const Place& now,
                              const std::array<double, kOrder>& by) {
      each_on(k, [&](std::size_t j, std::size_t r) {
        for (std::size_t i = 0; i < kMoved; ++i) slope_[j][i] += share[i] * by[r] * now[i];
        for (std::size_t q = r; q < kOrder && q <= k; ++q)
          for (std::size_t i = 0; i < kMoved; ++i)
            block(j, q - r)[(kMoved + 1) * i] += share[i] * by[r] * by[q];
      });
    };
    const auto look = [&](const Place& limit, double weight, Place now, auto&& of) {
      std::array<double, kOrder> by{};
      each_on(k, [&](std::size_t j, std::size_t r) {
        by[r] = of(hat_[j], r);
        add(now, by[r], move_[j]);
      });
      Place share{};
      add(share, weight, limit);
      add_look(share, now, by);
    };
    look(by_jerk_, for_jerk, {piece.d[0], piece.d[1], piece.d[2]},
         [](const Hat& hat, std::size_t r) { return hat.third[r]; });
    for (const double part : kLooks) {
      const double s = part * length;
      const Vec second = piece.second(s);
      look(by_acc_, for_acc / 2, {second[0], second[1], second[2]},
           [&](const Hat& hat, std::size_t r) { return hat.place(r, s)[2]; });
    }
  }
}

/// The same of -mu log(most^2 - |off|^2).
void Relaxer::add_barrier(double mu) noexcept {
  for (const Site& site : site_) {
    double left = site.most * site.most;
    for (const double x : site.off) left -= x * x;
    const double c = 2 * mu / left, e = 2 * c / left;
    Block bend{};
    for (std::size_t i = 0; i < kMoved; ++i)
      for (std::size_t o = 0; o < kMoved; ++o)
        bend[kMoved * i + o] = e * site.off[i] * site.off[o] + (i == o ? c : 0.0);
    each_on(site.stretch, [&](std::size_t j, std::size_t r) {
      add(slope_[j], c * site.by[r], site.off);
      for (std::size_t q = r; q < kOrder && q <= site.stretch; ++q)
        add(block(j, q - r), site.by[r] * site.by[q], bend);
    });
  }
}

/// Newton's step: the band's factors L D L', by blocks, in its place. False: it is not positive.
bool Relaxer::find_step() noexcept {
  inverse_.assign(splines_, Block{});
  for (std::size_t j = 0; j < splines_; ++j) {
    const std::size_t before = std::min(j, kOrder - 1);
    for (std::size_t o = before; o > 0; --o) {
      // Times D yet: that is taken out when the row is done.
      const std::size_t k = j - o;
      for (std::size_t m = before; m > o; --m)
        if (m - o < kOrder) take_product(block(j, o), block(j, m), block(k, m - o));
    }
    for (std::size_t o = before; o > 0; --o) {
      const Block factor = product(block(j, o), inverse_[j - o]);
      take_product(block(j, 0), block(j, o), factor);
      block(j, o) = factor;
    }
    if (!invert(block(j, 0), inverse_[j])) return false;
    step_[j] = {-slope_[j][0], -slope_[j][1], -slope_[j][2]};
    for (std::size_t o = 1; o <= before; ++o) take(step_[j], block(j, o), step_[j - o]);
  }
  for (std::size_t j = 0; j < splines_; ++j) {
    Place scaled{};
    for (std::size_t i = 0; i < kMoved; ++i)
      for (std::size_t o = 0; o < kMoved; ++o)
        scaled[i] += inverse_[j][kMoved * i + o] * step_[j][o];
    step_[j] = scaled;
  }
  for (std::size_t j = splines_; j-- > 0;)
    for (std::size_t o = 1; o <= std::min(j, kOrder - 1); ++o)
      take_turned(step_[j - o], block(j, o), step_[j]);
  return true;
}

/// How much of the step keeps all coefficients within their bounds, at most 1; makes their own steps.
double Relaxer::reach_of_step() noexcept {
  double far = 1;
  for (Site& site : site_) {
    site.step = {};
    each_on(site.stretch,
            [&](std::size_t j, std::size_t r) { add(site.step, site.by[r], step_[j]); });
    // |off + f step| = most
    double a = 0, b = 0, c = -site.most * site.most;
    for (std::size_t i = 0; i < kMoved; ++i) {
      a += site.step[i] * site.step[i];
      b += site.step[i] * site.off[i];
      c += site.off[i] * site.off[i];
    }
    if (!(a > 0)) continue;
    far = std::min(far, kTowards * (std::sqrt(std::max(b * b - a * c, 0.0)) - b) / a);
  }
  return far;
}

void Relaxer::apply(std::size_t from) noexcept {
  for (std::size_t k = 0; k < splines_ + kOrder - 1; ++k) {
    Piece& piece = made_[from + k];
    each_on(k, [&](std::size_t j, std::size_t r) {
      const std::array<double, 3> at = hat_[j].place(r, 0);
      for (std::size_t i = 0; i < kMoved; ++i) {
        piece.a[i] += move_[j][i] * at[0];
        piece.b[i] += move_[j][i] * at[1];
        piece.c[i] += move_[j][i] * at[2];
        piece.d[i] += move_[j][i] * hat_[j].third[r];
      }
    });
  }
}

/// Whether what has been made keeps the tolerance, or is no farther off than it was.
bool Relaxer::within(const Chain& chain, std::size_t from, std::size_t to) const noexcept {
  bool all = true;
  each_along(chain, from, to, [&](std::size_t p, std::size_t line, double begin, double end) {
    const auto share_of = [&](const Piece& piece) {
      return apart_on(chain, line, piece, knot_[p], begin, end).share(tolerance_);
    };
    const double share = share_of(made_[p]);
    // Not where it is no number.
    all = all && (share <= chain.keeps(line) || share <= share_of(were_[p - from]));
  });
  return all;
}

}  // namespace kerf::motion::path
