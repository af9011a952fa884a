#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(Math, Sum2WeighsItsInputs) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("sum2"), "s"));
  hal.set("s.in0", 2.0);
  hal.set("s.in1", 5.0);
  hal.run("s");
  EXPECT_DOUBLE_EQ(hal.get<double>("s.out"), 7.0);
  hal.set("s.gain0", 3.0);
  hal.set("s.gain1", -1.0);
  hal.set("s.offset", 0.25);
  hal.run("s");
  EXPECT_DOUBLE_EQ(hal.get<double>("s.out"), 1.25);
}

TEST(Math, Mux2Selects) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("mux2"), "m"));
  hal.set("m.in0", -1.5);
  hal.set("m.in1", 8.0);
  hal.run("m");
  EXPECT_EQ(hal.get<double>("m.out"), -1.5);
  hal.set("m.sel", true);
  hal.run("m");
  EXPECT_EQ(hal.get<double>("m.out"), 8.0);
}

TEST(Math, DdtGivesTheSlopeInUnitsPerSecond) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("ddt"), "d"));
  hal.set("d.in", 0.4);
  hal.run("d");
  EXPECT_NEAR(hal.get<double>("d.out"), 400.0, 1e-9);  // from zero before the first call
  for (int i = 1; i <= 5; ++i) {
    hal.set("d.in", 0.4 + 0.002 * i);
    hal.run("d");
    EXPECT_NEAR(hal.get<double>("d.out"), 2.0, 1e-9);
  }
  hal.run("d");
  EXPECT_EQ(hal.get<double>("d.out"), 0.0);
  hal.set("d.in", 0.0);
  hal.run("d", 50'000);
  EXPECT_NEAR(hal.get<double>("d.out"), -0.41 / 50e-6, 1e-6);
}

TEST(Math, NearLooksAtRatioOrDistance) {
  struct Case {
    double in1, in2, scale, difference;
    bool near;
  };
  constexpr Case kCases[] = {
      {1.0, 1.0, 1.0, 0.0, true},       {1.0, 1.0001, 1.0, 0.0, false},
      {0.0, 0.0, 1.0, 0.0, true},       {1.0, 1.5, 1.5, 0.0, true},
      {1.0, 1.5001, 1.5, 0.0, false},   {1.5, 1.0, 1.5, 0.0, true},
      {1.5, 0.99, 1.5, 0.0, false},     {-1.0, -1.5, 1.5, 0.0, true},
      {-1.5, -1.0, 1.5, 0.0, true},     {-1.0, -1.6, 1.5, 0.0, false},
      {1.0, -1.0, 1.5, 0.0, false},     {1.0, 1.25, 1.0, 0.25, true},
      {1.25, 1.0, 1.0, 0.25, true},     {1.0, 1.26, 1.0, 0.25, false},
      {-0.125, 0.125, 1.0, 0.25, true}, {100.0, 101.0, 1.02, 0.5, true},
      {0.0, 0.4, 1.02, 0.5, true},      {0.0, 0.6, 1.02, 0.5, false},
  };
  for (const Case& c : kCases) {
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module("near"), "n"));
    hal.set("n.in1", c.in1);
    hal.set("n.in2", c.in2);
    hal.set("n.scale", c.scale);
    hal.set("n.difference", c.difference);
    hal.run("n");
    EXPECT_EQ(hal.get<bool>("n.out"), c.near)
        << c.in1 << " " << c.in2 << " scale " << c.scale << " difference " << c.difference;
  }
}

TEST(Math, ScaleMult2HypotConstant) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("scale"), "s"));
  ASSERT_TRUE(hal.create(module("mult2"), "m"));
  ASSERT_TRUE(hal.create(module("hypot"), "h"));
  ASSERT_TRUE(hal.create(module("constant"), "k"));
  hal.set("s.in", 3.0);
  hal.set("s.gain", -2.0);
  hal.set("s.offset", 0.5);
  hal.run("s");
  EXPECT_EQ(hal.get<double>("s.out"), -5.5);
  hal.set("m.in0", 3.0);
  hal.set("m.in1", -0.5);
  hal.run("m");
  EXPECT_EQ(hal.get<double>("m.out"), -1.5);
  hal.set("h.in0", 2.0);
  hal.set("h.in1", -3.0);
  hal.set("h.in2", 6.0);
  hal.run("h");
  EXPECT_DOUBLE_EQ(hal.get<double>("h.out"), 7.0);
  hal.set("k.value", 4.25);
  hal.run("k");
  EXPECT_EQ(hal.get<double>("k.out"), 4.25);
}

TEST(Math, Limit1Bounds) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("limit1"), "l"));
  const auto limited = [&](double in) {
    hal.set("l.in", in);
    hal.run("l");
    return hal.get<double>("l.out");
  };
  EXPECT_EQ(limited(1e15), 1e15);
  hal.set("l.min", -1.0);
  hal.set("l.max", 2.0);
  EXPECT_EQ(limited(-1.5), -1.0);
  EXPECT_EQ(limited(0.7), 0.7);
  EXPECT_EQ(limited(2.5), 2.0);
}

TEST(Math, Limit2BoundsValueAndRate) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("limit2"), "l"));
  const auto limited = [&](double in) {
    hal.set("l.in", in);
    hal.run("l");
    return hal.get<double>("l.out");
  };
  hal.set("l.maxv", 300.0);
  hal.set("l.max", 1.0);
  EXPECT_NEAR(limited(5.0), 0.3, 1e-12);
  EXPECT_NEAR(limited(5.0), 0.6, 1e-12);
  EXPECT_NEAR(limited(0.65), 0.65, 1e-12);
  EXPECT_NEAR(limited(5.0), 0.95, 1e-12);
  EXPECT_EQ(limited(5.0), 1.0);
  EXPECT_NEAR(limited(-5.0), 0.7, 1e-12);
  hal.set("l.load", true);
  EXPECT_EQ(limited(-5.0), -5.0);
  hal.set("l.load", false);
  EXPECT_NEAR(limited(0.0), -4.7, 1e-12);
  hal.set("l.max", -10.0);
  EXPECT_NEAR(limited(0.0), -5.0, 1e-12) << "a bound that moves is met no faster than maxv";
}

TEST(Math, CompSwitchesWithHysteresis) {
  struct Step {
    double in1;
    bool out, equal;
  };
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("comp"), "c"));
  const auto expect = [&](std::initializer_list<Step> steps) {
    for (const Step& step : steps) {
      hal.set("c.in1", step.in1);
      hal.run("c");
      EXPECT_EQ(hal.get<bool>("c.out"), step.out) << step.in1;
      EXPECT_EQ(hal.get<bool>("c.equal"), step.equal) << step.in1;
    }
  };
  hal.set("c.in0", 10.0);
  expect({{9.9, false, false},
          {10.0, false, true},
          {10.1, true, false},
          {10.0, true, true},
          {9.9, false, false}});
  hal.set("c.hyst", 1.0);
  expect({{10.5, false, true}, {10.6, true, false}, {9.5, true, true}, {9.4, false, false}});
}

TEST(Math, ConvertsFloatsAndIntegers) {
  struct Case {
    double in;
    bool clamp;
    std::int32_t out;
    bool out_of_range;
  };
  constexpr Case kCases[] = {
      {0.9, false, 0, false},
      {-1.9, false, -1, false},
      {2147483647.9, false, INT32_MAX, false},
      {-2147483648.9, false, INT32_MIN, false},
      {2147483648.0, true, INT32_MAX, true},
      {-2147483649.0, true, INT32_MIN, true},
      {2147483648.0, false, INT32_MIN, true},
      {4294967299.0, false, 3, true},
      {-4294967299.0, false, -3, true},
      {1e300, true, INT32_MAX, true},
      {std::numeric_limits<double>::infinity(), false, INT32_MAX, true},
      {std::numeric_limits<double>::quiet_NaN(), true, 0, true},
  };
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("conv_float_s32"), "fs"));
  ASSERT_TRUE(hal.create(module("conv_s32_float"), "sf"));
  for (const Case& c : kCases) {
    hal.set("fs.in", c.in);
    hal.set("fs.clamp", c.clamp);
    hal.run("fs");
    EXPECT_EQ(hal.get<std::int32_t>("fs.out"), c.out) << c.in;
    EXPECT_EQ(hal.get<bool>("fs.out-of-range"), c.out_of_range) << c.in;
  }
  hal.set("sf.in", INT32_MIN);
  hal.run("sf");
  EXPECT_EQ(hal.get<double>("sf.out"), -2147483648.0);
}

TEST(AbsS64, TellsSizeAndSignBeyond32Bits) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("abs_s64"), "a"));
  struct Row {
    std::int64_t in, out;
  };
  for (const Row& row :
       {Row{0, 0}, Row{5'000'000'000, 5'000'000'000}, Row{-5'000'000'000, 5'000'000'000},
        Row{INT64_MAX, INT64_MAX}, Row{INT64_MIN, INT64_MIN}}) {
    hal.set("a.in", row.in);
    hal.run("a");
    EXPECT_EQ(hal.get<std::int64_t>("a.out"), row.out);
    EXPECT_EQ(hal.get<bool>("a.sign"), row.in < 0);
    EXPECT_EQ(hal.get<bool>("a.is-negative"), row.in < 0);
    EXPECT_EQ(hal.get<bool>("a.is-positive"), row.in > 0);
  }
}

}  // namespace
}  // namespace kerf::components
