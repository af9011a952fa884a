// Time laws on whole programs: limits in every cycle, less time than without, and holds that begin soon.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "bench/motion/families.hpp"
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
