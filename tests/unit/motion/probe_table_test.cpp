// G38.2 to G38.5 with contact and loss at each cycle of the approach, and with contacts that bounce until the machine stands.
//
// With KERF_COUNT set, each kind of bounce in each cycle instead of one of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

ProbeMove probe(double x, double vel, bool until_open) {
  ProbeMove p;
  p.end.x = x;
  p.vel_mm_s = vel;
  p.until_open = until_open;
  p.fail_is_error = true;
  return p;
}

struct Outcome {
  Pose probed;
  double rest{0}, first_fb{0}, first_vel{0};
  int cycles{0};
  bool tripped{false}, done{false};
};

/// `contact(cycle since the edge)`: whether the contact is as waited for, from the edge on.
template <class F>
Outcome approach(Rig& rig, bool until_open, double vel, int edge, F&& contact) {
  Outcome out;
  rig.in.probe = until_open;
  rig.push(probe(4, vel, until_open));
  const auto seq = rig.seq;
  for (int i = 0; i < 2000; ++i) {
    const bool met = i >= edge && contact(i - edge);
    rig.in.probe = met != until_open;
    if (i == edge) {
      out.first_fb = rig.in.joint[0].motor_pos_fb;
      out.first_vel = rig.status().joint[0].vel_cmd;
    }
    rig.cycle();
    if (rig.status().executed_seq >= seq || !rig.faults.empty()) {
      out.cycles = i + 1;
      break;
    }
  }
  out.done = rig.status().executed_seq >= seq;
  out.probed = rig.status().probed;
  out.tripped = rig.status().probe_tripped;
  out.rest = rig.status().pos_cmd.x;
  return out;
}

/// How many cycles the whole move takes.
int length_of(double vel, double jerk) {
  Rig rig;
  for (auto& j : rig.config.joint) j.max_jerk = jerk;
  rig.ready();
  ProbeMove p = probe(4, vel, false);
  p.fail_is_error = false;
  rig.push(p);
  return rig.finish(3000);
}

TEST(ProbeTable, TheFirstEdgeCountsWhateverTheContactDoesThen) {
  const double vel = 40;
  const bool all = std::getenv("KERF_COUNT") != nullptr;
  int cases = 0;
  double farthest = 0;
  for (const double jerk : {0.0, 30000.0}) {
    const int length = length_of(vel, jerk);
    ASSERT_GT(length, 50);
    // The last two cycles may already be those in which the end is met.
    for (int edge = 4; edge < length - 2; ++edge) {
      for (const bool until_open : {false, true}) {
        for (int bounce = 0; bounce < 4; ++bounce) {
          if (!all && bounce != (edge + (until_open ? 1 : 0)) % 4) continue;
          Rig rig;
          for (auto& j : rig.config.joint) j.max_jerk = jerk;
          rig.ready();
          const Outcome out = approach(rig, until_open, vel, edge, [&](int since) {
            switch (bounce) {
              case 1: return since == 0;               // met for a single cycle
              case 2: return since % 2 == 0;           // in each cycle of the stop
              case 3: return since < 3 || since > 15;  // once, for long
              default: return true;
            }
          });
          ASSERT_TRUE(rig.faults.empty())
              << edge << ' ' << bounce << " fault " << static_cast<int>(rig.faults[0].fault);
          ASSERT_TRUE(out.done) << edge;
          EXPECT_TRUE(out.tripped) << edge << ' ' << bounce;
          EXPECT_EQ(out.probed.x, out.first_fb) << edge << ' ' << bounce;
          // It brakes at once: 1000 mm/s2, with jerk also the time in which acceleration changes.
          const double v = vel, ramp = jerk > 0 ? 1000 / jerk : 0;
          EXPECT_LE(out.rest - out.first_fb, v * v / 2000 + v * (2 * ramp + 0.003)) << edge;
          EXPECT_LE(out.rest, 4 + 1e-9);
          ++cases;
          if (jerk == 0) farthest = std::max(farthest, out.rest - out.first_fb);
          rig.in.probe = false;
          rig.line({.x = 0}, 50);
          ASSERT_GT(rig.finish(3000), 0) << "the next move goes back from where it stands";
          EXPECT_TRUE(rig.faults.empty());
        }
      }
    }
  }
  std::printf(
      "result: probing at 40 mm/s, contact and loss in each cycle of the approach, four kinds of "
      "bounce: "
      "%d cases, all latched at the first edge; at rest at most %.3f mm after it (0.800 to "
      "brake)\n",
      cases, farthest);
}

TEST(ProbeTable, AContactAtTheStartIsSaidAndNothingMoves) {
  for (const bool until_open : {false, true}) {
    Rig rig;
    rig.ready();
    const Outcome out = approach(rig, until_open, 40, 0, [](int) { return true; });
    EXPECT_TRUE(rig.saw(Fault::probe_already_tripped));
    EXPECT_FALSE(out.tripped);
    EXPECT_EQ(rig.status().pos_cmd.x, 0);
  }
}

/// In a move that does not probe: at each cycle the path stops within its limits and says so.
TEST(ProbeTable, AContactInAFeedOrRapidStopsThePath) {
  for (const MotionKind kind : {MotionKind::feed, MotionKind::traverse}) {
    for (int edge = 4; edge < 100; ++edge) {
      Rig rig;
      rig.ready();
      rig.line({.x = 4}, 40, kind);
      rig.line({.x = 8}, 40, kind);
      rig.run(edge);
      const double at = rig.status().pos_cmd.x, v = rig.status().joint[0].vel_cmd;
      if (v <= 0) continue;  // a contact where the machine stands is nobody's
      rig.in.probe = true;
      rig.run(300);
      EXPECT_TRUE(rig.saw(Fault::probe_unexpected)) << edge;
      EXPECT_LE(rig.status().pos_cmd.x - at, v * v / 2000 + 0.003 * 100) << edge;
      EXPECT_TRUE(rig.status().in_position);
      EXPECT_FALSE(rig.saw(Fault::limit_acceleration));
    }
  }
}

/// NO_PROBE_JOG_ERROR, NO_PROBE_HOME_ERROR: what ends at a contact, and what goes on.
TEST(ProbeTable, JogsAndHomingEndAtAContactUnlessAllowed) {
  for (const bool allowed : {false, true}) {
    for (const bool homing : {false, true}) {
      for (int edge = 1; edge < 60; edge += 4) {
        Rig rig;
        rig.config.probe_error_inhibit_jog = rig.config.probe_error_inhibit_home = allowed;
        rig.config.joint[0].home_search_vel = 40;
        rig.config.joint[0].home_latch_vel = -4;
        rig.apply_config();
        rig.enable();
        if (homing) {
          ++rig.intent.home_seq;
          rig.intent.home_joint = 0;
        } else {
          rig.intent.joint_jog[0] = {1, JogIntent::Kind::continuous, 40, 0};
        }
        rig.run(edge);
        const double at = rig.status().joint[0].pos_cmd;
        rig.in.probe = true;
        rig.run(200);
        EXPECT_EQ(rig.saw(Fault::probe_unexpected), !allowed) << homing << edge;
        EXPECT_EQ(rig.status().in_position, !allowed) << homing << edge;
        if (!allowed) {
          EXPECT_LE(rig.status().joint[0].pos_cmd - at, 40 * 40 / 2000.0 + 0.1);
        }
        EXPECT_FALSE(rig.status().joint[0].homed);
      }
    }
  }
}

}  // namespace
}  // namespace kerf::motion
