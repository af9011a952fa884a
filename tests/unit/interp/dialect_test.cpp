// A dialect is rows of data (shop_dialect.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "interp/null_canon.hpp"
#include "interp/source.hpp"
#include "rig.hpp"
#include "shop_dialect.hpp"

namespace kerf::interp {
namespace {

class ShopDialect : public ::testing::Test {
 protected:
  /// The calls, and "error: TEXT" at the end.
  static std::string run(const std::string& program) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* out = open_memstream(&text, &size);
    std::string end;
    {
      TextCanon canon(out);
      Environment world;
      Core core(world, canon, {}, shop_dialect());
      core.init();
      std::fflush(out);
      const std::size_t before = size;
      core.open_main("p.ngc", make_text_source(program));
      Outcome o = Outcome::ok;
      for (int i = 0; i < 1000 && o == Outcome::ok; ++i) o = core.execute_next();
      std::fflush(out);
      std::string calls(text + before, size - before);
      for (std::size_t at = 0; (at = calls.find(" N..... ", at)) != std::string::npos;) {
        const std::size_t line = calls.rfind('\n', at) + 1;
        calls.erase(line == 0 && at < 8 ? 0 : line, at + 8 - line);
        at = calls.find('\n', line);
      }
      end = calls + (o == Outcome::error ? "error: " + core.error.text : "");
      last_column = core.error.column;
    }
    std::fclose(out);
    std::free(text);
    return end;
  }
  static inline int last_column = 0;
};

TEST_F(ShopDialect, LoopsWithoutOWordsNestAndTheirNumbersComeAgain) {
  EXPECT_EQ(
      run("#1=0\nWHILE [#1 LT 2] DO1\n#2=0\nN5 while[#2 lt 2]do2\n(debug,%d#1 #2)\n#2=[#2+1]\n"
          "END2 (inner)\n#1=[#1+1]\nEND1\nWHILE [0] DO1\n(debug,never)\nEND1\n(abort,done)\n"),
      "MESSAGE(\"0 0\")\nMESSAGE(\"0 1\")\nMESSAGE(\"1 0\")\nMESSAGE(\"1 1\")\nerror: done");
}

TEST_F(ShopDialect, StatementsSayWhatIsMissing) {
  EXPECT_EQ(run("WHILE [1] 2\n"), "error: 'do' or the end of the line expected");
  EXPECT_EQ(run("GOTO X\n"), "error: Bad format unsigned integer");
  EXPECT_EQ(run("GOTO 7 G0 X1\n"), "error: Unexpected character after statement");
  EXPECT_EQ(run("WHILE [1] DO\n"), "error: Bad format unsigned integer");
  EXPECT_EQ(run("WHILE [0] DO3\nM2\n"),
            "error: File ended with no percent sign (%) or program end (M2)");
}

TEST_F(ShopDialect, BlocksWithoutNumbersBelongTogetherByTheirNesting) {
  const char* const program =
      "#1=0\nWHILE [#1 LT 4]\n#1=[#1+1]\nIF [#1 EQ 1]\n(debug,%d#1 one)\n"
      "ELSEIF [#1 EQ 2]\nIF [0]\n(debug,never)\nELSE\n(debug,two)\nENDIF\n"
      "ELSE (others)\nIF [#1 EQ 4]\n(debug,four)\nENDIF\n(debug,other)\nENDIF\nENDWHILE\n"
      "WHILE [0]\nWHILE [1]\nENDWHILE\nENDWHILE\n(abort,end)\n";
  EXPECT_EQ(run(program),
            "MESSAGE(\"1 one\")\nMESSAGE(\"two\")\nMESSAGE(\"other\")\nMESSAGE(\"four\")\n"
            "MESSAGE(\"other\")\nerror: end");
  // A sub's blocks are its own, and a return leaves them.
  EXPECT_EQ(run("o1 sub\nIF [#1 GT 0]\no1 return [#1]\nENDIF\no1 endsub [9]\nIF [1]\no1 call [3]\n"
                "#2=#<_value>\no1 call [0]\n(debug,%d#2 #<_value>)\nENDIF\n(abort,end)\n"),
            "MESSAGE(\"3 9\")\nerror: end");
  for (const char* const wrong : {"ENDIF\n", "ELSE\n", "ENDWHILE\n", "WHILE [1]\nENDIF\n"})
    EXPECT_EQ(run(wrong), "error: A statement ends here that did not begin") << wrong;
  EXPECT_EQ(run("IF [0]\nIF [1]\nENDIF\nM2\n"),
            "error: File ended with no percent sign (%) or program end (M2)");
}

TEST_F(ShopDialect, GotoLeadsToLinesWithNumbers) {
  EXPECT_EQ(run("#1=0\nN10 #1=[#1+1]\n(debug,%d#1)\nIF [#1 LT 3] GOTO 10\nGOTO [10*2]\n(debug,no)\n"
                "N20 (abort,end)\n"),
            "MESSAGE(\"1\")\nMESSAGE(\"2\")\nMESSAGE(\"3\")\nerror: end");
  // Out of blocks, forward and back; the blocks that it stays inside of go on.
  EXPECT_EQ(run("#1=0\n#2=0\nWHILE [#2 LT 2]\n#2=[#2+1]\nN5 #1=[#1+1]\nIF [#1 LT 3]\nIF [1]\n"
                "GOTO 5\nENDIF\nENDIF\nWHILE [1] DO1\nIF [1] THEN GOTO 7\nEND1\nN7\n"
                "(debug,%d#1 #2)\nENDWHILE\n(abort,end)\n"),
            "MESSAGE(\"3 1\")\nMESSAGE(\"4 2\")\nerror: end");
  EXPECT_EQ(run("WHILE [1]\nIF [1]\nGOTO 8\nENDIF\nENDWHILE\nN8 ENDWHILE\n"),
            "error: A statement ends here that did not begin");
  EXPECT_EQ(
      run("G0 X1\nGOTO 9\nM2\n"),
      "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\nerror: No line N9 to "
      "go to");
}

TEST_F(ShopDialect, AJumpBackCostsNoSearchEachTime) {
  // Twenty thousand lines before the target, and as many rounds.
  std::string program = "#1=0\n";
  for (int i = 0; i < 20000; ++i) program += "(a line)\n";
  program += "N10 #1=[#1+1]\nIF [#1 LT 20000] GOTO 10\n(abort,%d#1)\n";
  Environment world;
  NullCanon canon;
  Core core(world, canon, {}, shop_dialect());
  core.init();
  core.open_main("p.ngc", make_text_source(program));
  int steps = 0;
  Outcome o = Outcome::ok;
  for (; o == Outcome::ok; ++steps) o = core.execute_next();
  EXPECT_EQ(core.error.text, "20000");
  EXPECT_LT(steps, 20000 + 2 * 20000 + 200);
}

TEST_F(ShopDialect, OneLineMayHoldBothBranches) {
  EXPECT_EQ(
      run("#1=1\nIF [#1 EQ 1] THEN #2=5 #3=6 ELSE #2=7\nIF [#1 EQ 2] THEN #4=1 ELSE #4=2\n"
          "IF [0] THEN G0 X1\nIF [1] THEN G0 X2 ELSE G0 X3\n(debug,%d#2 #3 #4)\n(abort,end)\n"),
      "STRAIGHT_TRAVERSE(2.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "MESSAGE(\"5 6 2\")\nerror: end");
  EXPECT_EQ(run("IF [0] THEN G0 X1 ELSE G0 X#<no>\n"), "error: Named parameter #<no> not defined");
  EXPECT_EQ(last_column, 28);
  // In a loop, where lines are kept.
  EXPECT_EQ(run("#1=0\nWHILE [#1 LT 3]\n#1=[#1+1]\nIF [#1 EQ 2] THEN #2=#1 ELSE #3=#1\nENDWHILE\n"
                "(debug,%d#2 #3)\n(abort,end)\n"),
            "MESSAGE(\"2 3\")\nerror: end");
}

TEST_F(ShopDialect, BareNamesAndFunctionsAreOperands) {
  EXPECT_EQ(run("#<_speed>=7\n#1=[_speed*2] #2=_speed #3=PRM[1+1] #4=[prm[3]+1]\n"
                "(debug,%d#1 #2 #3 #4)\n#5=prm[-1]\n"),
            "MESSAGE(\"14 7 20 31\")\nerror: No such setting");
  EXPECT_EQ(run("#1=_nobody\n"), "error: Named parameter #<_nobody> not defined");
}

TEST_F(ShopDialect, NumbersHoldTexts) {
  EXPECT_EQ(run("#300=\"Ab (c) ; d\" #1=5\n(debug,%d#300 and #1)\n#300=8\n(debug,%d#300)\n"
                "#301=\"x\"\n#302=#301\n(debug,%d#302 #301)\n#100=\"no\"\n"),
            "MESSAGE(\"Ab (c) ; d and 5\")\nMESSAGE(\"8\")\nMESSAGE(\"0 x\")\n"
            "error: Parameter #100 cannot hold a text");
  EXPECT_EQ(run("#300=\"a\"\n#300=\"b\" G0 X1 Q1\n"),
            "error: Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M67, M68 or user M "
            "code that uses it");
  EXPECT_EQ(run("#300=\"a\n"), "error: Unclosed quotation found");
}

TEST_F(ShopDialect, CodesTakeATextInQuotes) {
  EXPECT_EQ(run("M130 \"my Command.bat\" L1\n(abort,end)\n"),
            "MESSAGE(\"my Command.bat\")\nerror: end");
  EXPECT_EQ(run("M8 \"x\"\n"), "error: Bad character '\"' used");
}

TEST(LinuxcncDialect, IsChosenByItsName) {
  EXPECT_EQ(dialect_names()[0], "linuxcnc");
  for (const std::string_view name : dialect_names()) EXPECT_EQ(dialect_of(name).name, name);
}

TEST(LinuxcncDialect, HasNoneOfThis) {
  Rig rig;
  EXPECT_EQ(rig.mdi("GOTO 10"), "error: Unknown word where unary operation could be");
  EXPECT_EQ(rig.mdi("IF [1] THEN #1=2"), "error: Unknown word starting with f");
  EXPECT_EQ(rig.mdi("WHILE [1] DO1"), "error: Unknown word where unary operation could be");
  EXPECT_EQ(rig.mdi("#300=\"x\""), "error: bad number format (conversion failed) parsing '\"'");
  EXPECT_EQ(rig.mdi("#1=_x"), "error: bad number format (conversion failed) parsing '_'");
}

}  // namespace
}  // namespace kerf::interp
