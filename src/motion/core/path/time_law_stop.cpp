#include "motion/core/path/time_law_stop.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/ramp.hpp"

namespace kerf::motion::path {
namespace {

/// Below this share of its first x a motion that has not found its rest will not find it.
constexpr double kStill = 1e-6;
/// Steps, as a share of x over the acceleration of a straight; and the least one, as a share of the widest.
constexpr double kStep = 0.12, kLeastStep = 0.03;
/// Shares of the way to rest: a new step, and one that is too long; never shorter than this share of the widest.
constexpr double kOfRest = 0.14, kMostOfRest = 0.2, kLeastOfRest = 2e-4, kTooLong = 1.4;
/// What x keeps of b1 over an interval, and where b2 is looked for at first.
constexpr double kLeastLeft = 0.02, kFirstLeft = 0.1;
/// Share of the limits with which the way back is tried: another grid may need a little more. With 0.996 braking failed three times as often.
constexpr double kTry = 0.9995;
/// What jerk allows is looked at again where b2 is farther than that from where it was looked for (of b1).
constexpr double kSameB2 = 0.04;
/// An interval is halved so often at most where its jerk rows leave no room for the law: by more than this share.
constexpr int kNarrower = 2;
constexpr double kRoom = 0.01;
/// Back at the law but for that.
constexpr double kBack = 1e-9;
/// What would need so many times the jerk of a straight all along will not find its rest.
constexpr double kLost = 1.5;
/// Even jerk as a share of what a straight could do, above which it is not looked at.
constexpr double kEven = 1.02;
/// How near to what does not lead on what is taken has to be, as a share of the range of b2.
constexpr double kNarrow = 0.07;
/// Intervals that are taken at once before it is tried what leads on from there: at first, and most.
constexpr std::size_t kFirstFall = 8, kMostFall = 16;
/// Before that, so much of the way on which a straight's stop brakes until it lets go.
constexpr double kBrakesAtLeast = 0.9;
/// Braking ends where a try comes to no end that is sooner by this share, when the soonest is nearer than so many times a stop on a straight.
constexpr double kSooner = 0.998;
constexpr double kSoonEnough = 1.05;

}  // namespace

bool LawStop::create(Memory& memory, std::size_t intervals) noexcept {
  // Nodes have no values before they are reached.
  for (Buffer<double>* b : {&at_, &x_, &u_, &jerk_}) {
    if (!b->create(memory, intervals + 1)) return false;
    b->assign(intervals + 1, 0);
  }
  if (!along_.create(memory, intervals + 1) || !steps_.create(memory, intervals + 1)) return false;
  along_.assign(intervals + 1, LawPoint{});
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

void LawStop::by_rows(std::size_t r, std::size_t end, const double b[3], double share,
                      Range& range) const noexcept {
  const LawRows& rows = *rows_;
  const double *mid0 = rows.mid0.begin(), *mid1 = rows.mid1.begin(), *half = rows.half.begin();
  double low = range.low, high = range.high, low2 = low, high2 = high;
  for (; r + 1 < end; r += 2) {
    const double m = mid0[r] * b[0] + mid1[r] * b[1], h = share * half[r];
    const double m2 = mid0[r + 1] * b[0] + mid1[r + 1] * b[1], h2 = share * half[r + 1];
    low = std::max(low, m - h), high = std::min(high, m + h);
    low2 = std::max(low2, m2 - h2), high2 = std::min(high2, m2 + h2);
  }
  if (r < end) {
    const double m = mid0[r] * b[0] + mid1[r] * b[1], h = share * half[r];
    low = std::max(low, m - h), high = std::min(high, m + h);
  }
  range.low = std::max(low, low2);
  range.high = std::min(high, high2);
}

void LawStop::by_acc(std::size_t i, const double b[3], double share, Range& range) const noexcept {
  const LawInterval& in = (*rows_)[i];
  by_rows(in.row, in.row + static_cast<std::size_t>(in.accs), b, share, range);
}

void LawStop::by_jerk(std::size_t i, const double b[3], double share, Range& range) const noexcept {
  const LawInterval& in = (*rows_)[i];
  const double xm = (b[0] + 2 * b[1] + b[2]) / 4, right = share / std::sqrt(xm),
               over = 1 / (2 * xm);
  std::size_t r = in.row + static_cast<std::size_t>(in.accs);
  const auto jerks = static_cast<std::size_t>(in.jerks);
  range.whole = range.whole && !in.bounds_u;
  for (int k = 0; k < 3; ++k, r += jerks)
    by_rows(r, r + jerks, b, right * (1.5 - b[k] * over), range);
}

/// The place of node i, and the law there.
void LawStop::look_along(std::size_t i) noexcept {
  at_[i] = at_[i - 1] + (*rows_)[i - 1].length;
  const double at = law_.from + at_[i];
  while (law_at_ > 0 && law_begins_ > at) law_begins_ -= law_.step[--law_at_].length;
  while (law_at_ < law_.count && law_begins_ + law_.step[law_at_].length < at)
    law_begins_ += law_.step[law_at_++].length;
  // Behind its end it leads nowhere.
  along_[i] =
      law_at_ < law_.count ? at_place(law_.step[law_at_], at - law_begins_) : LawPoint{0, kNoLimit};
}

/// u / x of the law at node i. Where it gains speed an even one leads on as well, mostly.
double LawStop::slope(std::size_t i) const noexcept {
  if (!(along_[i].x > 0)) return kNoLimit;
  const double slope = along_[i].u / along_[i].x;
  return follows_ ? slope : std::min(slope, 0.0);
}

/// Whether the rows of interval i, which ask for more than the path does, the more the longer it is, leave room for the law.
bool LawStop::holds_law(std::size_t i) const noexcept {
  const LawPoint& from = along_[i];
  const double b[3] = {from.x, from.x + from.u * (*rows_)[i].length, along_[i + 1].x};
  if (!(b[1] > 0 && b[2] > 0)) return true;
  return rows_->jerk_excess(i, b) <= kRoom;
}

/// The b2 with which interval i leads back to the law.
double LawStop::back_at_law(std::size_t i) const noexcept {
  const double d = (*rows_)[i].length, left = 1 - slope(i + 1) * d;
  return left > kLeastLeft ? (x_[i] + u_[i] * d) / left : kNoLimit;
}

double LawStop::rest_way(std::size_t i) const noexcept {
  return u_[i] < 0 ? -2 * x_[i] / (3 * u_[i]) : kNoLimit;
}

/// What it would take from node i.
Ramp LawStop::straight_stop(std::size_t i) const noexcept {
  double acc = 0, jerk = 0;
  rows_->straightest(i, acc, jerk);
  return ramp_to({std::sqrt(x_[i]), u_[i]}, 0, {acc, jerk});
}

bool LawStop::add_step(std::size_t i, double step) noexcept {
  for (int k = 0;; ++k) {
    if (!rows_->add_step(step)) return false;
    look_along(i + 1);
    if (k == kNarrower || holds_law(i)) return true;
    step = (*rows_)[i].length / 2;
    rows_->take_back(i);
  }
}

/// Makes interval i where there is none; where it is too long for what is left to rest, anew. False: the window ends.
bool LawStop::step_ahead(std::size_t i) noexcept {
  LawRows& rows = *rows_;
  const double rest = rest_way(i), finest = kLeastOfRest * widest_;
  if (i < rows.size() && i > 0 && rows[i].length > std::max(kMostOfRest * rest, kTooLong * finest))
    rows.take_back(i);
  if (i < rows.size()) return true;
  double acc = 0, jerk = 0;
  rows.straightest(i - 1, acc, jerk);
  jerk_[i] = jerk;
  double step = std::clamp(kStep * x_[i] / acc, kLeastStep * widest_, widest_);
  step = std::min(step, std::max(kOfRest * rest, finest));
  return add_step(i, step);
}

/// Interval i has these coefficients; gives its w.
void LawStop::take(std::size_t i, const double b[3], double& w) noexcept {
  const double d = (*rows_)[i].length;
  w = (b[2] - 2 * b[1] + b[0]) / (d * d);
  x_[i + 1] = b[2];
  u_[i + 1] = (b[2] - b[1]) / d;
}

/// Interval i with the b2 that is nearest to what is wanted. `w`: of the one before, then of this one. False: no limits are kept so.
bool LawStop::reach(std::size_t i, double wanted, double share, double& w) noexcept {
  const double d = (*rows_)[i].length;
  double b[3] = {x_[i], x_[i] + u_[i] * d, 0};
  if (!(b[1] > 0)) return false;
  b[2] = std::max(b[1] + (u_[i] + w * d) * d, kFirstLeft * b[1]);
  Range acc;
  by_acc(i, b, share, acc);
  // What jerk allows depends on b2 a little.
  bool whole = false;
  for (int k = 0; k < 2; ++k) {
    Range range = acc;
    by_jerk(i, b, share, range);
    const double before = b[2];
    b[2] = std::max(range.clamp(wanted), kLeastLeft * b[1]);
    whole = range.whole && range.low <= range.high;
    if (std::abs(b[2] - before) < kSameB2 * b[1]) break;
  }
  take(i, b, w);
  // What is only tried is certified when it becomes a stop.
  return (share < 1 && whole) || kept(i);
}

/// Even jerk leads to rest from node i: the motion that has come there is a stop. False: it does not keep the limits.
bool LawStop::end_at(std::size_t i) noexcept {
  double t = t_;
  for (std::size_t k = settled_; k < i; ++k)
    t += 2 * (*rows_)[k].length / (std::sqrt(x_[k]) + std::sqrt(x_[k + 1]));
  t += 3 * rest_way(i) / std::sqrt(x_[i]);
  if (t < best_)
    for (std::size_t k = settled_; k < i; ++k)
      if (!kept(k)) return false;
  soonest_ = std::min(soonest_, t);
  if (t >= best_) return true;
  best_ = t;
  // What is settled stays as it is.
  steps_.truncate(std::min(kept_, settled_));
  for (std::size_t k = steps_.size(); k <= i; ++k) {
    const LawInterval& in = (*rows_)[k];
    const double d = k < i ? in.length : rest_way(i);
    steps_.push_back({in.stretch, in.from, d, {x_[k], x_[k] + u_[k] * d, k < i ? x_[k + 1] : 0}});
  }
  kept_ = settled_;
  return true;
}

/// Whether the motion can get back to the law from node i.
bool LawStop::leads_on(std::size_t i, double w) noexcept {
  for (; i + 1 < x_.size() && x_[i] > kStill * x_[0]; ++i) {
    narrow_ = i;
    if (u_[i] >= slope(i) * x_[i] - kBack * std::abs(slope(i) * x_[i])) return true;
    if (!step_ahead(i)) return false;
    const double jerk = u_[i] * u_[i] / (2 * std::sqrt(x_[i]));
    if (u_[i] < 0 && jerk < kEven * jerk_[i] && x_[i] <= rows_->stop_cap(i, rest_way(i)))
      return end_at(i);
    if (u_[i] < 0 && jerk > kLost * jerk_[i]) return false;
    if (!reach(i, back_at_law(i), kTry, w)) return false;
  }
  return false;
}

/// So many intervals from i on, or until `way` from the start: down as far as the rows allow, or back to the law. False: that does not lead on.
bool LawStop::go(std::size_t i, bool down, double way, std::size_t& count, double& w) noexcept {
  double now = w;
  const std::size_t first = i;
  for (const std::size_t end = i + count; i < end && (i == first || at_[i] < way); ++i) {
    if (i + kMostFall + 1 >= x_.size() || (i > 0 && !step_ahead(i)) ||
        !reach(i, down ? -kNoLimit : back_at_law(i), 1, now)) {
      count = i + 1 - first;
      return false;
    }
  }
  count = i - first;
  if (!leads_on(i, now)) return false;
  w = now;
  return true;
}

/// Interval i: down as far as it leads on, when that is less than the rows allow; `again`: the one before is such a one. `back`: so many behind it may go on back to the law
/// before what is lower than that comes to its end. False: nothing leads on.
bool LawStop::hold(std::size_t i, bool again, std::size_t& back, double& w) noexcept {
  double now = w;
  (void)reach(i, -kNoLimit, 1, now);
  const double lowest = x_[i + 1];
  now = w;
  if (!reach(i, back_at_law(i), 1, now)) return false;
  const double range = x_[i + 1] - lowest;
  const auto tried = [&](double share) {
    now = w;
    return reach(i, lowest + share * range, 1, now) && leads_on(i + 1, now);
  };
  // Between what does not lead on and what does.
  double low = 0, high = 1;
  bool sure = false;
  const auto look = [&](double share) {
    const bool leads = tried(share);
    (leads ? high : low) = share;
    sure = sure || leads;
    return leads;
  };
  // Behind an interval that has been held already hardly anything but the way back leads on.
  if (again) (void)look(1 - 0.99 * kNarrow);
  while (high - low > kNarrow) (void)look((low + high) / 2);
  const std::size_t narrow = narrow_;
  if (!sure && !tried(1)) return false;
  back = again && high == 1 && narrow > i + 2 ? narrow - i - 2 : 0;
  (void)reach(i, lowest + high * range, 1, w);
  return true;
}

/// Interval i as the soonest stop has it. False: that one is elsewhere.
bool LawStop::go_on_with_best(std::size_t i, double& w) noexcept {
  if (steps_.size() <= i + 1) return false;
  for (std::size_t k = std::min(kept_, i); k <= i; ++k) {
    const Step& step = steps_[k];
    const LawInterval& in = (*rows_)[k];
    if (step.stretch != in.stretch || step.from != in.from || step.length != in.length)
      return false;
    double b[3];
    coefficients(k, b);
    if (step.b[0] != b[0] || step.b[1] != b[1] || (k < i && step.b[2] != b[2])) return false;
  }
  take(i, steps_[i].b, w);
  return true;
}

bool LawStop::kept(std::size_t i) const noexcept {
  double b[3];
  coefficients(i, b);
  if (!(b[0] > 0 && b[1] > 0 && b[2] > 0)) return false;
  const LawExcess e = rows_->excess(i, b, i == 0);
  return e.vel <= aim_.most.vel && e.acc <= aim_.most.acc && e.jerk <= aim_.most.jerk;
}

bool LawStop::run(LawRows& rows, double way, double x0, double u0, const LawAlong& law,
                  const Aim& aim) noexcept {
  rows_ = &rows;
  aim_ = aim;
  law_ = law;
  best_ = kNoLimit;
  steps_.clear();
  for (const double widest : aim.widest) {
    if (best_ <= aim.enough_s) break;
    widest_ = widest;
    for (const bool follows : {false, true}) {
      if (follows && best_ < kNoLimit) break;
      follows_ = follows;
      rows.make_stepwise(way);
      x_[0] = x0;
      u_[0] = u0;
      along_[0] = {x0, u0};
      brake();
    }
  }
  return best_ < kNoLimit;
}

/// On one grid.
void LawStop::brake() noexcept {
  const LawRows& rows = *rows_;
  law_at_ = settled_ = kept_ = 0;
  law_begins_ = t_ = 0;
  soonest_ = kNoLimit;
  if (!add_step(0, widest_)) return;
  // As far as it certainly brakes in one go.
  RampState state{std::sqrt(x_[0]), u_[0]};
  Ramp straight = straight_stop(0);
  straight.seconds[2] = 0;
  double way = kBrakesAtLeast * straight.distance(state);
  double w = 0, before = kNoLimit;
  std::size_t count = x_.size();
  std::size_t lost = 0;  // falling from here to there has been tried and does not lead on
  bool held = false;
  while (settled_ + kMostFall + 1 < x_.size()) {
    const std::size_t i = settled_;
    std::size_t taken = count, back = 0;
    if (i + 1 != lost && go(i, true, way, count, w)) {
      taken = count;
      held = false;
      if (way < kNoLimit)
        count = kFirstFall;
      else
        count = lost > i + count ? (lost - i - count + 1) / 2 : std::min(2 * count, kMostFall);
    } else if (i + 1 != lost && count > 1) {
      lost = i + count;
      count /= 2;
      continue;
    } else if (hold(i, held, back, w)) {
      taken = count = 1;
      lost = 0;
      // Half of it at once: something lower may lead on from there.
      back = (back + 1) / 2;
      if (back > 0 && go(i + 1, false, kNoLimit, back, w)) taken += back;
      held = true;
    } else if (go_on_with_best(i, w)) {
      taken = count = 1;
      lost = 0;
    } else {
      return;
    }
    way = kNoLimit;
    for (; taken > 0; --taken, ++settled_)
      t_ += 2 * rows[settled_].length / (std::sqrt(x_[settled_]) + std::sqrt(x_[settled_ + 1]));
    if (t_ > best_ || !step_ahead(settled_)) return;
    // A crawl far ahead says nothing of what is nearer.
    if ((held || soonest_ >= kSooner * before) &&
        soonest_ - t_ < kSoonEnough * straight_stop(settled_).duration())
      return;
    before = soonest_;
  }
}

}  // namespace kerf::motion::path
