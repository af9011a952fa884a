#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::interp {
namespace {

struct Case {
  const char* expression;
  double value;
};

class Expressions : public ::testing::TestWithParam<Case> {};

TEST_P(Expressions, HaveTheDocumentedValue) {
  Rig rig;
  ASSERT_EQ(rig.mdi(std::string("#1=") + GetParam().expression), "");
  EXPECT_NEAR(rig.interp.parameters().get(1), GetParam().value, 1e-9) << GetParam().expression;
}

INSTANTIATE_TEST_SUITE_P(
    Manual, Expressions,
    ::testing::Values(Case{"[2.0 / 3 * 1.5 - 5.5 / 11.0]", 0.5},
                      Case{"[1 + acos[0] - [0 ** [4.0/2]]]", 91}, Case{"[2+3*2**2]", 14},
                      Case{"[2 ** 3 ** 2]", 64}, Case{"[-2 ** 2]", 4}, Case{"[7 MOD 4]", 3},
                      Case{"[-7 MOD 4]", 1}, Case{"[1 EQ 1.00005]", 1}, Case{"[1 NE 1.00005]", 0},
                      Case{"[1 LT 0 OR 1]", 1}, Case{"[1 XOR 1]", 0}, Case{"[1 AND 0]", 0},
                      Case{"[3 - -2]", 5}, Case{"[2 GE 2]", 1}, Case{"[2 LE 1]", 0},
                      Case{"[3 GT 2]", 1}, Case{"abs[-5]", 5}, Case{"atan[1]/[1]", 45},
                      Case{"ATAN[-1]/[0]", -90}, Case{"round[2.5]", 3}, Case{"round[-2.5]", -3},
                      Case{"fix[2.8]", 2}, Case{"fix[-2.8]", -3}, Case{"fup[2.8]", 3},
                      Case{"fup[-2.8]", -2}, Case{"exp[0]", 1}, Case{"ln[exp[2]]", 2},
                      Case{"[sqrt[4]*0]", 0}, Case{"sin[30]", 0.5}, Case{"cos[60]", 0.5},
                      Case{"tan[45]", 1}, Case{"asin[1]", 90}, Case{"-[2]", -2}, Case{"+3", 3},
                      Case{"-.5", -0.5}, Case{"1 0.2 5", 10.25}));

TEST(ExpressionErrors, NameTheirPlaceAndCause) {
  struct Wrong {
    const char* line;
    const char* text;
    int column;
  };
  const Wrong cases[] = {
      {"G0 X[1/0]", "Attempt to divide by zero", 7},
      {"G0 X[1 MOD 0]", "Calculation resulted in 'not a number'", 8},
      {"G0 XSQRT[-1]", "Negative argument to sqrt", 5},
      {"G0 XACOS[2]", "Argument to acos out of range", 5},
      {"G0 XASIN[2]", "Argument to asin out of range", 5},
      {"G0 XLN[0]", "Zero or negative argument to ln", 5},
      {"G0 XATAN[1]", "Slash missing after first atan argument", 12},
      {"G0 X[1 FOO 2]", "Unknown operation", 8},
      {"G0 X[1", "Unclosed expression", 5},
      {"G0 Xq", "Unknown word where unary operation could be", 5},
      {"Y-", "bad number format (conversion failed) parsing '-'", 2},
      {"g0x.5.5", "bad number format (trailing characters) parsing '.5.5'", 4},
      {"G0 Z", "No characters found in reading real value", 5},
      {"G0 X#99999", "Parameter number out of range", 5},
      {"G0 X#0", "Parameter number out of range", 5},
      {"G0 X#1.5", "Non integer value for integer", 5},
      {"G0 X#<nada>", "Named parameter #<nada> not defined", 5},
      {"X#<", "Named parameter not terminated", 4},
      {"#1", "Equal sign missing in parameter setting", 3},
      {"#5421=1", "Parameter is readonly", 1},
      {"#<_task>=2", "Cannot assign to read-only parameter #<_task>", 1},
      {"#<_hal[a]>=2", "Cannot assign to read-only parameter #<_hal[a]>", 1},
      {"#5603=1", "Parameter number out of range", 1},
      {"G0 X[[-8] ** .5]", "Attempt to raise negative to non integer power", 11},
  };
  for (const Wrong& c : cases) {
    Rig rig;
    EXPECT_EQ(rig.mdi(c.line), std::string("error: ") + c.text) << c.line;
    EXPECT_EQ(rig.interp.error().column, c.column) << c.line;
    EXPECT_EQ(rig.interp.error().line, 1);
    EXPECT_EQ(rig.interp.error().source, c.line);
  }
}

TEST(ExpressionErrors, DeepNestingIsRefusedNotRecursed) {
  Rig rig;
  const std::string deep = "#1=" + std::string(3000, '[') + "1" + std::string(3000, ']');
  EXPECT_EQ(rig.mdi(deep), "error: Expression nested too deeply");
  EXPECT_EQ(rig.mdi("#1=" + std::string(3000, '#') + "1"), "error: Expression nested too deeply");
  EXPECT_EQ(rig.mdi("#1=" + std::string(40, '[') + "1" + std::string(40, ']')), "");
}

TEST(Parameters, AreSetAfterAllValuesOfTheLineAreRead) {
  Rig rig;
  (void)rig.mdi("#3=15");
  EXPECT_EQ(rig.mdi("#3=6 G0 X#3"),
            "STRAIGHT_TRAVERSE(15.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.debug("#3"), "6.000000");
  (void)rig.mdi("#3=15 #3=7");
  EXPECT_EQ(rig.debug("#3"), "7.000000");
  (void)rig.mdi("#2=3 #4=#2");
  EXPECT_EQ(rig.debug("#4"), "0.000000");
  (void)rig.mdi("#5=##2");
  EXPECT_EQ(rig.debug("%d#5"), "7");
}

TEST(Parameters, NamesIgnoreCaseAndBlanks) {
  Rig rig;
  (void)rig.mdi("#<P a R am>=3");
  EXPECT_EQ(rig.debug("#<param> #<_no>"), "3.000000 ######");
  EXPECT_EQ(rig.mdi("#1=exists[#<param>] #2=exists[#<nope>] #3=exists[#<_metric>]"), "");
  EXPECT_EQ(rig.debug("%d#1 #2 #3"), "1 0 1");
}

TEST(Parameters, ReadHalAndIni) {
  Rig rig;
  rig.world.hal["motion-controller.time"] = 42;
  rig.world.ini["SETUP/XPOS"] = 3.145;
  EXPECT_EQ(rig.debug("#<_hal[motion-controller.time]> #<_ini[setup]xpos> #<_ini[setup]no>"),
            "42.000000 3.145000 ######");
  EXPECT_EQ(rig.mdi("#1=[#<_ini[setup]xpos>*2] #2=exists[#<_hal[none]>]"), "");
  EXPECT_EQ(rig.debug("%.2f#1 %d#2"), "6.29 0");
}

TEST(Parameters, PredefinedOnesFollowTheState) {
  Rig rig;
  EXPECT_EQ(rig.debug("%d#<_metric> #<_imperial> #<_absolute> #<_plane> #<_motion_mode> "
                      "#<_coord_system> #<_ccomp>"),
            "1 0 1 170 800 540 400");
  (void)rig.run("G20 G91 G18 F10\nG1 X1\nG59.1\nM3 S100\nM8\nG43.1 Z1\n(abort,x)\n");
  EXPECT_EQ(rig.debug("%d#<_metric> #<_imperial> #<_absolute> #<_plane> #<_motion_mode> "
                      "#<_coord_system> #<_tool_offset>"),
            "0 1 0 180 10 591 1");
  EXPECT_EQ(rig.debug("%d#<_spindle_on> #<_spindle_cw> #<_rpm> #<_flood> #<_mist> #<_feed>"),
            "1 1 100 1 0 10");
  EXPECT_EQ(rig.debug("%d#<_x> #<_z> #<_abs_z> #5422"), "1 -1 0 -1");
}

}  // namespace
}  // namespace kerf::interp
