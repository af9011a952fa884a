// Random programs under random overrides, holds and aborts: limits, path and ends.
#include <gtest/gtest.h>

#include "bench/motion/machines.hpp"
#include "property/motion/random_program.hpp"
#include "unit/motion/polar_kinematics.hpp"

namespace kerf::motion {
namespace {

using test::deviation;
using test::Oracle;
using test::Random;
using test::Rig;

struct Program {
  std::vector<PathItems::Variant> move;
  std::vector<Pose> start, end;
};

Program random_program(const Rig& rig, const Pose& from, Random& r, int moves) {
  Program p;
  Pose at = from, end;
  for (int i = 0; i < moves; ++i) {
    p.move.push_back(test::random_move(rig, at, r, end));
    p.start.push_back(at);
    p.end.push_back(end);
    at = end;
  }
  return p;
}

/// How far a point is from the program near its move `i`: a blend belongs to both of its moves.
double off(const Program& program, std::size_t i, const Pose& at, double allowed) {
  double best = 1e9;
  for (std::size_t k = i < 3 ? 0 : i - 3; k < program.move.size() && k <= i + 3; ++k)
    best = std::min(best, deviation(program.move[k], program.start[k], at));
  if (best <= std::max(allowed, 1e-6)) return best;
  // Near the centre of a spiral a small distance is a large angle: look for the nearest point.
  for (std::size_t k = i < 3 ? 0 : i - 3; k < program.move.size() && k <= i + 3; ++k)
    best = std::min(best, test::distance(program.move[k], program.start[k], at));
  return best;
}

/// Of a joint at half of its acceleration; with a jerk limit along the parts of the path that leave the least of both to braking.
double stop_time(const JointConfig& c) {
  if (!(c.max_jerk > 0)) return 2 * c.max_vel / c.max_acc;
  return c.max_vel / (0.06 * c.max_acc) + c.max_acc / (0.08 * c.max_jerk);
}

enum class Machine { plain, core_xy, table /**< that turns and tilts */, polar };

constexpr test::PolarKinematics kPolar;

test::RigKinematics moved_by(Machine machine, Random& r) {
  if (machine == Machine::polar) return test::RigKinematics(kPolar);
  if (machine == Machine::table) return test::RigKinematics(bench::kTable);
  test::RigKinematics out(test::random_axes(r));
  if (machine == Machine::core_xy) {
    out.core_xy = true;
    out.kind = KinematicsType::both;
  }
  return out;
}

/// One program on one machine; operators meddle.
void run_program(unsigned seed, Machine machine = Machine::plain, bool jerks = false) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  Rig rig(moved_by(machine, r));
  test::random_limits(rig, r, jerks);
  rig.ready();
  Oracle oracle;
  oracle.watch(rig);
  Program program = random_program(rig, rig.status().pos_cmd, r, r.integer(2, 8));
  // Any joint stops within this, at half of its acceleration: the path shares it with curvature, kinematics that mix axes keep a reserve.
  double stop_s = 0;
  for (std::size_t j = 0; j < rig.controller->joints(); ++j)
    stop_s = std::max(stop_s, stop_time(rig.config.joint[j]));
  const double p = r.chance(0.3) ? 0.0 : r.log(0.002, 0.5);
  PathControl control;
  control.mode = p > 0 ? PathControl::Mode::continuous : PathControl::Mode::exact_path;
  control.tolerance_mm = p;
  ASSERT_TRUE(rig.push(control));
  std::uint64_t first = rig.seq + 1;
  for (const auto& m : program.move) ASSERT_TRUE(rig.push(m));
  int aborts = r.integer(0, 2);
  bool meddle = true;
  double worst = 0;
  for (int cycle = 0; cycle < 400000; ++cycle) {
    if (meddle && r.chance(0.01))
      rig.intent.feed_override = r.chance(0.1) ? 0.0 : r.uniform(0.05, 2.5);
    if (meddle && r.chance(0.01)) rig.intent.rapid_override = r.uniform(0.1, 1);
    if (meddle && r.chance(0.003)) rig.orders.hold = !rig.orders.hold;
    if (cycle == (jerks ? 60000 : 20000)) {
      meddle = rig.orders.hold = false;
      rig.intent.feed_override = rig.intent.rapid_override = 1;
    }
    if (aborts > 0 && r.chance(0.002)) {
      --aborts;
      rig.abort();
      int cycles = 0;
      const std::uint64_t item = rig.status().current_seq;
      while (rig.status().acked_epoch != rig.orders.abort_epoch) {
        rig.cycle();
        oracle.watch(rig);
        ASSERT_LE(++cycles, stop_s / Rig::kPeriod + 25);
        if (item >= first)
          worst = std::max(worst, off(program, item - first, rig.status().pos_cmd, p));
      }
      rig.cycle();  // the planner forgets in its next turn
      oracle.watch(rig);
      ASSERT_TRUE(rig.status().path_empty);
      program = random_program(rig, rig.status().pos_cmd, r, r.integer(1, 5));
      first = rig.seq + 1;
      for (const auto& m : program.move) ASSERT_TRUE(rig.push(m));
      continue;
    }
    rig.cycle();
    oracle.watch(rig);
    const MotionStatus& s = rig.status();
    if (rig.controller->executor().move() != nullptr) {
      worst = std::max(worst, off(program, s.current_seq - first, s.pos_cmd, p));
    }
    if (s.executed_seq == rig.seq && s.path_empty) break;
  }
  EXPECT_EQ(rig.status().executed_seq, rig.seq) << "the end was not reached";
  EXPECT_EQ(rig.status().pos_cmd, program.end.back());
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
  EXPECT_LE(worst, p + 1e-6) << "P " << p;
  EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults[0].fault) << " value "
                                  << rig.faults[0].value << " limit " << rig.faults[0].limit;
}

TEST(PathProperty, AnyProgramKeepsLimitsAndPathAndReachesItsEnd) {
  const int count = test::property_count(300);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i));
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

TEST(PathProperty, WithJerkLimitsToo) {
  const int count = test::property_count(25);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::plain, true);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

TEST(PathProperty, KinematicsThatMixAxesWithJerkLimits) {
  const int count = test::property_count(20);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::core_xy, true);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

TEST(PathProperty, ATiltingTableWithJerkLimits) {
  const int count = test::property_count(25);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::table, true);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

/// 20: places of even speed a hair before the end of a stretch at a crawl.
TEST(PathProperty, ThroughTheNeighbourhoodOfAPoleWithJerkLimits) {
  const int count = test::property_count(20);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::polar, true);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

TEST(PathProperty, ThroughTheNeighbourhoodOfAPole) {
  const int count = test::property_count(40);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::polar);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

/// 19: a spiral that ends on the ray of its start; 270, 492: limits between the samples of spirals and tilted helices.
TEST(PathProperty, SeedsThatFailedOnce) {
  for (const unsigned seed : {18U, 19U, 270U, 492U}) run_program(seed);
}

TEST(PathProperty, KinematicsThatMixAxesKeepTheLimitsOfTheirJoints) {
  const int count = test::property_count(100);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), Machine::core_xy);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

/// Cycles for a program at a constant override.
int cycles_for(unsigned seed, double override_factor) {
  Random r(seed);
  Rig rig(test::random_axes(r));
  test::random_limits(rig, r);
  rig.config.max_feed_override = 4;
  rig.apply_config();
  rig.ready();
  const Program program = random_program(rig, rig.status().pos_cmd, r, 4);
  rig.intent.feed_override = override_factor;
  for (const auto& m : program.move) (void)rig.push(m);
  return rig.finish(4000000);
}

TEST(PathProperty, ALargerOverrideIsNeverSlower) {
  const int count = test::property_count(40);
  for (int i = 1; i <= count; ++i) {
    int before = 1 << 30;
    for (const double k : {0.2, 0.5, 1.0, 1.5, 4.0}) {
      const int now = cycles_for(static_cast<unsigned>(i), k);
      ASSERT_GT(now, 0) << "seed " << i;
      ASSERT_LE(now, before) << "seed " << i << " override " << k;
      before = now;
    }
  }
}

TEST(PathProperty, SplittingALineOnlyAddsItsStops) {
  // Two halves of a line take as long as two lines: the rest of a cycle is never lost at a corner.
  Rig one, two;
  one.ready();
  two.ready();
  two.push(PathControl{.mode = PathControl::Mode::exact_stop});
  one.line({.x = 7.123}, 60);
  two.line({.x = 3.5}, 60);
  two.line({.x = 7.123}, 60);
  const int a = one.finish(), b = two.finish();
  EXPECT_NEAR(b - a, 60 / 1000.0 / Rig::kPeriod, 1.01);
}

}  // namespace
}  // namespace kerf::motion
