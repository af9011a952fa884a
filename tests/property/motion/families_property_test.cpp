// The programs of the planner's benchmark while an operator turns the override and holds: no cycle passes a limit of a joint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <variant>

#include "bench/motion/campaign.hpp"
#include "bench/motion/families.hpp"
#include "property/motion/random_program.hpp"

namespace kerf {
namespace {

using motion::test::Rig;

/// The reference machine with these jerk limits (0: none), by time laws or boxes; ready to run.
void prepare(Rig& rig, double jerk, bool laws) {
  bench::reference_machine(rig.config);
  rig.config.time_laws = laws;
  for (auto& j : rig.config.joint) j.max_jerk = jerk;
  rig.apply_config();
  rig.ready();
}

void run(const bench::Program& program, std::uint64_t seed, double jerk = 0) {
  SCOPED_TRACE(program.name + ", seed " + std::to_string(seed));
  Rig rig({0, 1, 2, 3});
  rig.config.max_feed_override = 2;
  prepare(rig, jerk, true);
  motion::test::Oracle oracle;
  std::mt19937_64 random(seed);
  std::size_t next = 0;
  for (int cycle = 0; cycle < 400000; ++cycle) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    if (random() % 150 == 0)
      rig.intent.feed_override = 0.03 + static_cast<double>(random() % 1000) / 512.0;
    if (random() % 200 == 0)
      rig.intent.rapid_override = 0.05 + static_cast<double>(random() % 900) / 1000.0;
    if (random() % (rig.orders.hold ? 60 : 700) == 0) rig.orders.hold = !rig.orders.hold;
    rig.cycle();
    oracle.watch(rig);
    ASSERT_TRUE(rig.faults.empty())
        << "fault " << static_cast<int>(rig.faults[0].fault) << " joint " << rig.faults[0].index
        << " value " << rig.faults[0].value << " limit " << rig.faults[0].limit;
    if (next == program.items.size() && rig.status().executed_seq == rig.seq &&
        rig.status().path_empty)
      break;
  }
  EXPECT_EQ(rig.status().executed_seq, rig.seq) << "the end was not reached";
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
}

TEST(Families, KeepTheLimitsUnderChangingOverrides) {
  const int count = motion::test::property_count(6);
  for (int i = 1; i <= count && !testing::Test::HasFailure(); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    run(bench::mixture(120, seed), seed);
    run(bench::freeform(800, 0.01, 100, seed), seed);
    run(bench::arc_spiral(0.1, 80), seed);
    run(bench::four_axis(60, 0.02, 100, i % 2 == 0, seed), seed);
    run(bench::relief(600, 0.01, 100, i % 2 == 0, seed, i % 3 == 0 ? 4 : 0.6), seed);
    run(bench::short_arcs(0.01, 80), seed);
    run(bench::fractal(4, 0.5, 0.05, 100), seed);
    run(bench::arc_wave(0.01, 80, 0.3), seed);
    run(bench::inverse_time(60, 0.02, seed), seed);
    run(bench::contour(60, i % 2 == 0 ? 0.05 : 0.5, 150, seed), seed);
  }
}

/// Longer than what the planner looks at together.
TEST(Families, KeepTheLimitsWhereThePathIsCut) {
  const int count = motion::test::property_count(2);
  for (int i = 1; i <= count && !testing::Test::HasFailure(); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    run(bench::wander(1500, seed), seed, i % 4 == 0 ? 0 : i % 4 == 1 ? 5000 : 50000);
  }
}

/// Small equal lines between long ones become corners of their own for the planner, which may stand there: not where two of them meet, though as
/// far along.
TEST(Families, ACornerThatWasJoinedIsWhereItIs) {
  const int count = motion::test::property_count(14);
  for (int n = 1; n <= count && !testing::Test::HasFailure(); ++n) {
    motion::test::Random r(static_cast<unsigned>(n));
    const double p_mm = r.log(0.001, 0.01);
    bench::ProgramWriter w("small lines", p_mm, 200, false);
    double heading = 0;
    motion::Pose at;
    const auto go = [&](double length) {
      at.x += length * std::cos(heading);
      at.y += length * std::sin(heading);
      w.line(at);
    };
    for (int i = 0; i < 40; ++i) {
      go(r.log(0.02, 3));
      const double size = p_mm * r.log(0.1, 4);
      for (int k = r.integer(0, 5); k > 0; --k) {
        heading += r.chance(0.5) ? 0.0 : r.chance(0.5) ? r.uniform(-0.1, 0.1) : r.uniform(-3, 3);
        go(size);
      }
      heading += r.uniform(-3, 3);
    }
    run(w.done(), static_cast<std::uint64_t>(n), 50000);
  }
}

/// The largest share of the feed in force, of the move in execution or the one before it, at an override that does not change.
double feed_share(const bench::Program& program, double jerk, double override_, bool laws) {
  Rig rig({0, 1, 2, 3});
  prepare(rig, jerk, laws);
  rig.intent.feed_override = override_;
  std::size_t next = 0;
  double before = 0, share = 0;
  for (int cycle = 0; cycle < 4'000'000; ++cycle) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    rig.cycle();
    const auto& s = rig.status();
    const double wanted = s.requested_vel_mm_s * override_;
    const bool feeds = s.kind == motion::MotionKind::feed || s.kind == motion::MotionKind::arc;
    if (feeds && wanted > 0 && before > 0)
      share = std::max(share, s.vel_mm_s / std::max(wanted, before));
    before = feeds ? wanted : 0;
    if (next == program.items.size() && s.executed_seq == rig.seq && s.path_empty) break;
  }
  EXPECT_TRUE(rig.faults.empty());
  return share;
}

TEST(Families, KeepTheProgrammedFeed) {
  const int count = motion::test::property_count(2);
  double worst[3]{};
  for (int i = 1; i <= count; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    for (const bench::Program& program :
         {bench::mixture(20, seed), bench::freeform(100, 0.01, 30, seed),
          bench::inverse_time(15, 0.02, seed), bench::contour(8, 0.05, 50, seed)})
      for (const double jerk : {0.0, 5000.0 * i, 50000.0})
        for (const double scale : {0.1, 1.0})
          for (const bool laws : {false, true}) {
            const double share = feed_share(program, jerk, scale, laws);
            const int kind = jerk > 0 ? 1 + laws : 0;
            worst[kind] = std::max(worst[kind], share);
            // With jerk limits what is told of a feed is a price, not a wall; it is passed for milliseconds where the feed or the path changes.
            EXPECT_LE(share, jerk > 0 ? 1.05 : 1.0001)
                << program.name << ", jerk " << jerk << ", override " << scale
                << (laws ? ", laws" : "");
          }
  }
  std::printf("at most %.4f of the feed in force, limited in jerk %.4f, by laws %.4f\n", worst[0],
              worst[1], worst[2]);
}

/// The fastest of the tool in XYZ, as a share of the one feed of a program of lines, turns and reversals of all sizes in wide blends; by the
/// joints' positions.
double tool_share(unsigned seed, double jerk, bool laws) {
  Rig rig({0, 1, 2, 3});
  prepare(rig, jerk, laws);
  motion::test::Random r(seed);
  const double feed = r.log(0.3, 60);
  rig.push(motion::PathControl{.tolerance_mm = r.log(0.01, 1), .naive_cam_tolerance_mm = 0.0});
  motion::Pose at;
  std::vector<motion::Pose> ends;
  for (int i = 0; i < 60; ++i) {
    const double size = r.log(0.005, std::min(feed, 10.0));
    const bool turns = r.chance(0.3);
    if (r.chance(0.4)) at.a += r.uniform(-size, size);
    if (!turns && r.chance(0.6)) at.x += r.uniform(-size, size);
    if (!turns) at.z += r.chance(0.5) ? size : -size;
    ends.push_back(at);
  }
  double most = 0;
  std::size_t next = 0;
  motion::Pose before;
  for (int cycle = 0; cycle < 400000; ++cycle) {
    while (next < ends.size() && rig.line(ends[next], feed)) ++next;
    rig.cycle();
    const auto& joint = rig.status().joint;
    const motion::Pose now{.x = joint[0].pos_cmd, .y = joint[1].pos_cmd, .z = joint[2].pos_cmd};
    most = std::max(most, std::hypot(now.x - before.x, now.y - before.y, now.z - before.z));
    before = now;
    if (next == ends.size() && rig.status().executed_seq == rig.seq && rig.status().path_empty)
      break;
  }
  EXPECT_TRUE(rig.faults.empty());
  EXPECT_EQ(next, ends.size());
  return most / Rig::kPeriod / feed;
}

TEST(Families, TheToolKeepsTheFeedInCornersAndBesideTurns) {
  const int count = motion::test::property_count(8);
  double worst[3]{};
  for (int i = 1; i <= count; ++i) {
    const auto seed = static_cast<unsigned>(i);
    for (const double jerk : {0.0, 5000.0, 200000.0})
      for (const bool laws : {false, true}) {
        const int kind = jerk > 0 ? 1 + laws : 0;
        const double share = tool_share(seed, jerk, laws);
        worst[kind] = std::max(worst[kind], share);
        EXPECT_LE(share, jerk > 0 ? 1.05 : 1.0001)
            << "seed " << seed << ", jerk " << jerk << (laws ? ", laws" : "");
      }
  }
  std::printf("the tool at most at %.4f of the feed, limited in jerk %.4f, by laws %.4f\n",
              worst[0], worst[1], worst[2]);
}

TEST(Families, KeepJerkLimitsUnderChangingOverrides) {
  const int count = motion::test::property_count(2);
  for (int i = 1; i <= count && !testing::Test::HasFailure(); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const double jerk = i % 3 == 0 ? 5000 : i % 3 == 1 ? 50000 : 1e6;
    run(bench::mixture(60, seed), seed, jerk);
    run(bench::freeform(800, 0.01, 100, seed), seed, jerk);
    run(bench::arc_spiral(0.1, 80), seed, jerk);
    run(bench::fractal(4, 0.5, 0.05, 100), seed, jerk);
    run(bench::four_axis(60, 0.02, 100, i % 2 == 0, seed), seed, jerk);
  }
}

/// 0.02 mm lines at 100 mm/s that come just as fast as they are driven, `ahead` of them at the start: there is always more path than the way to
/// stop, so the feed never falls. Gives the slowest of its cycles as a share.
double five_thousand_blocks_a_second(double jerk, int ahead, bool merges) {
  constexpr double kStep = 0.02, kFeed = 100, kRadius = 40;
  constexpr int kPerCycle = 5, kCycles = 3000;
  Rig rig({0, 1, 2, 3});
  prepare(rig, jerk, true);
  rig.push(
      motion::PathControl{.tolerance_mm = 0.01, .naive_cam_tolerance_mm = merges ? 0.01 : 0.0});
  int sent = 0;
  const auto send = [&] {
    const double angle = ++sent * kStep / kRadius;
    return rig.line({.x = kRadius * std::sin(angle), .y = kRadius * (1 - std::cos(angle))}, kFeed);
  };
  for (int i = 0; i < ahead; ++i) EXPECT_TRUE(send());
  double slowest = 1e9;
  bool at_speed = false;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    for (int i = 0; i < kPerCycle; ++i) EXPECT_TRUE(send()) << "cycle " << cycle;
    rig.cycle();
    const double v = rig.status().vel_mm_s;
    at_speed = at_speed || v > kFeed * 0.999;
    if (at_speed) slowest = std::min(slowest, v);
  }
  EXPECT_TRUE(at_speed);
  EXPECT_TRUE(rig.faults.empty());
  return slowest / kFeed;
}

TEST(Families, FiveThousandBlocksASecondAtFeed) {
  for (const double jerk : {0.0, 50000.0})
    for (const bool merges : {true, false})
      EXPECT_GT(five_thousand_blocks_a_second(jerk, 500, merges), 0.997)
          << "jerk " << jerk << (merges ? "" : " Q0");
}

/// The path is cut again and again while it is made; nothing of that is seen, with jerk limits either.
TEST(Families, DenseLinesKeepTheirFeedWhereThePathIsCut) {
  constexpr double kFeed = 100, kStep = 0.02;
  for (const bool circle : {true, false})
    for (const bool merges : {true, false}) {
      // Of joined lines many more fit into what is looked at together.
      const bench::Program program =
          bench::dense_lines(merges ? 200 : 100, kStep, 0.01, kFeed, merges, circle);
      SCOPED_TRACE(program.name);
      Rig rig({0, 1, 2, 3});
      bench::reference_machine(rig.config);
      for (auto& j : rig.config.joint) j.max_jerk = 50000;
      rig.apply_config();
      rig.ready();
      motion::test::Oracle oracle;
      std::size_t next = 0;
      double slowest = 1, slowest_so_far = 1;
      bool at_feed = false;
      for (int cycle = 0; cycle < 10000 && rig.faults.empty(); ++cycle) {
        while (next < program.items.size() && rig.push(program.items[next])) ++next;
        rig.cycle();
        oracle.watch(rig);
        const double share = rig.status().vel_mm_s / kFeed;
        if (share > 0.998) {
          at_feed = true;
          slowest = slowest_so_far;
        }
        if (at_feed) slowest_so_far = std::min(slowest_so_far, share);
        if (next == program.items.size() && rig.status().executed_seq == rig.seq &&
            rig.status().path_empty)
          break;
      }
      EXPECT_TRUE(rig.faults.empty());
      EXPECT_EQ(rig.status().executed_seq, rig.seq);
      EXPECT_TRUE(at_feed);
      EXPECT_GE(slowest, 0.99);
      EXPECT_LE(oracle.acc, 1.001);
      EXPECT_LE(oracle.jerk, 1.01);
    }
}

TEST(Families, JumpsOfCurvatureKeepTheLimitsUnderChangingOverrides) {
  const int count = motion::test::property_count(12);
  for (int i = 1; i <= count && !testing::Test::HasFailure(); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    run(bench::tangent_moves(60, i % 3 == 0, i % 2 == 0, seed), seed);
  }
}

/// With holds, aborts and resumes; KERF_COUNT=10000 are ten million cycles.
TEST(Families, ACampaignHasNoException) {
  const auto cycles = static_cast<std::uint64_t>(motion::test::property_count(120)) * 1000;
  const bench::CampaignResult r = bench::campaign(cycles, 1);
  EXPECT_EQ(r.exceptions, 0U) << "first: seed " << r.bad_seed;
  EXPECT_GT(r.aborts, 0U);
  EXPECT_LE(r.vel, 1.0001);
  EXPECT_LE(r.acc, 1.001);
  EXPECT_LE(r.jerk, 1.01);
}

/// An arc at its largest centripetal acceleration and a rapid met at a fraction of its override: both once passed a limit.
TEST(Families, SeedsThatFailedOnce) {
  run(bench::arc_spiral(0.1, 80), 40);
  run(bench::mixture(400, 5), 1);
  // A leg gone on with for longer than had been looked ahead; the rounding of a ramp on its last phase.
  run(bench::arc_spiral(0.1, 80), 2, 1e6);
  run(bench::arc_spiral(0.1, 80), 5, 1e6);
}

}  // namespace
}  // namespace kerf
