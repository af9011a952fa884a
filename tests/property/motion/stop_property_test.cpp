// How soon and how fast the path stops, at any moment of the benchmark's programs: hold, abort, a lost heartbeat; and how soon an override is in force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "bench/motion/families.hpp"
#include "bench/motion/runs.hpp"
#include "motion/core/ramp.hpp"
#include "property/motion/drive.hpp"

namespace kerf {
namespace {

using motion::Fault;
using motion::MotionStatus;
using motion::PathSpan;
using motion::test::Rig;
namespace path = motion::path;

constexpr double kJerk = 50000;
constexpr std::size_t kJoints = 4;
/// Of the least time; and what cycles add: the one in which the order comes, and the one in which it comes to rest.
constexpr double kSlower = 1.1;
constexpr int kCycles = 2;
/// A stop or an override is in force by then (cycles).
constexpr int kInForce = 20;

enum class Order { hold, abort, heartbeat };

struct Drive : motion::test::Drive {
  using motion::test::Drive::Drive;
  void give(Order order) {
    if (order == Order::hold) rig.orders.hold = true;
    if (order == Order::abort) rig.abort();
    if (order == Order::heartbeat) rig.heart = false;
  }
};

/// Where the machine is on the curve.
struct Place {
  std::size_t span{0};
  double s{0}, x{0};  ///< of its piece; (dsigma/dt)^2
};

/// Index of the stretch in execution in the curve, and how far along it. False: between moves, or too slow to tell.
bool place_of(const Drive& drive, const std::vector<PathSpan>& curve, Place& out) {
  const PathSpan* move = drive.rig.controller->executor().move();
  if (move == nullptr || move->number >= curve.size()) return false;
  out.span = static_cast<std::size_t>(move->number);
  const PathSpan& span = curve[out.span];
  out.s = span.from + span.length - drive.rig.controller->executor().left();
  const path::Vec slope = span.piece.first(out.s);
  const double rate = span.piece.feed.metric < 0
                          ? 1.0
                          : path::norm3(slope, static_cast<std::size_t>(span.piece.feed.metric));
  if (rate < 1e-3) return false;
  out.x = std::pow(drive.speed() / rate, 2);
  const path::Vec at = span.piece.point(out.s), is = path::to_vec(drive.rig.status().pos_cmd);
  EXPECT_LT(path::max_abs(at - is), 1e-6) << "another curve";
  return out.x > 1;
}

/// Braking as hard as the joints can, at the places of a fine grid only.
double least_stop_s(const std::vector<PathSpan>& curve, const path::AxisLimits& limits, Place at) {
  constexpr int kSteps = 400;
  double seconds = 0, x = at.x;
  const double step = at.x / (2 * 2500.0) / kSteps;
  while (x > 0) {
    const PathSpan& span = curve[at.span];
    const double left = span.from + span.length - at.s;
    if (left <= 1e-12) {
      if (span.stop_at_end || at.span + 1 >= curve.size()) break;
      ++at.span;
      at.s = curve[at.span].from;
      continue;
    }
    const double h = std::min(step, left);
    const path::Vec p = span.piece.first(at.s), e = span.piece.second(at.s);
    double least = -1e9, most = 1e9;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(p[j]) < 1e-12) continue;
      // |p u + e x| <= A
      const double bend = (p[j] > 0 ? e[j] : -e[j]) * x;
      least = std::max(least, (-limits.acc[j] - bend) / std::abs(p[j]));
      most = std::min(most, (limits.acc[j] - bend) / std::abs(p[j]));
    }
    // Where an axis turns while all of its acceleration bends the path rounding would ask for any u.
    least = std::min(least, most);
    const double after = std::max(0.0, x + 2 * least * h);
    const double way = after > 0 ? h : x / (-2 * least);
    seconds += 2 * way / (std::sqrt(x) + std::sqrt(after));
    x = after;
    at.s += h;
  }
  return seconds;
}

std::vector<bench::Program> programs() {
  return {bench::zigzag(0.05, 100), bench::arc_spiral(0.1, 80), bench::freeform(800, 0.01, 100, 1),
          bench::fractal(4, 0.5, 0.05, 100), bench::mixture(60, 1)};
}

/// Cycles from the order to rest; -1: never. A lost heartbeat is noticed after its time only.
int stop(Drive& drive, Order order) {
  drive.give(order);
  if (order == Order::heartbeat)
    while (!drive.rig.saw(Fault::heartbeat_lost) && drive.speed() > 0) drive.cycle();
  for (int i = 0; i < 5000; ++i) {
    if (drive.speed() <= 0) {
      EXPECT_LE(drive.oracle.acc, 1.001);
      EXPECT_LE(drive.oracle.jerk, 1.01);
      return i;
    }
    drive.cycle();
  }
  return -1;
}

TEST(Stops, LimitedInAccelerationTakeTheLeastTimeAtAnyMoment) {
  const int count = motion::test::property_count(12);
  double worst = 0;
  for (const bench::Program& program : programs()) {
    path::AxisLimits limits;
    const std::vector<PathSpan> curve = bench::curve_of(program, 0, limits);
    std::mt19937_64 random(7);
    for (int i = 0; i < count; ++i) {
      const int when = 20 + static_cast<int>(random() % 3000);
      SCOPED_TRACE(program.name + ", cycle " + std::to_string(when));
      Drive drive(program, 0);
      drive.run(when);
      Place at;
      if (drive.done() || !place_of(drive, curve, at)) continue;
      const double least = least_stop_s(curve, limits, at);
      const int cycles = stop(drive, i % 2 == 0 ? Order::hold : Order::abort);
      ASSERT_GE(cycles, 0);
      EXPECT_LE(cycles, kSlower * least / Rig::kPeriod + kCycles);
      worst = std::max(worst, (cycles - kCycles) * Rig::kPeriod / least);
    }
  }
  std::printf("slowest stop: %.3f of the least time\n", worst);
}

TEST(Stops, LimitedInJerkTakeTheLeastTimeOnStraights) {
  const int count = motion::test::property_count(30);
  const bench::Program program = bench::zigzag(0, 100);
  std::mt19937_64 random(7);
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    const int when = 20 + static_cast<int>(random() % 5000);
    SCOPED_TRACE("cycle " + std::to_string(when));
    Drive drive(program, kJerk);
    drive.run(when - 1);
    const double before = drive.speed();
    drive.cycle();
    const PathSpan* move = drive.rig.controller->executor().move();
    const double v = drive.speed();
    if (move == nullptr || !move->piece.straight() || v <= 1) continue;
    // The acceleration is that of half a cycle before.
    const motion::RampLimits limits{move->even_acc, move->even_jerk};
    const double acc = (v - before) / Rig::kPeriod;
    const double least =
        motion::ramp_to({v, std::clamp(acc, -limits.acc, limits.acc)}, 0, limits).duration();
    const int cycles = stop(drive, i % 2 == 0 ? Order::hold : Order::abort);
    ASSERT_GE(cycles, 0);
    EXPECT_LE(cycles, kSlower * least / Rig::kPeriod + kCycles);
    worst = std::max(worst, (cycles - kCycles) * Rig::kPeriod / least);
  }
  std::printf("slowest stop: %.3f of the least time\n", worst);
}

/// Corners that are passed: laws drive, and a stop that stands ready begins within kInForce. From each of the moments until then it would take the
/// least time. Only where the straight has room for all of them.
TEST(Stops, OfTimeLawsTakeTheLeastTimeOnStraightsFromWhereTheyBegin) {
  const int count = motion::test::property_count(60);
  const bench::Program program = bench::zigzag(0.05, 100);
  path::AxisLimits axes;
  (void)bench::curve_of(program, kJerk, axes);
  std::mt19937_64 random(7);
  double worst = 0;
  int seen = 0;
  for (int i = 0; i < count; ++i) {
    const int when = 20 + static_cast<int>(random() % 5000);
    SCOPED_TRACE("cycle " + std::to_string(when));
    Drive drive(program, kJerk), on(program, kJerk);
    drive.run(when);
    on.run(when - 1);
    double before = on.speed(), latest = 0;
    bool room = true;
    for (int k = 0; k <= kInForce && room; ++k) {
      on.cycle();
      const motion::Executor& path = on.rig.controller->executor();
      const PathSpan* move = path.move();
      const double v = on.speed(), acc = (v - before) / Rig::kPeriod;
      before = v;
      room = move != nullptr && move->piece.straight() && v > 1;
      if (!room) break;
      const path::Box box = path::straight_box(move->piece, axes);
      const motion::RampLimits limits{box.acc, box.jerk};
      const motion::RampState state{v, std::clamp(acc, -limits.acc, limits.acc)};
      const motion::Ramp ramp = motion::ramp_to(state, 0, limits);
      room = path.left() > kSlower * ramp.distance(state);
      latest = std::max(latest, k * Rig::kPeriod + kSlower * ramp.duration());
    }
    if (!room) continue;
    ++seen;
    const int cycles = stop(drive, i % 2 == 0 ? Order::hold : Order::abort);
    ASSERT_GE(cycles, 0);
    EXPECT_LE(cycles, latest / Rig::kPeriod + kCycles);
    worst = std::max(worst, (cycles - kCycles) * Rig::kPeriod / latest);
  }
  EXPECT_GT(seen, count / 6);
  std::printf("slowest of %d stops: %.3f of the latest that is allowed\n", seen, worst);
}

TEST(Stops, ALostHeartbeatStopsOnThePathLikeAHold) {
  for (const double jerk : {0.0, kJerk})
    for (const bench::Program& program : programs()) {
      SCOPED_TRACE(program.name);
      Drive held(program, jerk), lost(program, jerk);
      held.run(400);
      lost.run(400);
      // Until it is noticed the path goes on as if nothing were.
      lost.give(Order::heartbeat);
      while (!lost.rig.saw(Fault::heartbeat_lost) && !lost.done()) {
        lost.cycle();
        if (!lost.rig.saw(Fault::heartbeat_lost)) held.cycle();
      }
      held.give(Order::hold);
      held.cycle();
      for (int i = 0; i < 2000 && (held.speed() > 0 || lost.speed() > 0); ++i) {
        EXPECT_EQ(held.rig.status().pos_cmd, lost.rig.status().pos_cmd) << "cycle " << i;
        held.cycle();
        lost.cycle();
      }
      EXPECT_EQ(lost.speed(), 0);
      EXPECT_EQ(held.rig.status().pos_cmd, lost.rig.status().pos_cmd);
    }
}

/// Beside a twin that nobody touches: where that one neither brakes nor is about to, orders show within 20 ms.
TEST(Stops, OrdersAndOverridesAreInForceWithin20ms) {
  const int count = motion::test::property_count(6);
  for (const double jerk : {0.0, kJerk})
    for (const bench::Program& program : programs()) {
      std::mt19937_64 random(11);
      for (int i = 0; i < count; ++i) {
        const int when = 20 + static_cast<int>(random() % 1500);
        const int kind = static_cast<int>(random() % 3);
        SCOPED_TRACE(program.name + ", cycle " + std::to_string(when) + ", order " +
                     std::to_string(kind) + (jerk > 0 ? ", jerk" : ""));
        Drive one(program, jerk), twin(program, jerk);
        one.run(when);
        twin.run(when);
        if (twin.done() || twin.speed() <= 1) continue;
        if (kind == 2)
          one.rig.intent.feed_override = 0.05;
        else
          one.give(kind == 1 ? Order::abort : Order::hold);
        one.run(kInForce);
        double gains[kInForce];
        for (double& gain : gains) {
          const double before = twin.speed();
          twin.cycle();
          gain = twin.speed() - before;
        }
        if (gains[kInForce - 1] < 0 || gains[kInForce - 1] < gains[0] || twin.speed() <= 1)
          continue;
        EXPECT_LT(one.speed(), twin.speed());
      }
    }
}

}  // namespace
}  // namespace kerf
