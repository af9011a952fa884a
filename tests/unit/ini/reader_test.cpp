// Typed reading: conversions, ranges, units, complaints and suggestions.
#include "ini/reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "ini/convert.hpp"
#include "ini/ini_file.hpp"
#include "ini/nearest.hpp"

namespace kerf::ini {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

IniFile ini(const std::string& text) {
  auto result = IniFile::parse(text, "m.ini");
  EXPECT_TRUE(result.ok);
  return result.file;
}

std::vector<std::string> lines(const std::vector<Diagnostic>& diagnostics) {
  std::vector<std::string> out;
  for (const auto& d : diagnostics) out.push_back(d.message());
  return out;
}

TEST(IniReader, GoodValuesNeedNoComplaint) {
  const IniFile file =
      ini("[J]\nV = 12.5\nN=-3\nU=0x1F\nB=Yes\nS=a b\nH=1\nH=2\nT=angular\nL=inch\nD=deg\n");
  Reader r(file);
  EXPECT_DOUBLE_EQ(r.real("J", "V", {.min = 0, .required = true, .unit = "mm/s"}), 12.5);
  EXPECT_EQ(r.integer("J", "N"), -3);
  EXPECT_EQ(r.unsigned_integer("J", "U"), 31U);
  EXPECT_TRUE(r.boolean("J", "B", false));
  EXPECT_EQ(r.string("J", "S"), "a b");
  EXPECT_THAT(r.strings("J", "H"), ElementsAre("1", "2"));
  EXPECT_EQ(r.choice("J", "T", {"LINEAR", "ANGULAR"}, 0), 1U);
  EXPECT_DOUBLE_EQ(r.linear_unit("J", "L"), 25.4);
  EXPECT_DOUBLE_EQ(r.angular_unit("J", "D"), 1.0);
  EXPECT_TRUE(r.complaints().empty());
  EXPECT_FALSE(r.failed());
}

TEST(IniReader, AbsentKeysGiveTheirDefaults) {
  const IniFile file = ini("[J]\n");
  Reader r(file);
  EXPECT_DOUBLE_EQ(r.real("J", "V", {.fallback = 2.5}), 2.5);
  EXPECT_EQ(r.integer("J", "N", {.fallback = -7}), -7);
  EXPECT_TRUE(r.boolean("J", "B", true));
  EXPECT_EQ(r.string("J", "S", "none"), "none");
  EXPECT_EQ(r.choice("J", "T", {"A", "B"}, 1), 1U);
  EXPECT_TRUE(r.complaints().empty());
}

TEST(IniReader, EveryBadKeyIsCollected) {
  const IniFile file =
      ini("[JOINT_0]\nMAX_VELOCITY = -1\nMAX_ACCELERATION = fast\nHOME = 1\nTYPE = LINAER\n"
          "BACKLASH = 0 # none\nFLAG = maybe\n");
  Reader r(file);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "MAX_VELOCITY",
                          {.fallback = 1, .min = 0, .min_excluded = true, .unit = "mm/s"}),
                   1);
  r.real("JOINT_0", "MAX_ACCELERATION", {.min = 0, .max = 1000, .unit = "mm/s^2"});
  r.choice("JOINT_0", "TYPE", {"LINEAR", "ANGULAR"}, 0);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "BACKLASH"), 0);
  r.boolean("JOINT_0", "FLAG", true);
  r.complain("JOINT_0", "HOME", "is outside the limits");
  EXPECT_TRUE(r.failed());
  EXPECT_THAT(
      lines(r.complaints()),
      ElementsAre("m.ini:2: error: [JOINT_0]MAX_VELOCITY = '-1': expected a number above 0 [mm/s]",
                  "m.ini:3: error: [JOINT_0]MAX_ACCELERATION = 'fast': expected a number from 0 to "
                  "1000 [mm/s^2]",
                  "m.ini:5: error: [JOINT_0]TYPE = 'LINAER': expected one of LINEAR ANGULAR; did "
                  "you mean 'LINEAR'?",
                  "m.ini:7: error: [JOINT_0]FLAG = 'maybe': expected one of TRUE YES ON 1 FALSE NO "
                  "OFF 0",
                  "m.ini:4: error: [JOINT_0]HOME: is outside the limits"));
}

TEST(IniReader, TrailingTextIsAWarningButACommentIsNot) {
  const IniFile file = ini("[A]\nC=100 # travel\nT=1.5\nS=1 000\nB=TRUE # c\n");
  Reader r(file);
  EXPECT_DOUBLE_EQ(r.real("A", "C"), 100);
  EXPECT_TRUE(r.complaints().empty());
  EXPECT_EQ(r.integer("A", "T"), 1);
  EXPECT_EQ(r.integer("A", "S"), 1);
  EXPECT_FALSE(r.failed());
  r.boolean("A", "B", false);
  ASSERT_EQ(r.complaints().size(), 3U);
  EXPECT_EQ(r.complaints()[0].message(),
            "m.ini:3: warning: [A]T = '1.5': '.5' after the number is ignored");
  EXPECT_THAT(r.complaints()[2].message(), HasSubstr("put it on a line of its own"));
}

TEST(IniReader, MissingRequiredKeyNamesTheNearest) {
  const IniFile file = ini("[JOINT_0]\nMAX_VELOCTIY=1\n[AXIS_X]\nMAX_LIMIT=5\n");
  const auto typo = get_real(file, "JOINT_0", "MAX_VELOCITY", {.required = true, .unit = "mm/s"});
  EXPECT_FALSE(typo.ok());
  EXPECT_EQ(typo.error(),
            "m.ini:1: error: [JOINT_0]MAX_VELOCITY is missing: expected a number [mm/s]; did you "
            "mean 'MAX_VELOCTIY' at m.ini:2?");
  const auto elsewhere = get_real(file, "JOINT_0", "MAX_LIMIT", {.required = true});
  EXPECT_THAT(elsewhere.error(), HasSubstr("[AXIS_X]MAX_LIMIT exists at m.ini:4"));
  const auto section = get_string(file, "JOINT_O", "HOME", {.required = true});
  EXPECT_THAT(section.error(), HasSubstr("did you mean [JOINT_0] at m.ini:1?"));
  const auto nothing = get_bool(file, "SPINDLE", "Q", {.required = true});
  EXPECT_THAT(nothing.error(), HasSubstr("there is no section [SPINDLE]"));
}

TEST(IniReader, UnsignedRefusesNegative) {
  const IniFile file = ini("[A]\nX=-3\nY=-0\n");
  EXPECT_FALSE(get_uint(file, "A", "X").ok());
  EXPECT_TRUE(get_uint(file, "A", "Y").ok());
  EXPECT_THAT(get_uint(file, "A", "X").error(), HasSubstr("an integer of at least 0"));
}

TEST(IniReader, UnknownKeysGetASuggestion) {
  const IniFile file = ini("[A]\nHOME=1\nHOEM_OFFSET=2\nHAL_ONLY=3\nHOEM_OFFSET=4\n[B]\nZ=1\n");
  Reader r(file);
  r.real("A", "HOME");
  r.real("A", "HOME_OFFSET");
  r.known_key("A", "HAL_ONLY");
  EXPECT_THAT(lines(r.unknown_keys({"A", "NOPE"})),
              ElementsAre("m.ini:3: warning: unknown key [A]HOEM_OFFSET; did you mean "
                          "'HOME_OFFSET'?"));
  EXPECT_THAT(lines(r.unknown_keys({"B"})), ElementsAre("m.ini:7: warning: unknown key [B]Z"));
}

TEST(IniConvert, IntegerPrefixes) {
  EXPECT_EQ(to_int("0x1F").value, 31);
  EXPECT_EQ(to_int("0b101").value, 5);
  EXPECT_EQ(to_int("0o17").value, 15);
  EXPECT_EQ(to_int("017").value, 17);
  EXPECT_EQ(to_int("+4").value, 4);
  EXPECT_EQ(to_int("-0x10").value, -16);
  EXPECT_EQ(to_int("-9223372036854775808").value, INT64_MIN);
  for (const char* bad : {"", "abc", "99999999999999999999", "9223372036854775808", "nan", "inf",
                          "--1", "+-1", "TRUE", "-"}) {
    EXPECT_FALSE(to_int(bad).valid) << bad;
  }
  EXPECT_TRUE(to_int("0xZ").valid);
  EXPECT_EQ(to_int("0xZ").rest, "xZ");
}

TEST(IniConvert, Reals) {
  EXPECT_DOUBLE_EQ(to_real("0x1F").value, 31);
  EXPECT_DOUBLE_EQ(to_real("+.5").value, 0.5);
  EXPECT_DOUBLE_EQ(to_real("-1e3").value, -1000);
  EXPECT_DOUBLE_EQ(to_real("99999999999999999999").value, 1e20);
  EXPECT_TRUE(to_real("1e-400").valid);
  EXPECT_TRUE(to_real("0b101").has_trailing());
  for (const char* bad : {"", "abc", "nan", "inf", "-inf", "1e400", "+-1", "."}) {
    EXPECT_FALSE(to_real(bad).valid) << bad;
  }
}

TEST(IniConvert, Units) {
  EXPECT_DOUBLE_EQ(mm_per_unit("MM").value(), 1);
  EXPECT_DOUBLE_EQ(mm_per_unit("cm").value(), 10);
  EXPECT_DOUBLE_EQ(mm_per_unit("imperial").value(), 25.4);
  EXPECT_DOUBLE_EQ(mm_per_unit("in").value(), 25.4);
  EXPECT_DOUBLE_EQ(mm_per_unit("metric").value(), 1);
  EXPECT_FALSE(mm_per_unit("furlong").has_value());
  EXPECT_NEAR(1.0 / deg_per_unit("rad").value(), 0.017453292519943295, 1e-17);
  EXPECT_DOUBLE_EQ(deg_per_unit("grad").value(), 0.9);
}

TEST(IniNearest, OnlyHelpfulSuggestions) {
  EXPECT_EQ(nearest_name("max_velocity", {"MAX_VELOCITY", "MIN_LIMIT"}), "MAX_VELOCITY");
  EXPECT_EQ(nearest_name("HOME", {"FERROR", "SCALE"}), "");
  EXPECT_EQ(nearest_name("X", {"Y"}), "");
}

}  // namespace
}  // namespace kerf::ini
