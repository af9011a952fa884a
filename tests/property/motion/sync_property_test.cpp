// Random threads and taps behind random spindles, under overrides, holds and aborts: limits, step, ends.
#include <gtest/gtest.h>

#include "motion/api/faults.hpp"
#include "property/motion/random_program.hpp"
#include "unit/motion/spindle_rig.hpp"

namespace kerf::motion {
namespace {

using test::Oracle;
using test::Random;
using test::SpindleRig;

Pose random_end(const SpindleRig& rig, const Pose& from, Random& r, double length) {
  Pose end = from;
  double d[3] = {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)};
  const double k = length / std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (std::size_t i = 0; i < 3; ++i) end[i] += d[i] * k;
  if ((rig.kinematics.axis_mask() & 8U) != 0 && r.chance(0.3)) end.a += r.uniform(-20, 20);
  return end;
}

/// What is only told, or refused before anything moves.
bool harmless(Fault f) {
  return f == Fault::sync_behind || f == Fault::sync_too_fast || f == Fault::sync_too_short;
}

/// `passes`: some cuts have a second pass behind them, whose index is asked for on the way back.
void run_program(unsigned seed, bool core_xy, bool passes) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  test::RigKinematics moved_by(r.chance(0.3) ? std::vector<int>{0, 1, 2, 3}
                                             : std::vector<int>{0, 1, 2});
  moved_by.core_xy = core_xy;
  SpindleRig rig(moved_by);
  test::random_limits(rig, r, seed % 3 == 1);
  rig.acceleration = r.chance(0.15) ? 0 : r.log(5, 500);
  rig.counts = r.chance(0.3) ? 0 : std::floor(r.log(60, 4000));
  rig.angle = r.uniform(-5, 5);
  rig.ready();
  PathControl control;
  control.tolerance_mm = r.log(0.002, 0.2);
  if (r.chance(0.3)) control.mode = PathControl::Mode::exact_path;
  rig.push(control);
  Oracle oracle;
  oracle.watch(rig);
  Pose at = rig.status().pos_cmd;
  double told = 0, worst_untold = 0, pitch = 1;
  for (int item = 0; item < 6; ++item) {
    const double rpm = r.log(60, 3000);
    pitch = r.log(0.3, 4);
    rig.turn(rpm, r.chance(0.7));
    const bool tap = r.chance(0.4);
    Pose end = random_end(rig, at, r, r.log(2, 20));
    if (tap) {
      rig.tap(end, pitch, r.chance(0.5) ? 1 : r.uniform(0.5, 2));
      end = at;
    } else {
      rig.thread(end, pitch);
      while (r.chance(0.4)) {
        end = random_end(rig, end, r, r.log(1, 10));
        rig.thread(end, pitch * (r.chance(0.5) ? 1.0 : r.uniform(0.5, 2)));
      }
    }
    if (passes && r.chance(0.4)) {
      rig.line(at, 0, MotionKind::traverse);
      if (tap)
        rig.tap(random_end(rig, at, r, r.log(2, 20)), pitch, 1);
      else
        rig.thread(random_end(rig, at, r, r.log(2, 20)), pitch);
    }
    rig.line(at, 0, MotionKind::traverse);
    const bool aborts = r.chance(0.3);
    const int abort_at = r.integer(1, 3000);
    const std::uint64_t passed = rig.faults.size();
    int cycle = 0;
    double lag_before = 0;
    while (rig.status().executed_seq < rig.seq || !rig.status().path_empty) {
      const bool meddle = cycle < 30000;
      if (meddle && r.chance(0.003))
        rig.disturbance = r.chance(0.5) ? 0 : r.uniform(-0.2, 0.2) * rpm / 60;
      if (meddle && r.chance(0.01)) rig.intent.feed_override = r.uniform(0, 2);
      if (meddle && r.chance(0.003)) rig.orders.hold = !rig.orders.hold;
      if (cycle == 30000) {
        rig.orders.hold = false;
        rig.disturbance = 0;
        rig.intent.feed_override = 1;
      }
      rig.cycle();
      oracle.watch(rig);
      const MotionStatus& s = rig.status();
      // A thread leaves its spindle when it stops at its end; a tap never does.
      if (tap && rig.faults.size() == passed && s.sync_in_step)
        worst_untold = std::max(worst_untold, std::abs(lag_before) - std::max(0.25 * pitch, 0.1));
      lag_before = s.sync_in_step ? s.sync_lag_mm : 0;
      if (rig.faults.size() > passed) {
        const FaultRecord& f = rig.faults.back();
        ASSERT_TRUE(harmless(f.fault)) << fault_text(f, rig.config);
        ++told;
      }
      const bool refused =
          rig.faults.size() > passed && rig.faults.back().fault != Fault::sync_behind;
      if (refused || (aborts && cycle == abort_at)) {
        rig.abort();
        // As task does.
        ++rig.intent.spindle_stop_seq[0];
        rig.orders.hold = false;
        int took = 0;
        while (rig.status().acked_epoch != rig.orders.abort_epoch) {
          rig.cycle();
          oracle.watch(rig);
          ASSERT_LE(++took, 10000);
        }
        rig.cycle();
        oracle.watch(rig);
        ASSERT_TRUE(rig.status().path_empty);
        ASSERT_FALSE(rig.in.spindle[0].index_enable);
        break;
      }
      ASSERT_LT(++cycle, 400000) << "the end was not reached: item " << item
                                 << (tap ? " tap" : " thread") << " waits "
                                 << static_cast<int>(s.waiting_for) << " lag " << s.sync_lag_mm
                                 << " in step " << s.sync_in_step << " v " << s.vel_mm_s << " rps "
                                 << rig.rps << " counts " << rig.counts << " to go "
                                 << s.distance_to_go << " pitch " << pitch;
    }
    if (rig.status().executed_seq == rig.seq) {
      EXPECT_EQ(rig.status().pos_cmd, at);
    }
    at = rig.status().pos_cmd;
    rig.orders.hold = false;
    rig.disturbance = 0;
    EXPECT_LE(oracle.vel, 1.0001);
    EXPECT_LE(oracle.acc, 1.001);
    EXPECT_LE(oracle.jerk, 1.01);
    if (testing::Test::HasFailure()) return;
    control.tolerance_mm = r.log(0.002, 0.2);
    rig.push(control);
  }
  EXPECT_LE(worst_untold, 0.0);
}

TEST(SyncProperty, AnyThreadAndTapKeepsLimitsAndEnds) {
  const int count = test::property_count(120);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), i % 4 == 0, i % 3 != 0);
    if (HasFatalFailure() || HasNonfatalFailure()) break;
  }
}

/// 1367: a tap that came home braking hard. With jerk limits, 10: one that went to and fro at its start; 169: one that came home faster
/// than its axis may; 16 and 1030: threads that ended short of their end.
TEST(SyncProperty, SeedsThatFailedOnce) {
  for (const unsigned seed : {10U, 169U, 1030U, 1367U}) run_program(seed, false, false);
  run_program(16, true, true);
}

}  // namespace
}  // namespace kerf::motion
