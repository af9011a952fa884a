// A dialect is rows of data: this one has statements without O-words, bare names, a function of its own, numbers that hold texts and
// codes that take a text. Nothing of it is in the interpreter.
#include <gtest/gtest.h>

#include <cmath>

#include "interp/codes/families.hpp"
#include "interp/source.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

constexpr StatementRow kStatements[] = {
    {"while", Flow::while_loop, true, "do"},
    {"end", Flow::endwhile, false, ""},
};
constexpr ExternalFunction kFunctions[] = {
    {"prm",
     [](Core& core, double& value) {
       if (value < 0) return core.fail(0, "", "No such setting");
       value = value * 10;
       return true;
     }},
};
constexpr std::int16_t kTextCodes[] = {130};
constexpr CodeRow kOwn[] = {
    {'m', 130, 130, 10, kOrderUser,
     [](Core& core, const Block& b, int) {
       core.out.call<&Canon::message>(core.out.keep(b.quoted));
       return true;
     },
     letters("l"), AxisUse::none},
};

class ShopDialect : public ::testing::Test {
 protected:
  static const Dialect& shop() {
    static const std::vector<std::span<const CodeRow>> families = [] {
      const auto base = linuxcnc_dialect().families;
      std::vector<std::span<const CodeRow>> all(base.begin(), base.end());
      all.emplace_back(kOwn);
      return all;
    }();
    static const Dialect dialect = [] {
      Dialect d = linuxcnc_dialect();
      d.name = "shop";
      d.families = families;
      d.statements = kStatements;
      d.functions = kFunctions;
      d.bare_names = d.quotes = true;
      d.first_text = 300;
      d.last_text = 399;
      d.text_codes = kTextCodes;
      return d;
    }();
    return dialect;
  }

  /// The calls, and "error: TEXT" at the end.
  static std::string run(const std::string& program) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* out = open_memstream(&text, &size);
    std::string end;
    {
      TextCanon canon(out);
      Environment world;
      Core core(world, canon, {}, shop());
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
  EXPECT_EQ(run("WHILE [1] 2\n"), "error: 'do' expected");
  EXPECT_EQ(run("WHILE [1] DO\n"), "error: Bad format unsigned integer");
  EXPECT_EQ(run("WHILE [0] DO3\nM2\n"),
            "error: File ended with no percent sign (%) or program end (M2)");
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

TEST(LinuxcncDialect, HasNoneOfThis) {
  Rig rig;
  EXPECT_EQ(rig.mdi("WHILE [1] DO1"), "error: Unknown word where unary operation could be");
  EXPECT_EQ(rig.mdi("#300=\"x\""), "error: bad number format (conversion failed) parsing '\"'");
  EXPECT_EQ(rig.mdi("#1=_x"), "error: bad number format (conversion failed) parsing '_'");
}

}  // namespace
}  // namespace kerf::interp
