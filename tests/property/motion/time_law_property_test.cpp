// Time laws on the curves of the benchmark's programs: within the limits by differences of positions, near the offline optimum, and
// solvable again from any of their own states.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "bench/motion/families.hpp"
#include "bench/motion/runs.hpp"
#include "motion/core/path/time_law.hpp"
#include "motion/core/ramp.hpp"
#include "property/motion/random_program.hpp"
#include "unit/motion/rig.hpp"

namespace kerf {
namespace {

namespace path = motion::path;
using path::LawStep;
using path::TimeLaw;

constexpr std::size_t kRoom = 3000;

double feed_of(const motion::PathSpan& span) { return span.speed.feed_cap; }

/// Adds the path from `at` (sigma from the start of the first span) to the end.
bool add(TimeLaw& law, const std::vector<motion::PathSpan>& spans, const path::AxisLimits& limits,
         std::size_t first, double from, double scale, int fineness) {
  law.begin(limits);
  for (std::size_t k = first; k < spans.size(); ++k) {
    const motion::PathSpan& s = spans[k];
    const double begin = k == first ? from : 0, wish = feed_of(s) * scale * scale;
    if (begin >= s.length * (1 - 1e-12)) continue;
    if (!law.add(k, s.piece, s.from + begin, s.from + s.length, s.from + s.length,
                 path::axis_cap(s.piece, s.from + begin, s.from + s.length, limits), wish,
                 fineness))
      return false;
  }
  return true;
}

struct Peaks {
  double vel{0}, acc{0}, jerk{0}, gap{0};
};

/// Samples a law once a period and looks at differences of positions.
Peaks sample(const path::Buffer<LawStep>& law, const std::vector<motion::PathSpan>& spans,
             const path::AxisLimits& limits, double period) {
  Peaks out;
  path::Vec q[4];
  std::size_t count = 0;
  double at = 0;
  for (std::size_t i = 0; i < law.size(); ++i) {
    const LawStep& step = law[i];
    const motion::PathSpan& span = spans[step.span];
    const double start = span.from + span.length - step.left - step.length;
    for (; at < step.seconds; at += period) {
      const path::LawState state = path::at(step, at);
      q[3] = q[2], q[2] = q[1], q[1] = q[0];
      q[0] = span.piece.point(start + state.s);
      ++count;
      for (std::size_t j = 0; j < rtapi::kAxes; ++j) {
        if (count > 1)
          out.vel = std::max(out.vel, std::abs(q[0][j] - q[1][j]) / period / limits.vel[j]);
        if (count > 2)
          out.acc = std::max(out.acc, std::abs(q[0][j] - 2 * q[1][j] + q[2][j]) /
                                          (period * period) / limits.acc[j]);
        if (count > 3)
          out.jerk = std::max(out.jerk, std::abs(q[0][j] - 3 * q[1][j] + 3 * q[2][j] - q[3][j]) /
                                            (period * period * period) / limits.jerk[j]);
      }
    }
    at -= step.seconds;
    out.gap = std::max(out.gap, std::abs(path::at(step, step.seconds).s / step.length - 1));
  }
  return out;
}

struct Tally {
  int laws{0}, ok{0}, first_try{0};
  long iterations{0}, intervals{0};
  double seconds{0}, solver_s{0};
  Peaks peaks;
};

void note(Tally& tally, TimeLaw& law, TimeLaw::Result result, double solver_s,
          const std::vector<motion::PathSpan>& spans, const path::AxisLimits& limits) {
  ++tally.laws;
  tally.iterations += law.iterations();
  tally.intervals +=
      static_cast<long>(result == TimeLaw::Result::ok ? law.law().size() : law.intervals());
  tally.solver_s += solver_s;
  if (result != TimeLaw::Result::ok) return;
  ++tally.ok;
  tally.seconds += law.seconds();
  const Peaks p = sample(law.law(), spans, limits, 1e-3);
  tally.peaks.vel = std::max(tally.peaks.vel, p.vel);
  tally.peaks.acc = std::max(tally.peaks.acc, p.acc);
  tally.peaks.jerk = std::max(tally.peaks.jerk, p.jerk);
  tally.peaks.gap = std::max(tally.peaks.gap, p.gap);
}

void print(const char* what, const std::string& name, const Tally& t) {
  std::printf(
      "%-22s %-26s laws %4d ok %4d iterations/law %5.1f intervals/law %6.1f us/interval/iteration "
      "%.2f ms/law %.2f v %.4f a %.4f j %.4f\n",
      what, name.c_str(), t.laws, t.ok, double(t.iterations) / t.laws, double(t.intervals) / t.laws,
      1e6 * t.solver_s / double(t.iterations) / (double(t.intervals) / t.laws),
      1e3 * t.solver_s / t.laws, t.peaks.vel, t.peaks.acc, t.peaks.jerk);
}

TimeLaw::Result timed(TimeLaw& law, const TimeLaw::Start& start, double& seconds) {
  const auto t0 = std::chrono::steady_clock::now();
  const TimeLaw::Result out = law.solve(start);
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  return out;
}

std::vector<bench::Program> programs(std::uint64_t seed) {
  std::vector<bench::Program> out;
  out.push_back(bench::freeform(300, 0.01, 100, seed));
  out.push_back(bench::relief(300, 0.01, 100, false, seed));
  out.push_back(bench::arc_spiral(0.1, 80));
  out.push_back(bench::arc_spiral(0.01, 80));
  out.push_back(bench::helical_arcs(0.1, 80));
  out.push_back(bench::arc_wave(0.01, 80, 0.3));
  out.push_back(bench::zigzag(0.05, 100));
  out.push_back(bench::fractal(4, 0.5, 0.05, 100));
  out.push_back(bench::four_axis(60, 0.02, 100, false, seed));
  out.push_back(bench::mixture(60, seed));
  return out;
}

TEST(TimeLaw, DrivesTheBenchmarksCurvesFromStopToStop) {
  motion::test::HeapMemory heap;
  TimeLaw law;
  ASSERT_TRUE(law.create(heap, kRoom));
  const int most = motion::test::property_count(60);
  for (const bench::Program& program : programs(1)) {
    path::AxisLimits limits;
    const std::vector<motion::PathSpan> curve = bench::curve_of(program, 50'000, limits);
    limits.jerks = true;
    Tally stops, moving;
    std::mt19937_64 random(7);
    std::size_t begin = 0;
    for (std::size_t k = 0; k < curve.size(); ++k) {
      const bool full = k - begin >= 250;
      if (!curve[k].stop_at_end && k + 1 < curve.size() && !full) continue;
      if (stops.laws >= most) break;
      const std::vector<motion::PathSpan> spans(curve.begin() + long(begin),
                                                curve.begin() + long(k) + 1);
      begin = k + 1;
      ASSERT_TRUE(add(law, spans, limits, 0, 0, 1, 4));
      double seconds = 0;
      TimeLaw::Result result = timed(law, {}, seconds);
      note(stops, law, result, seconds, spans, limits);
      if (result != TimeLaw::Result::ok) continue;
      const std::vector<LawStep> old(law.law().begin(), law.law().end());
      for (std::size_t i = 7; i + 1 < old.size() && moving.laws < most; i += 7) {
        const LawStep& at = old[i];
        const double scale =
            std::exp(std::uniform_real_distribution<double>(std::log(0.05), std::log(2))(random));
        ASSERT_TRUE(add(law, spans, limits, at.span, spans[at.span].length - at.left - at.length,
                        scale, 4));
        result = timed(law, {at.x, at.u}, seconds);
        note(moving, law, result, seconds, spans, limits);
      }
    }
    print("from rest", program.name, stops);
    ASSERT_GT(stops.laws, 0);
    if (moving.laws > 0) print("from moving states", program.name, moving);
    EXPECT_EQ(stops.ok, stops.laws);
    EXPECT_GE(moving.ok, 0.9 * moving.laws);
    for (const Tally* t : {&stops, &moving}) {
      EXPECT_LE(t->peaks.vel, 1.0001);
      EXPECT_LE(t->peaks.acc, 1.0005);
      EXPECT_LE(t->peaks.jerk, 1.005);
      EXPECT_LE(t->peaks.gap, 1e-9);
    }
  }
}

/// Least time to stand on a straight from speed v and acceleration a: jerk down, even braking, jerk up.
double least_stop(double v, double a, double acc, double jerk) {
  double t = 0;
  if (a > 0) {
    t = a / jerk;
    v += a * t / 2;
    a = 0;
  }
  const double peak = std::max(std::min(acc, std::sqrt(jerk * v + a * a / 2)), -a);
  const double ramp = (peak + a) / jerk;
  const double even = v + a * ramp - jerk * ramp * ramp / 2 - peak * peak / (2 * jerk);
  return t + ramp + std::max(even / peak, 0.0) + peak / jerk;
}

struct Ratios {
  int count{0};
  double sum{0}, worst{0};
  void note(double ratio) {
    ++count;
    sum += ratio;
    worst = std::max(worst, ratio);
  }
  void add(const Ratios& more) {
    count += more.count;
    sum += more.sum;
    worst = std::max(worst, more.worst);
  }
  [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
};

TEST(TimeLaw, StopsSoon) {
  motion::test::HeapMemory heap;
  TimeLaw law;
  ASSERT_TRUE(law.create(heap, kRoom));
  const int most = motion::test::property_count(25);
  Tally all;
  Ratios all_braked, all_later;
  int late = 0;
  for (const bench::Program& program : programs(2)) {
    path::AxisLimits limits;
    const std::vector<motion::PathSpan> curve = bench::curve_of(program, 50'000, limits);
    limits.jerks = true;
    Tally stops;
    Ratios braked;
    double worst = 0;
    for (std::size_t k = 0, begin = 0; k < curve.size() && stops.laws < most; ++k) {
      if (!curve[k].stop_at_end && k + 1 < curve.size() && k - begin < 250) continue;
      const std::vector<motion::PathSpan> spans(curve.begin() + long(begin),
                                                curve.begin() + long(k) + 1);
      begin = k + 1;
      ASSERT_TRUE(add(law, spans, limits, 0, 0, 1, 4));
      ASSERT_EQ(law.solve({}), TimeLaw::Result::ok);
      const std::vector<LawStep> old(law.law().begin(), law.law().end());
      // When each stop begins and stands, in the time of the law.
      std::vector<std::pair<double, double>> times;
      double begins = 0;
      std::size_t counted = 0;
      for (std::size_t i = 5; i + 1 < old.size() && stops.laws < most; i += 9) {
        const LawStep& at = old[i];
        while (counted < i) begins += old[counted++].seconds;
        const motion::PathSpan& span = spans[at.span];
        const path::LawAlong along{&at, old.size() - i, 0};
        ASSERT_TRUE(add(law, spans, limits, at.span, span.length - at.left - at.length, 1, 4));
        const bool searched = law.search_stop({at.x, at.u}) == TimeLaw::Result::ok;
        const double least = law.seconds();
        const bool brakes = law.brake_stop({at.x, at.u}, along) == TimeLaw::Result::ok;
        if (searched && brakes) braked.note(law.seconds() / least);
        const auto t0 = std::chrono::steady_clock::now();
        const TimeLaw::Result result = law.solve_stop({at.x, at.u}, along);
        note(stops, law, result,
             std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count(), spans,
             limits);
        if (result != TimeLaw::Result::ok) continue;
        EXPECT_EQ(law.law().back().kind, LawStep::Kind::stop);
        times.emplace_back(begins, begins + law.seconds());
        double acc = 0, jerk = 0;
        path::straight_limits(span.piece, span.from, limits, acc, jerk);
        // A straight that is all that is left.
        if (spans.size() == 1 && span.piece.straight())
          worst = std::max(worst, law.seconds() / least_stop(std::sqrt(at.x), at.u, acc, jerk));
      }
      for (auto now = times.begin(); now != times.end(); ++now)
        for (auto later = now + 1; later != times.end(); ++later) {
          if (later->first > now->second) break;
          const double ratio = (now->second - now->first) / (later->second - now->first);
          all_later.note(ratio);
          late += ratio > 1.1 ? 1 : 0;
        }
    }
    print("stops", program.name, stops);
    std::printf("%-22s %-26s %d without the solver: %.3f of the time that it finds, %.3f at most\n",
                "", program.name.c_str(), braked.count, braked.mean(), braked.worst);
    EXPECT_LE(braked.mean(), 1.0);
    EXPECT_LE(braked.worst, 1.1);
    all_braked.add(braked);
    if (worst > 0)
      std::printf("%-22s %-26s at most %.3f of the least time on straights\n", "",
                  program.name.c_str(), worst);
    // Where a law ends anyway nothing but the law itself may be left.
    all.laws += stops.laws;
    all.ok += stops.ok;
    EXPECT_LE(worst, 1.03);
    EXPECT_LE(stops.peaks.vel, 1.0001);
    EXPECT_LE(stops.peaks.acc, 1.0005);
    EXPECT_LE(stops.peaks.jerk, 1.005);
    EXPECT_LE(stops.peaks.gap, 1e-9);
  }
  EXPECT_GE(all.ok, 0.95 * all.laws);
  // The rest is mostly next to the end of a law, where nothing stops sooner than the law itself.
  EXPECT_GE(all_braked.count, 0.9 * all.laws);
  // To go on with the law for a while and to stop then is a way to stop too.
  std::printf("stops that begin later stand sooner: %d of %d by more than 1.1, %.3f at most\n",
              late, all_later.count, all_later.worst);
  EXPECT_EQ(late, 0);
}

TEST(TimeLaw, BrakesWithoutTheSolverFromAllStatesOfALaw) {
  motion::test::HeapMemory heap;
  TimeLaw law;
  ASSERT_TRUE(law.create(heap, kRoom));
  const int most = motion::test::property_count(400);
  for (const bench::Program& program : programs(2)) {
    path::AxisLimits limits;
    const std::vector<motion::PathSpan> curve = bench::curve_of(program, 50'000, limits);
    limits.jerks = true;
    int states = 0, brakes = 0;
    for (std::size_t k = 0, begin = 0; k < curve.size() && states < most; ++k) {
      if (!curve[k].stop_at_end && k + 1 < curve.size() && k - begin < 250) continue;
      const std::vector<motion::PathSpan> spans(curve.begin() + long(begin),
                                                curve.begin() + long(k) + 1);
      begin = k + 1;
      ASSERT_TRUE(add(law, spans, limits, 0, 0, 1, 4));
      ASSERT_EQ(law.solve({}), TimeLaw::Result::ok);
      const std::vector<LawStep> old(law.law().begin(), law.law().end());
      for (std::size_t i = 5; i + 5 < old.size() && states < most; i += 3) {
        const LawStep& at = old[i];
        const motion::PathSpan& span = spans[at.span];
        ASSERT_TRUE(add(law, spans, limits, at.span, span.length - at.left - at.length, 1, 4));
        ++states;
        brakes +=
            law.brake_stop({at.x, at.u}, {&at, old.size() - i, 0}) == TimeLaw::Result::ok ? 1 : 0;
      }
    }
    // On the relief one of twenty needs the second braking, along the law's own slope.
    EXPECT_GE(brakes, 0.98 * states) << program.name;
  }
}

/// What speed changes and cruising between them take on a straight, from `start` to rest.
double straight_time(double v, double a, double wish, double length,
                     const motion::RampLimits& limits) {
  const motion::Ramp up = motion::ramp_to({v, a}, wish, limits),
                     down = motion::ramp_to({wish, 0}, 0, limits);
  const double rest = length - up.distance({v, a}) - down.distance({wish, 0});
  return up.duration() + down.duration() + rest / wish;
}

TEST(TimeLaw, GoesOnFromStatesThatAreSlowForWhatJerkCanDo) {
  // As an override leaves them that is turned down to nothing and up again.
  motion::test::HeapMemory heap;
  TimeLaw law;
  ASSERT_TRUE(law.create(heap, 1024));
  std::mt19937_64 random(31);
  const auto log_uniform = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  const int count = 400;
  int failed = 0;
  double worst = 0;
  for (int n = 0; n < count; ++n) {
    const motion::RampLimits most{log_uniform(100, 5000), log_uniform(1000, 1e6)};
    path::AxisLimits limits;
    for (std::size_t j = 0; j < rtapi::kAxes; ++j)
      limits.vel[j] = 200, limits.acc[j] = most.acc, limits.jerk[j] = most.jerk;
    limits.jerks = true;
    const double wish = log_uniform(1e-3, 20), v = wish * log_uniform(1e-4, 1);
    // It can level out below the wish and above 0.
    const double a = std::uniform_real_distribution<double>(-0.6, 0.6)(random) *
                     std::min(most.acc, std::sqrt(2 * most.jerk * std::min(v, wish - v)));
    const double length = log_uniform(1, 100);
    const double straight = straight_time(v, a, wish, length, most);
    const path::Piece piece = path::straight_piece({}, {{1}}, length, {});
    law.begin(limits);
    ASSERT_TRUE(law.add(0, piece, 0, length, length, 4e4, wish * wish, 4));
    if (law.solve({v * v, a}) != TimeLaw::Result::ok) {
      ++failed;
      continue;
    }
    worst = std::max(worst, (law.seconds() - straight) / straight);
  }
  std::printf("%d of %d not found; at most %.4f longer than on a straight\n", failed, count, worst);
  // Nearly all of the rest had all but stopped, braking.
  EXPECT_LE(failed, count / 50);
  EXPECT_LT(worst, 0.1);
}

TEST(TimeLaw, TakesShortWindowsAndAxesWithoutLimits) {
  motion::test::HeapMemory heap;
  TimeLaw law;
  ASSERT_TRUE(law.create(heap, 300));
  for (const double length : {1e-4, 0.01, 1.0, 300.0})
    for (const double jerk : {50'000.0, path::kNoLimit}) {
      SCOPED_TRACE(std::to_string(length) + " mm, jerk " + std::to_string(jerk));
      path::AxisLimits limits;
      for (std::size_t j = 0; j < rtapi::kAxes; ++j)
        limits.vel[j] = 200, limits.acc[j] = 1750, limits.jerk[j] = jerk;
      limits.jerks = true;
      const path::Piece piece = path::straight_piece({}, {{0.6, 0.8}}, length, {});
      law.begin(limits);
      ASSERT_TRUE(law.add(7, piece, 0, length, length, 1e4, path::kNoLimit, 1));
      ASSERT_EQ(law.solve({}), TimeLaw::Result::ok);
      double way = 0;
      for (const LawStep& step : law.law()) {
        way += step.length;
        EXPECT_EQ(step.span, 7U);
        EXPECT_NEAR(step.left, length - way, 1e-9 * length);
      }
      EXPECT_NEAR(way, length, 1e-9 * length);
      // Never less than the axes' accelerations and the cap take.
      EXPECT_GE(law.seconds(), 0.999 * std::max(length / 100, 2 * std::sqrt(length / 2187.5)));
      EXPECT_LE(law.seconds(), 1.3 * (length / 100 + 0.2 + std::sqrt(length)));
    }
  // No room is said, and nothing there is no law.
  path::AxisLimits limits;
  law.begin(limits);
  EXPECT_EQ(law.solve({}), TimeLaw::Result::failed);
  bool fits = true;
  const path::Piece piece = path::straight_piece({}, {{1}}, 1, {});
  for (int k = 0; k < 400 && fits; ++k) fits = law.add(0, piece, 0, 1, 1, 1e4, 1e4, 1);
  EXPECT_FALSE(fits);
}

}  // namespace
}  // namespace kerf
