// Moves at the edge of what can be driven: no length, the same point again, back and forth, far too short, nearly straight arcs, numbers that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

using testing::HasSubstr;

std::string line(const char* format, double x, double y) {
  char text[120];
  std::snprintf(text, sizeof text, format, x, y);
  return text;
}

/// Every word of path control; the machine checks limits and path in each cycle (guard, path check), and its errors are looked at.
class OddMoves : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  void SetUp() override {
    MachineOptions options;
    options.replace = {{"MAX_LINEAR_VELOCITY = 120", std::get<1>(GetParam())}};
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    ASSERT_TRUE(m->mdi("G0 X10 Y10 Z-10")) << m->errors();
  }
  /// Runs to its end and stands there.
  void drive(const std::string& moves, double x, double y) {
    const auto reply = m->run_text("G21 G90 G54 F1200\n" + std::string(std::get<0>(GetParam())) +
                                   "\n" + moves + "M2\n");
    EXPECT_EQ(reply.state, task::CommandState::done) << reply.text;
    EXPECT_EQ(m->errors(), "");
    EXPECT_NEAR(m->joint(0), x, 1e-9);
    EXPECT_NEAR(m->joint(1), y, 1e-9);
    EXPECT_TRUE(m->motion().enabled);
  }
  std::unique_ptr<Machine> m;
};

TEST_P(OddMoves, WithoutLength) {
  std::string moves;
  for (int i = 0; i < 30; ++i)
    moves += i % 3 == 0 ? "G1 X10 Y10\n" : i % 3 == 1 ? "M62 P0\n" : "G0 X10\n";
  moves += "G1 X12\nG1 X12\nG1 Y11\nM63 P0\nG1 X12 Y11\nG1 X13\n";
  drive(moves, 13, 11);
}

TEST_P(OddMoves, TheSamePointAgain) {
  std::string moves;
  for (int i = 1; i <= 40; ++i) {
    const std::string to = line("G1 X%.4f Y%.4f\n", 10 + 0.1 * i, 10 + 0.05 * (i % 2));
    for (int k = 0; k <= i % 4; ++k) moves += to;
  }
  drive(moves, 14, 10);
}

TEST_P(OddMoves, BackAndForth) {
  std::string moves;
  for (int i = 1; i <= 12; ++i)
    moves += line("G1 X%.4f\n", i % 2 != 0 ? 10 + 20.0 / (i * i) : 10.0, 0);
  moves += "G1 X15 Y12\nG1 X10 Y10\nG2 X14 Y10 I2 J0\nG3 X10 Y10 I-2 J0\n";
  drive(moves, 10, 10);
}

TEST_P(OddMoves, OfAMillionthOfAMillimetreAndLess) {
  std::string moves;
  for (int i = 1; i <= 100; ++i) {
    moves += line("G1 X%.10f Y%.10f\n", 10 + 1e-9 * i, 10 + 1e-9 * (i % 3));
    moves += line("G1 X%.8f Y%.8f\n", 10 + 0.01 * i, 10);
    moves += line("G1 X%.8f Y%.8f\n", 10 + 0.01 * i + 1e-6, 10 + 1e-6);
  }
  moves += "G1 X12 Y10\n";
  drive(moves, 12, 10);
}

/// What is too short to be driven may stand beside the place that a speck before it has led to.
TEST_P(OddMoves, NothingBehindASpeck) {
  std::string moves;
  for (int i = 1; i <= 12; ++i) {
    const double x = 10 + i, speck = 1e-6 * (0.6 + 0.3 * i);
    moves += line("G1 X%.10f Y%.10f\n", x, 10);
    moves += line("G1 X%.10f Y%.10f\n", x + speck, 10);
    moves += line("G1 X%.10f Y%.10f\n", x + speck + 5e-10, 10);
    if (i % 3 == 0) moves += line("G1 X%.10f Y%.10f\n", x, 10.5);
  }
  drive(moves + "G1 X23 Y10\n", 23, 10);
}

TEST_P(OddMoves, ATapBehindASpeck) {
  std::string moves = "S600 M3\n";
  for (int i = 1; i <= 3; ++i) {
    const double x = 10 + i, speck = 0.4e-6 * i;
    moves += line("G1 X%.10f Y%.10f\n", x, 10);
    moves += line("G1 X%.10f Y%.10f\n", x + speck, 10);
    moves += line("G1 X%.10f Y%.10f\nG33.1 Z-15 K0.5\n", x + speck + 1e-9, 10);
  }
  drive(moves + "M5\nG1 X14 Y10\n", 14, 10);
}

TEST_P(OddMoves, ArcsOfAKilometre) {
  drive("G2 X20 Y10 R1000000\nG3 X30 Y10 R1000000\nG1 X31\nG2 X31.001 Y10 R1000000\n", 31.001, 10);
}

INSTANTIATE_TEST_SUITE_P(
    PathControl, OddMoves,
    testing::Combine(testing::Values("G64 P0.01", "G64 P0.5", "G64 P0.05 Q0", "G61", "G61.1"),
                     testing::Values("MAX_LINEAR_VELOCITY = 120",
                                     "MAX_LINEAR_VELOCITY = 120\nMAX_LINEAR_JERK = 20000")));

class NoNumbers : public testing::TestWithParam<const char*> {};

TEST_P(NoNumbers, AreRefusedAndNothingMoves) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const double x = m->joint(0);
  const auto reply = m->run_text(std::string("G21 G90 F600\n") + GetParam() + "\nG1 X50\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_THAT(m->errors(), HasSubstr("test.ngc:2"));
  m->run_for(0.2);
  EXPECT_EQ(m->joint(0), x);
  EXPECT_TRUE(m->mdi("G0 X1")) << m->errors();
}

INSTANTIATE_TEST_SUITE_P(Words, NoNumbers,
                         testing::Values("G1 X[0/0]", "G1 X[SQRT[-1]]", "G1 X[LN[0]]", "G1 Xnan",
                                         "G1 Xinf", "G1 X[ACOS[2]]", "G2 X10 Y0 R[0/0]",
                                         "G1 F[1/0] X1", "G64 P[0/0]"));

TEST(LimitsOfZero, AreRefusedWithTheirKey) {
  for (const char* key : {"MAX_VELOCITY = 100", "MAX_ACCELERATION = 1000"}) {
    SCOPED_TRACE(key);
    const std::string name(key, std::string(key).find(' '));
    MachineOptions options;
    options.replace = {{key, name + " = 0"}};
    auto m = Machine::start(options);
    EXPECT_FALSE(m->ready()) << "it started";
    EXPECT_THAT(m->errors(), HasSubstr(name));
    EXPECT_THAT(m->errors(), HasSubstr("mill.ini:"));
  }
}

}  // namespace
}  // namespace kerf::harness
