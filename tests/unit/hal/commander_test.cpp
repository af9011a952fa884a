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
  EXPECT_EQ(sub("[SEC]KEY"), "value");
  EXPECT_EQ(sub("a=[SEC]KEY,1"), "a=value,1");
  EXPECT_EQ(sub("[SEC](KEY)x"), "valuex");
  EXPECT_EQ(sub("$KERF_TEST_VAR/x $(KERF_TEST_VAR)x"), "env/x envx");
  EXPECT_EQ(sub("joint.[0-3].pos $ [x"), "joint.[0-3].pos $ [x");
  EXPECT_EQ(sub("[SEC]NONE"), "error: Ini variable '[SEC]NONE' not found.");
  EXPECT_EQ(sub("$KERF_NO_SUCH"), "error: Environment variable 'KERF_NO_SUCH' not found.");
  EXPECT_THAT(substitute("[SEC]KEY", {}).error().message(), HasSubstr("no INI file"));
  EXPECT_THAT(sub("[SEC](KEY"), HasSubstr("missing ')'"));
}

TEST(Words, CommentsAndQuotes) {
  EXPECT_EQ(without_comment("a b # c"), "a b ");
  EXPECT_EQ(without_comment("a#b"), "a");
  EXPECT_EQ(without_comment("a \"# no\" 'x#' # yes"), "a \"# no\" 'x#' ");
  EXPECT_THAT(*split_words("  a\tb  \"c d\" e'f g'h "),
              ElementsAre("a", "b", "\"c d\"", "e'f g'h"));
  EXPECT_EQ(unquoted("e'f g'h"), "ef gh");
  EXPECT_EQ(unquoted("config=\"a='1' b\""), "config=a='1' b");
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
      run("# first\n"
          "loadrt adder \\\n"
          "   names=a,b   # two\r\n"
          "\n"
          "net s a.out => b.in\n"
          "a.step = 5\n"
          "setp b.step 0x10\n"
          "getp a.step\n"
          "getp b.step"));
  EXPECT_EQ(sink_.out_text, "5\n16\n");
  EXPECT_EQ(sink_.err_text, "");
}

TEST_F(CommanderTest, ErrorsNameFileAndLineAndStop) {
  EXPECT_FALSE(run("loadrt adder\n\nnet s \\\n adder.0.in adder.0.owt\nshow pin\n"));
  EXPECT_EQ(sink_.err_text,
            "t.hal:3: Pin 'adder.0.owt' does not exist; did you mean 'adder.0.out'?\n");
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
  EXPECT_THAT(sink_.err_text, HasSubstr("<commandline>:0: parameter or pin 'value' not found"));
}

TEST_F(CommanderTest, ProgramsAreRefusedWithinTheHostsProcess) {
  EXPECT_FALSE(run("loadusr -W true\n"));
  EXPECT_THAT(sink_.err_text, HasSubstr("programs cannot be started here"));
  EXPECT_FALSE(run("loadusr -z true\n"));
  EXPECT_THAT(sink_.err_text, HasSubstr("unknown option '-z'"));
}

TEST_F(CommanderTest, VerboseSaysWhatWasDone) {
  commander_.set_level(Commander::Level::verbose);
  EXPECT_TRUE(run("loadrt adder\nnet s adder.0.in\nsetp adder.0.step 2\nstart\n"));
  EXPECT_EQ(
      sink_.err_text,
      "t.hal:1: Realtime module 'adder' loaded\nt.hal:2: Pin 'adder.0.in' linked to signal 's'\n"
      "t.hal:3: Parameter 'adder.0.step' set to 2\nt.hal:4: Realtime threads started\n");
  commander_.set_level(Commander::Level::silent);
  EXPECT_FALSE(run("nonsense\n"));
  EXPECT_EQ(sink_.err_text, "");
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
