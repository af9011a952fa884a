#include "motion/core/path/time_law_newton.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

constexpr double kToBound = 0.97;
/// m may fall by this share of itself in one step.
constexpr double kMostFall = 0.7;
/// What is aimed at, so that x does not end up above the wish while the barrier still gives way.
constexpr double kUnderWish = 0.999;
/// Breaking a wish costs this many times what it is worth by itself: being faster there lets its surroundings be faster too.
constexpr double kPrice = 4;
/// A law that breaks wishes by more than this (of x) where it need not is gone on with at so many times their price, so often. A high price from the
/// start would do too, but then one law of twelve from moving states is not found.
constexpr double kBroken = 1.03, kDearer = 6;
constexpr int kMostDearer = 2;
/// First slack of a limit that does not hold, relative to the limit.
constexpr double kFirstSlack = 0.3;
constexpr double kLeastMultiplier = 1e-30;
/// A wish that is far below is neared by this factor in one iteration.
constexpr double kSink = 0.5;
constexpr double kStalled = 1e-6;
/// Where a result is wanted soon it is given up when so many steps have left more than that share of what breaks the limits most: a quarter of
/// the work for stops went into laws that were not found, and 2 of 1000 that were would have been given up.
constexpr int kPatience = 4;
constexpr double kHardlyLess = 0.9;
/// Weights of the barrier (relative to the time) down to which a law goes before it begins to brake for wishes, and with which it begins.
constexpr double kRough = 0.1, kRecentre = 1;

/// What is lost counts against this much of the time at most (s): a law that takes minutes, at a feed near 0, must not lose seconds at its start.
/// Rounding may not let it come so near; then so many more steps have to do.
constexpr double kFarthest = 1;
constexpr int kMore = 6;
/// Rows are left out that come to less than this share of their limit at so many times the speed (squared) that is even there, and so many times the
/// acceleration and the jerk of a straight.
constexpr double kReached = 0.95, kLikely = 2, kLikelyAcc = 1.2, kLikelyJerk = 4;

// Of one number, or of each of two.
template <class V>
V larger(V a, V b) noexcept {
  return a > b ? a : b;
}
template <class V>
V smaller(V a, V b) noexcept {
  return a < b ? a : b;
}
template <class V>
V load(const Buffer<double>& from, std::size_t i) noexcept {
  V out;
  __builtin_memcpy(&out, from.begin() + i, sizeof out);
  return out;
}
template <class V>
void store(Buffer<double>& to, std::size_t i, V value) noexcept {
  __builtin_memcpy(to.begin() + i, &value, sizeof value);
}
/// The same number for each.
template <class V>
V each(double x) noexcept {
  return V{} + x;
}

}  // namespace

/// Of breaking a wish: as the time's own slope where x is, so that it outweighs it everywhere and drowns it nowhere.
double LawNewton::price_of(const Bound& wish, double x) noexcept {
  const double at = std::max(wish.top, x);
  return kPrice * wish.worth / (2 * at * std::sqrt(at));
}

LawNewton::JerkSide::JerkSide(const double b[3], double share) noexcept {
  const double over = 4 / (b[0] + 2 * b[1] + b[2]), k1 = share * std::sqrt(over), k3 = k1 * over;
  for (int k = 0; k < 3; ++k) {
    right[k] = 1.5 * k1 - 0.5 * b[k] * k3;
    const double middle = 0.75 * k3 * (b[k] * over - 1);
    slope[k][0] = middle * 0.25;
    slope[k][1] = middle * 0.5;
    slope[k][2] = middle * 0.25;
    slope[k][k] -= 0.5 * k3;
  }
}

bool LawNewton::create(Memory& memory, std::size_t intervals,
                       std::size_t rows_per_interval) noexcept {
  const std::size_t rows = intervals * rows_per_interval, n = intervals + 1;
  for (Buffer<double>* b : {&m_, &dm_, &node_, &left_, &right_, &d0_, &d1_, &d2_, &by_mu_, &kept_})
    if (!b->create(memory, n)) return false;
  // A limit and a wish each.
  for (Buffer<Bound>* b : {&at_middle_, &at_node_})
    if (!b->create(memory, 2 * n)) return false;
  for (Side* side : {&up_, &down_})
    for (Buffer<double>* b : {&side->s, &side->z, &side->ds, &side->dz, &side->over, &side->room})
      if (!b->create(memory, rows)) return false;
  for (Buffer<double>* b : {&a0_, &a1_, &a2_})
    if (!b->create(memory, rows)) return false;
  return side_.create(memory, n) && part_.create(memory, n);
}

void LawNewton::take_row(std::size_t r) noexcept {
  a0_.push_back(rows_->a0[r]);
  a1_.push_back(rows_->a1[r]);
  a2_.push_back(rows_->a2[r]);
}

/// With the largest speed that is likely on an interval, and the acceleration and the jerk of a straight there, a row comes to
///   |a0 + a1 + a2| x + |a1 + 2 a2| D u           of 1 where it is one of acceleration,
///   (that + |a2| D^2 w) sqrt(x)                  where it is one of jerk.
void LawNewton::take_rows(bool all) noexcept {
  const LawRows& rows = *rows_;
  for (Buffer<double>* b : {&a0_, &a1_, &a2_}) b->clear();
  for (std::size_t i = 0; i < n_; ++i) {
    const LawInterval& in = rows[i];
    Part& part = part_[i];
    part = {a0_.size(), static_cast<std::size_t>(in.accs), static_cast<std::size_t>(in.jerks)};
    std::size_t r = in.row;
    if (all || i == 0) {
      for (const std::size_t end = r + part.accs + 3 * part.jerks; r < end; ++r) take_row(r);
      continue;
    }
    double acc = 0, jerk = 0;
    rows.most_on(i, acc, jerk);
    const double x = std::min({in.cap, std::max(in.wish, x0_), kLikely * rows.even_cap(i)}),
                 v = std::sqrt(x), u = kLikelyAcc * acc * in.length,
                 w = kLikelyJerk * jerk * in.length * in.length;
    const auto by_x = [&](std::size_t k) {
      return std::abs(rows.a0[k] + rows.a1[k] + rows.a2[k]) * x +
             std::abs(rows.a1[k] + 2 * rows.a2[k]) * u;
    };
    for (const std::size_t end = r + part.accs; r < end; ++r) {
      if (by_x(r) > kReached)
        take_row(r);
      else
        --part.accs;
    }
    const std::size_t jerks = part.jerks;
    bool taken[LawRows::kMostJerks]{};
    for (std::size_t j = 0; j < jerks; ++j) {
      for (std::size_t k = r + j; k < r + 3 * jerks; k += jerks)
        taken[j] = taken[j] || by_x(k) * v + std::abs(rows.a2[k]) * w > kReached;
      if (!taken[j]) --part.jerks;
    }
    for (int k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < jerks; ++j, ++r)
        if (taken[j]) take_row(r);
  }
}

void LawNewton::begin(const LawRows& rows, double x0, double u0, bool patient, bool all) noexcept {
  rows_ = &rows;
  n_ = rows.size();
  first_ = 1;
  last_ = n_ - 1;
  x0_ = x0;
  rests_ = x0 <= 0;
  for (Buffer<double>* b : {&m_, &dm_, &node_, &left_, &right_, &kept_}) b->assign(n_ + 1, 0);
  part_.assign(n_, Part());
  take_rows(all);
  // Those next to rest count nowhere.
  for (Side* side : {&up_, &down_}) {
    side->s.assign(a0_.size(), 1);
    side->z.assign(a0_.size(), 0);
  }
  side_.assign(n_ + 1, JerkSide());
  at_middle_.clear();
  at_node_.clear();
  for (std::size_t i = 1; i < n_; ++i) {
    const double before = rows[i - 1].length, after = rows[i].length;
    left_[i] = after / (before + after);
    right_[i] = before / (before + after);
  }
  if (rests_) {
    left_[1] = 0;
    right_[1] = 1 / (1 + 2 * rows[1].length / (3 * rows[0].length));
  } else {
    m_[0] = x0 + u0 * rows[0].length;
  }
  left_[n_ - 1] = 1 / (1 + 2 * rows[n_ - 2].length / (3 * rows[n_ - 1].length));
  right_[n_ - 1] = 0;
  // At first nothing is to brake for a wish.
  waits_ = sinks_ = false;
  const auto add = [&](Buffer<Bound>& to, std::size_t i, double top, double worth) {
    if (top >= kNoLimit) return;
    Bound c;
    c.i = i;
    c.top = c.wanted = top;
    c.worth = worth;
    if (worth > 0 && top < x0 && patient) {
      c.top = x0;
      waits_ = true;
    }
    to.push_back(c);
  };
  for (std::size_t i = first_; i < last_; ++i) {
    add(at_middle_, i, rows[i].cap, 0);
    if (rows[i].wish < kNoLimit) add(at_middle_, i, kUnderWish * rows[i].wish, worth_of(i));
  }
  for (std::size_t i = 1; i < n_; ++i) {
    const LawInterval &before = rows[i - 1], &after = rows[i];
    double cap = std::min(before.cap, after.cap);
    const double wish = std::min(before.wish, after.wish);
    const bool wishes = before.wish != after.wish && wish < cap;
    if (rests_ && i == 1) cap = std::min(cap, rows.start_cap());
    if (i == n_ - 1) cap = std::min(cap, rows.stop_cap());
    add(at_node_, i, cap, 0);
    const double worth = std::max((before.length + after.length) / 2, 2 * worth_of_node(i));
    if (wishes) add(at_node_, i, kUnderWish * wish, worth);
  }
}

/// What x is worth there: the time it takes falls by this / (2 x^1.5) a unit of it. Simpson's weights: an interval of length D takes D/6 (b0^-1/2 + 4 xm^-1/2 +
/// b2^-1/2) and each of its three coefficients is worth a third of it; one with even jerk from or to rest 3 D x^-1/2.
double LawNewton::worth_of_node(std::size_t i) const noexcept {
  const double before = (*rows_)[i - 1].length, after = (*rows_)[i].length;
  return (rests_ && i == 1 ? 3 * before : before / 3) + (i == n_ - 1 ? 3 * after : after / 3);
}

/// Of m, which the nodes at both ends of its interval follow.
double LawNewton::worth_of(std::size_t i) const noexcept {
  const double start = i > 0 ? right_[i] * worth_of_node(i) : 0;
  return (*rows_)[i].length / 3 + start + left_[i + 1] * worth_of_node(i + 1);
}

void LawNewton::coefficients(std::size_t i, double b[3]) const noexcept {
  b[0] = i == 0 ? x0_ : node_[i];
  b[1] = m_[i];
  b[2] = node_[i + 1];
}

template <class F>
void LawNewton::each_bound(F&& f) noexcept {
  for (Bound& c : at_middle_) f(c, m_[c.i]);
  for (Bound& c : at_node_) f(c, node_[c.i]);
}

void LawNewton::set_nodes() noexcept {
  for (std::size_t i = 1; i < n_; ++i) node_[i] = left_[i] * m_[i - 1] + right_[i] * m_[i];
}

double LawNewton::seconds() const noexcept {
  double t = 0;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    double b[3];
    coefficients(i, b);
    Quadratic unused;
    t += build_time((*rows_)[i].length, b, unused);
  }
  if (rests_) t += 3 * (*rows_)[0].length / std::sqrt(node_[1]);
  return t + 3 * (*rows_)[n_ - 1].length / std::sqrt(node_[n_ - 1]);
}

void LawNewton::start(bool shrink, const Aim& aim) noexcept {
  acc_ = aim.acc;
  jerk_ = aim.jerk;
  // Between the guesses at the nodes.
  for (std::size_t i = first_; i < last_; ++i) {
    const double x0 = i == 1 && rests_ ? node_[1] / right_[1] : (i == 0 ? x0_ : node_[i]);
    const double x1 = node_[i + 1];
    m_[i] = i + 1 == n_ - 1 ? x1 / left_[n_ - 1] : (x0 + x1) / 2;
  }
  set_nodes();
  if (shrink) shrink_guess();
}

void LawNewton::shrink_guess() noexcept {
  for (int round = 0; round < 200; ++round) {
    // dm_ holds the factors.
    dm_.assign(n_ + 1, 1.0);
    bool any = false;
    for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
      double b[3];
      coefficients(i, b);
      const JerkSide side(b, 0.9 * jerk_);
      const Part& part = part_[i];
      std::size_t r = part.row;
      bool holds = node_[i + 1] <= 0.95 * at_node_[i + 1].top &&
                   m_[i] <= 0.95 * at_middle_[i].top &&
                   (i == 0 || node_[i] <= 0.95 * at_node_[i].top);
      const std::size_t all = part.accs + 3 * part.jerks;
      for (std::size_t k = 0; k < all && holds; ++k, ++r) {
        const double right = k < part.accs ? 0.9 * acc_ : side.right[(k - part.accs) / part.jerks];
        holds = std::abs(a0_[r] * b[0] + a1_[r] * b[1] + a2_[r] * b[2]) <= right;
      }
      if (holds) continue;
      any = true;
      for (std::size_t k = i < 3 ? 0 : i - 3; k <= std::min(i + 3, n_); ++k) dm_[k] = 0.85;
    }
    if (!any) break;
    for (std::size_t i = first_; i < last_; ++i) m_[i] *= dm_[i];
    set_nodes();
  }
}

void LawNewton::start_wish(Bound& c, double x) noexcept {
  c.price = price_of(c, x);
  const double g = x - c.top, least = kFirstSlack * std::max(c.top, x);
  c.t = g > 0 ? g + least : least;
  c.s = c.t - g;
  c.z = c.price * c.t / (c.s + c.t);
  c.y = c.price - c.z;
}

/// Away from the bounds: what was worth being near to is no more.
void LawNewton::raise_multipliers(double mu) noexcept {
  for (Side* side : {&up_, &down_})
    for (std::size_t r = 0; r < a0_.size(); ++r) side->z[r] = std::max(side->z[r], mu / side->s[r]);
  each_bound([&](Bound& c, double) {
    if (!(c.worth > 0)) c.z = std::max(c.z, mu / c.s);
  });
}

void LawNewton::wish_truly(double mu) noexcept {
  raise_multipliers(mu);
  each_bound([&](Bound& c, double x) {
    if (c.worth > 0 && c.wanted < c.top) {
      c.top = std::max(c.wanted, kSink * x);
      start_wish(c, x);
    }
  });
}

/// Where x was above the wish from the start on it comes down as fast as it can anyway.
bool LawNewton::make_broken_wishes_dearer() noexcept {
  bool any = false, below = false;
  for (Bound& c : at_middle_) {
    if (!(c.worth > 0)) continue;
    const double x = m_[c.i];
    below = below || x <= c.wanted;
    if (!below || x <= kBroken * c.wanted) continue;
    c.worth *= kDearer;
    start_wish(c, x);
    any = true;
  }
  return any;
}

void LawNewton::start_slacks(double mu) noexcept {
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    double b[3];
    coefficients(i, b);
    const JerkSide side(b, jerk_);
    const Part& part = part_[i];
    const std::size_t all = part.accs + 3 * part.jerks;
    std::size_t r = part.row;
    for (std::size_t k = 0; k < all; ++k, ++r) {
      const double right =
          k < part.accs ? acc_
                        : std::max(side.right[(k - part.accs) / part.jerks], 0.1 * side.right[0]);
      const double v = a0_[r] * b[0] + a1_[r] * b[1] + a2_[r] * b[2];
      up_.s[r] = std::max(right - v, kFirstSlack * right);
      down_.s[r] = std::max(right + v, kFirstSlack * right);
      for (Side* row : {&up_, &down_}) {
        row->z[r] = mu / row->s[r];
        row->ds[r] = row->dz[r] = 0;
      }
    }
  }
  each_bound([&](Bound& c, double x) {
    if (c.worth > 0) {
      start_wish(c, x);
    } else {
      c.s = std::max(c.top - x, kFirstSlack * c.top);
      c.z = mu / c.s;
    }
  });
}

/// The time over an interval; its derivatives become q.
double LawNewton::build_time(double length, const double b[3], Quadratic& q) noexcept {
  const double xm = (b[0] + 2 * b[1] + b[2]) / 4, d = length / 6;
  const double i0 = 1 / b[0], im = 1 / xm, i2 = 1 / b[2];
  const double r0 = d * std::sqrt(i0), rm = 4 * d * std::sqrt(im), r2 = d * std::sqrt(i2);
  const double t0 = r0 * i0, tm = rm * im, t2 = r2 * i2, hm = 0.75 * tm * im / 16;
  q.g[0] = 0.5 * t0 + 0.125 * tm;
  q.g[1] = 0.25 * tm;
  q.g[2] = 0.5 * t2 + 0.125 * tm;
  q.h00 = 0.75 * t0 * i0 + hm;
  q.h01 = q.h12 = 2 * hm;
  q.h02 = hm;
  q.h11 = 4 * hm;
  q.h22 = 0.75 * t2 * i2 + hm;
  return r0 + rm + r2;
}

/// Row r, or r and the one behind it: moved on, looked at, and added.
template <bool kSlopes, class V>
inline void LawNewton::add_row(std::size_t r, const double b[3], double right, const Look& look,
                               Sums<V>& to) noexcept {
  const V c0 = load<V>(a0_, r), c1 = load<V>(a1_, r), c2 = load<V>(a2_, r);
  const V v = c0 * b[0] + c1 * b[1] + c2 * b[2], room = right - v, room_down = right + v;
  // A slack that is too small may grow to what it truly is.
  const V s = larger(load<V>(up_.s, r) + look.primal * load<V>(up_.ds, r), room);
  const V s_down = larger(load<V>(down_.s, r) + look.primal * load<V>(down_.ds, r), room_down);
  const V least = each<V>(kLeastMultiplier);
  const V z = larger(load<V>(up_.z, r) + look.dual * load<V>(up_.dz, r), least);
  const V z_down = larger(load<V>(down_.z, r) + look.dual * load<V>(down_.dz, r), least);
  const V over = 1 / s, over_down = 1 / s_down;
  store(up_.s, r, s), store(up_.z, r, z), store(up_.over, r, over), store(up_.room, r, room);
  store(down_.s, r, s_down), store(down_.z, r, z_down);
  store(down_.over, r, over_down), store(down_.room, r, room_down);
  const V w = z * over, w_down = z_down * over_down;
  const V back = w * (s - room), back_down = w_down * (s_down - room_down);
  to.least = smaller(to.least, smaller(room, room_down));
  to.sum += s * z + s_down * z_down;
  const V weight = w + w_down, pull = back - back_down, pull_mu = over - over_down;
  const V h0 = weight * c0, h1 = weight * c1;
  to.h00 += h0 * c0, to.h01 += h0 * c1, to.h02 += h0 * c2;
  to.h11 += h1 * c1, to.h12 += h1 * c2, to.h22 += weight * c2 * c2;
  to.g0 += pull * c0, to.g1 += pull * c1, to.g2 += pull * c2;
  to.m0 += pull_mu * c0, to.m1 += pull_mu * c1, to.m2 += pull_mu * c2;
  if constexpr (kSlopes) {
    const V difference = w - w_down;
    to.x0 += difference * c0, to.x1 += difference * c1, to.x2 += difference * c2;
    to.weights += weight, to.pulls += back + back_down, to.pulls_mu += over + over_down;
  }
}

/// The rows [r, end) with one right side. With slopes the right side depends on b too.
template <bool kSlopes>
void LawNewton::add_rows(std::size_t r, std::size_t end, const double b[3], const Section& section,
                         Quadratic& q, Look& look) noexcept {
  Sums<Pair> two{each<Pair>(section.right)};
  Sums<double> one{section.right};
  if (section.given) {
    for (; r < end; ++r)
      if (a2_[r] != 0) add_row<kSlopes>(r, b, section.right, look, one);
  }
  for (; r + 1 < end; r += 2) add_row<kSlopes>(r, b, section.right, look, two);
  if (r < end) add_row<kSlopes>(r, b, section.right, look, one);
  const auto all = [](Pair p, double x) { return p[0] + p[1] + x; };
  const double least = std::min({two.least[0], two.least[1], one.least});
  look.worst = std::max(look.worst, -least * section.relative);
  look.sum += all(two.sum, one.sum);
  q.h00 += all(two.h00, one.h00), q.h01 += all(two.h01, one.h01), q.h02 += all(two.h02, one.h02);
  q.h11 += all(two.h11, one.h11), q.h12 += all(two.h12, one.h12), q.h22 += all(two.h22, one.h22);
  q.g[0] -= all(two.g0, one.g0), q.g[1] -= all(two.g1, one.g1), q.g[2] -= all(two.g2, one.g2);
  q.mu[0] -= all(two.m0, one.m0), q.mu[1] -= all(two.m1, one.m1), q.mu[2] -= all(two.m2, one.m2);
  if constexpr (kSlopes) {
    const double s0 = section.slope[0], s1 = section.slope[1], s2 = section.slope[2];
    const double weight = all(two.weights, one.weights), pull = all(two.pulls, one.pulls),
                 pull_mu = all(two.pulls_mu, one.pulls_mu), x0 = all(two.x0, one.x0),
                 x1 = all(two.x1, one.x1), x2 = all(two.x2, one.x2);
    for (int k = 0; k < 3; ++k) {
      q.g[k] += pull * section.slope[k];
      q.mu[k] += pull_mu * section.slope[k];
    }
    q.h00 += weight * s0 * s0 - 2 * x0 * s0;
    q.h01 += weight * s0 * s1 - x0 * s1 - x1 * s0;
    q.h02 += weight * s0 * s2 - x0 * s2 - x2 * s0;
    q.h11 += weight * s1 * s1 - 2 * x1 * s1;
    q.h12 += weight * s1 * s2 - x1 * s2 - x2 * s1;
    q.h22 += weight * s2 * s2 - 2 * x2 * s2;
  }
}

/// Of interval i, over the unknowns: b0 = l m[i-1] + r m[i], b2 = ll m[i] + rr m[i+1].
void LawNewton::add(std::size_t i, const Quadratic& q) noexcept {
  const double l = left_[i], rt = right_[i], ll = left_[i + 1], rr = right_[i + 1];
  const double h00 = q.h00, h01 = q.h01, h02 = q.h02, h11 = q.h11, h12 = q.h12, h22 = q.h22;
  const double g0 = q.g[0], g1 = q.g[1], mu0 = q.mu[0], mu1 = q.mu[1];
  if (i > 0) {
    d0_[i - 1] += l * l * h00;
    d1_[i - 1] += l * (rt * h00 + h01 + ll * h02);
    d2_[i - 1] += l * rr * h02;
    dm_[i - 1] += l * g0;
    by_mu_[i - 1] += l * mu0;
  }
  d0_[i] += rt * (rt * h00 + 2 * h01 + 2 * ll * h02) + h11 + ll * (2 * h12 + ll * h22);
  d1_[i] += rr * (rt * h02 + h12 + ll * h22);
  d0_[i + 1] += rr * rr * h22;
  dm_[i] += rt * g0 + g1 + ll * q.g[2];
  by_mu_[i] += rt * mu0 + mu1 + ll * q.mu[2];
  dm_[i + 1] += rr * q.g[2];
  by_mu_[i + 1] += rr * q.mu[2];
}

void LawNewton::add_at_node(std::size_t i, double h, double g, double by_mu) noexcept {
  const double l = left_[i], r = right_[i];
  d0_[i - 1] += h * l * l;
  d1_[i - 1] += h * l * r;
  d0_[i] += h * r * r;
  dm_[i - 1] += g * l;
  dm_[i] += g * r;
  by_mu_[i - 1] += by_mu * l;
  by_mu_[i] += by_mu * r;
}

/// Moved on by these steps, looked at where x is now, and made ready to be added.
void LawNewton::prepare(Bound& c, double x, double primal, double dual) noexcept {
  c.s += primal * c.ds;
  c.z = std::max(c.z + dual * c.dz, kLeastMultiplier);
  if (c.worth > 0) {
    c.t += primal * c.dt;
    c.y = std::max(c.y - dual * c.dz, kLeastMultiplier);
    if (sinks_) c.top = std::min(c.top, std::max(c.wanted, kSink * x));
    const double price = price_of(c, x), change = price / c.price;
    c.price = price;
    c.z *= change;
    c.y *= change;
    sum_ += c.s * c.z + c.t * c.y;
    terms_ += 2;
    const double by_z = 1 / c.z, by_y = 1 / c.y;
    c.weight = 1 / (c.s * by_z + c.t * by_y);
    c.pull = c.weight * (x - c.top);  // dz without a step
    c.pull_mu = c.weight * (by_z - by_y);
    c.push = c.z + c.pull;
    c.push_mu = c.pull_mu;
    return;
  }
  c.s = std::max(c.s, c.top - x);
  sum_ += c.s * c.z;
  ++terms_;
  if (x > c.top * (1 + worst_)) worst_ = x / c.top - 1;
  c.push_mu = 1 / c.s;
  c.weight = c.z * c.push_mu;
  c.off = x - c.top + c.s;
  c.push = c.weight * c.off;
}

/// Moves on by these steps, looks where all is then, and builds the matrix for the next step and its right side, which is linear in mu.
void LawNewton::look_and_build(double primal, double dual) noexcept {
  const LawRows& rows = *rows_;
  for (std::size_t i = first_; i < last_; ++i) m_[i] += primal * dm_[i];
  set_nodes();
  for (Buffer<double>* b : {&d0_, &d1_, &d2_, &dm_, &by_mu_}) b->assign(n_ + 1, 0);
  sum_ = worst_ = time_ = 0;
  terms_ = 0;
  Look look;
  look.primal = primal;
  look.dual = dual;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    const LawInterval& in = rows[i];
    double b[3];
    coefficients(i, b);
    const JerkSide& side = side_[i] = JerkSide(b, jerk_);
    Quadratic q;
    time_ += build_time(in.length, b, q);
    const std::size_t accs = part_[i].accs, jerks = part_[i].jerks;
    std::size_t r = part_[i].row;
    // What the start state alone decides is no row.
    add_rows<false>(r, r + accs, b, {acc_, 1, nullptr, i == 0}, q, look);
    r += accs;
    const double relative = 1 / side.right[0];
    for (int k = 0; k < 3 && jerks > 0; ++k, r += jerks)
      add_rows<true>(r, r + jerks, b, {side.right[k], relative, side.slope[k], false}, q, look);
    terms_ += 2 * accs + 6 * jerks;
    add(i, q);
  }
  sum_ = look.sum;
  worst_ = look.worst;
  for (Bound& c : at_middle_) {
    prepare(c, m_[c.i], primal, dual);
    d0_[c.i] += c.weight;
    dm_[c.i] -= c.push;
    by_mu_[c.i] -= c.push_mu;
  }
  for (Bound& c : at_node_) {
    prepare(c, node_[c.i], primal, dual);
    add_at_node(c.i, c.weight, -c.push, -c.push_mu);
  }
  const auto rest = [&](std::size_t i, double length) {
    const double x = node_[i], v = std::sqrt(x), t = 1.5 * length / (x * v);
    time_ += 3 * length / v;
    add_at_node(i, 1.5 * t / x, t, 0);
  };
  if (rests_) rest(1, rows[0].length);
  rest(n_ - 1, rows[n_ - 1].length);
}

bool LawNewton::factor_and_solve(double mu) noexcept {
  for (std::size_t i = first_; i < last_; ++i) dm_[i] += mu * by_mu_[i];
  // L D L^T of five diagonals; dm_ holds the right side, then the step. m[0] is no unknown.
  for (std::size_t i = first_; i < last_; ++i) {
    double d = d0_[i], l1 = d1_[i], y = dm_[i];
    if (i >= first_ + 1) {
      d -= d1_[i - 1] * d1_[i - 1] * d0_[i - 1];
      l1 -= d1_[i - 1] * d0_[i - 1] * d2_[i - 1];
      y -= d1_[i - 1] * dm_[i - 1];
    }
    if (i >= first_ + 2) {
      d -= d2_[i - 2] * d2_[i - 2] * d0_[i - 2];
      y -= d2_[i - 2] * dm_[i - 2];
    }
    if (!(d > 0)) return false;
    d0_[i] = d;
    d1_[i] = l1 / d;
    d2_[i] /= d;
    dm_[i] = y;
  }
  for (std::size_t i = last_; i-- > first_;) {
    double y = dm_[i] / d0_[i];
    if (i + 1 < last_) y -= d1_[i] * dm_[i + 1];
    if (i + 2 < last_) y -= d2_[i] * dm_[i + 2];
    dm_[i] = y;
  }
  for (std::size_t i = 0; i < first_; ++i) dm_[i] = 0;
  for (std::size_t i = last_; i <= n_; ++i) dm_[i] = 0;
  return std::isfinite(dm_[first_]);
}

template <class V>
inline void LawNewton::step_row(std::size_t r, const double db[3], double mu, double dright,
                                V& primal, V& dual) noexcept {
  const V dv = load<V>(a0_, r) * db[0] + load<V>(a1_, r) * db[1] + load<V>(a2_, r) * db[2];
  const auto side = [&](Side& of, V moves) {
    const V z = load<V>(of.z, r), over = load<V>(of.over, r);
    const V ds = load<V>(of.room, r) - load<V>(of.s, r) + moves, dz = (mu - z * ds) * over - z;
    store(of.ds, r, ds), store(of.dz, r, dz);
    primal = larger(primal, -ds * over);
    dual = larger(dual, -dz / z);
  };
  side(up_, dright - dv);
  side(down_, dright + dv);
}

/// What the rows [r, end) say of the largest steps, as 1 over them.
void LawNewton::step_rows(std::size_t r, std::size_t end, const double db[3], double mu, bool given,
                          double dright, double& primal, double& dual) noexcept {
  Pair primals = each<Pair>(primal), duals = each<Pair>(dual);
  if (given) {
    for (; r < end; ++r)
      if (a2_[r] != 0) step_row(r, db, mu, dright, primal, dual);
  }
  for (; r + 1 < end; r += 2) step_row(r, db, mu, dright, primals, duals);
  if (r < end) step_row(r, db, mu, dright, primal, dual);
  primal = std::max({primal, primals[0], primals[1]});
  dual = std::max({dual, duals[0], duals[1]});
}

void LawNewton::step_sizes(double mu) noexcept {
  // 1 over the largest step.
  double primal = kToBound, dual = kToBound;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    const double db[3] = {i == 0 ? 0 : left_[i] * dm_[i - 1] + right_[i] * dm_[i], dm_[i],
                          left_[i + 1] * dm_[i] + right_[i + 1] * dm_[i + 1]};
    const std::size_t accs = part_[i].accs, jerks = part_[i].jerks;
    std::size_t r = part_[i].row;
    step_rows(r, r + accs, db, mu, i == 0, 0, primal, dual);
    r += accs;
    for (int k = 0; k < 3 && jerks > 0; ++k, r += jerks) {
      const double* slope = side_[i].slope[k];
      const double dright = slope[0] * db[0] + slope[1] * db[1] + slope[2] * db[2];
      step_rows(r, r + jerks, db, mu, false, dright, primal, dual);
    }
  }
  const auto bound = [&](Bound& c, double dx) {
    if (c.worth > 0) {
      c.dz = c.pull + mu * c.pull_mu + c.weight * dx;
      c.ds = mu / c.z - c.s - c.s / c.z * c.dz;
      c.dt = mu / c.y - c.t + c.t / c.y * c.dz;
      primal = std::max({primal, -c.ds / c.s, -c.dt / c.t});
      dual = std::max({dual, -c.dz / c.z, c.dz / c.y});
      return;
    }
    c.ds = -c.off - dx;
    c.dz = (mu - c.z * c.ds) * c.push_mu - c.z;
    primal = std::max(primal, -c.ds * c.push_mu);
    dual = std::max(dual, -c.dz / c.z);
  };
  for (Bound& c : at_middle_) bound(c, dm_[c.i]);
  for (Bound& c : at_node_) bound(c, left_[c.i] * dm_[c.i - 1] + right_[c.i] * dm_[c.i]);
  for (std::size_t i = first_; i < last_; ++i)
    primal = std::max(primal, -dm_[i] / m_[i] * (kToBound / kMostFall));
  primal_ = kToBound / primal;
  dual_ = kToBound / dual;
}

bool LawNewton::run(const Aim& aim) noexcept {
  iterations_ = 0;
  acc_ = aim.acc;
  jerk_ = aim.jerk;
  const std::size_t rows = a0_.size() * 2 + 4 * n_;
  double before = seconds();
  double mu = aim.mu * before / static_cast<double>(rows);
  start_slacks(mu);
  look_and_build(0, 0);
  bool gives_up = aim.soon;       // until the limits are kept
  int more = 0;                   // steps after a result that is near enough
  double worst[kPatience + 1]{};  // after each of the last steps
  int dearer = 0;                 // how often a result was kept and gone on from
  // Keeps the last result; where the steps after it lead nowhere, it stands.
  const auto give_up = [&] {
    if (dearer == 0) return false;
    std::copy(kept_.begin(), kept_.begin() + n_, m_.begin());
    set_nodes();
    return true;
  };
  for (; iterations_ < aim.iterations; ++iterations_) {
    if (!factor_and_solve(mu)) return give_up();
    step_sizes(mu);
    look_and_build(primal_, dual_);
    const double now = time_, step = std::min(primal_, dual_);
    const bool settled = std::abs(now - before) < 3e-3 * now;
    before = now;
    if (!waits_ && sum_ < aim.gap * now && worst_ < aim.violation && settled && step > 0.3 &&
        (sum_ < aim.gap * std::min(now, kFarthest) || ++more > kMore)) {
      if (aim.soon || dearer == kMostDearer || !make_broken_wishes_dearer()) return true;
      std::copy(m_.begin(), m_.begin() + n_, kept_.begin());
      ++dearer;
      more = 0;
      mu = kRough * now / static_cast<double>(terms_);
      raise_multipliers(mu);
      look_and_build(0, 0);
      continue;
    }
    if (!std::isfinite(now) || primal_ < kStalled) return give_up();
    gives_up = gives_up && worst_ >= aim.violation;
    std::copy(worst + 1, worst + kPatience + 1, worst);
    worst[kPatience] = worst_;
    if (gives_up && iterations_ >= kPatience && worst_ > kHardlyLess * worst[0]) return false;
    const double terms = static_cast<double>(terms_);
    if (waits_ && worst_ < aim.violation && step > 0.3) {
      waits_ = false;
      sinks_ = true;
      mu = kRecentre * now / terms;
      wish_truly(mu);
      look_and_build(0, 0);
      continue;
    }
    const double shrink = step > 0.9 ? 0.1 : step > 0.5 ? 0.3 : step > 0.2 ? 0.5 : 1;
    mu = shrink * sum_ / terms;
    if (waits_) mu = std::max(mu, kRough * now / terms);
  }
  // Near enough, by steps too small to be sure of.
  return (!waits_ && sum_ < aim.gap * before && worst_ < aim.violation) || give_up();
}

}  // namespace kerf::motion::path
