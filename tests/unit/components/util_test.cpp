#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(Threads, MakesThemInOrder) {
  hal::TestBuilder hal;
  hal.set_arg("name1", "base-thread");
  hal.set_arg("period1", "50000");
  hal.set_arg("fp1", "0");
  hal.set_arg("name2", "servo-thread");
  hal.set_arg("period2", "1000000");
  ASSERT_TRUE(hal.create(module("threads"), "threads")) << hal.error();
  ASSERT_EQ(hal.threads().size(), 2U);
  EXPECT_EQ(hal.threads()[0].name, "base-thread");
  EXPECT_EQ(hal.threads()[0].period_ns, 50'000);
  EXPECT_EQ(hal.threads()[1].name, "servo-thread");
  EXPECT_EQ(hal.threads()[1].period_ns, 1'000'000);
}

TEST(Threads, HasOneOfAMillisecondWithoutParameters) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("threads"), "threads"));
  ASSERT_EQ(hal.threads().size(), 1U);
  EXPECT_EQ(hal.threads()[0].name, "thread1");
  EXPECT_EQ(hal.threads()[0].period_ns, 1'000'000);
}

TEST(Threads, RefusesWhatMakesNoThread) {
  using Args = std::vector<std::pair<std::string, std::string>>;
  struct Case {
    Args args;
    const char* message;
  };
  const Case cases[] = {
      {{{"name1", "a"}, {"period1", "2000000"}, {"name2", "b"}, {"period2", "1000000"}},
       "period2 is shorter than the one before it, thread b"},
      {{{"name2", "b"}}, "period2 must be above zero, thread b"},
      {{{"name1", "a"}, {"period1", "-5"}}, "period1 must be above zero, thread a"},
      {{{"period3", "5000000"}}, "name3 is missing for period3"},
  };
  for (const Case& c : cases) {
    hal::TestBuilder hal;
    for (const auto& [name, text] : c.args) hal.set_arg(name, text);
    EXPECT_FALSE(hal.create(module("threads"), "threads"));
    EXPECT_EQ(hal.error(), c.message);
  }
}

class SiggenTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(hal.create(module("siggen"), "siggen.0")) << hal.error(); }
  double get(const char* wave) { return hal.get<double>(std::string("siggen.0.") + wave); }
  hal::TestBuilder hal;
};

TEST_F(SiggenTest, MakesOnePeriodOfEveryWave) {
  constexpr double kAmplitude = 2.0, kOffset = 0.25;
  constexpr int kSteps = 200;  // 5 Hz at 1 kHz
  hal.set("siggen.0.frequency", 5.0);
  hal.set("siggen.0.amplitude", kAmplitude);
  hal.set("siggen.0.offset", kOffset);
  for (int i = 1; i < kSteps; ++i) {
    hal.run("siggen.0.update");
    const double p = static_cast<double>(i) / kSteps;
    SCOPED_TRACE(p);
    EXPECT_NEAR(get("sine"), kOffset + kAmplitude * std::sin(2 * std::numbers::pi * p), 1e-9);
    EXPECT_NEAR(get("cosine"), kOffset + kAmplitude * std::cos(2 * std::numbers::pi * p), 1e-9);
    EXPECT_NEAR(get("sawtooth"), kOffset + kAmplitude * (2 * p - 1), 1e-9);
    const double triangle = p < 0.5 ? 1 - 4 * p : 4 * p - 3;
    EXPECT_NEAR(get("triangle"), kOffset + kAmplitude * triangle, 1e-9);
    if (i == kSteps / 2) continue;  // the edge may fall on either side
    EXPECT_EQ(get("square"), kOffset + (p > 0.5 ? kAmplitude : -kAmplitude));
    EXPECT_EQ(hal.get<bool>("siggen.0.clock"), p > 0.5);
  }
}

TEST_F(SiggenTest, CountsPeriodsByItsFrequency) {
  hal.set("siggen.0.frequency", 37.0);
  int edges = 0;
  bool before = false;
  for (int i = 0; i < 10'000; ++i) {
    hal.run("siggen.0.update");
    const bool now = hal.get<bool>("siggen.0.clock");
    edges += now && !before ? 1 : 0;
    before = now;
    ASSERT_LE(std::fabs(get("sine")), 1.0 + 1e-12);
  }
  EXPECT_NEAR(edges, 370, 1);
}

TEST_F(SiggenTest, ResetHoldsTheMiddleOfThePeriod) {
  hal.set("siggen.0.amplitude", 3.0);
  hal.run("siggen.0.update", 1'000'000, 77);
  hal.set("siggen.0.reset", true);
  hal.run("siggen.0.update", 1'000'000, 3);
  EXPECT_EQ(get("sine"), 0.0);
  EXPECT_EQ(get("sawtooth"), 0.0);
  EXPECT_EQ(get("square"), -3.0);
  EXPECT_EQ(get("cosine"), -3.0);
  EXPECT_EQ(get("triangle"), -3.0);
  EXPECT_FALSE(hal.get<bool>("siggen.0.clock"));
  hal.set("siggen.0.reset", false);
  hal.run("siggen.0.update");
  EXPECT_NEAR(get("sawtooth"), 3.0 * 0.002, 1e-9);  // goes on from there at 1 Hz
}

TEST_F(SiggenTest, CutsFrequenciesAboveHalfTheRateOfCalls) {
  hal.set("siggen.0.frequency", 800.0);
  hal.run("siggen.0.update");
  EXPECT_DOUBLE_EQ(get("sawtooth"), 0.0);
  hal.run("siggen.0.update");
  EXPECT_DOUBLE_EQ(get("sawtooth"), -1.0);
}

TEST_F(SiggenTest, RunsBackwardsAtANegativeFrequency) {
  hal.set("siggen.0.frequency", -10.0);
  hal.run("siggen.0.update", 1'000'000, 25);
  EXPECT_NEAR(get("sine"), -1.0, 1e-9);
  EXPECT_NEAR(get("sawtooth"), 0.5, 1e-9);
}

TEST(Siggen, NamesItsChannels) {
  hal::TestBuilder numbered;
  numbered.set_arg("num_chan", "3");
  ASSERT_TRUE(numbered.create(module("siggen"), "siggen.0")) << numbered.error();
  EXPECT_TRUE(numbered.has("siggen.2.sine"));
  EXPECT_FALSE(numbered.has("siggen.3.sine"));
  EXPECT_EQ(numbered.functions().size(), 3U);

  hal::TestBuilder named;
  ASSERT_TRUE(named.create(module("siggen"), "left")) << named.error();
  EXPECT_TRUE(named.has("left.sine"));
  EXPECT_EQ(named.functions(), std::vector<std::string>{"left.update"});
}

TEST(Siggen, RefusesBadNumbersOfChannels) {
  for (const char* count : {"17", "-1", "0"}) {
    hal::TestBuilder hal;
    hal.set_arg("num_chan", count);
    EXPECT_FALSE(hal.create(module("siggen"), "siggen.0"));
    EXPECT_EQ(hal.error(), "num_chan= must be from 1 to 16");
  }
  hal::TestBuilder both;
  both.set_arg("num_chan", "2");
  EXPECT_FALSE(both.create(module("siggen"), "left"));
  EXPECT_EQ(both.error(), "num_chan= goes with neither count= nor names=");
}

}  // namespace
}  // namespace kerf::components
