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

constexpr Key kJointKeys[] = {
    real("MAX_VELOCITY", "").unit("mm/s").above(0).otherwise("1"),
    real("MAX_ACCELERATION", "").unit("mm/s^2").from(0).to(1000),
    real("HOME", "").otherwise("2.5"),
    real("BACKLASH", ""),
    integer("N", "").otherwise("-7"),
    boolean("FLAG", "").otherwise("YES"),
    text("S", "").otherwise("none"),
    text("H", "").repeated(),
    choice("TYPE", "LINEAR ANGULAR", "").otherwise("ANGULAR"),
    reals("P", "3 6", "").unit("mm"),
    text("L", ""),
    text("N2", ""),
};
constexpr KeySection kSections[] = {{"JOINT_n", "", kJointKeys, By::motion}};
constexpr KeyTable kTable{kSections};

TEST(IniReader, GoodValuesNeedNoComplaint) {
  const IniFile file =
      ini("[JOINT_0]\nMAX_VELOCITY = 12.5\nN=-3\nFLAG=no\nS=a "
          "b\nH=1\nH=2\nTYPE=linear\nL=inch\nN2=0.25\n"
          "P=1 2\t-3.5\n");
  Reader r(file, kTable);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "MAX_VELOCITY"), 12.5);
  EXPECT_EQ(r.integer("JOINT_0", "N"), -3);
  EXPECT_FALSE(r.boolean("JOINT_0", "FLAG"));
  EXPECT_EQ(r.string("JOINT_0", "S"), "a b");
  EXPECT_THAT(r.strings("JOINT_0", "H"), ElementsAre("1", "2"));
  EXPECT_EQ(r.choice("JOINT_0", "TYPE"), 0U);
  EXPECT_THAT(r.reals("JOINT_0", "P"), ElementsAre(1, 2, -3.5));
  EXPECT_DOUBLE_EQ(r.linear_unit("JOINT_0", "L"), 25.4);
  EXPECT_DOUBLE_EQ(r.linear_unit("JOINT_0", "N2"), 4) << "units in 1 mm";
  EXPECT_TRUE(r.complaints().empty());
  EXPECT_FALSE(r.failed());
}

TEST(IniReader, AbsentKeysGiveTheTablesDefaults) {
  const IniFile file = ini("[JOINT_0]\n");
  Reader r(file, kTable);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "HOME"), 2.5);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "HOME", 7), 7) << "the caller's own default";
  EXPECT_EQ(r.integer("JOINT_0", "N"), -7);
  EXPECT_TRUE(r.boolean("JOINT_0", "FLAG"));
  EXPECT_EQ(r.string("JOINT_0", "S"), "none");
  EXPECT_EQ(r.choice("JOINT_0", "TYPE"), 1U);
  EXPECT_TRUE(r.reals("JOINT_0", "P").empty());
  EXPECT_TRUE(r.complaints().empty());
}

TEST(IniReader, AKeyThatIsNotInTheTableIsAFaultOfTheProgram) {
  const IniFile file = ini("[JOINT_0]\nSECRET = 1\n");
  Reader r(file, kTable);
  r.real("JOINT_0", "SECRET");
  ASSERT_TRUE(r.failed());
  EXPECT_THAT(r.complaints()[0].message(), HasSubstr("is not in the table"));
}

TEST(IniReader, EveryBadKeyIsCollected) {
  const IniFile file =
      ini("[JOINT_0]\nMAX_VELOCITY = -1\nMAX_ACCELERATION = fast\nHOME = 1\nTYPE = LINAER\n"
          "BACKLASH = 0 # none\nFLAG = maybe\nP = 1 2\n");
  Reader r(file, kTable);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "MAX_VELOCITY"), 1);
  r.real("JOINT_0", "MAX_ACCELERATION");
  r.choice("JOINT_0", "TYPE");
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "BACKLASH"), 0);
  EXPECT_TRUE(r.boolean("JOINT_0", "FLAG"));
  EXPECT_TRUE(r.reals("JOINT_0", "P").empty());
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
                  "m.ini:8: error: [JOINT_0]P = '1 2': expected 3 or 6 numbers [mm]",
                  "m.ini:4: error: [JOINT_0]HOME: is outside the limits"));
}

TEST(IniReader, TrailingTextIsAWarningButACommentIsNot) {
  const IniFile file = ini("[JOINT_0]\nHOME=100 # travel\nN=1.5\nBACKLASH=1 000\nFLAG=TRUE # c\n");
  Reader r(file, kTable);
  EXPECT_DOUBLE_EQ(r.real("JOINT_0", "HOME"), 100);
  EXPECT_TRUE(r.complaints().empty());
  EXPECT_EQ(r.integer("JOINT_0", "N"), 1);
  EXPECT_EQ(r.real("JOINT_0", "BACKLASH"), 1);
  EXPECT_FALSE(r.failed());
  r.boolean("JOINT_0", "FLAG");
  ASSERT_EQ(r.complaints().size(), 3U);
  EXPECT_EQ(r.complaints()[0].message(),
            "m.ini:3: warning: [JOINT_0]N = '1.5': '.5' after the number is ignored");
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
