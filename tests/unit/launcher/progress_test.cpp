#include "launcher/progress.hpp"

#include <gtest/gtest.h>

namespace kerf::launcher {
namespace {

ProgressState at(double fraction, double elapsed_s) {
  ProgressState s;
  s.fraction = fraction;
  s.elapsed_s = elapsed_s;
  return s;
}

TEST(Progress, TimeLeftFollowsFromTimeTaken) {
  EXPECT_DOUBLE_EQ(*estimate_left_s(at(0.25, 10)), 30);
  EXPECT_DOUBLE_EQ(*estimate_left_s(at(1, 10)), 0);
  EXPECT_FALSE(estimate_left_s(at(0, 10)).has_value());
  EXPECT_FALSE(estimate_left_s(at(0.5, 0.1)).has_value());
}

TEST(Progress, LinesBeforeTheFirstMoveAreNoMeasure) {
  ProgressState s = at(0.6, 10);
  s.from_fraction = 0.5;
  EXPECT_NEAR(*estimate_left_s(s), 40, 1e-9);
  s.fraction = 0.5;
  EXPECT_FALSE(estimate_left_s(s).has_value());
}

TEST(Progress, TheLineFitsTheTerminal) {
  ProgressState s = at(0.5, 65);
  s.line = 23;
  s.lines = 46;
  for (int width = 1; width < 140; ++width)
    EXPECT_LT(static_cast<int>(progress_line(s, width).size()), width);
  const std::string line = progress_line(s, 120);
  EXPECT_NE(
      line.find(
          "[####################                    ]  50 %  line 23 of 46  1:05, about 1:05 left"),
      std::string::npos)
      << line;
}

TEST(Progress, ClockText) {
  EXPECT_EQ(clock_text(-1), "0:00");
  EXPECT_EQ(clock_text(59.9), "0:59");
  EXPECT_EQ(clock_text(754), "12:34");
  EXPECT_EQ(clock_text(3723), "1:02:03");
}

TEST(Progress, AFileGetsALineEveryTenPercent) {
  ProgressPrinter printer(false, 80);
  EXPECT_EQ(printer.update(at(0.05, 1), 1), "");
  EXPECT_NE(printer.update(at(0.101, 1), 1).find(" 10 %"), std::string::npos);
  EXPECT_EQ(printer.update(at(0.15, 1), 1), "");
  EXPECT_NE(printer.update(at(0.57, 1), 1).find(" 57 %"), std::string::npos);
  EXPECT_EQ(printer.update(at(0.58, 1), 1), "");
  EXPECT_NE(printer.update(at(1, 2), 2).find("100 %"), std::string::npos);
  EXPECT_EQ(printer.update(at(1, 2), 2), "");
  EXPECT_EQ(printer.clear(), "");
}

TEST(Progress, AFileHearsOnceWhatIsWaitedFor) {
  ProgressPrinter printer(false, 80);
  ProgressState s = at(0.01, 1);
  s.waiting = "tool 3 in the spindle";
  EXPECT_EQ(printer.update(s, 1), "kerf: the program waits for tool 3 in the spindle\n");
  EXPECT_EQ(printer.update(s, 2), "");
}

TEST(Progress, ATerminalLineIsDrawnAtMostTenTimesASecondAndCanBeCleared) {
  ProgressPrinter printer(true, 80);
  EXPECT_EQ(printer.update(at(0.1, 1), 1.0).substr(0, 4), "\r\x1b[K");
  EXPECT_EQ(printer.update(at(0.1, 1), 1.05), "");
  EXPECT_NE(printer.update(at(0.1, 1), 1.11), "");
  EXPECT_EQ(printer.clear(), "\r\x1b[K");
  EXPECT_EQ(printer.clear(), "");
  // After another message the line comes back at once.
  EXPECT_NE(printer.update(at(0.1, 1), 1.12), "");
}

}  // namespace
}  // namespace kerf::launcher
