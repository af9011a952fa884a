// Components that LinuxCNC has since 2.9.
#include <gtest/gtest.h>

#include <string>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(LedDim, FollowsTheCurveOfTheEye) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("led-dim"), "c"));
  struct Row {
    double in, out;
  };
  for (const auto& [in, out] :
       {Row{0, 0}, Row{0.04, 0.0044282}, Row{0.5, 0.1841865}, Row{1, 1}, Row{-3, 0}, Row{7, 1}}) {
    hal.set("c.in", in);
    hal.run("c");
    EXPECT_NEAR(hal.get<double>("c.out"), out, 1e-6) << in;
  }
}

TEST(LimitAxis, KeepsTheRangeItIsIn) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("limit-axis"), "c", 2)) << hal.error();
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-no-range")) << "none is enabled";
  EXPECT_TRUE(hal.get<bool>("c.error-limit-01")) << "no limits given";
  for (const auto& [name, value] : {std::pair{"c.min-range-00", 0.0},
                                    {"c.max-range-00", 10.0},
                                    {"c.min-range-01", 8.0},
                                    {"c.max-range-01", 20.0},
                                    {"c.min-limit-00", -1.0},
                                    {"c.max-limit-00", 1.0},
                                    {"c.min-limit-01", -5.0},
                                    {"c.max-limit-01", 5.0}})
    hal.set(name, value);
  hal.set("c.enable-00", true);
  hal.set("c.enable-01", true);
  struct Row {
    double fb;
    bool sticky;
    std::uint32_t range;
    bool none;
    double max;
  };
  for (const Row& row :
       {Row{5, false, 0, false, 1}, Row{9, false, 0, false, 1}, Row{10, false, 0, false, 1},
        Row{11, false, 1, false, 5}, Row{9, true, 1, false, 5}, Row{9, false, 0, false, 1},
        Row{11, true, 1, false, 5}, Row{8, true, 1, false, 5}, Row{7.9, true, 0, false, 1},
        Row{25, true, 0, true, 1}, Row{9, true, 0, false, 1}}) {
    hal.set("c.sticky-01", row.sticky);
    hal.set("c.fb", row.fb);
    hal.run("c");
    EXPECT_EQ(hal.get<std::uint32_t>("c.current-range"), row.range) << row.fb;
    EXPECT_EQ(hal.get<bool>("c.error-no-range"), row.none) << row.fb;
    EXPECT_EQ(hal.get<bool>("c.error-range-00"), row.none) << row.fb;
    EXPECT_FALSE(hal.get<bool>("c.error-limit-00"));
    EXPECT_EQ(hal.get<double>("c.max-output"), row.max) << row.fb;
    EXPECT_EQ(hal.get<double>("c.min-output"), -row.max) << row.fb;
  }
  // Limits that contradict each other are never given to anybody.
  hal.set("c.max-limit-00", -2.0);
  hal.set("c.fb", 5.0);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-limit-00"));
  EXPECT_TRUE(hal.get<bool>("c.error-no-range"));
  EXPECT_EQ(hal.get<double>("c.max-output"), 1.0);
  hal.set("c.max-limit-00", 1.0);
  hal.set("c.enable-00", false);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-no-range"));
  hal::TestBuilder wrong;
  EXPECT_FALSE(wrong.create(module("limit-axis"), "c", 11));
}

TEST(Bitmerge, GivesEachBitItsWeight) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("bitmerge"), "c", 32)) << hal.error();
  for (int bit = 0; bit < 32; ++bit) {
    const std::string pin = std::string("c.in-") + (bit < 10 ? "0" : "") + std::to_string(bit);
    hal.set(pin, true);
    hal.run("c");
    EXPECT_EQ(hal.get<std::uint32_t>("c.out"), std::uint32_t{1} << bit);
    hal.set(pin, false);
  }
  hal.set("c.in-00", true);
  hal.set("c.in-31", true);
  hal.run("c");
  EXPECT_EQ(hal.get<std::uint32_t>("c.out"), 0x80000001U);
  hal::TestBuilder usual, wrong;
  ASSERT_TRUE(usual.create(module("bitmerge"), "c"));
  EXPECT_TRUE(usual.has("c.in-15"));
  EXPECT_FALSE(usual.has("c.in-16"));
  EXPECT_FALSE(wrong.create(module("bitmerge"), "c", 33));
}

TEST(Momentary2nist, AsksUntilTheDeviceFollows) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("momentary2nist"), "c"));
  struct Row {
    bool in, is_on, on, off;
  };
  for (const Row& row :
       {Row{false, false, false, false}, Row{true, false, true, false},
        Row{true, false, true, false}, Row{true, true, false, false},
        Row{true, false, false, false},  // went off by itself: nobody asked anew
        Row{false, false, false, false}, Row{true, true, false, false},
        Row{false, true, false, true}, Row{false, true, false, true}, Row{true, true, false, false},
        Row{false, true, false, true}, Row{false, false, false, false}}) {
    hal.set("c.in", row.in);
    hal.set("c.is-on", row.is_on);
    hal.run("c");
    EXPECT_EQ(hal.get<bool>("c.on"), row.on);
    EXPECT_EQ(hal.get<bool>("c.off"), row.off);
  }
}

TEST(SafetyLatch, TakesAnErrorThatLastsAndLetsGoWhenItIsGone) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("safety-latch"), "c"));
  hal.set("c.error-in", true);
  hal.run("c", 1'000'000, 199);  // 500 percent a second
  EXPECT_FALSE(hal.get<bool>("c.error-out"));
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-out"));
  hal.set("c.reset", true);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-out")) << "the error is still there";
  hal.set("c.error-in", false);
  hal.run("c", 1'000'000, 1000);
  EXPECT_TRUE(hal.get<bool>("c.error-out")) << "reset has no edge";
  hal.set("c.reset", false);
  hal.run("c");
  hal.set("c.reset", true);
  hal.run("c");
  EXPECT_FALSE(hal.get<bool>("c.error-out"));
  // Without latching it heals; short errors far apart do no harm.
  hal.set("c.latching", false);
  for (int i = 0; i < 20; ++i) {
    hal.set("c.error-in", true);
    hal.run("c", 1'000'000, 100);
    hal.set("c.error-in", false);
    hal.run("c", 1'000'000, 200);
    ASSERT_FALSE(hal.get<bool>("c.error-out")) << i;
  }
  hal.set("c.threshold", 0);
  hal.set("c.error-in", true);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.error-out"));
  hal.set("c.error-in", false);
  hal.run("c", 1'000'000, 2);
  EXPECT_FALSE(hal.get<bool>("c.error-out"));
}

TEST(Reset, WritesAtTheChosenEdges) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("reset"), "c"));
  hal.set("c.reset-s32", -7);
  hal.set("c.reset-float", 2.5);
  hal.set("c.reset-u32", 9U);
  hal.set("c.out-bit", true);
  hal.set("c.trigger", true);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.out-bit")) << "no edge in the first call";
  const auto edge = [&](bool to) {
    hal.set("c.out-bit", true);
    hal.set("c.out-s32", 1);
    hal.set("c.trigger", to);
    hal.run("c");
    return hal.get<std::int32_t>("c.out-s32") == -7 && !hal.get<bool>("c.out-bit");
  };
  EXPECT_FALSE(edge(false));
  EXPECT_TRUE(edge(true));
  EXPECT_EQ(hal.get<double>("c.out-float"), 2.5);
  EXPECT_EQ(hal.get<std::uint32_t>("c.out-u32"), 9U);
  EXPECT_FALSE(edge(true));
  hal.set("c.rising-edge", false);
  hal.set("c.falling-edge", true);
  EXPECT_TRUE(edge(false));
  EXPECT_FALSE(edge(true));
}

TEST(OutputBuffer, PassesAllOnAtOnce) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("output-buffer"), "c", 2));
  EXPECT_FALSE(hal.has("c.out-02"));
  hal.set("c.in-00", true);
  hal.run("c");
  EXPECT_FALSE(hal.get<bool>("c.out-00"));
  hal.set("c.in-01", true);
  hal.set("c.update", true);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.out-00") && hal.get<bool>("c.out-01"));
  hal.set("c.update", false);
  hal.set("c.in-00", false);
  hal.run("c");
  EXPECT_TRUE(hal.get<bool>("c.out-00"));
  hal.set("c.enable", false);
  hal.run("c");
  EXPECT_FALSE(hal.get<bool>("c.out-00") || hal.get<bool>("c.out-01"));
}

TEST(Radiobutton, KeepsTheLastOne) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("radiobutton"), "c", 3));
  const auto press = [&](const char* button) {
    hal.set(button, true);
    hal.run("c");
    hal.set(button, false);
    hal.run("c");
    std::string out;
    for (const char* pin : {"c.out-00", "c.out-01", "c.out-02"})
      out += hal.get<bool>(pin) ? '1' : '0';
    return out + std::to_string(hal.get<std::int32_t>("c.selected"));
  };
  hal.run("c");
  EXPECT_EQ(hal.get<std::int32_t>("c.selected"), -1);
  EXPECT_EQ(press("c.in-01"), "0101");
  EXPECT_EQ(press("c.in-02"), "0012");
  EXPECT_EQ(press("c.off"), "000-1");
  hal.set("c.in-02", true);
  EXPECT_EQ(press("c.in-00"), "1000") << "the lowest";
  EXPECT_EQ(press("c.in-01"), "0101") << "a button that stays down is no edge";
}

TEST(Laserpower, IsLessInCornersAndNothingAtStandstill) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("laserpower"), "c"));
  hal.set("c.enable", true);
  hal.set("c.power-request", 80.0);
  hal.set("c.requested-velocity", 100.0);
  hal.set("c.min-power", 10.0);
  hal.set("c.distance-to-go", 5.0);
  const auto power = [&](double velocity) {
    hal.set("c.current-velocity", velocity);
    hal.run("c");
    return hal.get<double>("c.power");
  };
  EXPECT_DOUBLE_EQ(power(100), 80);
  EXPECT_DOUBLE_EQ(power(50), 40);
  EXPECT_DOUBLE_EQ(power(1), 10) << "min-power";
  EXPECT_DOUBLE_EQ(power(0), 0);
  EXPECT_DOUBLE_EQ(power(1000), 80);
  hal.set("c.max-power", 60.0);
  EXPECT_DOUBLE_EQ(power(100), 60);
  hal.set("c.distance-off", 6.0);
  EXPECT_DOUBLE_EQ(power(100), 0);
  hal.set("c.raster-mode", true);
  EXPECT_DOUBLE_EQ(power(100), 0);
  hal.set("c.raster-power", 33.0);
  EXPECT_DOUBLE_EQ(power(3), 33);
  hal.set("c.enable", false);
  EXPECT_DOUBLE_EQ(power(3), 0);
}

TEST(DemuxGeneric, SelectedOutputHasTheValueOthersZero) {
  hal::TestBuilder hal;
  hal.set_arg("config", "fs4,bb3");
  ASSERT_TRUE(hal.create(module("demux-generic"), "demux-generic")) << hal.error();
  hal.set("demux-gen.00.in-float", -12.7);
  hal.set("demux-gen.00.sel-bit-01", true);
  hal.run("demux-gen.00");
  EXPECT_EQ(hal.get<std::int32_t>("demux-gen.00.out-s32-02"), -12);
  hal.set("demux-gen.00.sel-int", 1U);
  hal.run("demux-gen.00");
  EXPECT_EQ(hal.get<std::int32_t>("demux-gen.00.out-s32-02"), 0);
  EXPECT_EQ(hal.get<std::int32_t>("demux-gen.00.out-s32-03"), -12);
  hal.set("demux-gen.00.in-float", 1e12);
  hal.set("demux-gen.00.sel-int", 77U);
  hal.run("demux-gen.00");
  EXPECT_EQ(hal.get<std::int32_t>("demux-gen.00.out-s32-03"), 2147483647);
  EXPECT_FALSE(hal.has("demux-gen.01.sel-bit-00"));
  hal.set("demux-gen.01.in-bit", true);
  hal.run("demux-gen.01");
  EXPECT_TRUE(hal.get<bool>("demux-gen.01.out-bit-00"));
}

TEST(Enum, NamesStandForNumbers) {
  hal::TestBuilder hal;
  hal.set_arg("enums", "D;OFF;SLOW;;FAST,E;STOP;GO");
  ASSERT_TRUE(hal.create(module("enum"), "enum")) << hal.error();
  EXPECT_EQ(hal.get<std::uint32_t>("enum-decode.00.FAST-val"), 3U);
  hal.set("enum-decode.00.input", 3U);
  hal.run("enum-decode.00");
  EXPECT_TRUE(hal.get<bool>("enum-decode.00.FAST-out"));
  EXPECT_FALSE(hal.get<bool>("enum-decode.00.OFF-out"));
  hal.set("enum-decode.00.SLOW-val", 20U);
  hal.set("enum-decode.00.input", 20U);
  hal.run("enum-decode.00");
  EXPECT_TRUE(hal.get<bool>("enum-decode.00.SLOW-out"));
  hal.set("enum-encode.01.GO-in", true);
  hal.run("enum-encode.01");
  EXPECT_EQ(hal.get<std::uint32_t>("enum-encode.01.output"), 1U);
  for (const char* wrong : {"", "X;A", "E", "D;;"}) {
    hal::TestBuilder other;
    other.set_arg("enums", wrong);
    EXPECT_FALSE(other.create(module("enum"), "enum")) << wrong;
    EXPECT_NE(other.error(), "");
  }
}

TEST(Freqgen, MakesStepsOfTheWantedFrequency) {
  hal::TestBuilder hal;
  hal.set_arg("step_type", "0");
  ASSERT_TRUE(hal.create(module("freqgen"), "freqgen")) << hal.error();
  hal.set("freqgen.0.velocity", 5.0);
  hal.set("freqgen.0.velocity-scale", 100.0);
  hal.run("freqgen.make-pulses", 50'000);
  for (int ms = 0; ms < 1000; ++ms) {
    hal.run("freqgen.update-freq");
    hal.run("freqgen.make-pulses", 50'000, 20);
  }
  hal.run("freqgen.capture-position");
  EXPECT_NEAR(hal.get<std::int32_t>("freqgen.0.counts"), 500, 1);
}

}  // namespace
}  // namespace kerf::components
