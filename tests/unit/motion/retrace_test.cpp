// A negative adaptive feed: the path backwards, and forwards again.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

class Retrace : public testing::Test {
 protected:
  void start() {
    rig.ready();
    OverrideEnable e;
    e.feed = e.feed_hold = e.adaptive = true;
    rig.push(e);
    rig.run(3);
  }
  void factor(double f) { rig.in.adaptive_feed = f; }
  [[nodiscard]] const Pose& pos() const { return rig.status().pos_cmd; }
  void expect_no_fault() const {
    for (const auto& f : rig.faults)
      ADD_FAILURE() << "fault " << static_cast<int>(f.fault) << " value " << f.value;
  }
  Rig rig;
};

double distance_to_track(const Pose& p, const std::vector<Pose>& track) {
  double best = 1e9;
  for (std::size_t i = 0; i + 1 < track.size(); ++i) {
    const Pose d = track[i + 1] - track[i], q = p - track[i];
    const double len2 = d.x * d.x + d.y * d.y + d.z * d.z;
    const double dot = q.x * d.x + q.y * d.y + q.z * d.z;
    const double t = len2 > 0 ? std::clamp(dot / len2, 0.0, 1.0) : 0.0;
    best = std::min(best, std::hypot(q.x - t * d.x, q.y - t * d.y, q.z - t * d.z));
  }
  return best;
}

TEST_F(Retrace, ALineGoesBackToItsStartAndForwardsAgainToItsEnd) {
  start();
  rig.line({.x = 50}, 20);
  rig.run_until([&] { return pos().x > 30; });
  factor(-0.5);
  rig.run_until([&] { return rig.status().vel_mm_s == 0; }, 100);
  const double turned = pos().x;
  EXPECT_LT(turned, 31) << "it brakes as hard as the axis can";
  rig.run(500);
  EXPECT_NEAR(rig.status().vel_mm_s, 10, 1e-9) << "half of the programmed feed";
  EXPECT_LT(pos().x, turned - 4);
  rig.run(5000);
  EXPECT_NEAR(pos().x, 0, 1e-9);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_LT(rig.status().executed_seq, rig.seq);
  factor(1);
  rig.finish();
  EXPECT_EQ(pos().x, 50);
  expect_no_fault();
}

TEST_F(Retrace, BlendedCornersAndArcsAreDrivenBackOnTheSamePath) {
  start();
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.2});
  for (int i = 0; i < 6; ++i) {
    const double x = 10.0 * i;
    rig.line({.x = x + 5, .y = 8, .z = 0.1 * i}, 40,
             i == 3 ? MotionKind::traverse : MotionKind::feed);
    ArcMove arc;
    arc.end = {.x = x + 10, .y = 8, .z = 0.1 * i};
    arc.centre[0] = x + 7.5;
    arc.centre[1] = 8;
    arc.normal[2] = -1;
    arc.vel_mm_s = 30;
    rig.push(arc);
    rig.line({.x = x + 10, .y = 0, .z = 0.1 * i}, 35);
  }
  std::vector<Pose> track{pos()};
  rig.run_until([&] { return track.push_back(pos()), pos().x > 45; });
  factor(-1);
  double fastest = 0;
  rig.run_until(
      [&] {
        // While it brakes it goes on.
        if (rig.status().vel_mm_s > 0 && fastest == 0 && distance_to_track(pos(), track) > 1e-3)
          track.push_back(pos());
        else
          fastest = std::max(fastest, rig.status().vel_mm_s);
        EXPECT_LT(distance_to_track(pos(), track), 0.02) << pos().x << ' ' << pos().y;
        return pos().x < 12;
      },
      20000);
  EXPECT_GT(fastest, 25) << "at speed through the corners";
  // Back and forth at any moment.
  for (int i = 0; i < 40; ++i) {
    factor(i % 2 == 0 ? 0.7 : -1.3);
    rig.run(17 + 13 * (i % 7));
    EXPECT_LT(distance_to_track(pos(), track), 0.02);
  }
  factor(1);
  EXPECT_GT(rig.finish(), 0);
  EXPECT_EQ(pos(), (Pose{.x = 60, .y = 0, .z = 0.5}));
  expect_no_fault();
}

TEST_F(Retrace, ExactStopsAreStopsBackwardsToo) {
  start();
  rig.push(PathControl{.mode = PathControl::Mode::exact_stop});
  rig.line({.x = 10}, 50);
  rig.line({.x = 10, .y = 10}, 50);
  rig.line({.x = 20, .y = 10}, 50);
  rig.run_until([&] { return pos().x > 15; });
  factor(-1);
  rig.run_until([&] { return pos().x < 5; }, 3000);
  EXPECT_LT(pos().x, 5);
  EXPECT_NEAR(pos().y, 0, 1e-9);
  // A hold in the middle, then on in the other direction.
  factor(0);
  rig.run(200);
  const double held = pos().x;
  rig.run(100);
  EXPECT_EQ(pos().x, held);
  factor(1.2);
  rig.finish();
  EXPECT_EQ(pos(), (Pose{.x = 20, .y = 10}));
  expect_no_fault();
}

TEST_F(Retrace, ThePathIsKeptForItsDeclaredLength) {
  start();
  rig.push(PathControl{.mode = PathControl::Mode::exact_stop});
  for (int i = 1; i <= 900; ++i) rig.line({.x = 0.1 * i}, 50);
  rig.run_until([&] { return pos().x >= 80; });
  factor(-1);
  int still = 0;
  double last = pos().x;
  rig.run_until([&] {
    still = pos().x == last ? still + 1 : 0;
    last = pos().x;
    return still > 200;
  });
  const auto stretches = static_cast<std::size_t>(std::lround((80 - pos().x) / 0.1));
  EXPECT_GE(stretches, path::PathHistory::kGeneration);
  EXPECT_LE(stretches, 2 * path::PathHistory::kGeneration + 1);
  factor(1);
  rig.finish();
  EXPECT_EQ(pos().x, 0.1 * 900);
  expect_no_fault();
}

/// Without adaptive feed nothing was made ready for the way back.
TEST_F(Retrace, TurnsBackSoonOverALongWayThatNobodyExpectedToBeDrivenBack) {
  rig.ready();
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.01});
  const auto point = [](int i) {
    const double t = 0.05 * i;
    return Pose{.x = 0.4 * i, .y = 3 * std::sin(t)};
  };
  int sent = 0;
  rig.run_until([&] {
    while (sent < 700 && rig.path->size() < 400) rig.line(point(++sent), 60);
    return pos().x >= point(600).x;
  });
  rig.intent.backwards = true;
  double last = pos().x;
  const int turns = rig.run_until([&] { return std::exchange(last, pos().x) > pos().x; });
  EXPECT_LE(turns, 100);
  rig.run(200);
  EXPECT_NEAR(rig.status().vel_mm_s, 60, 0.5);
  rig.run_until([&] { return rig.status().vel_mm_s == 0; });
  EXPECT_LT(pos().x, point(600 - 125).x) << "all of what is kept: two stretches a line";
  rig.intent.backwards = false;
  rig.finish();
  EXPECT_NEAR(pos().x, point(700).x, 1e-9);
  expect_no_fault();
}

TEST_F(Retrace, DenseStreamsForgetTheirOldestPartAndStillStopInTime) {
  start();
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.05});
  int sent = 0;
  const auto point = [](int i) {
    const double t = 0.02 * i;
    return Pose{.x = 0.3 * i, .y = 5 * std::sin(t), .z = std::cos(2 * t) - 1};
  };
  for (int cycle = 0; cycle < 9000; ++cycle) {
    while (sent < 3000 && rig.path->size() < 900) {
      ++sent;
      rig.line(point(sent), 60);
    }
    if (cycle > 3000 && cycle % 1500 == 0) factor(-1.5);
    if (cycle > 3000 && cycle % 1500 == 1000) factor(1);
    rig.cycle();
  }
  factor(-1);
  rig.run(20000);
  EXPECT_EQ(rig.status().vel_mm_s, 0) << "it stands where the history begins";
  factor(1.5);
  rig.finish();
  EXPECT_EQ(pos(), point(3000));
  expect_no_fault();
}

TEST_F(Retrace, NothingIsDoneTwiceAndWhatIsNoMoveIsAnEnd) {
  start();
  rig.line({.x = 10}, 50);
  rig.push(Dwell{.seconds = 0.1});
  rig.line({.x = 20}, 50);
  rig.push(OutputChange{.index = 0, .synchronised = true, .value = 1});
  rig.push(OutputChange{.index = 1, .value = 1});
  rig.line({.x = 30}, 50);
  rig.push(OutputChange{.index = 0, .synchronised = true, .value = 0});
  rig.push(OutputChange{.index = 1, .value = 0});
  rig.line({.x = 40}, 50);
  rig.run_until([&] { return pos().x > 25; });
  EXPECT_EQ(rig.controller->outputs().digital, 3U);
  rig.run_until([&] { return pos().x > 35; });
  factor(-1);
  rig.run(3000);
  EXPECT_NEAR(pos().x, 10, 1e-9) << "not behind the dwell";
  factor(1);
  const int cycles = rig.run_until([&] {
    EXPECT_EQ(rig.controller->outputs().digital, 0U);
    return rig.status().executed_seq >= rig.seq;
  });
  EXPECT_LT(cycles, 800) << "no dwell";
  EXPECT_EQ(pos().x, 40);
  expect_no_fault();
}

TEST_F(Retrace, AMachineWithoutAPathDoesNotMove) {
  start();
  rig.line({.x = 10}, 50);
  rig.finish();
  factor(-1);
  rig.run(1000);
  EXPECT_EQ(pos().x, 10);
  // A move that begins while the factor is negative waits where it is.
  rig.line({.x = 20}, 50);
  rig.run(10);
  EXPECT_LE(pos().x, 10);
  rig.abort();
  rig.run(300);
  const double stands = pos().x;
  rig.run(300);
  EXPECT_EQ(pos().x, stands);
  factor(1);
  rig.run(300);
  EXPECT_EQ(pos().x, stands) << "the abort has dropped it";
}

TEST_F(Retrace, HoldAndAbortStopItBackwardsAsForwards) {
  start();
  rig.line({.x = 50, .y = 20}, 50);
  rig.line({.x = 50, .y = 90}, 50);
  rig.run_until([&] { return pos().y > 60; });
  factor(-1);
  rig.run(300);
  EXPECT_GT(rig.status().vel_mm_s, 40);
  rig.orders.hold = true;
  rig.run(120);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  const Pose held = pos();
  factor(1);
  rig.run(100);
  EXPECT_EQ(pos(), held);
  rig.orders.hold = false;
  rig.run(200);
  EXPECT_GT(rig.status().vel_mm_s, 40);
  factor(-1);
  rig.run(300);
  rig.abort();
  rig.run(100);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  const Pose stands = pos();
  rig.run(500);
  EXPECT_EQ(pos(), stands);
  factor(1);
  rig.line({.x = 1}, 50);
  rig.finish();
  EXPECT_EQ(pos().x, 1);
  expect_no_fault();
}

TEST_F(Retrace, OnlyWhereTheMachineMayReverse) {
  rig.config.adaptive_reverses = false;
  rig.apply_config();
  start();
  rig.line({.x = 50}, 20);
  rig.run_until([&] { return pos().x > 30; });
  factor(-1);
  rig.run(1000);
  EXPECT_GT(pos().x, 30);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
}

TEST_F(Retrace, AProbeContactOnTheWayBackStopsIt) {
  start();
  rig.line({.x = 50}, 20);
  rig.run_until([&] { return pos().x > 30; });
  factor(-1);
  rig.run(300);
  rig.in.probe = true;
  rig.run(300);
  EXPECT_TRUE(rig.saw(Fault::probe_unexpected));
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_GT(pos().x, 10);
}

}  // namespace
}  // namespace kerf::motion
