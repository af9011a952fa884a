#include "launcher/run_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "samples.hpp"

namespace kerf::launcher {
namespace {

using test::sample;

TEST(RunStatistics, FindsThePeaksOfATrapezoid) {
  // 0.1 s up with 500 mm/s2, 0.1 s at 50 mm/s, 0.1 s down.
  RunStatistics run;
  double x = 0, v = 0;
  for (std::uint64_t i = 0; i <= 300; ++i) {
    run.add(sample(100 + i, x));
    const double a = i < 100 ? 500 : i < 200 ? 0 : -500;
    x += v * 1e-3 + a * 0.5e-6;
    v += a * 1e-3;
  }
  ASSERT_EQ(run.joints().size(), 3U);
  EXPECT_NEAR(run.joints()[0].peak_vel, 50, 0.01);
  EXPECT_NEAR(run.joints()[0].peak_acc, 500, 0.01);
  EXPECT_EQ(run.joints()[1].peak_vel, 0);
  EXPECT_NEAR(run.joints()[0].max, 10, 0.01);
  EXPECT_NEAR(run.feed_length_mm(), 10, 0.01);
  EXPECT_NEAR(run.seconds(), 0.3, 1e-9);
  EXPECT_EQ(run.cycles(), 301U);
}

TEST(RunStatistics, AStartInMotionIsNoAccelerationFromRest) {
  RunStatistics run;
  for (std::uint64_t i = 0; i < 10; ++i) run.add(sample(i, 0.05 * static_cast<double>(i)));
  EXPECT_NEAR(run.joints()[0].peak_vel, 50, 1e-6);
  EXPECT_NEAR(run.joints()[0].peak_acc, 0, 1e-3);
}

TEST(RunStatistics, AGapIsNoJump) {
  RunStatistics run;
  run.add(sample(1, 0));
  run.add(sample(2, 0.01));
  run.add(sample(10, 50));
  run.add(sample(11, 50.01));
  EXPECT_NEAR(run.joints()[0].peak_vel, 10, 1e-6);
  EXPECT_EQ(run.missing_cycles(), 7U);
  EXPECT_NEAR(run.seconds(), 0.010, 1e-12);
}

TEST(RunStatistics, RecordsOfThePastAreIgnored) {
  RunStatistics run;
  run.add(sample(5, 0));
  run.add(sample(5, 9));
  run.add(sample(4, 9));
  EXPECT_EQ(run.cycles(), 1U);
  EXPECT_EQ(run.joints()[0].max, 0);
}

TEST(RunStatistics, TellsFeedFromRapidAndCountsMovingBlocks) {
  RunStatistics run;
  std::uint64_t cycle = 0;
  run.add(sample(cycle++, 0));
  auto s = sample(cycle++, 3);
  s.kind = motion::MotionKind::traverse;
  run.add(s);
  run.add(sample(cycle++, 3, 4));
  s = sample(cycle++, 3, 4);  // a block that moves nothing
  s.block = 2;
  run.add(s);
  s = sample(cycle++, 3, 4, 2);
  s.block = 3;
  s.kind = motion::MotionKind::arc;
  run.add(s);
  EXPECT_DOUBLE_EQ(run.rapid_length_mm(), 3);
  EXPECT_DOUBLE_EQ(run.feed_length_mm(), 6);
  EXPECT_EQ(run.moving_blocks(), 2U);
}

TEST(RunStatistics, MoreJointsThanThereCanBeAreNoHarm) {
  RunStatistics run;
  auto s = sample(1, 0);
  s.joints = 1000;
  run.add(s);
  EXPECT_EQ(run.joints().size(), motion::kMaxJoints);
  s.joints = -1;
  s.cycle = 2;
  run.add(s);
}

TEST(Summary, NamesPeaksAndLimits) {
  RunStatistics run;
  for (std::uint64_t i = 0; i < 10; ++i) run.add(sample(i, 0.05 * static_cast<double>(i)));
  SummaryInput input;
  input.program = "part.ngc";
  input.program_lines = 12;
  input.lines_executed = 11;
  input.limits = {{100, 1000, false}, {0, 0, true}};
  const std::string text = format_summary(run, input);
  EXPECT_NE(text.find("part.ngc"), std::string::npos);
  EXPECT_NE(text.find("11 of 12 executed"), std::string::npos) << text;
  EXPECT_NE(text.find("50.0 / 100 mm/s   50 %"), std::string::npos) << text;
  EXPECT_NE(text.find("deg/s"), std::string::npos) << text;
  EXPECT_EQ(text.find("not recorded"), std::string::npos);
}

TEST(Summary, SaysThatCyclesAreMissing) {
  RunStatistics run;
  run.add(sample(1, 0));
  run.add(sample(4, 0));
  SummaryInput input;
  input.dropped = 2;
  EXPECT_NE(format_summary(run, input).find("2 cycles were not recorded (2 found no room)"),
            std::string::npos);
}

TEST(Duration, ReadsAsPeopleSayIt) {
  EXPECT_EQ(format_duration(3.42), "3.4 s");
  EXPECT_EQ(format_duration(59.97), "1 min 00.0 s");
  EXPECT_EQ(format_duration(123.4), "2 min 03.4 s");
  EXPECT_EQ(format_duration(3723), "1 h 02 min 03 s");
}

}  // namespace
}  // namespace kerf::launcher
