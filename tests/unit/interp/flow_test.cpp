#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "rig.hpp"

namespace kerf::interp {
namespace {

/// The messages that a program prints, joined by blanks.
std::string messages(Rig& rig, const std::string& program) {
  const std::string all = rig.run(program + "\n(abort,end)\n");
  std::string out;
  for (std::size_t at = 0; (at = all.find("MESSAGE(\"", at)) != std::string::npos;) {
    at += 9;
    const std::size_t end = all.find('"', at);
    if (!out.empty()) out.push_back(' ');
    out.append(all, at, end - at);
    at = end;
  }
  const std::size_t error = all.find("error: ");
  if (error != std::string::npos && all.substr(error) != "error: end")
    out += "|" + all.substr(error);
  return out;
}

TEST(Flow, IfElseifElse) {
  for (const int i : {1, 2, 3}) {
    Rig rig;
    EXPECT_EQ(messages(rig, "#1=" + std::to_string(i) +
                                "\no1 if [#1 eq 1]\n(debug,a)\no1 elseif [#1 eq 2]\n(debug,b)\no1 "
                                "else\n(debug,c)\no1 endif\n(debug,e)"),
              std::string(1, static_cast<char>('a' + i - 1)) + " e");
  }
}

TEST(Flow, WhileBreakContinue) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "#1=0\no1 while [#1 lt 9]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 endif\n"
                     "o3 if [#1 eq 4]\no1 break\no3 endif\n(debug,%d#1)\no1 endwhile\n(debug,end)"),
            "1 3 end");
}

TEST(Flow, DoRunsAtLeastOnceAndContinueGoesToItsWhile) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "#1=5\no1 do\n#1=[#1+1]\no2 if [#1 eq 6]\no1 continue\no2 "
                     "endif\n(debug,%d#1)\no1 while [#1 lt 8]\n(debug,end)"),
            "7 8 end");
}

TEST(Flow, RepeatNestsAndZeroSkips) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o1 repeat [2]\no2 repeat [2]\n(debug,x)\no2 endrepeat\n(debug,y)\no1 "
                     "endrepeat\no3 repeat [0]\n(debug,z)\no3 endrepeat"),
            "x x y x x y");
}

TEST(Flow, BreakOutOfTwoLoops) {
  Rig rig;
  EXPECT_EQ(
      messages(rig, "o1 while [1]\no2 while [1]\no1 break\no2 endwhile\no1 endwhile\n(debug,out)"),
      "out");
}

TEST(Flow, SubsHaveArgumentsLocalsAndAValue) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o<add> sub\n#<s>=[#1+#2]\n#<_g>=7\no<add> return "
                     "[#<s>]\n(debug,never)\no<add> endsub\n#1=99 #<s>=5\n"
                     "o<add> call [3] [4]\n(debug,%d#<_value> #<_value_returned> #1 #<s> "
                     "#<_g>)\no<add> call\n(debug,%d#<_value>)"),
            "7 1 99 5 7 0");
}

TEST(Flow, SubsAfterTheCallAndComputedNumbers) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "#1=100\no[#1+1] call [5]\n(debug,back)\n(abort,end)\no101 "
                     "sub\n(debug,%d#1)\no101 endsub"),
            "5 back");
}

TEST(Flow, LocalLabelsMayRepeatInSubs) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o9 sub\no1 repeat [2]\n(debug,s)\no1 endrepeat\no9 endsub\no1 repeat [2]\no9 "
                     "call\no1 endrepeat"),
            "s s s s");
}

TEST(Flow, ReturnInsideALoopLeavesBoth) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o9 sub\no1 while [1]\no2 if [1]\no9 return [1]\no2 endif\no1 endwhile\no9 "
                     "endsub\no9 call\no9 call\n(debug,%d#<_call_level>)"),
            "0");
}

TEST(Flow, RecursionEndsAtTenLevels) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o9 sub\no1 if [#1 gt 0]\no9 call [#1-1]\no1 endif\no9 endsub\no9 call "
                     "[9]\n(debug,fine)\no9 call [50]"),
            "fine|error: Too many subroutine levels");
}

TEST(Flow, ErrorsNameLabelAndLine) {
  struct Wrong {
    const char* program;
    const char* text;
  };
  const Wrong cases[] = {
      {"\n\no2 call", "EOF in file:test.ngc seeking o-word: o<2> from line: 3"},
      {"o<x> call", "EOF in file:test.ngc seeking o-word: o<x> from line: 1"},
      {"o1 if [0]", "File ended with no percent sign (%) or program end (M2)"},
      {"o1 sub\no2 sub\no2 endsub\no1 endsub\no1 call", "Nested subroutine definition"},
      {"o1 repeat [3]\no1 break\no1 endrepeat",
       "2: no matching while/do label: 'o1 break' (found 'repeat' in line 1)"},
      {"o1 if [1]\nN5 O1 endWhile (x)\no1 endif",
       "2: no matching label: 'N5 O1 endWhile (x)' (found 'if' in line 1)"},
      {"o1 repeat [1]\no1 else\no1 endrepeat",
       "2: no matching 'if' label: 'o1 else' (found 'repeat' in line 1)"},
      {"o1 endif", "1: undefined O-word label: 'o1 endif'"},
      {"o1 elseif [1]", "1: undefined O-word label: 'o1 elseif [1]'"},
      {"o1 if [1]\no1 endif\no1 if [0]\no1 endif",
       "3: duplicate O-word label - already defined in line 1: 'o1 if [0]'"},
      {"o1 while [0]\no1 endwhile\no1 repeat [2]\no1 endrepeat",
       "3: duplicate O-word label: 'o1 repeat [2]' - defined in line 1"},
      {"o<x> sub\no<x> endsub\no<x> sub\no<x> endsub",
       "File:test.ngc line:3 redefining sub: o|x| already defined in file:test.ngc"},
      {"o1.5 sub", "Non integer value for integer"},
      {"o1 return [3]", "1: not in a subroutine definition: 'o1 return [3]'"},
      {"o1 call [1", "Unclosed expression"},
      {"o1 call [1] G0", "Unexpected character after O-word"},
      {"o1 if", "Left bracket missing after 'if'"},
      {"o1 while [1/0]", "Attempt to divide by zero"},
  };
  for (const Wrong& c : cases) {
    Rig rig;
    const std::string out = rig.run(std::string(c.program) + "\n");
    EXPECT_EQ(out.substr(out.find("error: ")), std::string("error: ") + c.text) << c.program;
  }
}

TEST(Flow, ALabelIsOneBlockInEachSubAndADoMayComeAgain) {
  Rig rig;
  EXPECT_EQ(
      messages(rig,
               "o9 sub\no1 if [1]\n(debug,a)\no1 endif\no9 endsub\no1 repeat [1]\no9 call\n"
               "o1 endrepeat\no2 do\n(debug,b)\no2 while [0]\no2 do\n(debug,c)\no2 while [0]"),
      "a b c");
}

TEST(Flow, CommentsBesideOWordsDoNothing) {
  Rig rig;
  EXPECT_EQ(messages(rig, "o1 if [1] (debug,a)\n(debug,b)\no1 endif ;debug,c"), "b");
}

TEST(Flow, RepeatRoundsItsCount) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "o1 repeat [1.6]\n(debug,a)\no1 endrepeat\no2 repeat [1.4]\n(debug,b)\no2 "
                     "endrepeat\no3 repeat [-2]\n(debug,c)\no3 endrepeat"),
            "a a b");
}

TEST(Flow, WarningsInsteadOfErrorsWhenTheIniSaysSo) {
  Settings settings;
  settings.oword_warnonly = true;
  Rig rig(settings);
  EXPECT_EQ(
      messages(rig, "o1 endif\n(debug,a)\no2 if [1]\no2 endif\no2 if [1]\n(debug,b)\no2 endif"),
      "a b");
  ASSERT_EQ(rig.world.warnings.size(), 2U);
  EXPECT_EQ(rig.world.warnings[0], "1: undefined O-word label: 'o1 endif'");
  EXPECT_EQ(rig.world.warnings[1],
            "5: duplicate O-word label - already defined in line 3: 'o2 if [1]'");
}

TEST(Flow, SubsMayKnowTheNumberOfTheirArguments) {
  Settings settings;
  settings.oword_nargs = true;
  Rig rig(settings);
  EXPECT_EQ(messages(rig, "o1 sub\n(debug,%d#<n_args>)\no1 endsub\no1 call\no1 call [5] [6] [7]"),
            "0 3");
}

// Manual: "Fanuc-Style Numbered Programs"; its own example, shortened.
TEST(Numbered, ProgramsAreCalledByM98WithGlobalParameters) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "O1 (title)\n#1=0\nM98 P100 L2\n(debug,main %d#1)\n(abort,end)\n"
                     "O100\n#1=[#1+1]\nM98 P200 L3\n(debug,%.1f#1)\nM99\n"
                     "O200 (x)\n#1=[#1+0.1]\nM99 (back)"),
            "1.3 2.6 main 3");
}

TEST(Numbered, ErrorsNameWhatIsMixed) {
  struct Wrong {
    const char* program;
    const char* text;
  };
  const Wrong cases[] = {
      {"M98", "Found 'm98' code with no P-word"},
      {"M98 P7\nM2", "EOF in file:test.ngc seeking o-word: o<7> from line: 1"},
      {"o1 if [0]\nO7\nM99\no1 endif\nM98 P7\nM2",
       "EOF in file:test.ngc seeking o-word: o<7> from line: 5"},
      {"M98 P7 L-1", "Negative l word used"},
      {"M98 P7.5", "Non integer value for integer"},
      {"M98 P7 M3 S100", "Unexpected character after O-word"},
      {"G0 X1 M98 P7", "Unknown m code used: M98"},
      {"o7 call\nM2\nO7\nM99", "Fanuc 'O....' subroutine must be called with 'M98'"},
      {"M98 P7\nM2\no7 sub\no7 endsub", "'O.... sub' subroutine must be called with 'O.... call'"},
      {"M98 P7\nM2\nO7\no7 return", "Fanuc 'O....' subroutine definition must end with 'M99'"},
      {"o7 sub\nM99\no7 endsub\no7 call",
       "'O.... endsub' or 'O.... return' must follow 'O.... sub' subroutine definition"},
  };
  for (const Wrong& c : cases) {
    Rig rig;
    const std::string out = rig.run(std::string(c.program) + "\n");
    const std::size_t at = out.find("error: ");
    EXPECT_EQ(at == std::string::npos ? out : out.substr(at), std::string("error: ") + c.text)
        << c.program;
  }
  Settings settings;
  settings.disable_fanuc_style_sub = true;
  Rig rig(settings);
  EXPECT_EQ(rig.run("M98 P1\n"), "error: DISABLE_FANUC_STYLE_SUB set in INI file, but found m98");
  EXPECT_EQ(rig.run("O1\n"),
            "error: DISABLE_FANUC_STYLE_SUB disabled in INI file, but found bare O-word");
}

TEST(Numbered, M99BeginsTheMainProgramAnewOnTheMachineAndEndsItElsewhere) {
  const std::string program =
      "%\n#1=[#1+1]\n(debug,%d#1)\no1 if [#1 eq 3]\n(abort,out)\no1 endif\nM99\n%\n";
  Settings settings;
  settings.is_task = true;
  Rig machine(settings);
  EXPECT_EQ(machine.run(program), "MESSAGE(\"1\")\nMESSAGE(\"2\")\nMESSAGE(\"3\")\nerror: out");
  Rig listing;
  const std::string out = listing.run(program);
  EXPECT_EQ(out.substr(0, 13), "MESSAGE(\"1\")\n") << out;
  EXPECT_NE(out.find("PROGRAM_END()"), std::string::npos);
}

TEST(Numbered, EachRunHasItsOwnNamesAndGivesModesBack) {
  Rig rig;
  EXPECT_EQ(messages(rig,
                     "M98 P5 L2\n(debug,%d#<_absolute>)\n(abort,end)\nO5\nM73\nG91\n"
                     "o1 if [exists[#<a>]]\n(debug,left)\no1 endif\n#<a>=1\n(debug,run)\nM99"),
            "run run 1");
}

TEST(Flow, FilesOfSubsAreFoundAndComeFirst) {
  const auto dir =
      std::filesystem::temp_directory_path() / ("kerf_interp_" + std::to_string(::getpid()));
  std::filesystem::create_directories(dir);
  const auto write = [&](const char* name, const char* text) {
    std::FILE* f = std::fopen((dir / name).c_str(), "w");
    std::fputs(text, f);
    std::fclose(f);
  };
  write("ext.ngc",
        "o<helper> sub\n(debug,helper %d#1)\no<helper> endsub\no<ext> sub\n(debug,ext "
        "%d#1)\no<helper> call [9]\no<ext> endsub [8]\nM2\n");
  {
    Rig rig;
    rig.world.files.add_directory(dir.string());
    EXPECT_EQ(messages(rig, "o<ext> call [3]\n(debug,%d#<_value>)"), "ext 3 helper 9 8");
    EXPECT_EQ(rig.mdi("o<ext> call [4]"), "MESSAGE(\"ext 4\")\nMESSAGE(\"helper 9\")\n");
    // An edited file is read anew by the next MDI line.
    write("ext.ngc", "o<ext> sub\n(debug,new)\no<ext> endsub\n");
    EXPECT_EQ(rig.mdi("o<ext> call [4]"), "MESSAGE(\"new\")\n");
    write("empty.ngc", "M2\n");
    EXPECT_EQ(rig.mdi("o<empty> call"), "error: EOF in file:" + (dir / "empty.ngc").string() +
                                            " seeking o-word: o<empty> from line: 1");
  }
  std::filesystem::remove_all(dir);
}

TEST(Flow, LongSkipsAreCutIntoSteps) {
  std::string program = "o1 if [0]\n";
  for (int i = 0; i < 50000; ++i) program += "G0 X1\n";
  program += "o1 endif\nM2\n";
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("long.ngc", program).ok());
  int steps = 0;
  Outcome o = Outcome::ok;
  while (o == Outcome::ok) o = rig.interp.execute_next(), ++steps;
  EXPECT_EQ(o, Outcome::program_end);
  EXPECT_GT(steps, 10);
  EXPECT_LT(steps, 1000);
}

TEST(Flow, AnEndlessLoopIsLeftByNotCalling) {
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("loop.ngc", "o1 while [1]\n#1=[#1+1]\no1 endwhile\n").ok());
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  rig.interp.abort();
  EXPECT_GT(rig.interp.parameters().get(1), 300);
  EXPECT_EQ(rig.interp.next_line(), 1);
}

TEST(Mdi, LeavesTheOpenProgramWhereItIs) {
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("p.ngc", "G0 X1\nG0 X2\nM2\n").ok());
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.mdi("G0 Y5").substr(0, 8), "STRAIGHT");
  EXPECT_EQ(rig.interp.next_line(), 2);
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.x, 2);
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.y, 5);
}

TEST(Mdi, DoesNotSpoilTheFirstPercentOfTheOpenProgram) {
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("p.ngc", "%\nG0 X1\n%\n").ok());
  (void)rig.mdi("G0 Y5");
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.mdi("%").substr(66), "error: Bad character '%' used");
  EXPECT_EQ(rig.interp.execute_next(), Outcome::program_end);
}

TEST(Mdi, EmptyLinesDoNothing) {
  Rig rig;
  EXPECT_EQ(rig.mdi(""), "");
  EXPECT_EQ(rig.mdi("   ; x"), "");
  EXPECT_FALSE(rig.interp.mdi_active());
}

TEST(Program, NeedsAnEnd) {
  Rig rig;
  EXPECT_EQ(rig.run("G0 X1\n").substr(66),
            "error: File ended with no percent sign (%) or program end (M2)");
  EXPECT_EQ(rig.run("%\n").substr(0, 46), "error: File ended with no percent sign (%)");
  EXPECT_EQ(rig.run("\n%\nM8\n%\nM9\n"), "FLOOD_ON()\nFINISH()\n");
  EXPECT_EQ(rig.run("M8\n%\n"), "FLOOD_ON()\nerror: Bad character '%' used");
  (void)rig.run("M2");
  EXPECT_EQ(rig.run("M2"), rig.run("M2\n"))
      << "the last line needs no line end, and a program runs again from the top";
}

TEST(Program, ErrorsLetTheNextLineRun) {
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("p.ngc", "G1 X1\nG0 X2\nM2\n").ok());
  EXPECT_EQ(rig.interp.execute_next(), Outcome::error);
  EXPECT_EQ(rig.interp.error().message(),
            "p.ngc:1: Cannot do g1 with zero feed rate\nWrite F with a feed, here or before");
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.interp.execute_next(), Outcome::program_end);
}

}  // namespace
}  // namespace kerf::interp
