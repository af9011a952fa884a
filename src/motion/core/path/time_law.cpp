#include "motion/core/path/time_law.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

constexpr double kMostVel = 1e-4, kMostAcc = 5e-4, kMostJerk = 5e-3;
/// |w| t^2 below which the series of LawStep::Kind::spline is used.
constexpr double kSeries = 1e-4;
/// The first guess: shares of speed, and of acceleration and jerk of a straight.
constexpr double kGuessSpeed = 0.8, kGuessAcc = 0.75, kGuessJerk = 0.15;

double seconds_of(const LawStep& step, double x1) noexcept {
  const double sum = std::sqrt(step.x) + std::sqrt(x1);
  const double k = std::sqrt(std::abs(step.w)), arg = k * step.length / sum;
  if (arg * arg < kSeries) {
    const double z = step.w * step.length * step.length / (sum * sum);
    return 2 * step.length / sum * (1 + z / 3 + z * z / 5);
  }
  return 2 / k * (step.w > 0 ? std::atanh(std::min(arg, 1 - 1e-15)) : std::atan(arg));
}

}  // namespace

LawState at(const LawStep& step, double t) noexcept {
  LawState out;
  if (step.kind != LawStep::Kind::spline) {
    const bool start = step.kind == LawStep::Kind::start;
    const double r = start ? t / step.seconds : 1 - t / step.seconds;
    out.s = start ? step.length * r * r * r : step.length * (1 - r * r * r);
    out.speed = 3 * step.length * r * r / step.seconds;
    out.acc = (start ? 6 : -6) * step.length * r / (step.seconds * step.seconds);
    return out;
  }
  const double v = std::sqrt(step.x), z = step.w * t * t;
  if (std::abs(z) < kSeries) {
    out.s = v * t * (1 + z / 6 * (1 + z / 20)) + 0.5 * step.u * t * t * (1 + z / 12 * (1 + z / 30));
    out.speed = v * (1 + z / 2 * (1 + z / 12)) + step.u * t * (1 + z / 6 * (1 + z / 20));
  } else if (step.w > 0) {
    const double k = std::sqrt(step.w), sinh = std::sinh(k * t), half = std::sinh(0.5 * k * t);
    out.s = v / k * sinh + 2 * step.u / step.w * half * half;
    out.speed = v * (1 + 2 * half * half) + step.u / k * sinh;
  } else {
    const double k = std::sqrt(-step.w), sin = std::sin(k * t), half = std::sin(0.5 * k * t);
    out.s = v / k * sin - 2 * step.u / step.w * half * half;
    out.speed = v * (1 - 2 * half * half) + step.u / k * sin;
  }
  out.acc = step.w * out.s + step.u;
  return out;
}

bool TimeLaw::create(Memory& memory, std::size_t intervals) noexcept {
  return rows_.create(memory, intervals) && newton_.create(memory, intervals) &&
         law_.create(memory, intervals) && x_.create(memory, intervals + 1);
}

void TimeLaw::begin(const AxisLimits& limits) noexcept {
  rows_.begin(limits);
  next_guess_ = 0;
}

bool TimeLaw::add(std::uint64_t number, const Piece& piece, double from, double to, double span_end,
                  double cap, double wish, int fineness) noexcept {
  LawStretch s;
  s.piece = piece;
  s.from = from;
  s.to = to;
  s.span_end = span_end;
  s.cap = cap;
  s.wish = wish;
  s.guess = next_guess_;
  s.number = number;
  s.fineness = fineness;
  next_guess_ = 0;
  return !(to > from) || rows_.add(s);
}

void TimeLaw::guess_nodes(const Start& start, bool with_given) noexcept {
  const std::size_t n = rows_.size();
  const bool rests = start.x <= 0;
  x_.assign(n + 1, 0);
  x_[0] = start.x;
  const auto even = [&](std::size_t i) {
    return kGuessSpeed * std::min(rows_.even_cap(i), rows_[i].wish);
  };
  for (std::size_t i = 1; i < n; ++i) {
    x_[i] = std::min(
        {even(i - 1), even(i), i > 1 ? even(i - 2) : kNoLimit, i + 1 < n ? even(i + 1) : kNoLimit});
    if (with_given && rows_[i].guess > 0) x_[i] = 0.99 * rows_[i].guess;
  }
  // x grows like it does from a stop, by a power 4/3 of the way, and by 2 A D at most.
  double acc = 0, jerk = 0;
  const auto grow = [&](std::size_t from, std::size_t to, std::size_t way_of) {
    if (with_given && rows_[to].guess > 0) return;
    rows_.straightest(way_of, acc, jerk);
    const double d = rows_[way_of].length, j = kGuessJerk * std::min(jerk, 1e12);
    const double s = std::sqrt(2 * x_[from] * std::sqrt(x_[from]) / (9 * j)) + d;
    const double by_jerk = std::cbrt(20.25 * j * j * s * s * s * s);
    x_[to] = std::min({x_[to], by_jerk, x_[from] + 2 * kGuessAcc * acc * d});
  };
  for (std::size_t i = n; i-- > 1;) grow(i + 1, i, i);
  if (rests) {
    for (std::size_t i = 1; i < n; ++i) grow(i - 1, i, i - 1);
    return;
  }
  // From a moving state: between the hardest braking and the hardest driving.
  double low = start.x, high = start.x, ul = start.u, uh = start.u;
  for (std::size_t i = 1; i < n; ++i) {
    rows_.straightest(i - 1, acc, jerk);
    const double d = rows_[i - 1].length;
    const double jl = jerk * d / std::sqrt(std::max(low, 1e-12)), jh = jerk * d / std::sqrt(high);
    ul = std::max(ul - 0.7 * jl, -0.9 * acc);
    uh = std::min(uh + 0.7 * jh, 0.9 * acc);
    low = std::max(low + 2 * ul * d, 0.0);
    high += 2 * uh * d;
    if (!(with_given && rows_[i].guess > 0)) x_[i] = std::clamp(x_[i], low, std::max(low, high));
    if (low <= 0 && high > 1e12) break;
  }
}

TimeLaw::Result TimeLaw::solve(const Start& start) noexcept {
  iterations_ = 0;
  if (rows_.stretches().empty()) return Result::failed;
  if (!rows_.make(start.x, start.u)) return Result::full;
  return attempt(start);
}

TimeLaw::Result TimeLaw::attempt(const Start& start) noexcept {
  const bool rests = start.x <= 0;
  bool given = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) given = given || rows_[i].guess > 0;
  LawNewton::Aim aim;
  for (int round = 0; round < 4; ++round) {
    newton_.begin(rows_, start.x, start.u);
    guess_nodes(start, given && round < 2);
    for (std::size_t i = 1; i < rows_.size(); ++i) newton_.guess(i, x_[i]);
    // From rest any profile that is slow enough is feasible.
    aim.share = round == 0 || rests ? 0.998 : 0.9998;
    aim.mu = round < 2 ? 1e-2 : 1e-1;
    newton_.start(rests && !(given && round < 2), aim.share);
    const bool ok = newton_.run(aim);
    iterations_ += newton_.iterations();
    if (!ok || !certify(start)) continue;
    write(start);
    return Result::ok;
  }
  return Result::failed;
}

bool TimeLaw::certify(const Start& start) noexcept {
  const std::size_t n = rows_.size();
  const bool rests = start.x <= 0;
  for (std::size_t i = rests ? 1 : 0; i + 1 < n; ++i) {
    double b[3];
    newton_.coefficients(i, b);
    if (!(b[0] > 0 && b[1] > 0 && b[2] > 0)) return false;
    const LawExcess e = rows_.excess(i, b, i == 0);
    if (!(e.vel <= kMostVel && e.acc <= kMostAcc && e.jerk <= kMostJerk)) return false;
  }
  if (rests && !(newton_.node(1) <= rows_.start_cap() * (1 + kMostVel))) return false;
  return newton_.node(n - 1) <= rows_.stop_cap() * (1 + kMostVel);
}

void TimeLaw::write(const Start& start) noexcept {
  const std::size_t n = rows_.size();
  law_.clear();
  seconds_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const LawInterval& in = rows_[i];
    const LawStretch& from = rows_.stretches()[in.stretch];
    LawStep step;
    step.length = in.length;
    step.span = from.number;
    step.left = std::max(from.span_end - (in.from + in.length), 0.0);
    if (i == 0 && start.x <= 0) {
      step.kind = LawStep::Kind::start;
      step.seconds = 3 * in.length / std::sqrt(newton_.node(1));
    } else if (i + 1 == n) {
      step.kind = LawStep::Kind::stop;
      step.x = newton_.node(i);
      step.u = -2 * step.x / (3 * in.length);
      step.seconds = 3 * in.length / std::sqrt(step.x);
    } else {
      double b[3];
      newton_.coefficients(i, b);
      step.x = b[0];
      step.u = (b[1] - b[0]) / in.length;
      step.w = (b[2] - 2 * b[1] + b[0]) / (in.length * in.length);
      step.seconds = seconds_of(step, b[2]);
    }
    seconds_ += step.seconds;
    law_.push_back(step);
  }
}

TimeLaw::Result TimeLaw::solve_stop(const Start& start) noexcept { return solve(start); }

}  // namespace kerf::motion::path
