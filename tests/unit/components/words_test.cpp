// Components that say something: message to the operator, lcd to a display.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "hal/operator_line.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

using Lines = std::vector<std::string>;

class Message : public testing::Test {
 protected:
  Message() { hal.provide(hal::kOperatorLine, &line); }
  hal::TestBuilder hal;
  Lines said;
  hal::OperatorLine line{
      [](void* to, std::string_view text) noexcept { static_cast<Lines*>(to)->emplace_back(text); },
      &said};
};

TEST_F(Message, OfOffsetsThatApplyOffsetsLeavesBehindComesOnce) {
  ASSERT_TRUE(hal.create(module("moveoff"), "mv", 1)) << hal.error();
  for (const char* pin : {"mv.power-on", "mv.move-enable", "mv.apply-offsets"}) hal.set(pin, true);
  const auto run = [this](bool applies) {
    hal.set("mv.apply-offsets", applies);
    for (int i = 0; i < 100; ++i) hal.run("mv.read-inputs");
  };
  run(true);
  run(false);
  EXPECT_TRUE(said.empty()) << "there was no offset";
  hal.set("mv.offset-in-0", 0.5);
  run(true);
  run(false);
  EXPECT_EQ(said.size(), 1U);
}

TEST_F(Message, ComesOnceForEachEdge) {
  hal.set_arg("messages", "oil is low,no air");
  hal.set_arg("names", "oil,air");
  ASSERT_TRUE(hal.create(module("message"), "message")) << hal.error();
  hal.set("air.edge", false);
  hal.set("air.trigger", true);
  const auto run = [this] {
    hal.run("oil");
    hal.run("air");
  };
  run();
  EXPECT_TRUE(said.empty());
  hal.set("oil.trigger", true);
  run();
  run();
  EXPECT_EQ(said, Lines{"oil is low"});
  hal.set("air.trigger", false);
  run();
  hal.set("oil.trigger", false);
  run();
  EXPECT_EQ(said, (Lines{"oil is low", "no air"}));
}

TEST_F(Message, ForceSaysItAgainWhileTheTriggerIsActive) {
  hal.set_arg("messages", "stop");
  ASSERT_TRUE(hal.create(module("message"), "message")) << hal.error();
  hal.set("message.0.force", true);
  hal.run("message.0");
  EXPECT_TRUE(said.empty());
  hal.set("message.0.force", false);
  hal.set("message.0.trigger", true);
  hal.run("message.0", hal::TestBuilder::kPeriodNs, 3);
  hal.set("message.0.force", true);
  hal.run("message.0", hal::TestBuilder::kPeriodNs, 3);
  EXPECT_EQ(said, (Lines{"stop", "stop"}));
}

TEST_F(Message, NeedsATextForEachInstance) {
  hal.set_arg("messages", "one,two");
  hal.set_arg("count", "3");
  EXPECT_FALSE(hal.create(module("message"), "message"));
  EXPECT_NE(hal.error().find("messages="), std::string::npos) << hal.error();
}

/// What the display gets in one pass of the page.
std::string shown(hal::TestBuilder& hal) {
  constexpr int kQuietCalls = 100, kStart = 16, kCalls = 400;
  hal.run("lcd", hal::TestBuilder::kPeriodNs, kQuietCalls + kStart);
  std::string out;
  for (int i = 0; i < kCalls; ++i) {
    hal.run("lcd");
    out += static_cast<char>(hal.get<std::uint32_t>("lcd.00.out"));
  }
  const std::string end("\0\x1b=  ", 5);
  const auto from = out.find(end), to = out.find(end, from + 1);
  return to == std::string::npos ? out : out.substr(from + end.size(), to - from - end.size());
}

std::string shown(const std::string& format, double value) {
  hal::TestBuilder hal;
  hal.set_arg("fmt_strings", format);
  if (!hal.create(module("lcd"), "lcd")) return hal.error();
  const char* arg = "lcd.00.page.00.arg.00";
  if (hal.has(arg)) {
    if (hal.type(arg) == hal::Type::floating)
      hal.set(arg, value);
    else
      hal.set(arg, static_cast<std::int64_t>(value));
  }
  return shown(hal);
}

TEST(Lcd, KeepsWidths) {
  EXPECT_EQ(shown("%f", 1.5), "1.5000");
  EXPECT_EQ(shown("%8.2f", -3.456), "   -3.46");
  EXPECT_EQ(shown("%+08.2f", 3.456), "+0003.46");
  EXPECT_EQ(shown("%5.2f", 123.456), "*****");
  EXPECT_EQ(shown("%5.1f", 1e300), "*****");
  EXPECT_EQ(shown("%5.1f", std::numeric_limits<double>::quiet_NaN()), "*****");
  EXPECT_EQ(shown("%3d", -123), "-**");
  EXPECT_EQ(shown("%+05d", 12), "+0012");
  EXPECT_EQ(shown("%04x", 171), "00AB");
  EXPECT_EQ(shown("%d", -2147483648.0), "-2147483648");
  EXPECT_EQ(shown("%5c", 66), "BBBBB");
  EXPECT_EQ(shown("%b\\41\\42", 0), "B");
}

TEST(Lcd, TakesEscapes) { EXPECT_EQ(shown("a\\tb\\n\\7C\\2C\\\\%%", 0), "a    b\x18\n\r|,\\%"); }

TEST(Lcd, RefusesWhatItCannotShow) {
  EXPECT_NE(shown("%z", 0).find("fmt_strings="), std::string::npos);
  EXPECT_NE(shown("\\4", 0).find("fmt_strings="), std::string::npos);
  EXPECT_NE(shown("%bY", 0).find("fmt_strings="), std::string::npos);
  EXPECT_NE(shown("", 0).find("fmt_strings="), std::string::npos);
}

TEST(Lcd, TakesTheSeparatorOfDecimals) {
  hal::TestBuilder hal;
  hal.set_arg("fmt_strings", "%.1f");
  ASSERT_TRUE(hal.create(module("lcd"), "lcd")) << hal.error();
  hal.set("lcd.00.decimal-separator", 44);
  hal.set("lcd.00.page.00.arg.00", 2.5);
  EXPECT_EQ(shown(hal), "2,5");
}

}  // namespace
}  // namespace kerf::components
