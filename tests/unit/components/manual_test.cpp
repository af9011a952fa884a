// Components that do what the manual says where LinuxCNC 2.9 does something else (docs/differences.md).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(ByTheManual, OhmicSensesAtItsThresholds) {
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
  EXPECT_FALSE(at(3.0));
  EXPECT_TRUE(at(3.1));
  EXPECT_FALSE(at(2.9));
  EXPECT_TRUE(at(4.0));
  hal.set("o.is-probing", false);
  EXPECT_TRUE(at(1.5));
  EXPECT_TRUE(at(1.0));
  EXPECT_FALSE(at(0.9));
  EXPECT_FALSE(at(4.0));
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
