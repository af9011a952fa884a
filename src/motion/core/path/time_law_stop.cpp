#include "motion/core/path/time_law_stop.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

constexpr int kPasses = 8;
/// Below this share of its first x a motion that has not found its rest will not find it.
constexpr double kStill = 1e-6;
/// Of the jerk of a straight: what is counted on for the way to rest at least.
constexpr double kLeastEven = 0.05;
/// A jerk row in which b2 counts less than that beside b1 bounds u, not w.
constexpr double kNoW = 1e-3;
/// A place at which no w would do: steps towards a u at which one does, how far beyond it, and how much larger u may become in one (of the
/// acceleration of a straight).
constexpr int kRootSteps = 4;
constexpr double kBeyondRoot = 1.02, kMostMore = 0.5;
/// u is never held above this share of that acceleration, and not at all below this share of the first x.
constexpr double kMostLow = 0.5, kSlow = 0.03;
/// Steps, as a share of x over the acceleration of a straight; and the least one, as a share of the widest.
constexpr double kStep = 0.12, kLeastStep = 0.03;
/// Shares of the way to rest: a new step, and one that is too long; never shorter than this share of the widest.
constexpr double kOfRest = 0.14, kMostOfRest = 0.2, kLeastOfRest = 2e-4, kTooLong = 1.4;
/// What x keeps of b1 over an interval, and where b2 is looked for at first.
constexpr double kLeastLeft = 0.02, kFirstLeft = 0.1;

}  // namespace

bool LawStop::create(Memory& memory, std::size_t intervals) noexcept {
  for (Buffer<double>* b : {&at_, &x_, &u_, &low_, &even_, &old_at_, &old_low_, &old_even_})
    if (!b->create(memory, intervals + 2)) return false;
  return true;
}

double LawStop::Range::clamp(double b) const noexcept {
  return low <= high ? std::clamp(b, low, high) : (low + high) / 2;
}

void LawStop::coefficients(std::size_t i, double b[3]) const noexcept {
  b[0] = x_[i];
  b[1] = x_[i] + u_[i] * (*rows_)[i].length;
  b[2] = x_[i + 1];
}

void LawStop::by_acc(std::size_t i, const double b[3], Range& range) const noexcept {
  const LawRows& rows = *rows_;
  const LawInterval& in = rows[i];
  for (std::size_t r = in.row; r < in.row + static_cast<std::size_t>(in.accs); ++r) {
    const double a2 = rows.a2[r];
    if (a2 == 0) continue;
    const double over = 1 / a2, half = std::abs(over);
    const double middle = -over * (rows.a0[r] * b[0] + rows.a1[r] * b[1]);
    range.low = std::max(range.low, middle - half);
    range.high = std::min(range.high, middle + half);
  }
}

void LawStop::by_jerk(std::size_t i, const double b[3], double share, Side side,
                      Range& range) const noexcept {
  const LawRows& rows = *rows_;
  const LawInterval& in = rows[i];
  const double xm = (b[0] + 2 * b[1] + b[2]) / 4, right = share / std::sqrt(xm);
  std::size_t r = in.row + static_cast<std::size_t>(in.accs);
  for (int k = 0; k < 3; ++k) {
    const double limit = side == Side::middle ? right : right * (1.5 - b[k] / (2 * xm));
    for (std::int32_t j = 0; j < in.jerks; ++j, ++r) {
      const double a1 = rows.a1[r], a2 = rows.a2[r];
      if (std::abs(a2) < kNoW * std::abs(a1)) continue;
      const double over = 1 / a2, half = limit * std::abs(over);
      const double middle = -over * (rows.a0[r] * b[0] + a1 * b[1]);
      if (middle - half > range.low) range.low = middle - half, range.low_slope = -a1 * over;
      if (middle + half < range.high) range.high = middle + half, range.high_slope = -a1 * over;
    }
  }
}

/// The least u at the end of an interval where it passes with x.
double LawStop::acc_bound(std::size_t i, double x) const noexcept {
  const LawRows& rows = *rows_;
  const LawInterval& in = rows[i];
  double low = -kNoLimit;
  // The last Bernstein coefficient of each axis is over b1 and b2 only: (a1 + a2) x - a1 D u.
  for (std::size_t r = in.row; r < in.row + static_cast<std::size_t>(in.accs); ++r) {
    const double p = -rows.a1[r] * in.length, e = rows.a1[r] + rows.a2[r];
    if (rows.a0[r] == 0 && p != 0)
      low = std::max(low, (-aim_.acc - std::copysign(1.0, p) * e * x) / std::abs(p));
  }
  return low;
}

/// What is known of the place of a new node: from the last pass, else what a straight could do.
void LawStop::hold_back(std::size_t i) noexcept {
  double acc = 0, jerk = 0;
  rows_->straightest(i - 1, acc, jerk);
  at_[i] = at_[i - 1] + (*rows_)[i - 1].length;
  low_[i] = -aim_.acc * acc;
  even_[i] = aim_.jerk * jerk;
  while (seen_ + 1 < old_at_.size() && old_at_[seen_] < at_[i - 1]) ++seen_;
  for (std::size_t k = seen_; k < old_at_.size(); ++k) {
    low_[i] = std::max(low_[i], old_low_[k]);
    even_[i] = std::min(even_[i], old_even_[k]);
    if (old_at_[k] >= at_[i]) break;
  }
}

/// Makes interval i where there is none; where it is too long for what is left to rest, anew. False: the window ends.
bool LawStop::step_ahead(std::size_t i, double rest_way) noexcept {
  LawRows& rows = *rows_;
  const double finest = kLeastOfRest * aim_.widest;
  if (i < rows.size() && i > 0 &&
      rows[i].length > std::max(kMostOfRest * rest_way, kTooLong * finest))
    rows.take_back(i);
  if (i < rows.size()) return true;
  double acc = 0, jerk = 0;
  rows.straightest(i - 1, acc, jerk);
  const double step = std::clamp(kStep * x_[i] / acc, kLeastStep * aim_.widest, aim_.widest);
  if (!rows.add_step(std::min(step, std::max(kOfRest * rest_way, finest)))) return false;
  hold_back(i + 1);
  return true;
}

/// Interval i: down as far as it leads on. `w`: of the one before, then of this one. False: nothing keeps the limits.
bool LawStop::take(std::size_t i, double& w) noexcept {
  const double d = (*rows_)[i].length;
  double b[3] = {x_[i], x_[i] + u_[i] * d, 0};
  b[2] = std::max(b[1] + (u_[i] + w * d) * d, kFirstLeft * b[1]);
  Range acc;
  by_acc(i, b, acc);
  bool any = true;
  // What jerk allows depends on b2 a little.
  for (int k = 0; k < 2; ++k) {
    const double least = std::max(low_[i + 1], -std::sqrt(2 * even_[i + 1] * std::sqrt(b[2])));
    Range range = acc;
    by_jerk(i, b, 1, Side::safe, range);
    any = range.low <= range.high;
    b[2] = std::max(range.clamp(b[1] + least * d), kLeastLeft * b[1]);
  }
  w = (b[2] - 2 * b[1] + b[0]) / (d * d);
  x_[i + 1] = b[2];
  u_[i + 1] = (b[2] - b[1]) / d;
  return any || kept(i);
}

bool LawStop::forwards() noexcept {
  LawRows& rows = *rows_;
  double t = 0, best = kNoLimit, w = 0;
  reached_ = seen_ = 0;
  for (std::size_t i = 0; i + 1 < x_.size() && x_[i] > kStill * x_[0]; ++i) {
    const double x = x_[i], u = u_[i];
    const double rest_way = u < 0 ? -2 * x / (3 * u) : kNoLimit;
    if (!step_ahead(i, rest_way)) break;
    const double total = t + 3 * rest_way / std::sqrt(x);
    if (total < best && x <= rows.stop_cap(i, rest_way)) {
      best = total;
      end_ = i;
      way_ = rest_way;
    }
    if (t > best || !(x + u * rows[i].length > 0)) break;
    const bool keeps = take(i, w);
    reached_ = i + 1;
    // Behind a place at which nothing keeps the limits there is nothing to learn.
    if (!keeps) break;
    t += 2 * rows[i].length / (std::sqrt(x) + std::sqrt(x_[i + 1]));
  }
  return best < kNoLimit;
}

/// What interval i asks of the nodes before it.
void LawStop::learn(std::size_t i) noexcept {
  const double d = (*rows_)[i].length;
  double b[3], acc = 0, jerk = 0;
  coefficients(i, b);
  rows_->straightest(i, acc, jerk);
  Range range;
  by_jerk(i, b, aim_.jerk, Side::safe, range);
  // Where no w would do at this u, it has to be larger.
  double u = -kNoLimit;
  for (int k = 0; k < kRootSteps && range.low > range.high; ++k) {
    const double slope = range.high_slope - range.low_slope;
    const double more = kBeyondRoot * (range.low - range.high) / slope;
    if (!(slope > 0) || !(more < kMostMore * acc * d)) break;
    b[1] += more;
    b[2] += 2 * more;
    u = (b[1] - b[0]) / d;
    range = Range{};
    by_jerk(i, b, aim_.jerk, Side::safe, range);
  }
  const auto w_of = [&](const Range& r) { return (r.high - 2 * b[1] + b[0]) / (d * d); };
  Range evenly;
  by_jerk(i, b, aim_.jerk, Side::middle, evenly);
  even_[i] = std::clamp(w_of(evenly) * std::sqrt((b[0] + 2 * b[1] + b[2]) / 4), kLeastEven * jerk,
                        aim_.jerk * jerk);
  low_[i + 1] = std::max(low_[i + 1], acc_bound(i, x_[i + 1]));
  low_[i] = std::min(std::max(low_[i + 1] - w_of(range) * d, u), kMostLow * acc);
  if (x_[i] < kSlow * x_[0]) low_[i] = -kNoLimit;
}

void LawStop::backwards() noexcept {
  const double behind = low_[reached_];
  low_[reached_] = -kNoLimit;
  for (std::size_t i = reached_; i-- > 0;) learn(i);
  low_[reached_] = std::max(low_[reached_], behind);
  // The least on the way to rest.
  for (std::size_t i = 0; i < reached_; ++i) {
    double way = u_[i] < 0 ? -2 * x_[i] / (3 * u_[i]) : 0;
    for (std::size_t k = i; k < reached_ && way > 0; ++k) {
      even_[i] = std::min(even_[i], even_[k]);
      way -= (*rows_)[k].length;
    }
  }
  remember();
}

void LawStop::remember() noexcept {
  const std::size_t n = rows_->size() + 1;
  const auto copy = [n](const Buffer<double>& from, Buffer<double>& to) {
    to.assign(n, 0);
    std::copy(from.begin(), from.begin() + n, to.begin());
  };
  copy(at_, old_at_);
  copy(low_, old_low_);
  copy(even_, old_even_);
}

bool LawStop::kept(std::size_t i) const noexcept {
  double b[3];
  coefficients(i, b);
  if (!(b[0] > 0 && b[1] > 0 && b[2] > 0)) return false;
  const LawExcess e = rows_->excess(i, b, i == 0);
  return e.vel <= aim_.most.vel && e.acc <= aim_.most.acc && e.jerk <= aim_.most.jerk;
}

bool LawStop::certified() const noexcept {
  for (std::size_t i = 0; i < end_; ++i)
    if (!kept(i)) return false;
  return true;
}

bool LawStop::run(LawRows& rows, double way, double x0, double u0, const Aim& aim) noexcept {
  rows_ = &rows;
  aim_ = aim;
  rows.make_stepwise(way);
  for (Buffer<double>* b : {&at_, &x_, &u_, &low_, &even_}) b->assign(rows.most() + 1, 0);
  for (Buffer<double>* b : {&old_at_, &old_low_, &old_even_}) b->clear();
  seen_ = 0;
  passes_ = 0;
  x_[0] = x0;
  u_[0] = u0;
  if (!rows.add_step(aim.widest)) return false;
  hold_back(1);
  std::size_t before = 0;
  double last = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    passes_ = pass;
    const bool found = forwards();
    if (found && certified()) return true;
    // Nothing new.
    if (reached_ == before && x_[reached_] == last) return false;
    before = reached_;
    last = x_[reached_];
    backwards();
  }
  return false;
}

}  // namespace kerf::motion::path
