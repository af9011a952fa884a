// Time laws on whole programs: limits in every cycle, less time than without, and holds that begin soon.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>
#include <vector>

#include "bench/motion/families.hpp"
#include "bench/motion/runs.hpp"
#include "property/motion/drive.hpp"

namespace kerf::motion {
namespace {

/// With or without laws.
struct Drive : test::Drive {
  Drive(const bench::Program& moves, bool laws, double jerk = 50000)
      : test::Drive(moves, jerk, laws) {}
  void cycle() {
    test::Drive::cycle();
    by_law += rig.controller->view().law.number != 0 ? 1 : 0;
  }
  template <class F>
  int run_until(F&& until, int most = 400000) {
    for (int i = 1; i <= most; ++i) {
      cycle();
      if (until()) return i;
      if (!rig.faults.empty()) return -1;
    }
    return -1;
  }
  int finish() {
    return run_until([&] { return done(); });
  }
  [[nodiscard]] bool stands() const { return speed() == 0; }
  void expect_limits() const {
    EXPECT_LE(oracle.vel, 1.0001);
    EXPECT_LE(oracle.acc, 1.001);
    EXPECT_LE(oracle.jerk, 1.01);
    for (const auto& f : rig.faults) ADD_FAILURE() << "fault " << static_cast<int>(f.fault);
  }

  int by_law{0};
};

std::vector<bench::Program> curves() {
  return {bench::freeform(600, 0.01, 100, 1),
          bench::arc_spiral(0.1, 80),
          bench::zigzag(0.05, 100),
          bench::fractal(4, 0.5, 0.05, 100),
          bench::four_axis(60, 0.02, 100, false, 3),
          bench::mixture(60, 4)};
}

TEST(TimeLaws, ArcsThatAreSmallAgainstPDoNotHoldThemBack) {
  const bench::Program program = bench::short_arcs(1, 80);
  EXPECT_LE(bench::run(program, {50000}).seconds, 1.15 * bench::run(program, {}).seconds);
}

TEST(TimeLaws, KeepTheLimitsAndAreFasterThanBoxes) {
  int by_law = 0, cycles = 0;
  for (const auto& program : curves()) {
    Drive with(program, true), without(program, false);
    const int t = with.finish(), t0 = without.finish();
    with.expect_limits();
    by_law += with.by_law;
    cycles += t;
    EXPECT_LE(t, t0 * 1.01 + 20) << program.name;
    std::printf("%-30s %6d cycles, boxes %6d: %.3f\n", program.name.c_str(), t, t0,
                static_cast<double>(t) / t0);
    const LawMaker::Counts& c = with.rig.planner.law_counts();
    for (const auto& [what, n] : {std::pair{"from rest", c.rests},
                                  std::pair{"children", c.children}, std::pair{"stops", c.stops}}) {
      const auto all = static_cast<double>(std::max<std::uint64_t>(n.all, 1));
      std::printf("  %-10s %6d (%d not found): %6.0f intervals, %5.1f iterations\n", what,
                  static_cast<int>(n.all), static_cast<int>(n.failed),
                  static_cast<double>(n.intervals) / all, static_cast<double>(n.iterations) / all);
    }
  }
  // Straights from rest to rest and what stops everywhere need none.
  EXPECT_GT(by_law, cycles / 2);
}

bench::Program first_moves(bench::Program program, std::size_t items) {
  program.items.resize(std::min(items, program.items.size()));
  return program;
}

bench::Program in_mode(PathControl::Mode mode, bench::Program program) {
  for (auto& item : program.items)
    if (auto* control = std::get_if<PathControl>(&item)) control->mode = mode;
  return program;
}

/// The same program with a stop at each corner.
bench::Program with_stops(bench::Program program) {
  return in_mode(PathControl::Mode::exact_stop, std::move(program));
}

/// Beside stops at all corners: most that a blend may cost, and where blends are known to pay, what they take at most.
TEST(TimeLaws, CornersAreBlendedWhereThatIsFasterThanToStop) {
  struct Case {
    bench::Program program;
    double most{1.002};
  };
  const Case cases[] = {
      {first_moves(bench::arc_spiral(0.01, 80), 12)},
      {first_moves(bench::arc_spiral(0.1, 80), 12), 0.985},
      {first_moves(bench::arc_spiral(0.3, 80), 12), 0.80},
      {first_moves(bench::helical_arcs(0.01, 80), 12)},
      {first_moves(bench::helical_arcs(0.1, 80), 12), 0.97},
      {first_moves(bench::zigzag(0.05, 100, 13), 12), 0.97},
      {first_moves(bench::zigzag(0.05, 100, 6.5), 12), 0.96},
      {first_moves(bench::zigzag(0.05, 100, 2), 20), 0.91},
      {bench::corner(90, 10, 0.01, 100)},
      {bench::corner(90, 10, 0.05, 100)},
      {bench::corner(90, 10, 0.2, 100), 0.97},
      {bench::corner(20, 3, 0.003, 100)},
      {bench::corner(60, 40, 0.01, 100)},
      {bench::corner(120, 10, 0.05, 100)},
      {bench::corner(150, 10, 0.05, 100), 0.98},
  };
  for (const Case& c : cases) {
    for (const double path_jerk : {0.0, 50000.0}) {
      const bench::RunOptions limits{.jerk = 50000, .path_jerk = path_jerk};
      const double ours = bench::run(c.program, limits).seconds,
                   stops = bench::run(with_stops(c.program), limits).seconds;
      std::printf("%-26s P%-5g %.3f s, with stops %.3f s: %.3f\n", c.program.name.c_str(),
                  c.program.p_mm, ours, stops, ours / stops);
      // Times are whole cycles.
      EXPECT_LE(ours, c.most * stops + 0.002)
          << c.program.name << ", P" << c.program.p_mm << ", along the path " << path_jerk;
    }
  }
}

/// [TRAJ]MAX_LINEAR_JERK counts on straights and where the path leads on. Corners are the joints' alone: there the way slows down while sigma does not.
TEST(TimeLaws, AJerkAlongThePathHoldsStraightsBackAndNoCorners) {
  const double jerk = 50000;
  bench::ProgramWriter writer("diagonal", 0.05, 100);
  writer.line({.x = 6, .y = 6});
  const bench::Program diagonal = writer.done();
  // Both joints have the half of the square of what the path has.
  EXPECT_NEAR(bench::run(diagonal, {.jerk = jerk, .path_jerk = jerk}).seconds,
              bench::run(diagonal, {.jerk = jerk / std::sqrt(2.0)}).seconds, 0.002);
  for (const auto& program : curves()) {
    Drive drive(program, true, jerk);
    drive.rig.config.traj_max_jerk_mm_s3 = jerk;
    drive.rig.apply_config();
    drive.finish();
    drive.expect_limits();
    const double with = bench::run(program, {.jerk = jerk, .path_jerk = jerk}).seconds,
                 without = bench::run(program, {.jerk = jerk}).seconds;
    std::printf("%-30s %.3f s, along the path too %.3f s: %.3f\n", program.name.c_str(), without,
                with, with / without);
    EXPECT_LE(with, 1.02 * without) << program.name;
  }
}

/// A rotary axis beside linear ones that alone are limited in jerk ([TRAJ]MAX_LINEAR_JERK does that): its ramps once ended beside theirs.
TEST(TimeLaws, AnAxisWithoutAJerkLimitKeepsItsAcceleration) {
  for (const double turn : {-44.7164, 10.0, 90.0})
    for (const double p : {0.01, 0.1, 0.5}) {
      bench::ProgramWriter writer("turn", p, 57.8);
      for (const double x : {2.7, 3.7, 10.0}) {
        writer.line({.x = x, .a = writer.at().a});
        writer.line({.x = x, .a = writer.at().a + turn});
      }
      const bench::Program program = writer.done();
      Drive drive(program, true, 96637);
      drive.rig.config.joint[3].max_jerk = 0;
      drive.rig.apply_config();
      EXPECT_GT(drive.finish(), 0) << turn << ", P" << p;
      drive.expect_limits();
    }
}

/// A way of 3 mm in lines of micrometres, straight or hardly bent: once the path stood behind each of them.
TEST(TimeLaws, LinesOfMicrometresTakeNoLongerThanTheirWay) {
  for (const double step : {0.0005, 0.001, 0.002, 0.005})
    for (const bool exact : {false, true}) {
      bench::ProgramWriter one("line", 0.01, 100, false), many("micrometres", 0.01, 100, false);
      one.line({.x = 3, .y = 1});
      const int lines = static_cast<int>(std::lround(3 / step));
      for (int i = 1; i <= lines; ++i) {
        const double x = 3.0 * i / lines;
        many.line({.x = x, .y = x / 3 + (exact ? 0.0 : 0.002 * x * (x - 3))});
      }
      const bench::Program line = one.done();
      bench::Program parts = many.done();
      if (exact) parts = in_mode(PathControl::Mode::exact_path, std::move(parts));
      Drive whole(line, true), drive(parts, true);
      const int least = whole.finish(), cycles = drive.finish();
      drive.expect_limits();
      std::printf("%g mm%s: %d cycles, in one line %d\n", step, exact ? " in exact path mode" : "",
                  cycles, least);
      EXPECT_LE(cycles, 1.15 * least) << step;
    }
}

/// A feed that changes in each cycle, as adaptive feed does: what a hold is left with is made again now and then, not each time, and is there when it is
/// wanted.
TEST(TimeLaws, FromRestAreMadeRarelyUnderAFeedThatSwings) {
  const bench::Program program = bench::freeform(600, 0.01, 100, 1);
  Drive d(program, true);
  d.run(300);
  d.rig.orders.hold = true;
  ASSERT_GT(d.run_until([&] { return d.stands(); }, 1000), 0);
  const std::uint64_t before = d.rig.planner.law_counts().rests.all;
  for (int cycle = 0; cycle < 1000; ++cycle) {
    d.rig.intent.feed_override = 0.8 + 0.2 * std::sin(cycle * 0.01);
    d.cycle();
  }
  const std::uint64_t made = d.rig.planner.law_counts().rests.all - before;
  EXPECT_GE(made, 5U) << "of a second";
  EXPECT_LE(made, 26U) << "of a second";
  d.rig.orders.hold = false;
  EXPECT_GT(d.run_until([&] { return !d.stands(); }, 3), 0);
  for (int cycle = 0; cycle < 300; ++cycle) {
    d.rig.intent.feed_override = 0.8 + 0.2 * std::sin(cycle * 0.01);
    d.cycle();
  }
  d.rig.intent.feed_override = 1;
  EXPECT_GT(d.finish(), 0);
  d.expect_limits();
}

/// A child for each feed sees as far as it takes to stop, not all that there is.
TEST(TimeLaws, SeeAsFarAsTheyHaveToUnderAFeedThatSwings) {
  for (const bench::Program& program :
       {bench::freeform(600, 0.01, 100, 1), bench::zigzag(0.05, 50)}) {
    Drive d(program, true);
    int cycles = 0;
    while (!d.done() && d.rig.faults.empty()) {
      d.rig.intent.feed_override = 0.7 + 0.3 * std::sin(cycles++ * 0.0044);
      d.cycle();
    }
    d.expect_limits();
    const LawMaker::Count& n = d.rig.planner.law_counts().children;
    std::printf("%s: %d children in %.1f s, %.0f intervals\n", program.name.c_str(),
                static_cast<int>(n.all), cycles * 0.001,
                static_cast<double>(n.intervals) / static_cast<double>(n.all));
    EXPECT_LE(30 * n.failed, n.all);
    EXPECT_LT(n.intervals, 150 * n.all) << program.name;
  }
}

/// Where the path bends so much that no feed is reached a law is as good for another feed.
TEST(TimeLaws, StayWhereAnotherFeedHoldsNothingBack) {
  const bench::Program program = bench::fractal(4, 0.5, 0.05, 100);
  std::uint64_t children[2]{};
  int cycles[2]{};
  for (const bool swings : {false, true}) {
    Drive d(program, true);
    int& n = cycles[swings ? 1 : 0];
    for (; !d.done() && d.rig.faults.empty(); ++n) {
      if (swings) d.rig.intent.feed_override = 0.9 + 0.1 * std::sin(n * 0.01);
      d.cycle();
    }
    d.expect_limits();
    children[swings ? 1 : 0] = d.rig.planner.law_counts().children.all;
  }
  EXPECT_LE(children[1], children[0] + 3);
  EXPECT_NEAR(cycles[1], cycles[0], 3);
}

/// What no move of the program follows: the rapid override beside feed moves, be they long or short.
TEST(TimeLaws, AreNotChangedByWhatNoMoveFollows) {
  bench::ProgramWriter writer("long and short", 0.02, 60, false);
  for (int i = 0; i < 6; ++i) {
    writer.line({.x = 180, .y = 2.0 * i});
    for (int k = 1; k <= 20; ++k) writer.line({.x = 180 - 0.1 * k, .y = 2.0 * i + 0.1 * k});
    writer.line({.x = 0, .y = 2.0 * i + 2});
  }
  const bench::Program program = writer.done();
  for (const double jerk : {0.0, 50000.0}) {
    Drive still(program, true, jerk), swings(program, true, jerk);
    int n = 0;
    for (; !still.done() && still.rig.faults.empty() && n < 100000; ++n) {
      swings.rig.intent.rapid_override = 0.7 + 0.3 * std::sin(n * 0.01);
      still.cycle();
      swings.cycle();
      ASSERT_EQ(still.rig.status().pos_cmd, swings.rig.status().pos_cmd)
          << "cycle " << n << ", jerk " << jerk;
    }
    EXPECT_TRUE(swings.done());
    EXPECT_GT(n, 1000);
  }
}

/// Lathes and the like: an axis that is not there does not make stops seem long, for which laws would be made anew all the time.
TEST(TimeLaws, AreMadeNoMoreOftenWhereAnAxisIsMissing) {
  std::uint64_t children[2]{};
  for (const bool lathe : {false, true}) {
    bench::ProgramWriter writer("waves", 0.02, 60, false);
    for (int i = 1; i <= 800; ++i) writer.line({.x = 3 * std::sin(i * 0.05), .z = -0.3 * i});
    const bench::Program program = writer.done();
    const std::vector<int> axes = lathe ? std::vector{0, 2} : std::vector{0, 1, 2};
    test::Drive d(program, 50000, true, test::RigKinematics(axes));
    while (!d.done() && d.rig.faults.empty()) d.cycle();
    EXPECT_TRUE(d.rig.faults.empty());
    EXPECT_LE(d.oracle.jerk, 1.01);
    children[lathe ? 1 : 0] = d.rig.planner.law_counts().children.all;
  }
  std::printf("children: %d, on a lathe %d\n", static_cast<int>(children[0]),
              static_cast<int>(children[1]));
  EXPECT_GT(children[0], 3U);
  EXPECT_LE(children[1], 2 * children[0]);
}

/// Where a feed changes and where an output stands a hair before the end of a stretch: a sliver of path, over which no law was found.
TEST(TimeLaws, AreFoundThroughFeedsAndOutputs) {
  for (const double step : {0.35, 0.05}) {
    bench::ProgramWriter writer("waves", 0.02, 60, false);
    bench::Program program = writer.done();
    for (int i = 1; i <= 400; ++i) {
      Pose to;
      to.x = i * step;
      to.y = std::sin(to.x * 1.7) + 0.3 * std::sin(to.x * 4.1);
      LinearMove line;
      line.end = to;
      line.vel_mm_s = i % 2 == 0 ? 60 : 55;
      program.items.emplace_back(line);
      program.items.emplace_back(
          OutputChange{.index = 1, .synchronised = true, .value = i % 2 == 0 ? 1.0 : 0.0});
    }
    Drive drive(program, true);
    drive.finish();
    drive.expect_limits();
    const LawMaker::Counts& c = drive.rig.planner.law_counts();
    EXPECT_EQ(c.rests.failed, 0U);
    EXPECT_EQ(c.children.failed, 0U);
  }
  // A tiny move at the end of a program.
  bench::ProgramWriter writer("waves", 0.02, 60, false);
  for (int i = 1; i <= 60; ++i) writer.line({.x = i * 0.35, .y = std::sin(i * 0.6)});
  writer.line({.x = 60 * 0.35 + 1e-5, .y = std::sin(36.0) + 1e-5});
  const bench::Program program = writer.done();
  Drive drive(program, true);
  drive.finish();
  drive.expect_limits();
  EXPECT_EQ(drive.rig.planner.law_counts().children.failed, 0U);
  path::AxisLimits limits;
  double shortest = 1;
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    for (const PathSpan& span : bench::curve_of(bench::mixture(150, seed), 50000, limits))
      shortest = std::min(shortest, span.length);
  std::printf("shortest stretch of some mixtures: %g mm\n", shortest);
  EXPECT_GT(shortest, 1e-5);
}

TEST(TimeLaws, AHoldBeginsSoonAndWhatIsLeftIsDriven) {
  for (const auto& program : curves()) {
    Drive d(program, true);
    int holds = 0, longest = 0;
    for (int at = 150;; at += 170) {
      if (d.run_until([&] { return d.done() || at-- <= 0; }) < 0 || d.done()) break;
      d.rig.orders.hold = true;
      const int cycles = d.run_until([&] { return d.stands(); }, 2000);
      ASSERT_GT(cycles, 0) << program.name;
      longest = std::max(longest, cycles);
      ++holds;
      for (int i = 0; i < 30; ++i) d.cycle();
      ASSERT_TRUE(d.stands());
      d.rig.orders.hold = false;
      at = 0;
      if (holds > 12) break;
    }
    d.rig.orders.hold = false;
    EXPECT_GT(d.finish(), 0) << program.name;
    d.expect_limits();
    EXPECT_LT(longest, 400) << program.name;
    std::printf("%-30s %d holds, at most %d ms\n", program.name.c_str(), holds, longest);
  }
}

TEST(TimeLaws, WithoutAPlannerTheRunningLawEndsInRest) {
  const bench::Program program = curves()[0];
  Drive d(program, true);
  for (int i = 0; i < 400; ++i) d.cycle();
  d.rig.plan = false;
  ASSERT_GT(d.run_until([&] { return d.stands(); }, 3000), 0);
  d.expect_limits();
}

}  // namespace
}  // namespace kerf::motion
