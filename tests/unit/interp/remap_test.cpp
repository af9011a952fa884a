// REMAP: new codes and new bodies for built-in ones. Manual: "Remap Extending G-code".
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "rig.hpp"

namespace kerf::interp {
namespace {

namespace fs = std::filesystem;

Remap remap(const std::string& text) {
  const RemapParse p = parse_remap(text);
  EXPECT_TRUE(p.remap) << p.error;
  return p.remap.value_or(Remap{});
}

Settings remapped(const std::vector<std::string>& lines) {
  Settings s;
  for (const std::string& line : lines) s.remaps.push_back(remap(line));
  return s;
}

/// An interpreter with remaps whose bodies are files of a temporary folder.
class RemapTest : public ::testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::temp_directory_path() /
           ("kerf_remap_" + std::to_string(::getpid()) + "_" +
            ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  /// `body`: what stands between sub and endsub; `value`: what endsub returns.
  void sub(const std::string& name, const std::string& body, const std::string& value = "") {
    std::ofstream(dir_ / (name + ".ngc"))
        << "o<" << name << "> sub\n"
        << body << "o<" << name << "> endsub " << value << "\nM2\n";
  }
  Rig& rig(const std::vector<std::string>& remaps) { return rig(remapped(remaps)); }
  Rig& rig(const Settings& settings) {
    rig_ = std::make_unique<Rig>(settings);
    rig_->world.files.add_directory(dir_.string());
    return *rig_;
  }
  /// Runs lines and M2; the calls without those of the program end.
  std::string run(const std::string& lines) {
    std::string out = rig_->run(lines + "%\n");
    const std::size_t end = out.rfind("error: Bad character '%' used");
    EXPECT_NE(end, std::string::npos) << out;
    return end == std::string::npos ? out : out.substr(0, end);
  }
  std::string fails(const std::string& lines) {
    const std::string out = rig_->run(lines + "M2\n");
    const std::size_t at = out.rfind("error: ");
    return at == std::string::npos ? "no error in " + out : out.substr(at + 7);
  }
  static std::string message(const std::string& text) { return "MESSAGE(\"" + text + "\")\n"; }

  fs::path dir_;
  std::unique_ptr<Rig> rig_;
};

TEST(RemapLine, ReadsAllOptions) {
  const Remap r = remap("M400 modalgroup=9 argspec=@Pq^>n prolog=before ngc=name epilog=behind");
  EXPECT_EQ(r.letter, 'm');
  EXPECT_EQ(r.code, 400);
  EXPECT_EQ(r.group, 9);
  EXPECT_EQ(r.words, "Pq");
  EXPECT_TRUE(r.positional && r.spindle && r.feed && r.line_number);
  EXPECT_EQ(r.ngc, "name");
  EXPECT_EQ(r.prolog, "before");
  EXPECT_EQ(r.epilog, "behind");
  EXPECT_EQ(remap("g88.6 py=f").code, 886);
  EXPECT_EQ(remap("G88.6 python=f").group, 1);
  EXPECT_EQ(remap("M6 ngc=x").group, 10);
  EXPECT_EQ(remap("T argspec= ngc=x").letter, 't');
}

TEST(RemapLine, RefusesWhatThePeerRefuses) {
  const std::pair<const char*, const char*> rows[] = {
      {"M400",
       "code 'M400' - no remap function given, use either 'python=<function>' or "
       "'ngc=<basename>'"},
      {"M400 ngc=a modalgroup=3",
       "error: code 'M400' : invalid modalgroup=<int> given (currently valid: 4..10)"},
      {"M400 ngc=a modalgroup=x",
       "error: code 'M400' : invalid modalgroup=<int> given (currently valid: 4..10)"},
      {"M400 ngc=a py=b", "can't remap to an ngc file and a Python function"},
      {"M400 ngc=a argspec=P!", "argspec: illegal word '!'"},
  };
  for (const auto& [text, error] : rows) {
    const RemapParse p = parse_remap(text);
    EXPECT_FALSE(p.remap) << text;
    EXPECT_EQ(p.error, error) << text;
  }
  for (const char* text : {"", "X ngc=a", "M ngc=a", "M1000 ngc=a", "G100 ngc=a", "M1.5 ngc=a"})
    EXPECT_FALSE(parse_remap(text).error.empty()) << text;
}

TEST(RemapLine, WarnsOfWhatItIgnores) {
  const RemapParse near = parse_remap("M400 ngc=a modalgrup=10");
  ASSERT_EQ(near.warnings.size(), 1U);
  EXPECT_EQ(near.warnings[0], "unrecognized option 'modalgrup=10'; did you mean modalgroup=?");
  EXPECT_TRUE(near.remap);
  for (const char* text : {"M3 ngc=a", "G1 ngc=a", "M150 ngc=a"}) {
    const RemapParse p = parse_remap(text);
    EXPECT_FALSE(p.remap) << text;
    EXPECT_TRUE(p.error.empty()) << text;
    EXPECT_EQ(p.warnings.size(), 1U) << text;
  }
}

TEST_F(RemapTest, WordsBecomeLocalNames) {
  sub("m400",
      "(debug,p #<p> level #<_remap_level> #<_call_level>)\n"
      "o1 if [EXISTS[#<q>]]\n(debug,q #<q>)\no1 endif\n");
  rig({"M400 modalgroup=10 argspec=Pq ngc=m400"});
  EXPECT_EQ(run("M400 P123\n"), message("p 123.000000 level 1.000000 1.000000"));
  EXPECT_EQ(run("M400 P1 Q2 R3\n"),
            message("p 1.000000 level 1.000000 1.000000") + message("q 2.000000"));
  EXPECT_EQ(fails("M400\n"), "user-defined M400: missing: P");
  EXPECT_EQ(rig_->interp.error().line, 1);
  EXPECT_EQ(rig_->debug("#<p>"), "######");  // local to the body
}

TEST_F(RemapTest, PositionalWordsAndConditions) {
  sub("a", "(debug,#1 #2 #3)\n");
  rig({"M410 argspec=@PQr ngc=a", "M411 argspec=PQ^> ngc=a", "M412 argspec=^> ngc=a",
       "M413 argspec=n@ ngc=a"});
  EXPECT_EQ(run("#1=7\nM410 P10 Q20\n(debug,#1)\n"),
            message("10.000000 20.000000 0.000000") + message("7.000000"));
  EXPECT_EQ(fails("M410 P10\n"), "user-defined M410: missing: Q");
  EXPECT_EQ(fails("M411\n"), "user-defined M411: missing: P,QF>0,S>0,");
  EXPECT_EQ(fails("M412\n"), "user-defined M412:F>0,S>0,");
  EXPECT_EQ(fails("F1\nM412\n"), "user-defined M412:S>0,");
  EXPECT_EQ(fails("F1 S1\nM412\n"), "no error in " + rig_->run("F1 S1\nM412\nM2\n"));
}

TEST_F(RemapTest, LineNumberIsThatOfTheBlock) {
  sub("nn", "(debug,#<n>)\n");
  rig({"M412 argspec=n ngc=nn"});
  EXPECT_EQ(run("G90\nN55 M412\n"), message("2.000000"));
}

TEST_F(RemapTest, RunsInTheOrderOfExecution) {
  for (const char* name : {"a", "b", "f", "t"})
    sub(name, std::string("(debug,") + name + " feed #<_feed> rpm #<_rpm>)\n");
  rig({"M411 modalgroup=4 ngc=a", "M410 ngc=b", "F argspec=f ngc=f", "T ngc=t"});
  EXPECT_EQ(run("M411 F100 S200 T2 G0 X1 M410 (first)\n"),
            "COMMENT(\"first\")\n" + message("f feed 0.000000 rpm 0.000000") +
                "SET_SPINDLE_SPEED(0, 200.0000)\n" + message("t feed 0.000000 rpm 200.000000") +
                message("b feed 0.000000 rpm 200.000000") +
                "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n" +
                message("a feed 0.000000 rpm 200.000000"));
}

TEST_F(RemapTest, ModalGroupsOfNewCodes) {
  sub("a", "");
  rig({"M405 modalgroup=5 ngc=a", "M406 modalgroup=6 ngc=a", "M408 modalgroup=8 ngc=a",
       "M410 ngc=a", "M411 ngc=a", "G88.6 ngc=a", "G88.7 ngc=a"});
  for (const char* line : {"M405 M62 P1", "M406 M6", "M408 M8", "M410 M411", "M410 M101"})
    EXPECT_EQ(fails(std::string(line) + "\n"), "Two m codes used from same modal group") << line;
  for (const char* line : {"G88.6 G88.7", "G88.6 G1 X1"})
    EXPECT_EQ(fails(std::string(line) + "\n"), "Two g codes used from same modal group") << line;
  EXPECT_EQ(fails("G88.6 G92 X1\n"), "Cannot use two g codes that both use axis values");
  EXPECT_EQ(fails("M410 X1\n"), "Cannot use axis values without a g code that uses them");
  EXPECT_EQ(fails("M500\n"), "M-code greater than 199: M500");
}

TEST_F(RemapTest, BuiltInInsideItsOwnBody) {
  sub("change", "(debug,before)\nM6\n(debug,behind #<_remap_level>)\n");
  sub("speed", "S[#<s> * 2]\n");
  sub("feed", "F[#<f> * 2]\n");
  sub("tool", "T[#<t> + 1]\n");
  sub("stop", "(debug,stop)\nM1\n");
  rig({"M6 modalgroup=6 ngc=change", "S argspec=S ngc=speed", "F argspec=f ngc=feed",
       "T argspec=t ngc=tool", "M1 modalgroup=4 ngc=stop"});
  rig_->world.files.set_tool({5, 5, {}, 0, 0, 0, 0});
  EXPECT_EQ(run("F10 S100 T4\n"),
            "SET_FEED_RATE(20.0000)\nSET_SPINDLE_SPEED(0, 200.0000)\nSELECT_TOOL(5)\n");
  EXPECT_EQ(run("M6\nG0 X1\n"),
            message("before") + "STOP_SPINDLE_TURNING(0)\nCHANGE_TOOL()\n" +
                message("behind 1.000000") +
                "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(run("M1\n"), message("stop") + "OPTIONAL_PROGRAM_STOP()\n");
}

TEST_F(RemapTest, NestsTenDeepAndNoDeeper) {
  sub("outer", "M400\n");
  sub("inner", "(debug,#<_remap_level> #<_call_level>)\n");
  sub("self", "M402\n");
  rig({"M401 ngc=outer", "M400 ngc=inner", "M402 ngc=self"});
  EXPECT_EQ(run("M401\n"), message("2.000000 2.000000"));
  EXPECT_EQ(fails("M402\n"), "maximum nesting of remapped blocks exceeded");
  EXPECT_EQ(run("M401\n"), message("2.000000 2.000000"));
}

TEST_F(RemapTest, MotionCodesStayModalOnlyAsCycles) {
  sub("g", "(debug,x #<x> motion #<_motion_mode>)\nG0 X5\n");
  rig({"G88.6 argspec=x ngc=g"});
  EXPECT_EQ(run("G88.6 X1\nX3\n"),
            message("x 1.000000 motion 800.000000") +
                "STRAIGHT_TRAVERSE(5.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
                "STRAIGHT_TRAVERSE(3.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST_F(RemapTest, CycleGlueKeepsCodeAndWords) {
  sub("cyc",
      "(debug,x #<x> y #<y> z #<z> r #<r> l #<l>)\no1 if [EXISTS[#<p>]]\n(debug,p)\no1 endif\n");
  rig({"G84.3 argspec=xyzabcuvwprl prolog=cycle_prolog ngc=cyc epilog=cycle_epilog modalgroup=1"});
  EXPECT_EQ(run("F5\nG84.3 X1 Y2 Z3 R1\nX3 Y4 P2\nX6 Y7 L2\n(debug,#<_motion_mode>)\nG80\n"),
            "SET_FEED_RATE(5.0000)\n" +
                message("x 1.000000 y 2.000000 z 3.000000 r 1.000000 l 1.000000") +
                message("x 3.000000 y 4.000000 z 3.000000 r 1.000000 l 1.000000") + message("p") +
                message("x 6.000000 y 7.000000 z 3.000000 r 1.000000 l 2.000000") +
                message("843.000000") + "COMMENT(\"interpreter: motion mode set to none\")\n");
  EXPECT_EQ(fails("G84.3 X1 Y1 Z1\n"), "G84.3: R word missing");
  EXPECT_EQ(fails("F5\nG84.3 X1 Z1 R-1\n"), "G84.3: R must be greater than 0");
  EXPECT_EQ(fails("F5\nG84.3 X1 Z1 R1 A1\n"), "G84.3: ABC not allowed");
  EXPECT_EQ(fails("F5\nG84.3 X1 U1 R1\n"), "G84.3: can't combine UVW and XYZ");
  EXPECT_EQ(fails("F5\nG84.3 X1 R1 L0\n"), "G84.3: L must be a positive integer");
  EXPECT_EQ(fails("F5\nG84.3 X1 R1 P-1\n"), "G84.3: P must not be negative");
  EXPECT_EQ(fails("G93 F5\nG84.3 X1 R1\n"), "G84.3: cannot use inverse time feed with a cycle");
}

class GlueTest : public RemapTest {
 protected:
  void SetUp() override {
    RemapTest::SetUp();
    sub("prepare", "(debug,tool #<tool> pocket #<pocket>)\n", "[#<_ret>]");
    sub("change",
        "(debug,in #<tool_in_spindle> #<current_pocket> next #<selected_tool> "
        "#<selected_pocket>)\n",
        "[#<_ret>]");
    sub("settool", "(debug,tool #<tool> pocket #<pocket>)\n", "[#<_ret>]");
    sub("setspeed", "#<speed>=[#<speed> + 1]\n", "[#<_ret>]");
    sub("setfeed", "#<feed>=[#<feed> + 1]\n", "[#<_ret>]");
    rig({"T prolog=prepare_prolog ngc=prepare epilog=prepare_epilog",
         "M6 modalgroup=6 prolog=change_prolog ngc=change epilog=change_epilog",
         "M61 modalgroup=6 prolog=settool_prolog ngc=settool epilog=settool_epilog",
         "S prolog=setspeed_prolog ngc=setspeed epilog=setspeed_epilog",
         "F prolog=setfeed_prolog ngc=setfeed epilog=setfeed_epilog"});
    Pose z;
    z.z = 10;
    rig_->world.files.set_tool({1, 4, z, 0, 0, 0, 0});
    rig_->world.files.set_tool({2, 5, {}, 0, 0, 0, 0});
  }
};

TEST_F(GlueTest, ToolChangeWithoutPython) {
  EXPECT_EQ(run("#<_ret>=1\nT1 M6\nG43\n(debug,#5400 #<_selected_tool>)\nM61 Q2\n"),
            message("tool 1.000000 pocket 4.000000") + "SELECT_TOOL(1)\n" +
                message("in 0.000000 0.000000 next 1.000000 4.000000") + "CHANGE_TOOL()\n" +
                "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 10.0000, 0.0000 0.0000 0.0000, 0.0000 "
                "0.0000 0.0000)\n" +
                message("1.000000 -1.000000") + message("tool 2.000000 pocket 5.000000") +
                "CHANGE_TOOL_NUMBER(2)\n");
}

TEST_F(GlueTest, ReturnValueDecides) {
  const std::pair<const char*, const char*> rows[] = {
      {"#<_ret>=-2\nT1\n", "T1: aborted (return code -2.0)"},
      {"#<_ret>=0\nT1\n", "T1: aborted (return code 0.0)"},
      {"#<_ret>=-2\nM61 Q1\n", "M61 aborted (return code -2.0)"},
      {"#<_ret>=-2\nS5\n", "S: remap procedure returned -2.000000"},
      {"#<_ret>=-2\nF5\n", "F: remap procedure returned -2.000000"},
      {"#<_ret>=1\nT1\n#<_ret>=-1\nM6\n", "M6 aborted (return code -1.0)"},
      {"#<_ret>=1\nT9\n", "T9: pocket not found"},
      {"#<_ret>=1\nM61\n", "M61 requires a Q parameter"},
      {"#<_ret>=1\nM61 Q-1\n", "M61: Q value < 0"},
      {"#<_ret>=1\nM61 Q9\n", "M61 failed: requested tool 9 not in table"},
      {"#<_ret>=1\nS-5\n", "Negative spindle speed used"},
  };
  for (const auto& [program, error] : rows) EXPECT_EQ(fails(program), error) << program;
  EXPECT_EQ(
      run("#<_ret>=1\nS100 F20\n(debug,#<_rpm> #<_feed>)\n"),
      "SET_FEED_RATE(21.0000)\nSET_SPINDLE_SPEED(0, 101.0000)\n" + message("101.000000 21.000000"));
}

TEST_F(GlueTest, M6NeedsAToolAndNoCompensation) {
  EXPECT_EQ(fails("#<_ret>=1\nM6\n"), "M6: no tool prepared");
}

TEST_F(RemapTest, BodyThatUsesTheBuiltInNeedsNoEpilog) {
  sub("change", "M6\n", "[1]");
  sub("prepare", "T#<tool>\n", "[1]");
  rig({"T prolog=prepare_prolog ngc=prepare epilog=prepare_epilog",
       "M6 modalgroup=6 prolog=change_prolog ngc=change epilog=change_epilog"});
  rig_->world.files.set_tool({1, 4, {}, 0, 0, 0, 0});
  EXPECT_EQ(run("T1 M6\n"), "SELECT_TOOL(1)\nSTOP_SPINDLE_TURNING(0)\nCHANGE_TOOL()\n");
}

TEST_F(RemapTest, LatheToolsWithWear) {
  rig({"T python=index_lathe_tool_with_wear", "M6 python=ignore_m6"});
  Pose offset, wear;
  offset.z = 2;
  wear.z = 0.5;
  rig_->world.files.set_tool({2, 2, offset, 0, 0, 0, 0});
  rig_->world.files.set_tool({10001, 3, wear, 0, 0, 0, 0});
  EXPECT_EQ(run("T201 M6 G0 X1\n"),
            "CHANGE_TOOL_NUMBER(2)\n"
            "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 2.5000, 0.0000 0.0000 0.0000, 0.0000 0.0000 "
            "0.0000)\nSTRAIGHT_TRAVERSE(1.0000, 0.0000, -2.5000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(fails("T301\n"), "T301: requested tool 3 not found in the tool table");
}

TEST_F(RemapTest, TheRestOfTheBlockFollowsAWaitInTheBody) {
  sub("probe", "M66 P0 L0\n(debug,#5399)\n");
  rig({"M400 ngc=probe"});
  const std::string out = rig_->mdi("M400 G0 X1 M0", {.input_value = 1});
  EXPECT_EQ(out, message("1.000000") +
                     "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
                     "PROGRAM_STOP()\n");
  EXPECT_EQ(rig_->interp.call_level(), 0);
}

TEST_F(RemapTest, AWaitBeforeTheRemapIsDoneFirst) {
  sub("a", "(debug,#5399)\n");
  rig({"M400 ngc=a"});
  EXPECT_EQ(rig_->mdi("M66 P0 L0 M400", {.input_value = 1}), message("1.000000"));
}

TEST_F(RemapTest, ABlockInErrorBeforeItsRemapDoesNothing) {
  sub("a", "(debug,a)\n");
  rig({"M400 argspec=P ngc=a", "M401 ngc=nofile"});
  EXPECT_EQ(rig_->mdi("F100 S5 M400"), "error: user-defined M400: missing: P");
  EXPECT_EQ(rig_->debug("#<_feed>"), "0.000000");
  EXPECT_EQ(rig_->mdi("F100 M401"), "error: INTERP_REMAP: NGC file not found: ngc=nofile");
  EXPECT_EQ(rig_->debug("#<_feed>"), "0.000000");
}

TEST_F(RemapTest, AnErrorInTheBodyEndsIt) {
  sub("bad", "G0 X1\nG1 X2\n");
  rig({"M400 ngc=bad"});
  EXPECT_EQ(fails("M400 G0 Y1\n"), "Cannot do g1 with zero feed rate");
  EXPECT_EQ(rig_->interp.error().line, 3);
  rig_->interp.abort();
  EXPECT_EQ(rig_->interp.call_level(), 0);
  EXPECT_EQ(rig_->mdi("G0 Y2"),
            "STRAIGHT_TRAVERSE(1.0000, 2.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST_F(RemapTest, MdiDoesNotDisturbAProgramInARemap) {
  sub("a", "(debug,one)\n(debug,two)\n");
  rig({"M400 ngc=a"});
  ASSERT_TRUE(rig_->interp.open_text("t.ngc", "M400 G0 X1\nM2\n").ok());
  for (int i = 0; i < 2; ++i) EXPECT_EQ(rig_->interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig_->calls(), message("one"));
  EXPECT_EQ(rig_->mdi("M400"), message("one") + message("two"));
  std::string rest;
  while (rig_->interp.execute_next() == Outcome::ok) {
  }
  EXPECT_EQ(rig_->calls().substr(0, 15 + 18), message("two") + "STRAIGHT_TRAVERSE(");
}

}  // namespace
}  // namespace kerf::interp
