#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace kerf::components
