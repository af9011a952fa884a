#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

struct Gate {
  const char* name;
  bool out[4];  // for in0,in1 = 00, 10, 01, 11
};

TEST(Logic, GatesFollowTheirTruthTables) {
  constexpr Gate kGates[] = {
      {"and2", {false, false, false, true}},
      {"or2", {false, true, true, true}},
      {"xor2", {false, true, true, false}},
  };
  for (const Gate& gate : kGates) {
    SCOPED_TRACE(gate.name);
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module(gate.name), "g")) << hal.error();
    for (unsigned row = 0; row < 4; ++row) {
      hal.set("g.in0", (row & 1U) != 0);
      hal.set("g.in1", (row & 2U) != 0);
      hal.run("g");
      EXPECT_EQ(hal.get<bool>("g.out"), gate.out[row]) << "row " << row;
    }
  }
}

TEST(Logic, NotInverts) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("not"), "not.0"));
  hal.run("not.0");
  EXPECT_TRUE(hal.get<bool>("not.0.out"));
  hal.set("not.0.in", true);
  hal.run("not.0");
  EXPECT_FALSE(hal.get<bool>("not.0.out"));
}

TEST(Logic, GatesChangeNothingUntilTheyRun) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("or2"), "or2.0"));
  hal.set("or2.0.in0", true);
  EXPECT_FALSE(hal.get<bool>("or2.0.out"));
}

/// Feeds `in` a text of 0 and 1, one a call, and gives what `out` was after each.
std::string trace(hal::TestBuilder& hal, const std::string& in, const char* in_pin = "c.in",
                  const char* out_pin = "c.out") {
  std::string out;
  for (const char bit : in) {
    hal.set(in_pin, bit == '1');
    hal.run("c");
    out += hal.get<bool>(out_pin) ? '1' : '0';
  }
  return out;
}

TEST(Logic, ToggleTurnsOverAtDebouncedPresses) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("toggle"), "c"));
  EXPECT_EQ(trace(hal, "0010011111010011100"), "0000001111111110000");
  hal.set("c.out", true);  // somebody else switches it on
  EXPECT_EQ(trace(hal, "0110"), "1100") << "released long enough before";
  hal.set("c.debounce", 1U);
  EXPECT_EQ(trace(hal, "00101"), "00110");
  for (const std::uint32_t bad : {0U, 10001U}) {
    hal.set("c.debounce", bad);
    hal.run("c");
    EXPECT_EQ(hal.get<std::uint32_t>("c.debounce"), 2U) << bad;
  }
}

TEST(Logic, EdgeMakesPulses) {
  struct Case {
    bool both, in_edge;
    std::int32_t width_ns;
    const char *in, *out;
  };
  constexpr Case kCases[] = {
      {false, true, 0, "0110010", "0001001"},   // falling
      {false, false, 0, "0110010", "0100010"},  // rising
      {true, true, 0, "0110010", "0101011"},
      {true, true, 2'500'000, "00111111000", "00111000111"},
      {false, false, 2'000'000, "0101000", "0111100"},  // started anew
      {false, false, 2'000'000, "0100000", "0110000"},
      {false, false, -5, "0100", "0100"},
  };
  for (const Case& c : kCases) {
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module("edge"), "c"));
    hal.set("c.both", c.both);
    hal.set("c.in-edge", c.in_edge);
    hal.set("c.out-width-ns", c.width_ns);
    EXPECT_EQ(trace(hal, c.in), c.out) << c.in;
    EXPECT_NE(hal.get<bool>("c.out"), hal.get<bool>("c.out-invert"));
    EXPECT_EQ(hal.get<bool>("c.last-in"), std::string_view(c.in).back() == '1');
  }
}

TEST(Logic, OneshotMakesOnePulseATrigger) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("oneshot"), "c"));
  hal.set("c.width", 0.003);
  EXPECT_EQ(trace(hal, "0111111"), "0111000");
  EXPECT_TRUE(hal.get<bool>("c.out-not"));
  EXPECT_EQ(trace(hal, "0101000"), "0111110");
  hal.set("c.retriggerable", false);
  EXPECT_EQ(trace(hal, "0101000"), "0111000");
  hal.set("c.rising", false);
  hal.set("c.falling", true);
  EXPECT_EQ(trace(hal, "0110000"), "0001110");
}

TEST(Logic, OneshotResetEndsThePulse) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("oneshot"), "c"));
  hal.set("c.width", 0.003);
  EXPECT_EQ(trace(hal, "011"), "011");
  EXPECT_DOUBLE_EQ(hal.get<double>("c.time-left"), 0.002);
  hal.set("c.reset", true);
  EXPECT_EQ(trace(hal, "111"), "000");
  EXPECT_DOUBLE_EQ(hal.get<double>("c.time-left"), 0.002) << "as in LinuxCNC it stands";
  hal.set("c.reset", false);
  EXPECT_EQ(trace(hal, "11111"), "11100");
  EXPECT_EQ(hal.get<double>("c.time-left"), 0.0);
}

TEST(Logic, TimedelayPassesOnWhatLasts) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("timedelay"), "c"));
  hal.set("c.on-delay", 0.003);
  hal.set("c.off-delay", 0.002);
  EXPECT_EQ(trace(hal, "001111110001010110111100"), "000011111000000000001110");
  EXPECT_DOUBLE_EQ(hal.get<double>("c.elapsed"), 0.002);
  hal.set("c.on-delay", 0.0);
  EXPECT_EQ(trace(hal, "0101"), "0111");
}

TEST(Tp, APulseLastsItsTimeWhateverTheInputDoes) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("tp"), "tp"));
  hal.set("tp.pt", 0.0045);
  const auto step = [&](bool in) {
    hal.set("tp.in", in);
    hal.run("tp");
    return hal.get<bool>("tp.q");
  };
  EXPECT_FALSE(step(false));
  // Short input, long input, and an edge within the pulse: five periods reach 4.5 ms.
  for (const int on : {1, 3, 20}) {
    int length = 0;
    for (int i = 0; i < 20; ++i) length += step(i < on || i == 4) ? 1 : 0;
    EXPECT_EQ(length, 5) << on;
    // As in LinuxCNC the time goes back although in may still be true.
    EXPECT_EQ(hal.get<double>("tp.et"), 0.0);
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(step(false));
    EXPECT_EQ(hal.get<double>("tp.et"), 0.0);
  }
}

TEST(Demux, ANumberPastTheLastIsTheLastAndOneBelowZeroIsNone) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("demux"), "d"));
  hal.set("d.sel-u32", std::uint32_t{100});
  hal.run("d");
  EXPECT_TRUE(hal.get<bool>("d.out-31"));
  hal.set("d.sel-u32", std::uint32_t{1} << 31U);
  hal.run("d");
  EXPECT_FALSE(hal.get<bool>("d.out-31"));
  hal.set("d.bargraph", true);
  hal.run("d");
  EXPECT_FALSE(hal.get<bool>("d.out-00"));
}

}  // namespace
}  // namespace kerf::components
