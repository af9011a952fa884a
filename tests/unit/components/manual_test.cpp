// Components that do what the manual says where LinuxCNC 2.9 does something else (docs/differences.md).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(ByTheManual, InvertAndDiv2GiveZeroWithinTheDeadband) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("invert"), "i"));
  ASSERT_TRUE(hal.create(module("div2"), "d"));
  hal.set("d.in0", 3.0);
  for (const double in : {0.0, 0.05, -0.05, 0.1}) {
    for (const char* c : {"i", "d"}) {
      const std::string name = c;
      hal.set(name + ".deadband", 0.1);
      hal.set(name + (name == "i" ? ".in" : ".in1"), in);
      hal.run(name);
      EXPECT_EQ(hal.get<double>(name + ".out"), 0.0) << in;
    }
  }
  hal.set("i.in", -0.2);
  hal.set("d.in1", -0.2);
  hal.run("i");
  hal.run("d");
  EXPECT_DOUBLE_EQ(hal.get<double>("i.out"), -5.0);
  EXPECT_DOUBLE_EQ(hal.get<double>("d.out"), -15.0);
  // The smallest deadband is 1e-8.
  hal.set("i.deadband", 0.0);
  hal.set("i.in", 0.9e-8);
  hal.run("i");
  EXPECT_EQ(hal.get<double>("i.out"), 0.0);
}

TEST(ByTheManual, Toggle2nistActsOnRisingEdges) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("toggle2nist"), "t"));
  const auto step = [&](bool in, bool is_on) {
    hal.set("t.in", in);
    hal.set("t.is-on", is_on);
    hal.run("t");
    return (hal.get<bool>("t.on") ? 1 : 0) + (hal.get<bool>("t.off") ? 2 : 0);
  };
  EXPECT_EQ(step(false, false), 0);
  EXPECT_EQ(step(true, false), 1);
  EXPECT_EQ(step(true, false), 1);
  EXPECT_EQ(step(true, true), 0);
  EXPECT_EQ(step(false, true), 0) << "the release is no press";
  EXPECT_EQ(step(true, true), 2);
  EXPECT_EQ(step(false, true), 2);
  EXPECT_EQ(step(false, false), 0);
}

TEST(ByTheManual, OhmicSensesAtItsThreshold) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("ohmic"), "o"));
  hal.set("o.thcad-max-volt-freq", 3200.0);
  hal.set("o.thcad-divide", 32.0);
  hal.set("o.volt-divider", 1.0);
  hal.set("o.ohmic-threshold", 3.0);
  hal.set("o.ohmic-low", 1.0);
  hal.set("o.is-probing", true);
  const auto at = [&](double volts) {
    hal.set("o.velocity-in", volts * 20.0);
    hal.run("o");
    return hal.get<bool>("o.ohmic-on");
  };
  EXPECT_FALSE(at(2.9));
  EXPECT_TRUE(at(3.0));
  EXPECT_TRUE(at(1.5));
  EXPECT_FALSE(at(1.0));
  EXPECT_FALSE(at(2.9));
}

TEST(ByTheManual, JoyhandleIsPointSymmetrical) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("joyhandle"), "j"));
  hal.set("j.inverse", true);
  hal.set("j.deadband", 0.1);
  const auto at = [&](double in) {
    hal.set("j.in", in);
    hal.run("j");
    return hal.get<double>("j.out");
  };
  for (double x = 0.0; x < 1.2; x += 0.05) EXPECT_DOUBLE_EQ(at(-x), -at(x)) << x;
}

TEST(ByTheManual, ConversionsTellWhatDoesNotFit) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("conv_float_u32"), "fu"));
  ASSERT_TRUE(hal.create(module("conv_float_s32"), "fs"));
  const auto at = [&](const char* c, double in, bool clamp) {
    const std::string name = c;
    hal.set(name + ".in", in);
    hal.set(name + ".clamp", clamp);
    hal.run(name);
    return hal.get<bool>(name + ".out-of-range");
  };
  for (const bool clamp : {false, true}) {
    EXPECT_FALSE(at("fu", 4294967295.0, clamp));
    EXPECT_EQ(hal.get<std::uint32_t>("fu.out"), 4294967295U);
    EXPECT_TRUE(at("fu", 4294967296.0, clamp));
    EXPECT_EQ(hal.get<std::uint32_t>("fu.out"), clamp ? 4294967295U : 0U);
    EXPECT_TRUE(at("fu", -1.0, clamp));
    EXPECT_EQ(hal.get<std::uint32_t>("fu.out"), clamp ? 0U : 4294967295U);
    EXPECT_FALSE(at("fs", 2147483647.0, clamp));
    EXPECT_FALSE(at("fs", -2147483648.0, clamp));
    EXPECT_TRUE(at("fs", 2147483648.0, clamp));
    EXPECT_EQ(hal.get<std::int32_t>("fs.out"), clamp ? INT32_MAX : INT32_MIN);
    EXPECT_TRUE(at("fs", std::nan(""), clamp));
    EXPECT_EQ(hal.get<std::int32_t>("fs.out"), 0);
  }
}

TEST(ByTheManual, ConversionsOf64BitsKeepWhatFits) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("conv_s64_u64"), "a"));
  ASSERT_TRUE(hal.create(module("conv_u64_s32"), "b"));
  ASSERT_TRUE(hal.create(module("conv_s32_s64"), "c"));
  hal.set("a.in", std::int64_t{-1});
  hal.run("a");
  EXPECT_TRUE(hal.get<bool>("a.out-of-range"));
  EXPECT_EQ(hal.get<std::uint64_t>("a.out"), UINT64_MAX);
  hal.set("b.in", std::int64_t{1} << 40);
  hal.set("b.clamp", true);
  hal.run("b");
  EXPECT_TRUE(hal.get<bool>("b.out-of-range"));
  EXPECT_EQ(hal.get<std::int32_t>("b.out"), INT32_MAX);
  hal.set("c.in", -7);
  hal.run("c");
  EXPECT_EQ(hal.get<std::int64_t>("c.out"), -7);
}

}  // namespace
}  // namespace kerf::components
