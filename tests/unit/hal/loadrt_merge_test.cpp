// What [HAL]TWOPASS makes of the loadrt lines of several files.
#include "hal/tcl/loadrt_merge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "hal/tcl/script.hpp"

namespace kerf::hal::tcl::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

/// The merged lines, or the first error.
std::vector<std::string> merged(const std::vector<std::string>& lines) {
  LoadrtMerge merge([](const std::string& module) -> std::optional<std::vector<std::string>> {
    if (module == "stranger") return std::nullopt;
    if (module == "debounce") return {{"cfg"}};
    return {{}};
  });
  int number = 0;
  for (const auto& line : lines) {
    if (const auto added = merge.add(words(line), {"f.hal", ++number}); !added.ok())
      return {"error: " + added.error().message()};
  }
  std::vector<std::string> out;
  for (const auto& module : merge.modules()) {
    std::string line;
    for (const auto& word : module.words()) line += (line.empty() ? "" : " ") + word;
    out.push_back(line);
  }
  return out;
}

TEST(LoadrtMerge, JoinsNamesInTheOrderOfTheLines) {
  EXPECT_THAT(merged({"and2 names=aa", "or2", "and2 names=ab,ac", "and2 names=ad"}),
              ElementsAre("and2 names=aa,ab,ac,ad", "or2"));
}

TEST(LoadrtMerge, SumsCounts) {
  EXPECT_THAT(merged({"and2 count=1", "and2 count=2", "pid num_chan=2", "pid num_chan=3"}),
              ElementsAre("and2 count=3", "pid num_chan=5"));
}

TEST(LoadrtMerge, ALineWithoutACountAddsNothingToOthers) {
  EXPECT_THAT(merged({"and2", "and2 count=2", "not", "not"}), ElementsAre("and2 count=2", "not"));
}

TEST(LoadrtMerge, OneFormAModule) {
  EXPECT_THAT(
      merged({"and2 names=a", "and2 count=2"}),
      ElementsAre("error: loadrt and2: count= here and names= at f.hal:1; a module takes one "
                  "of count=, num_chan= and names="));
  EXPECT_THAT(merged({"pid num_chan=1", "pid names=x"})[0], HasSubstr("num_chan= at f.hal:1"));
}

TEST(LoadrtMerge, ANameTwiceSaysWhere) {
  EXPECT_THAT(merged({"and2 names=a", "and2 names=b", "and2 names=c,a"}),
              ElementsAre("error: loadrt and2: the name 'a' is given twice; the others are at "
                          "f.hal:1, f.hal:2"));
  EXPECT_THAT(merged({"and2 names=a,a"})[0], HasSubstr("'a' is given twice"));
}

TEST(LoadrtMerge, PersonalitiesStayWithTheirInstances) {
  EXPECT_THAT(
      merged({"logic names=l1 personality=0x102", "logic names=l2,l3 personality=0x103,0x104"}),
      ElementsAre("logic names=l1,l2,l3 personality=0x102,0x103,0x104"));
  // Lines without personalities, before, between and after.
  EXPECT_THAT(merged({"logic names=a,b", "logic names=c personality=3", "logic names=d,e",
                      "logic names=f personality=6"}),
              ElementsAre("logic names=a,b,c,d,e,f personality=0,0,3,0,0,6"));
  EXPECT_THAT(merged({"logic count=3 personality=1", "logic count=1 personality=4"}),
              ElementsAre("logic count=4 personality=1,0,0,4"));
}

TEST(LoadrtMerge, OtherArraysAreJoined) {
  EXPECT_THAT(merged({"debounce cfg=2,3", "debounce cfg=4"}), ElementsAre("debounce cfg=2,3,4"));
  EXPECT_THAT(merged({"debounce cfg=2", "debounce cfg=2"}), ElementsAre("debounce cfg=2,2"));
}

TEST(LoadrtMerge, TheModuleSaysWhatIsAnArray) {
  EXPECT_THAT(merged({"board cfg=2", "board cfg=4"}),
              ElementsAre("error: loadrt board: cfg=4 here and cfg=2 at f.hal:1"));
  // loadrt will say that there is no such module.
  EXPECT_THAT(merged({"stranger cfg=2", "stranger cfg=4"}), ElementsAre("stranger cfg=2,4"));
}

TEST(LoadrtMerge, OtherParametersMustAgree) {
  EXPECT_THAT(merged({"motmod servo_period_nsec=1000000", "motmod num_joints=3",
                      "motmod servo_period_nsec=1000000"}),
              ElementsAre("motmod servo_period_nsec=1000000 num_joints=3"));
  EXPECT_THAT(merged({"motmod num_joints=3", "motmod num_joints=4"}),
              ElementsAre("error: loadrt motmod: num_joints=4 here and num_joints=3 at f.hal:1"));
}

TEST(LoadrtMerge, ANumberMustBeOne) {
  EXPECT_THAT(merged({"and2 count=two"})[0], HasSubstr("count='two' is not a number"));
  EXPECT_THAT(merged({"and2 count=-1"})[0], HasSubstr("is not a number"));
  EXPECT_THAT(merged({"and2 count=99999999999999999999"})[0], HasSubstr("is not a number"));
  EXPECT_THAT(merged({""})[0], HasSubstr("needs a module"));
}

/// However names are spread over lines, all come out, each once, in order.
TEST(LoadrtMerge, AnySplitOfNamesGivesTheSameLine) {
  std::mt19937 random(42);
  for (int round = 0; round < 200; ++round) {
    std::string all, line;
    std::vector<std::string> lines;
    const int count = 1 + static_cast<int>(random() % 30);
    for (int i = 0; i < count; ++i) {
      const std::string name = "n" + std::to_string(i);
      all += (all.empty() ? "" : ",") + name;
      line += (line.empty() ? "and2 names=" : ",") + name;
      if (random() % 3 == 0 || i + 1 == count) lines.push_back(std::exchange(line, ""));
    }
    ASSERT_THAT(merged(lines), ElementsAre("and2 names=" + all)) << "round " << round;
  }
}

TEST(TwoPass, TheMagicCommentIgnoresCaseAndBlanks) {
  EXPECT_TRUE(is_excluded("#NOTWOPASS"));
  EXPECT_TRUE(is_excluded("loadrt x\n  # No Two\tPass, since it is special\nnet a b\n"));
  EXPECT_FALSE(is_excluded("loadrt x # NOTWOPASS\n"));
  EXPECT_FALSE(is_excluded("# NO, TWOPASS\n# not#two pass\nNOTWOPASS\n#NOTWOPAS"));
  EXPECT_FALSE(is_excluded(""));
}

TEST(TwoPass, OptionsAreWordsBetweenCommasOrBlanks) {
  EXPECT_FALSE(TwoPassOptions::parse("on").verbose);
  EXPECT_TRUE(TwoPassOptions::parse("on,verbose,nodelete").verbose);
  EXPECT_TRUE(TwoPassOptions::parse("nodelete Verbose").verbose);
  EXPECT_FALSE(TwoPassOptions::parse("nonverbose").verbose);
}

}  // namespace
}  // namespace kerf::hal::tcl::test
