#include "motion/core/path/time_law_newton.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

constexpr std::size_t kRowsPerInterval = 30;
constexpr double kToBound = 0.97;
/// m may fall by this share of itself in one step.
constexpr double kMostFall = 0.7;
/// What is aimed at, so that x does not end up above the wish while the barrier still gives way.
constexpr double kUnderWish = 0.999;
/// A wish costs this many times what breaking it is worth.
constexpr double kPrice = 2;
/// First slack of a limit that does not hold, relative to the limit.
constexpr double kFirstSlack = 0.05;
constexpr double kLeastMultiplier = 1e-30;
/// A wish that is far below is neared by this factor in one iteration.
constexpr double kSink = 0.5;
constexpr double kStalled = 1e-6;
/// Weights of the barrier (relative to the time) down to which a law goes before it begins to brake for wishes, and with which it begins.
constexpr double kRough = 0.1, kRecentre = 1;

}  // namespace

/// Of breaking a wish: as the time's own slope where x is, so that it outweighs it everywhere and drowns it nowhere.
double LawNewton::price_of(const Bound& wish, double x) noexcept {
  const double at = std::max(wish.top, x);
  return kPrice * wish.length / (2 * at * std::sqrt(at));
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

bool LawNewton::create(Memory& memory, std::size_t intervals) noexcept {
  const std::size_t rows = intervals * kRowsPerInterval, n = intervals + 1;
  for (Buffer<double>* b : {&m_, &dm_, &node_, &left_, &right_, &d0_, &d1_, &d2_})
    if (!b->create(memory, n)) return false;
  for (Buffer<double>* b :
       {&v_, &sp_, &sm_, &zp_, &zm_, &dsp_, &dsm_, &dzp_, &dzm_, &over_p_, &over_m_})
    if (!b->create(memory, rows)) return false;
  for (Buffer<Bound>* b : {&at_middle_, &at_node_, &wish_middle_, &wish_node_})
    if (!b->create(memory, n)) return false;
  return side_.create(memory, n);
}

void LawNewton::begin(const LawRows& rows, double x0, double u0, bool patient) noexcept {
  rows_ = &rows;
  n_ = rows.size();
  first_ = 1;
  last_ = n_ - 1;
  x0_ = x0;
  rests_ = x0 <= 0;
  for (Buffer<double>* b : {&m_, &dm_, &node_, &left_, &right_, &d0_, &d1_, &d2_})
    b->assign(n_ + 1, 0);
  for (Buffer<double>* b :
       {&v_, &sp_, &sm_, &zp_, &zm_, &dsp_, &dsm_, &dzp_, &dzm_, &over_p_, &over_m_})
    b->assign(rows.a0.size(), 0);
  for (Buffer<Bound>* b : {&at_middle_, &at_node_, &wish_middle_, &wish_node_}) {
    Bound none;
    none.top = kNoLimit;
    b->assign(n_ + 1, none);
  }
  side_.assign(n_ + 1, JerkSide());
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
  for (std::size_t i = first_; i < last_; ++i) {
    at_middle_[i].top = rows[i].cap;
    wish_middle_[i].top = rows[i].wish < kNoLimit ? kUnderWish * rows[i].wish : kNoLimit;
    wish_middle_[i].length = rows[i].length;
  }
  for (std::size_t i = 1; i < n_; ++i) {
    const double cap = std::min(rows[i - 1].cap, rows[i].cap);
    at_node_[i].top = cap;
    const double wish = std::min(rows[i - 1].wish, rows[i].wish);
    if (rows[i - 1].wish == rows[i].wish || wish >= cap) continue;
    wish_node_[i].top = kUnderWish * wish;
    wish_node_[i].length = (rows[i - 1].length + rows[i].length) / 2;
  }
  if (rests_) at_node_[1].top = std::min(at_node_[1].top, rows.start_cap());
  at_node_[n_ - 1].top = std::min(at_node_[n_ - 1].top, rows.stop_cap());
  // At first nothing is to brake for a wish.
  waits_ = sinks_ = false;
  for (Buffer<Bound>* all : {&wish_middle_, &wish_node_})
    for (Bound& c : *all) {
      c.wanted = c.top;
      if (c.top >= x0 || !patient) continue;
      c.top = x0;
      waits_ = true;
    }
}

void LawNewton::coefficients(std::size_t i, double b[3]) const noexcept {
  b[0] = i == 0 ? x0_ : node_[i];
  b[1] = m_[i];
  b[2] = node_[i + 1];
}

void LawNewton::set_nodes() noexcept {
  for (std::size_t i = 1; i < n_; ++i) node_[i] = left_[i] * m_[i - 1] + right_[i] * m_[i];
}

double LawNewton::seconds() const noexcept {
  double t = 0;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    double b[3];
    coefficients(i, b);
    const double xm = (b[0] + 2 * b[1] + b[2]) / 4;
    t += (*rows_)[i].length / 6 * (1 / std::sqrt(b[0]) + 4 / std::sqrt(xm) + 1 / std::sqrt(b[2]));
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
  const LawRows& rows = *rows_;
  for (int round = 0; round < 200; ++round) {
    // dm_ holds the factors.
    dm_.assign(n_ + 1, 1.0);
    bool any = false;
    for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
      double b[3];
      coefficients(i, b);
      const JerkSide side(b, 0.9 * jerk_);
      std::size_t r = rows[i].row;
      bool holds = node_[i + 1] <= 0.95 * at_node_[i + 1].top &&
                   m_[i] <= 0.95 * at_middle_[i].top &&
                   (i == 0 || node_[i] <= 0.95 * at_node_[i].top);
      const std::int32_t accs = rows[i].accs, all = accs + 3 * rows[i].jerks;
      for (std::int32_t k = 0; k < all && holds; ++k, ++r) {
        const double right = k < accs ? 0.9 * acc_ : side.right[(k - accs) / rows[i].jerks];
        holds = std::abs(rows.a0[r] * b[0] + rows.a1[r] * b[1] + rows.a2[r] * b[2]) <= right;
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

void LawNewton::wish_truly(double mu) noexcept {
  // Away from the bounds: what was worth being near to is no more.
  for (std::size_t r = 0; r < sp_.size(); ++r) {
    zp_[r] = std::max(zp_[r], mu / sp_[r]);
    zm_[r] = std::max(zm_[r], mu / sm_[r]);
  }
  for (Buffer<Bound>* all : {&at_middle_, &at_node_})
    for (Bound& c : *all) c.z = std::max(c.z, mu / c.s);
  const auto bound = [&](Bound& c, double x) {
    if (c.wanted >= c.top || !c.used()) return;
    c.top = std::max(c.wanted, kSink * x);
    start_wish(c, x);
  };
  for (std::size_t i = first_; i < last_; ++i) bound(wish_middle_[i], m_[i]);
  for (std::size_t i = 1; i < n_; ++i) bound(wish_node_[i], node_[i]);
}

void LawNewton::start_slacks(double mu) noexcept {
  const LawRows& rows = *rows_;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    double b[3];
    coefficients(i, b);
    const JerkSide side(b, jerk_);
    const std::int32_t accs = rows[i].accs, all = accs + 3 * rows[i].jerks;
    std::size_t r = rows[i].row;
    for (std::int32_t k = 0; k < all; ++k, ++r) {
      const double right =
          k < accs ? acc_ : std::max(side.right[(k - accs) / rows[i].jerks], 0.1 * side.right[0]);
      const double v = rows.a0[r] * b[0] + rows.a1[r] * b[1] + rows.a2[r] * b[2];
      sp_[r] = std::max(right - v, kFirstSlack * right);
      sm_[r] = std::max(right + v, kFirstSlack * right);
      zp_[r] = mu / sp_[r];
      zm_[r] = mu / sm_[r];
    }
  }
  const auto bound = [&](Bound& c, double x) {
    if (!c.used()) return;
    if (c.length > 0) {
      start_wish(c, x);
    } else {
      c.s = std::max(c.top - x, kFirstSlack * c.top);
      c.z = mu / c.s;
    }
  };
  for (std::size_t i = first_; i < last_; ++i)
    bound(at_middle_[i], m_[i]), bound(wish_middle_[i], m_[i]);
  for (std::size_t i = 1; i < n_; ++i) bound(at_node_[i], node_[i]), bound(wish_node_[i], node_[i]);
}

void LawNewton::look() noexcept {
  const LawRows& rows = *rows_;
  sum_ = worst_ = 0;
  terms_ = 0;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    double b[3];
    coefficients(i, b);
    const JerkSide& side = side_[i] = JerkSide(b, jerk_);
    const std::int32_t accs = rows[i].accs, jerks = rows[i].jerks;
    std::size_t r = rows[i].row;
    const auto look_at = [&](double right, double relative) {
      const double v = rows.a0[r] * b[0] + rows.a1[r] * b[1] + rows.a2[r] * b[2];
      v_[r] = v;
      // A slack that is too small may grow to what it truly is.
      sp_[r] = std::max(sp_[r], right - v);
      sm_[r] = std::max(sm_[r], right + v);
      sum_ += sp_[r] * zp_[r] + sm_[r] * zm_[r];
      worst_ = std::max(worst_, (std::abs(v) - right) * relative);
    };
    // What the start state alone decides is no row.
    for (std::int32_t k = 0; k < accs; ++k, ++r)
      if (i > 0 || rows.a2[r] != 0) look_at(acc_, 1);
    const double relative = 1 / side.right[0];
    for (int k = 0; k < 3; ++k)
      for (std::int32_t j = 0; j < jerks; ++j, ++r) look_at(side.right[k], relative);
    terms_ += static_cast<std::size_t>(2 * accs + 6 * jerks);
  }
  const auto bound = [&](Bound& c, double x) {
    if (!c.used()) return;
    c.at = x;
    if (c.price > 0) {
      if (sinks_) c.top = std::min(c.top, std::max(c.wanted, kSink * x));
      const double price = price_of(c, x), change = price / c.price;
      c.price = price;
      c.z *= change;
      c.y *= change;
      sum_ += c.s * c.z + c.t * c.y;
      terms_ += 2;
      return;
    }
    c.s = std::max(c.s, c.top - x);
    sum_ += c.s * c.z;
    worst_ = std::max(worst_, x / c.top - 1);
    ++terms_;
  };
  for (std::size_t i = first_; i < last_; ++i)
    bound(at_middle_[i], m_[i]), bound(wish_middle_[i], m_[i]);
  for (std::size_t i = 1; i < n_; ++i) bound(at_node_[i], node_[i]), bound(wish_node_[i], node_[i]);
}

void LawNewton::build(double mu) noexcept {
  const LawRows& rows = *rows_;
  d0_.assign(n_ + 1, 0);
  d1_.assign(n_ + 1, 0);
  d2_.assign(n_ + 1, 0);
  dm_.assign(n_ + 1, 0);
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    const LawInterval& in = rows[i];
    double b[3];
    coefficients(i, b);
    // The time, then the rows: matrix h and right side g over b.
    double h00 = 0, h01 = 0, h02 = 0, h11 = 0, h12 = 0, h22 = 0, g0 = 0, g1 = 0, g2 = 0;
    {
      const double xm = (b[0] + 2 * b[1] + b[2]) / 4, d = in.length / 6;
      const double i0 = 1 / b[0], im = 1 / xm, i2 = 1 / b[2];
      const double t0 = d * i0 * std::sqrt(i0), tm = 4 * d * im * std::sqrt(im),
                   t2 = d * i2 * std::sqrt(i2);
      g0 = 0.5 * t0 + 0.125 * tm;
      g1 = 0.25 * tm;
      g2 = 0.5 * t2 + 0.125 * tm;
      const double hm = 0.75 * tm * im / 16;
      h00 = 0.75 * t0 * i0 + hm;
      h22 = 0.75 * t2 * i2 + hm;
      h01 = h12 = 2 * hm;
      h11 = 4 * hm;
      h02 = hm;
    }
    std::size_t r = in.row;
    for (std::int32_t k = 0; k < in.accs; ++k, ++r) {
      const double c0 = rows.a0[r], c1 = rows.a1[r], c2 = rows.a2[r];
      if (i == 0 && c2 == 0) continue;
      const double v = v_[r], ip = 1 / sp_[r], im = 1 / sm_[r];
      over_p_[r] = ip;
      over_m_[r] = im;
      const double wp = zp_[r] * ip, wm = zm_[r] * im, w = wp + wm;
      const double pull =
          (mu * ip + wp * (v - acc_ + sp_[r])) - (mu * im + wm * (sm_[r] - v - acc_));
      g0 -= c0 * pull;
      g1 -= c1 * pull;
      g2 -= c2 * pull;
      const double w0 = w * c0, w1 = w * c1;
      h00 += w0 * c0;
      h01 += w0 * c1;
      h02 += w0 * c2;
      h11 += w1 * c1;
      h12 += w1 * c2;
      h22 += w * c2 * c2;
    }
    if (in.jerks > 0) {
      const JerkSide& side = side_[i];
      for (int k = 0; k < 3; ++k) {
        const double right = side.right[k];
        double weights = 0, pulls = 0, x0 = 0, x1 = 0, x2 = 0;
        for (std::int32_t j = 0; j < in.jerks; ++j, ++r) {
          const double c0 = rows.a0[r], c1 = rows.a1[r], c2 = rows.a2[r];
          const double v = v_[r], ip = 1 / sp_[r], im = 1 / sm_[r];
          over_p_[r] = ip;
          over_m_[r] = im;
          const double wp = zp_[r] * ip, wm = zm_[r] * im, w = wp + wm, dw = wp - wm;
          const double pp = mu * ip + wp * (v - right + sp_[r]),
                       pm = mu * im + wm * (sm_[r] - v - right);
          const double pull = pp - pm;
          weights += w;
          pulls += pp + pm;
          x0 += dw * c0;
          x1 += dw * c1;
          x2 += dw * c2;
          g0 -= c0 * pull;
          g1 -= c1 * pull;
          g2 -= c2 * pull;
          const double w0 = w * c0, w1 = w * c1;
          h00 += w0 * c0;
          h01 += w0 * c1;
          h02 += w0 * c2;
          h11 += w1 * c1;
          h12 += w1 * c2;
          h22 += w * c2 * c2;
        }
        const double s0 = side.slope[k][0], s1 = side.slope[k][1], s2 = side.slope[k][2];
        g0 += s0 * pulls;
        g1 += s1 * pulls;
        g2 += s2 * pulls;
        h00 += weights * s0 * s0 - 2 * x0 * s0;
        h01 += weights * s0 * s1 - x0 * s1 - x1 * s0;
        h02 += weights * s0 * s2 - x0 * s2 - x2 * s0;
        h11 += weights * s1 * s1 - 2 * x1 * s1;
        h12 += weights * s1 * s2 - x1 * s2 - x2 * s1;
        h22 += weights * s2 * s2 - 2 * x2 * s2;
      }
    }
    // Over m: b0 = l m[i-1] + r m[i], b2 = ll m[i] + rr m[i+1].
    const double l = left_[i], rt = right_[i], ll = left_[i + 1], rr = right_[i + 1];
    if (i > 0) {
      d0_[i - 1] += l * l * h00;
      d1_[i - 1] += l * (rt * h00 + h01 + ll * h02);
      d2_[i - 1] += l * rr * h02;
      dm_[i - 1] += l * g0;
    }
    d0_[i] += rt * (rt * h00 + 2 * h01 + 2 * ll * h02) + h11 + ll * (2 * h12 + ll * h22);
    d1_[i] += rr * (rt * h02 + h12 + ll * h22);
    d0_[i + 1] += rr * rr * h22;
    dm_[i] += rt * g0 + g1 + ll * g2;
    dm_[i + 1] += rr * g2;
  }
  const auto bound = [&](Bound& c) {
    const double g = c.at - c.top;
    if (c.price > 0) {
      c.weight = 1 / (c.s / c.z + c.t / c.y);
      c.pull = c.weight * (g + mu / c.z - mu / c.y);  // dz without a step
      return c.z + c.pull;
    }
    c.weight = c.z / c.s;
    c.off = g + c.s;
    return mu / c.s + c.weight * c.off;
  };
  for (std::size_t i = first_; i < last_; ++i)
    for (Bound* c : {&at_middle_[i], &wish_middle_[i]}) {
      if (!c->used()) continue;
      dm_[i] -= bound(*c);
      d0_[i] += c->weight;
    }
  const auto at_node = [&](std::size_t i, double h, double g) {
    const double l = left_[i], r = right_[i];
    d0_[i - 1] += h * l * l;
    d1_[i - 1] += h * l * r;
    d0_[i] += h * r * r;
    dm_[i - 1] += g * l;
    dm_[i] += g * r;
  };
  for (std::size_t i = 1; i < n_; ++i)
    for (Bound* c : {&at_node_[i], &wish_node_[i]}) {
      if (!c->used()) continue;
      const double g = bound(*c);
      at_node(i, c->weight, -g);
    }
  const auto rest = [&](std::size_t i, double length) {
    const double x = node_[i], t = 1.5 * length / (x * std::sqrt(x));
    at_node(i, 1.5 * t / x, t);
  };
  if (rests_) rest(1, rows[0].length);
  rest(n_ - 1, rows[n_ - 1].length);
}

bool LawNewton::factor_and_solve() noexcept {
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

void LawNewton::step_sizes(double mu) noexcept {
  const LawRows& rows = *rows_;
  // 1 over the largest step.
  double primal = kToBound, dual = kToBound;
  for (std::size_t i = rests_ ? 1 : 0; i < last_; ++i) {
    const LawInterval& in = rows[i];
    const double db0 = i == 0 ? 0 : left_[i] * dm_[i - 1] + right_[i] * dm_[i], db1 = dm_[i],
                 db2 = left_[i + 1] * dm_[i] + right_[i + 1] * dm_[i + 1];
    std::size_t r = in.row;
    const auto step = [&](double right, double dright) {
      const double dv = rows.a0[r] * db0 + rows.a1[r] * db1 + rows.a2[r] * db2;
      const double ip = over_p_[r], im = over_m_[r], zp = zp_[r], zm = zm_[r];
      const double dsp = right - v_[r] - sp_[r] - dv + dright,
                   dsm = right + v_[r] - sm_[r] + dv + dright;
      const double dzp = (mu - zp * dsp) * ip - zp, dzm = (mu - zm * dsm) * im - zm;
      dsp_[r] = dsp;
      dsm_[r] = dsm;
      dzp_[r] = dzp;
      dzm_[r] = dzm;
      primal = std::max({primal, -dsp * ip, -dsm * im});
      // Seldom, so that there is next to no division.
      if (-dzp > dual * zp) dual = -dzp / zp;
      if (-dzm > dual * zm) dual = -dzm / zm;
    };
    for (std::int32_t k = 0; k < in.accs; ++k, ++r)
      if (i > 0 || rows.a2[r] != 0) step(acc_, 0);
    if (in.jerks == 0) continue;
    const JerkSide& side = side_[i];
    for (int k = 0; k < 3; ++k) {
      const double dright =
          side.slope[k][0] * db0 + side.slope[k][1] * db1 + side.slope[k][2] * db2;
      for (std::int32_t j = 0; j < in.jerks; ++j, ++r) step(side.right[k], dright);
    }
  }
  const auto bound = [&](Bound& c, double dx) {
    if (!c.used()) return;
    if (c.price > 0) {
      c.dz = c.pull + c.weight * dx;
      c.ds = mu / c.z - c.s - c.s / c.z * c.dz;
      c.dt = mu / c.y - c.t + c.t / c.y * c.dz;
      primal = std::max({primal, -c.ds / c.s, -c.dt / c.t});
      dual = std::max({dual, -c.dz / c.z, c.dz / c.y});
      return;
    }
    c.ds = -c.off - dx;
    c.dz = (mu - c.z * c.ds) / c.s - c.z;
    primal = std::max(primal, -c.ds / c.s);
    dual = std::max(dual, -c.dz / c.z);
  };
  for (std::size_t i = first_; i < last_; ++i) {
    bound(at_middle_[i], dm_[i]);
    bound(wish_middle_[i], dm_[i]);
    primal = std::max(primal, -dm_[i] / m_[i] * (kToBound / kMostFall));
  }
  for (std::size_t i = 1; i < n_; ++i) {
    const double dx = left_[i] * dm_[i - 1] + right_[i] * dm_[i];
    bound(at_node_[i], dx);
    bound(wish_node_[i], dx);
  }
  primal_ = kToBound / primal;
  dual_ = kToBound / dual;
}

void LawNewton::move() noexcept {
  for (std::size_t i = first_; i < last_; ++i) m_[i] += primal_ * dm_[i];
  set_nodes();
  for (std::size_t r = 0; r < sp_.size(); ++r) {
    sp_[r] += primal_ * dsp_[r];
    sm_[r] += primal_ * dsm_[r];
    zp_[r] = std::max(zp_[r] + dual_ * dzp_[r], kLeastMultiplier);
    zm_[r] = std::max(zm_[r] + dual_ * dzm_[r], kLeastMultiplier);
  }
  for (Buffer<Bound>* all : {&at_middle_, &wish_middle_, &at_node_, &wish_node_})
    for (Bound& c : *all) {
      if (!c.used()) continue;
      c.s += primal_ * c.ds;
      c.z = std::max(c.z + dual_ * c.dz, kLeastMultiplier);
      if (c.price <= 0) continue;
      c.t += primal_ * c.dt;
      c.y = std::max(c.y - dual_ * c.dz, kLeastMultiplier);
    }
}

bool LawNewton::run(const Aim& aim) noexcept {
  iterations_ = 0;
  acc_ = aim.acc;
  jerk_ = aim.jerk;
  const std::size_t rows = sp_.size() * 2 + 4 * n_;
  double before = seconds();
  double mu = aim.mu * before / static_cast<double>(rows);
  start_slacks(mu);
  look();
  for (; iterations_ < aim.iterations; ++iterations_) {
    build(mu);
    if (!factor_and_solve()) return false;
    step_sizes(mu);
    move();
    look();
    const double now = seconds(), step = std::min(primal_, dual_);
    const bool settled = std::abs(now - before) < 3e-3 * now;
    before = now;
    if (!waits_ && sum_ < aim.gap * now && worst_ < aim.violation && settled && step > 0.3)
      return true;
    if (!std::isfinite(now) || primal_ < kStalled) return false;
    const double terms = static_cast<double>(terms_);
    if (waits_ && worst_ < aim.violation && step > 0.3) {
      waits_ = false;
      sinks_ = true;
      mu = kRecentre * now / terms;
      wish_truly(mu);
      look();
      continue;
    }
    const double shrink = step > 0.9 ? 0.1 : step > 0.5 ? 0.3 : step > 0.2 ? 0.7 : 1.2;
    mu = shrink * sum_ / terms;
    if (waits_) mu = std::max(mu, kRough * now / terms);
  }
  return false;
}

}  // namespace kerf::motion::path
