#include "motion/core/path/time_law.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/ramp.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kMostVel = 1e-4, kMostAcc = 5e-4, kMostJerk = 5e-3;
/// |w| t^2 below which the series of LawStep::Kind::spline is used.
constexpr double kSeries = 1e-4;
/// The first guess: shares of speed, and of acceleration and jerk of a straight.
constexpr double kGuessSpeed = 0.8, kGuessAcc = 0.75, kGuessJerk = 0.3;
constexpr std::size_t kLeastIntervals = 8;
/// Of accelerations: relative.
constexpr double kSameAcc = 1e-6;
/// Shares of the limits that are used up from a moving state when less did not do.
constexpr double kEdgeAcc = 1.0001, kEdgeJerk = 1.002;
/// A stop is looked for within this many times the way of a stop on a straight, as a way down to these shares of x.
constexpr double kStopWays[] = {2.5, 5};
constexpr double kCrawls[] = {1e-2, 1e-3};
/// Steps of that way; where the crawl begins, and how much farther than an even jerk from there would stop.
constexpr double kStopSteps = 24, kNearlyStill = 0.05, kStopRoom = 1.2;
/// Ends that are tried, relative to that one.
constexpr double kStopEnds[] = {1.0, 1.1, 1.3, 1.6};
/// Windows this many times as long as a stop on a straight end soon enough; attempts at each of them.
constexpr double kStopHere = 1.3;
constexpr int kStopRounds = 2;
/// Braking without the solver: steps on the way of a straight at least; and of another grid where a stop takes that many times as long as there. What
/// braking comes to depends on the grid by chance, by some per cent near sharp bends.
constexpr double kBrakeSteps[] = {72, 48};
constexpr double kBrakeEnough = 1.25;
/// So long a law is followed before braking is tried again, and at most (s).
constexpr double kFollowEvery = 0.002, kFollowMost = 0.012;
/// Braking is tried from places of a law so far apart (of its time).
constexpr double kLaterEvery = 0.12;
/// A stop that took more passes, or the solver, is tried nearer by this factor and again, down to that one; not when it takes less than so many
/// times what it would on a straight, nor in more intervals; and is worth it when it gains that much.
constexpr double kNearer = 0.93, kNearest = 0.3, kSoonEnough = 1.25, kWorthwhile = 0.999;
constexpr std::size_t kMostNearer = 40;
/// A wish below this share of the start's x is far.
constexpr double kFarBelow = 0.5;
/// From rest the guess is made feasible from this attempt on.
constexpr int kShrinkFrom = 1;
/// First weight of the barrier, relative to the time: the middle of what is feasible first.
constexpr double kFirstMu = 1;
/// Of the time in which acceleration builds up.
constexpr double kRounding = 0.4;
constexpr int kRoundings = 2;
/// Of the sum over the window.
constexpr double kRoundedSum = 1e-12;
/// From a moving state: shares of acceleration and jerk, what counts as reached, and what x keeps of itself over an interval.
constexpr double kTrackAcc = 0.85, kTrackJerk = 0.6, kTracked = 0.03, kMostDrop = 0.4;

double seconds_of(const LawStep& step, double x1) noexcept {
  const double sum = std::sqrt(step.x) + std::sqrt(x1);
  const double k = std::sqrt(std::abs(step.w)), arg = k * step.length / sum;
  if (arg * arg < kSeries) {
    const double z = step.w * step.length * step.length / (sum * sum);
    return 2 * step.length / sum * (1 + z / 3 + z * z / 5);
  }
  return 2 / k * (step.w > 0 ? std::atanh(std::min(arg, 1 - 1e-15)) : std::atan(arg));
}

/// Between these coefficients, over the step's length.
void spline(const double b[3], LawStep& step) noexcept {
  const double d = step.length;
  step.x = b[0];
  step.u = (b[1] - b[0]) / d;
  step.w = (b[2] - 2 * b[1] + b[0]) / (d * d);
  step.seconds = seconds_of(step, b[2]);
}

/// What is left of a step behind a place of it.
void behind(double from, LawStep& step) noexcept {
  const double end = at_place(step, step.length).x;
  const LawPoint at = at_place(step, from);
  step.x = at.x;
  step.u = at.u;
  step.length -= from;
  step.seconds = seconds_of(step, end);
}

/// With even jerk from the start of a step.
double way_to_rest(const LawStep& s) noexcept { return -2 * s.x / (3 * s.u); }

}  // namespace

bool TimeLaw::create(Memory& memory, std::size_t intervals,
                     std::size_t rows_per_interval) noexcept {
  return rows_.create(memory, intervals, rows_per_interval) &&
         newton_.create(memory, intervals, rows_per_interval) && law_.create(memory, intervals) &&
         kept_.create(memory, intervals) && x_.create(memory, intervals + 1) &&
         sums_.create(memory, intervals + 1) && way_.create(memory, intervals + 1) &&
         stop_.create(memory, intervals);
}

void TimeLaw::begin(const AxisLimits& limits) noexcept { rows_.begin(limits); }

bool TimeLaw::add(std::uint64_t number, const Piece& piece, double from, double to, double span_end,
                  double cap, double wish, int fineness, const JointCurve* joints) noexcept {
  LawStretch s;
  s.piece = piece;
  s.from = from;
  s.to = to;
  s.span_end = span_end;
  s.cap = cap;
  s.wish = wish;
  s.number = number;
  s.fineness = fineness;
  s.joints = joints != nullptr && joints->count > 0 ? joints : nullptr;
  return !(to > from) || rows_.add(s);
}

void TimeLaw::guess_nodes(const Start& start, bool patient) noexcept {
  const std::size_t n = rows_.size();
  const bool rests = start.x <= 0;
  x_.assign(n + 1, 0);
  x_[0] = start.x;
  // Evenly, and beside its neighbours.
  sums_.assign(n + 1, kNoLimit);
  for (std::size_t i = 0; i < n; ++i)
    sums_[i] = kGuessSpeed * std::min(rows_.even_cap(i),
                                      patient ? std::max(rows_[i].wish, start.x) : rows_[i].wish);
  for (std::size_t i = 1; i < n; ++i)
    x_[i] = std::min({sums_[i - 1], sums_[i], i > 1 ? sums_[i - 2] : kNoLimit, sums_[i + 1]});
  // x grows like it does from a stop, by a power 4/3 of the way, and by 2 A D at most.
  double acc = 0, jerk = 0;
  const auto grow = [&](std::size_t from, std::size_t to, std::size_t way_of) {
    rows_.straightest(way_of, acc, jerk);
    const double d = rows_[way_of].length, j = kGuessJerk * std::min(jerk, 1e12);
    const double s = way_from_rest(x_[from], j) + d;
    const double by_jerk = std::cbrt(20.25 * j * j * s * s * s * s);
    x_[to] = std::min({x_[to], by_jerk, x_[from] + 2 * kGuessAcc * acc * d});
  };
  for (std::size_t i = n; i-- > 1;) grow(i + 1, i, i);
  if (rests)
    for (std::size_t i = 1; i < n; ++i) grow(i - 1, i, i - 1);
  for (int k = 0; k < kRoundings; ++k) round_off();
  if (!rests) track(start);
}

void TimeLaw::round_off() noexcept {
  // Where acceleration would jump downwards x is cut to its mean around the place; sums_ holds the integral up to a node.
  const std::size_t n = rows_.size();
  sums_.assign(n + 1, 0);
  way_.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    way_[i + 1] = way_[i] + rows_[i].length;
    sums_[i + 1] = sums_[i] + (x_[i] + x_[i + 1]) / 2 * rows_[i].length;
  }
  double acc = 0, jerk = 0;
  std::size_t low = 0, high = 0;
  const auto integral = [&](std::size_t& k, double s) {
    while (k + 1 < n && way_[k + 1] < s) ++k;
    while (k > 0 && way_[k] > s) --k;
    const double f = (s - way_[k]) / rows_[k].length;
    return sums_[k] + f * (sums_[k + 1] - sums_[k]);
  };
  for (std::size_t i = 1; i < n; ++i) {
    rows_.straightest(i, acc, jerk);
    const double wide = kRounding * acc / jerk * std::sqrt(x_[i]);
    // Without a jerk limit it may jump.
    if (!(acc < kNoLimit && jerk < kNoLimit)) continue;
    const double h = std::min({wide, way_[i] / 2, (way_[n] - way_[i]) / 2});
    // Of a difference of sums rounding would leave nothing.
    if (2 * h * x_[i] < kRoundedSum * sums_[n]) continue;
    const double mean = (integral(high, way_[i] + h) - integral(low, way_[i] - h)) / (2 * h);
    x_[i] = std::min(x_[i], mean);
  }
}

void TimeLaw::track(const Start& start) noexcept {
  // From the state towards the guess with a part of acceleration and jerk, until it is reached.
  double x = start.x, a = start.u, acc = 0, jerk = 0;
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    const double d = rows_[i - 1].length, v = std::sqrt(x), wanted = std::sqrt(x_[i]),
                 off = wanted - v;
    rows_.straightest(i - 1, acc, jerk);
    acc *= kTrackAcc;
    jerk = std::min(kTrackJerk * jerk, 1e12);
    const double aim = std::copysign(std::min(acc, std::sqrt(2 * jerk * std::abs(off))), off);
    const double reach = jerk * d / v;
    if (std::abs(off) < kTracked * v && std::abs(a) < reach) return;
    const double next = std::clamp(aim, a - reach, a + reach);
    const double then = std::max(x + (a + next) * d, kMostDrop * x);
    // There, or past it within one interval.
    if ((then - x_[i]) * off > 0) return;
    x = then;
    a = next;
    x_[i] = x;
  }
}

TimeLaw::Result TimeLaw::solve(const Start& start) noexcept {
  iterations_ = 0;
  if (rows_.stretches().empty()) return Result::failed;
  // Near its end a law may have few intervals left, which a new one had better keep.
  const bool rests = start.x <= 0;
  if (!rests) {
    if (!rows_.make(start.x, start.u, 1)) return Result::full;
    if (is_last_stop(start)) {
      newton_.begin(rows_, start.x, start.u, false, true);
      write(start);
      return Result::ok;
    }
    if (rows_.size() > 1 && attempt(start) == Result::ok) return Result::ok;
    if (rows_.size() >= kLeastIntervals) return Result::failed;
  }
  return rows_.make(start.x, start.u, kLeastIntervals) ? attempt(start) : Result::full;
}

/// Whether what is left is just the interval of even jerk at the end of an older law.
bool TimeLaw::is_last_stop(const Start& start) const noexcept {
  if (rows_.size() > 1) return false;
  const double u = -2 * start.x / (3 * rows_[0].length);
  return std::abs(start.u - u) <= kSameAcc * std::abs(u) &&
         start.x <= rows_.stop_cap() * (1 + kMostVel);
}

TimeLaw::Result TimeLaw::attempt(const Start& start) noexcept {
  const bool rests = start.x <= 0;
  double lowest = kNoLimit;
  for (std::size_t i = 0; i < rows_.size(); ++i) lowest = std::min(lowest, rows_[i].wish);
  // Far above a wish: first something that keeps the limits, then braking.
  const bool waits = lowest < kFarBelow * start.x;
  LawNewton::Aim aim;
  // Stops: other ends are tried instead of other ways to the same one. So all of the limits is used up at once, and nothing else tried.
  const bool stops = rounds_ == kStopRounds;
  const int rounds = stops && !waits ? 1 : rounds_;
  aim.soon = stops;
  for (int round = 0; round < rounds; ++round) {
    const bool patient = waits == (round % 2 == 0);
    // A law that breaks what was left out is looked for with all of it.
    newton_.begin(rows_, start.x, start.u, patient, stops || round > 0);
    guess_nodes(start, patient);
    for (std::size_t i = 1; i < rows_.size(); ++i) newton_.guess(i, x_[i]);
    // A state on the edge of what is possible, and the certificate allows for it.
    if (!rests && (stops || round > 0)) aim.acc = kEdgeAcc, aim.jerk = kEdgeJerk;
    aim.mu = kFirstMu;
    newton_.start(rests && round >= kShrinkFrom, aim);
    const bool ok = newton_.run(aim);
    iterations_ += newton_.iterations();
    work_ += static_cast<std::uint64_t>(newton_.iterations()) * rows_.size();
    if (!ok || !certify(start)) continue;
    write(start);
    round_ = round;
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

void TimeLaw::place(std::size_t stretch, double from, double length, LawStep& step) const noexcept {
  const LawStretch& s = rows_.stretches()[stretch];
  step.length = length;
  step.span = s.number;
  step.left = std::max(s.span_end - (from + length), 0.0);
}

void TimeLaw::write(const Start& start) noexcept {
  const std::size_t n = rows_.size();
  law_.clear();
  seconds_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const LawInterval& in = rows_[i];
    LawStep step;
    place(in.stretch, in.from, in.length, step);
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
      spline(b, step);
    }
    seconds_ += step.seconds;
    law_.push_back(step);
  }
}

TimeLaw::Result TimeLaw::solve_stop(const Start& start, const LawAlong& law) noexcept {
  return brake_stop(start, law) == Result::ok ? Result::ok : search_stop(start);
}

/// The law that ends a little before the end of the one that was found, and then nearer still, as long as that stands sooner.
void TimeLaw::end_nearer(const Start& start) noexcept {
  if (seconds_ < kSoonEnough * straight_stop(start)) return;
  const double straight = stop_way(start);
  double end = 0;
  for (const LawStep& s : law_) end += s.length;
  keep();
  int used = iterations_;
  rounds_ = kStopRounds;
  for (double share = kNearer; share > kNearest; share *= kNearer) {
    const double way = share * end;
    rows_.shorten(way, std::min(straight, way) / kStopSteps);
    if (!rows_.make(start.x, start.u, kLeastIntervals) || rows_.size() > kMostNearer) break;
    iterations_ = 0;
    const bool sooner = attempt(start) == Result::ok && seconds_ < kWorthwhile * kept_seconds_;
    used += iterations_;
    if (!sooner) break;
    keep();
  }
  rounds_ = kRounds;
  rows_.shorten(kNoLimit, kNoLimit);
  iterations_ = used;
  restore();
}

void TimeLaw::keep() noexcept {
  kept_.clear();
  for (const LawStep& s : law_) kept_.push_back(s);
  kept_seconds_ = seconds_;
}

void TimeLaw::restore() noexcept {
  law_.clear();
  for (const LawStep& s : kept_) law_.push_back(s);
  seconds_ = kept_seconds_;
}

/// What a stop on a straight like the first place of the window takes.
double TimeLaw::straight_stop(const Start& start) const noexcept {
  const LawStretch& first = rows_.stretches().front();
  double acc = 0, jerk = 0;
  straight_limits(first, first.from, rows_.limits(), acc, jerk);
  return ramp_to({std::sqrt(start.x), start.u}, 0, {acc, jerk}).duration();
}

TimeLaw::Result TimeLaw::brake_stop(const Start& start, const LawAlong& law) noexcept {
  iterations_ = 0;
  law_.clear();
  seconds_ = 0;
  if (rows_.stretches().empty() || !(start.x > 0)) return Result::failed;
  if (brake(start, 0, law)) return Result::ok;
  // Just before a sharp bend braking may lead nowhere: the law is followed for a while before.
  if (law.count == 0 || law.step[0].kind != LawStep::Kind::spline) return Result::failed;
  kept_.clear();
  for (std::size_t k = 0; k < law.count; ++k) kept_.push_back(law.step[k]);
  behind(law.from, kept_[0]);
  return brake_on_the_way(kFollowEvery, kFollowMost, kNoLimit) ? Result::ok : Result::failed;
}

/// Braking from `way` on, where the state is `from`, is added to the law.
bool TimeLaw::brake(const Start& from, double way, const LawAlong& law) noexcept {
  LawStop::Aim aim;
  aim.most = {kMostVel, kMostAcc, kMostJerk};
  for (int k = 0; k < 2; ++k) aim.widest[k] = stop_way(from) / kBrakeSteps[k];
  aim.enough_s = kBrakeEnough * straight_stop(from);
  if (!stop_.run(rows_, way, from.x, from.u, law, aim)) return false;
  const Buffer<LawStop::Step>& steps = stop_.steps();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const LawStop::Step& made = steps[i];
    LawStep step;
    place(made.stretch, made.from, made.length, step);
    spline(made.b, step);
    if (i + 1 == steps.size()) {
      step.w = 0;
      step.kind = LawStep::Kind::stop;
      step.seconds = 3 * step.length / std::sqrt(step.x);
    }
    seconds_ += step.seconds;
    if (!law_.push_back(step)) return false;
  }
  return true;
}

/// The law as far as its interval k, and braking from there. False: there is none.
bool TimeLaw::brake_behind(std::size_t k) noexcept {
  law_.clear();
  seconds_ = 0;
  double way = 0;
  for (std::size_t i = 0; i < k; ++i) {
    law_.push_back(kept_[i]);
    seconds_ += kept_[i].seconds;
    way += kept_[i].length;
  }
  return brake({kept_[k].x, kept_[k].u}, way, {kept_.begin() + k, kept_.size() - k, 0});
}

/// The soonest of the stops that go along what is kept and brake from places `every` seconds apart, the last one before `end`. False: none takes less than
/// `least`.
bool TimeLaw::brake_on_the_way(double every, double end, double least) noexcept {
  std::size_t best = 0;
  double t = 0, next = every;
  for (std::size_t k = 0; k + 1 < kept_.size() && t < end; ++k) {
    if (t > next) {
      next += every;
      if (brake_behind(k) && seconds_ < least) {
        least = seconds_;
        best = k;
      }
    }
    t += kept_[k].seconds;
  }
  return best > 0 && brake_behind(best);
}

/// Whether braking stands sooner from some place of the law on.
void TimeLaw::brake_later() noexcept {
  keep();
  if (!brake_on_the_way(kLaterEvery * kept_seconds_, kept_seconds_, kept_seconds_)) restore();
}

TimeLaw::Result TimeLaw::search_stop(const Start& start) noexcept {
  iterations_ = 0;
  if (rows_.stretches().empty() || !(start.x > 0)) return Result::failed;
  // Down to a crawl as soon as limits allow; this, or the law that ends where the crawl begins, whichever stands first.
  const double straight = stop_way(start);
  int used = 0;
  if (rows_.whole_way() < kStopHere * straight) {
    // The window ends about as soon as anything could.
    if (solve(start) == Result::ok) return Result::ok;
    used = iterations_;
    iterations_ = 0;
  }
  const auto within = [&](double way, double crawl) {
    rows_.shorten(way, straight / kStopSteps);
    if (!rows_.make(start.x, start.u, kLeastIntervals)) return false;
    if (crawl > 0) rows_.wish(crawl * start.x);
    const bool ok = attempt(start) == Result::ok;
    used += iterations_;
    iterations_ = 0;
    return ok;
  };
  bool found = false;
  rounds_ = kStopRounds;
  for (const double ways : kStopWays)
    for (const double crawl : kCrawls) found = found || within(ways * straight, crawl);
  if (found) {
    double end = 0;
    for (std::size_t i = 0; i < law_.size(); ++i) {
      if (law_[i].u < 0 && law_[i].x < kNearlyStill * start.x) {
        end += kStopRoom * way_to_rest(law_[i]);
        break;
      }
      end += law_[i].length;
    }
    cut();
    keep();
    for (const double more : kStopEnds)
      if (within(more * end, 0)) break;
    if (seconds_ > kept_seconds_) restore();
  }
  rounds_ = kRounds;
  rows_.shorten(kNoLimit, kNoLimit);
  iterations_ = used;
  if (!found) return Result::failed;
  brake_later();
  end_nearer(start);
  return Result::ok;
}

double TimeLaw::stop_way(const Start& start) const noexcept {
  // As on a straight like the first place of the window; speeding up ends first.
  const LawStretch& first = rows_.stretches().front();
  double acc = 0, jerk = 0;
  straight_limits(first, first.from, rows_.limits(), acc, jerk);
  const double v = std::sqrt(start.x), rise = std::max(start.u, 0.0) / jerk;
  const double top = v + start.u * rise / 2;
  return v * rise + top * top / (2 * acc) + top * acc / (2 * jerk);
}

void TimeLaw::cut() noexcept {
  double t = 0, best = seconds_;
  std::size_t at = law_.size();
  for (std::size_t i = 0; i + 1 < law_.size(); ++i) {
    const LawStep& s = law_[i];
    if (s.u < 0) {
      const double way = way_to_rest(s), total = t + 3 * way / std::sqrt(s.x);
      if (total < best && s.x <= rows_.stop_cap(i, way)) {
        best = total;
        at = i;
      }
    }
    t += s.seconds;
  }
  if (at == law_.size()) return;
  LawStep& s = law_[at];
  const double way = way_to_rest(s);
  s.left += s.length - way;
  s.length = way;
  s.seconds = 3 * way / std::sqrt(s.x);
  s.w = 0;
  s.kind = LawStep::Kind::stop;
  law_.truncate(at + 1);
  seconds_ = best;
}

}  // namespace kerf::motion::path
