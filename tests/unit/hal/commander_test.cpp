#include "hal/cmd/commander.hpp"

#include <cstdlib>

#include "ini/ini_file.hpp"
#include "unit/hal/fixture.hpp"

namespace kerf::hal::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::optional<std::string> ini(std::string_view section, std::string_view key) {
  if (section == "SEC" && key == "KEY") return "value";
  if (section == "SEC" && key == "MULTI") return "two words";
  return std::nullopt;
}

std::string sub(const char* text) {
  auto r = substitute(text, ini);
  return r.ok() ? *r : "error: " + r.error().message();
}

TEST(Words, Substitute) {
  ::setenv("KERF_TEST_VAR", "env", 1);
  ::setenv("KERF_TEST.V-2", "dotted", 1);
  EXPECT_EQ(sub("[SEC]KEY"), "value");
  EXPECT_EQ(sub("a=[SEC]KEY,1"), "a=value,1");
  EXPECT_EQ(sub("[SEC]KEY[SEC]KEY$KERF_TEST_VAR"), "valuevalueenv");
  EXPECT_EQ(sub("[SEC](KEY)x"), "valuex");
  EXPECT_EQ(sub("$KERF_TEST_VAR/x $(KERF_TEST_VAR)x"), "env/x envx");
  EXPECT_EQ(sub("\"$KERF_TEST_VAR x\" '[SEC]KEY'"), "\"env x\" 'value'");
  EXPECT_EQ(sub("\\$KERF_TEST_VAR"), "\\env");
  // A name may have dots and dashes, so these are other variables.
  EXPECT_EQ(sub("$KERF_TEST.V-2"), "dotted");
  EXPECT_EQ(sub("[SEC]KEY.1"), "error: Ini variable '[SEC]KEY.1' not found.");
  EXPECT_EQ(sub("joint.[0-3].pos"), "error: Ini variable '[0-3].pos' not found.");
  EXPECT_EQ(sub("[SEC]NONE"), "error: Ini variable '[SEC]NONE' not found.");
  EXPECT_EQ(sub("$KERF_NO_SUCH"), "error: Environment variable 'KERF_NO_SUCH' not found.");
  for (const char* text : {"$", "a$ b", "$()", "${X}", "[SEC]", "[SEC] KEY", "[SEC]()"})
    EXPECT_EQ(sub(text), "error: Empty variable name.") << text;
  EXPECT_EQ(sub("[SEC"), "error: Missing close square bracket.");
  EXPECT_EQ(sub("$(X"), "error: Missing close parenthesis.");
  EXPECT_EQ(sub("[SEC](KEY"), "error: Missing close parenthesis.");
  EXPECT_THAT(substitute("[SEC]KEY", {}).error().message(), HasSubstr("No INI file was given"));
}

TEST(Words, CommentsAndQuotes) {
  EXPECT_EQ(without_comment("a b # c"), "a b ");
  EXPECT_EQ(without_comment("a#b"), "a");
  EXPECT_EQ(without_comment("a \"# no\" 'x#' # yes"), "a \"# no\" 'x#' ");
  EXPECT_THAT(*split_words("  a\tb  \"c d\" e'f g'h "),
              ElementsAre("a", "b", "\"c d\"", "e'f g'h"));
  EXPECT_EQ(split_words("a 'b").error().message(), "unterminated quoted string");
  EXPECT_EQ(unquoted("e'f g'h"), "ef gh");
  EXPECT_EQ(unquoted("config=\"a='1' b\""), "config=a='1' b");
}

class Capture final : public CommandSink {
 public:
  void out(std::string_view text) override { out_text += text; }
  void err(std::string_view text) override { err_text += text; }
  std::string out_text;
  std::string err_text;
};

class CommanderTest : public HostTest {
 protected:
  bool run(std::string_view text) {
    sink_.out_text.clear();
    sink_.err_text.clear();
    return commander_.run_text(text, "t.hal");
  }
  LocalSession session_{*host_};
  Capture sink_;
  Commander commander_{session_, ini, &sink_};
};

TEST_F(CommanderTest, RunsAFileWithCommentsContinuationsAndArrows) {
  EXPECT_TRUE(
      run("# first \\\n continued\n"
          "loadrt adder \\\n"
          "   names=a,b   # two\r\n"
          "\n"
          "net s a.out => b.in\n"
          "a.step = 5\n"
          "setp b.step 0x10\n"
          "getp a.step\n"
          "getp b.step"));
  EXPECT_EQ(sink_.out_text, "5\n16\n");
  EXPECT_EQ(sink_.err_text, "t.hal:4: Warning: File contains DOS-style line endings.\n");
}

TEST_F(CommanderTest, ErrorsNameFileAndLineAndStop) {
  EXPECT_FALSE(run("loadrt adder\n\nnet s \\\n adder.0.in adder.0.owt\nshow pin\n"));
  EXPECT_EQ(sink_.err_text,
            "t.hal:4: Pin 'adder.0.owt' does not exist; did you mean 'adder.0.out'?\n");
  EXPECT_EQ(sink_.out_text, "");
  EXPECT_FALSE(run("lodart x\n"));
  EXPECT_EQ(sink_.err_text, "t.hal:1: Unknown command 'lodart'; did you mean 'loadrt'?\n");
}

TEST_F(CommanderTest, KeepGoingGoesOnAndStillFails) {
  commander_.set_keep_going(true);
  EXPECT_FALSE(run("nonsense\nloadrt adder\nlist pin\n"));
  EXPECT_EQ(sink_.out_text, "adder.0.in adder.0.out adder.0.time \n");
}

TEST_F(CommanderTest, MessagesOfThePeer) {
  EXPECT_TRUE(run("loadrt adder names=a,b\nnet s a.out b.in\nnewsig u u32\n"));
  const std::pair<const char*, const char*> rows[] = {
      {"setp a.in", "setp requires 2 arguments, 1 given"},
      {"list", "list requires at least 1 arguments, 0 given"},
      {"show nonsense", "Unknown 'show' type 'nonsense'"},
      {"list nonsense", "Unknown 'list' type 'nonsense'"},
      {"status nothing", "Unknown 'status' type 'nothing'"},
      {"getp nonexist", "pin or parameter 'nonexist' not found"},
      {"gets nosig", "signal 'nosig' not found"},
      {"setp a.step abc", "value 'abc' invalid for S32"},
      {"setp a.out 1", "pin 'a.out' is not writable"},
      {"setp nothing.at.all 1", "parameter or pin 'nothing.at.all' not found"},
      {"net s", "'net' requires at least one pin, none given"},
      {"net", "net requires at least 1 arguments, 0 given"},
      {"net x zzz.qqq.vvv", "Pin 'zzz.qqq.vvv' does not exist"},
      {"print 'a", "unterminated quoted string"},
      {"getp [SEC]NONE", "Ini variable '[SEC]NONE' not found."},
      {"source /nofile.hal", "Could not open hal file '/nofile.hal': No such file or directory"},
  };
  for (const auto& [line, message] : rows) {
    EXPECT_FALSE(run(line)) << line;
    EXPECT_EQ(sink_.err_text, "t.hal:1: " + std::string(message) + "\n") << line;
  }
  EXPECT_TRUE(run("print \"a # b\"\n"));
  EXPECT_EQ(sink_.err_text, "t.hal:1: HALCMD MSG: \"a # b\"\n");
}

TEST_F(CommanderTest, TypesAndValues) {
  EXPECT_TRUE(
      run("loadrt adder\nnewsig u u32\nsets u 0xff\ngets u\nstype u\nptype adder.0.step\n"));
  EXPECT_EQ(sink_.out_text, "255\nu32\ns32\n");
}

TEST_F(CommanderTest, WordsOfACommandLineAreNotSplitAgain) {
  const std::string words[] = {"setp", "[SEC]KEY", "1 2"};
  EXPECT_FALSE(commander_.run_words(words));
  EXPECT_EQ(sink_.err_text, "<commandline>:0: parameter or pin '[SEC]KEY' not found\n");
}

TEST_F(CommanderTest, ProgramsAreRefusedWithinTheHostsProcess) {
  EXPECT_FALSE(run("loadusr -W true\n"));
  EXPECT_THAT(sink_.err_text, HasSubstr("programs cannot be started here"));
  EXPECT_FALSE(run("loadusr -z true\n"));
  EXPECT_THAT(sink_.err_text, HasSubstr("loadusr: invalid option -- 'z'"));
}

TEST_F(CommanderTest, VerboseSaysWhatWasDone) {
  commander_.set_level(Commander::Level::verbose);
  EXPECT_TRUE(run("loadrt adder\nnet s adder.0.in\nsetp adder.0.step 2\nstart\n"));
  EXPECT_EQ(
      sink_.out_text,
      "t.hal:1: Realtime module 'adder' loaded\nt.hal:2: Pin 'adder.0.in' linked to signal 's'\n"
      "t.hal:3: Parameter 'adder.0.step' set to 2\nt.hal:4: Realtime threads started\n");
  commander_.set_level(Commander::Level::silent);
  EXPECT_FALSE(run("nonsense\n"));
  EXPECT_EQ(sink_.err_text, "");
}

/// Lines are joined with nothing between them, and a message names the last.
TEST_F(CommanderTest, ABackslashJoinsLines) {
  EXPECT_TRUE(run("news\\\nig a bi\\\r\nt\nlist sig\n"));
  EXPECT_EQ(sink_.out_text, "a \n");
  EXPECT_EQ(sink_.err_text, "t.hal:3: Warning: File contains DOS-style line endings.\n");
  EXPECT_FALSE(run("nope \\\n  x\n"));
  EXPECT_EQ(sink_.err_text, "t.hal:2: Unknown command 'nope'\n");
  EXPECT_TRUE(run("newsig last \\\nbit \\"));
}

/// Quotes are part of the words that a command is given.
TEST_F(CommanderTest, QuotesStay) {
  EXPECT_TRUE(
      run("newsig \"a\" bit\nlist sig\nloadrt adder names=\"p,q\"\nlist pin *.in\nsave comp\n"));
  EXPECT_EQ(sink_.out_text, "\"a\" \np.in q.in \n# components\nloadrt adder names=\"p,q\"\n");
}

TEST_F(CommanderTest, EchoPrintsWhatIsRead) {
  EXPECT_TRUE(run("echo\n newsig  a bit # c\n\nunecho\nnewsig b bit\n"));
  EXPECT_EQ(sink_.err_text, "(2)<echo>:  newsig  a bit \n(3)<echo>: \n(4)<echo>: unecho\n");
  EXPECT_EQ(sink_.out_text, "Echo on\nEcho off\n");
}

TEST_F(CommanderTest, RefusedCommandsSayWhich) {
  EXPECT_TRUE(run("newsig s bit\nloadrt adder\n"));
  const std::pair<const char*, const char*> rows[] = {
      {"newsig s bit", "newsig failed: duplicate signal 's'"},
      {"delsig nope.nope", "delsig failed: signal 'nope.nope' not found"},
      {"linkps adder.0.in nope.nope", "link failed: signal 'nope.nope' not found"},
      {"unlinkp nope.nope", "unlink failed: pin 'nope.nope' not found"},
      {"addf nope.nope t", "addf failed: function 'nope.nope' not found"},
      {"alias pin nope.nope a", "alias failed: pin 'nope.nope' not found"},
      {"alias x adder.0.in a", "alias failed: the first word is pin or param, not 'x'"},
      {"newsig t wrong",
       "Unknown signal type 'wrong'; known are bit, float, s32, u32, s64, u64, port"},
  };
  for (const auto& [line, message] : rows) {
    EXPECT_FALSE(run(line)) << line;
    EXPECT_EQ(sink_.err_text, "t.hal:1: " + std::string(message) + "\n") << line;
  }
  EXPECT_TRUE(run("newsig f FLOAT\nstype f\ndelsig all\nlist sig\n"));
  EXPECT_EQ(sink_.out_text, "float\n\n");
}

/// A script behaves as if each command were asked for alone: the same messages at the same lines, and the same HAL.
TEST_F(CommanderTest, ManyCommandsAtOnceAreDoneInOrder) {
  std::string text = "loadrt adder names=c0";
  for (int i = 1; i < 400; ++i) text += ",c" + std::to_string(i);
  ASSERT_TRUE(run(text));
  text.clear();
  for (int i = 0; i < 400; ++i)
    text += "setp c" + std::to_string(i) + ".step " + std::to_string(i) + "\n";
  text += "net bad c1.out c2.out\nsetp c0.step 77\ngetp c0.step\n";
  EXPECT_FALSE(run(text));
  EXPECT_THAT(sink_.err_text, testing::StartsWith("t.hal:401: Signal 'bad'"));
  EXPECT_EQ(sink_.out_text, "");
  EXPECT_EQ(*view_->value("c399.step"), "399");
  EXPECT_EQ(*view_->value("c0.step"), "0");  // nothing after the error was done

  commander_.set_keep_going(true);
  EXPECT_FALSE(run(text + "setp c1.step x\nsetp $ 1\nsetp c2.step 5\nnope\n"));
  EXPECT_THAT(sink_.err_text, testing::MatchesRegex("t.hal:401: Signal 'bad'[^\n]*\n"
                                                    "t.hal:404: value 'x' invalid for S32\n"
                                                    "t.hal:405: Empty variable name.\n"
                                                    "t.hal:407: Unknown command 'nope'\n"));
  EXPECT_EQ(sink_.out_text, "77\n");
  EXPECT_EQ(*view_->value("c2.step"), "5");
}

TEST_F(CommanderTest, SaveGivesTheCommandsThatMakeHal) {
  EXPECT_TRUE(
      run("loadrt adder names=a,b\nloadrt test-threads name1=servo period1=1000000\n"
          "net s a.out => b.in\nnewsig w u64\nsetp a.step -7\naddf a servo\n"
          "alias pin a.in first\nalias param b.step size\n"));
  EXPECT_TRUE(run("save\n"));
  const std::string saved = sink_.out_text;
  EXPECT_EQ(saved,
            "# components\n"
            "loadrt adder names=a,b\n"
            "loadrt test-threads name1=servo period1=1000000\n"
            "#loadrt __servo  (not loaded by loadrt, no args saved)\n"
            "# pin aliases\n"
            "alias pin a.in first\n"
            "# param aliases\n"
            "alias param b.step size\n"
            "# signals\n"
            "newsig w u64\n"
            "# nets\n"
            "net s a.out => b.in\n"
            "# parameter values\n"
            "setp a.step                   -7\n"
            "setp a.tmax                    0\n"
            "setp b.tmax                    0\n"
            "setp servo.tmax                    0\n"
            "setp size                    1\n"
            "# realtime thread/function links\n"
            "addf a servo\n");
  EXPECT_TRUE(run("delsig all\nunload all\n"));
  EXPECT_TRUE(run(saved));
  EXPECT_TRUE(run("save\n"));
  EXPECT_EQ(sink_.out_text, saved);
  EXPECT_FALSE(run("save nothing\n"));
  EXPECT_EQ(sink_.err_text, "t.hal:1: Unknown 'save' type 'nothing'\n");
  EXPECT_FALSE(run("save all /no/such/folder/x\n"));
  EXPECT_THAT(sink_.err_text, HasSubstr("Can't open 'save' destination '/no/such/folder/x'"));
}

/// Columns of the newest LinuxCNC.
TEST_F(CommanderTest, ShowHasThePeersColumns) {
  EXPECT_TRUE(
      run("loadrt adder names=a,b\nnet s a.out => b.in\nnewsig w u64\nsets w 255\nsetp a.step -7\n"
          "loadrt test-threads name1=servo period1=1000000\naddf a servo\naddf b servo\n"));
  EXPECT_TRUE(run("show pin a b.in\nshow sig\nshow param a\nshow comp adder\nshow thread\n"));
  EXPECT_EQ(sink_.out_text,
            "Component Pins:\n"
            "Owner   Type  Dir                 Value  Name\n"
            "     1  s32   IN                      0  a.in\n"
            "     1  s32   OUT                     0  a.out ==> s\n"
            "     1  s32   OUT                     0  a.time\n"
            "     1  s32   IN                      0  b.in <== s\n"
            "\n"
            "Signals:\n"
            "Type                  Value  Name     (linked to)\n"
            "s32                       0  s\n"
            "                                 <== a.out\n"
            "                                 ==> b.in\n"
            "u64      0x00000000000000FF  w\n"
            "\n"
            "Parameters:\n"
            "Owner   Type  Dir                 Value  Name\n"
            "     1  s32   RW                     -7  a.step\n"
            "     1  s32   RW                      0  a.tmax\n"
            "     1  bit   RO                  FALSE  a.tmax-increased\n"
            "\n"
            "Loaded HAL Components:\n"
            "ID      Type  Name                                                    PID   State\n"
            "     1  RT    adder                                                         ready\n"
            "\n"
            "Realtime Threads:\n"
            "     Period  FP     Name               (     Time, Max-Time )\n"
            "    1000000  YES                 servo (        0,        0 )\n"
            "                  1 a\n"
            "                  2 b\n"
            "\n");
  commander_.set_script_mode(true);
  EXPECT_TRUE(run("show sig\nshow pin a.out\nshow thread\n"));
  EXPECT_EQ(sink_.out_text,
            "s32    0  s <== a.out ==> b.in\nu64    255  w\n\nadder s32   OUT 0 a.out ==> s\n\n"
            "1000000 YES servo        0 0 a b\n\n");
}

TEST_F(CommanderTest, RandomLinesNeverCrash) {
  const std::string alphabet = "ab .=[]()$\"'#\\<>-0netshowadder";
  std::uint64_t state = 12345;
  for (int i = 0; i < 3000; ++i) {
    std::string line;
    for (int n = 0; n < 24; ++n) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      line += alphabet[(state >> 33U) % alphabet.size()];
    }
    (void)run(line);
  }
}

}  // namespace
}  // namespace kerf::hal::test
