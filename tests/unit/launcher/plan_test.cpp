#include "launcher/plan.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace kerf::launcher {
namespace {

namespace fs = std::filesystem;

class PlanTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "plan_test_" + std::to_string(getpid());
    fs::create_directories(dir_ + "/machine");
    fs::create_directories(dir_ + "/library");
    fs::create_directories(dir_ + "/mine");
    for (const char* name :
         {"machine/one.hal", "machine/two.hal", "machine/post.hal", "machine/end.hal",
          "machine/both.hal", "library/both.hal", "library/sys.hal", "mine/two.hal"})
      std::ofstream(dir_ + "/" + name) << "# empty\n";
  }
  void TearDown() override { fs::remove_all(dir_); }

  LaunchPlan plan(const std::string& text, bool with_mine = false) {
    auto loaded = ini::IniFile::parse(text, dir_ + "/machine/m.ini");
    EXPECT_TRUE(loaded.ok);
    HalSearch search{{}, {dir_ + "/library"}};
    if (with_mine) search.first = {dir_ + "/mine"};
    return make_plan(loaded.file, search);
  }
  static std::string messages(const LaunchPlan& plan) {
    std::string out;
    for (const auto& d : plan.diagnostics) out += d.message() + "\n";
    return out;
  }
  std::string dir_;
};

TEST_F(PlanTest, FilesInOrderThenCommandsInOrder) {
  const LaunchPlan p = plan(
      "[HAL]\nHALCMD = start later\nHALFILE = two.hal\nHALFILE = one.hal\nHALCMD = setp a 1\n"
      "POSTGUI_HALCMD = setp b 2\nPOSTGUI_HALFILE = post.hal\nSHUTDOWN = end.hal\n");
  ASSERT_TRUE(p.ok) << messages(p);
  ASSERT_EQ(p.hal.size(), 4U);
  EXPECT_EQ(p.hal[0].text, dir_ + "/machine/two.hal");
  EXPECT_EQ(p.hal[1].text, dir_ + "/machine/one.hal");
  EXPECT_FALSE(p.hal[2].is_file);
  EXPECT_EQ(p.hal[2].text, "start later");
  EXPECT_EQ(p.hal[2].at.line, 2);
  EXPECT_EQ(p.hal[3].text, "setp a 1");
  ASSERT_EQ(p.postgui.size(), 2U);
  EXPECT_EQ(p.postgui[0].text, dir_ + "/machine/post.hal");
  EXPECT_EQ(p.postgui[1].text, "setp b 2");
  ASSERT_EQ(p.shutdown.size(), 1U);
}

TEST_F(PlanTest, SearchesTheMachinesFolderBeforeTheLibrary) {
  const LaunchPlan p = plan(
      "[HAL]\nHALFILE = both.hal\nHALFILE = LIB:both.hal\nHALFILE = sys.hal\nHALFILE = " + dir_ +
      "/machine/one.hal\nHALFILE = ./two.hal\n");
  ASSERT_TRUE(p.ok) << messages(p);
  EXPECT_EQ(p.hal[0].text, dir_ + "/machine/both.hal");
  EXPECT_EQ(p.hal[1].text, dir_ + "/library/both.hal");
  EXPECT_EQ(p.hal[2].text, dir_ + "/library/sys.hal");
  EXPECT_EQ(p.hal[3].text, dir_ + "/machine/one.hal");
  EXPECT_EQ(p.hal[4].text, dir_ + "/machine/two.hal");
}

TEST_F(PlanTest, FoldersOfTheCommandLineComeFirst) {
  const LaunchPlan p = plan("[HAL]\nHALFILE = two.hal\nHALFILE = one.hal\n", true);
  EXPECT_EQ(p.hal[0].text, dir_ + "/mine/two.hal");
  EXPECT_EQ(p.hal[1].text, dir_ + "/machine/one.hal");
}

TEST_F(PlanTest, AMissingFileIsNamedWithPlaceAndNearestName) {
  const LaunchPlan p = plan("[HAL]\nHALFILE = one.hal\nHALFILE = tow.hal\n");
  EXPECT_FALSE(p.ok);
  EXPECT_NE(
      messages(p).find("m.ini:3: error: [HAL]HALFILE: no file 'tow.hal' in " + dir_ + "/machine"),
      std::string::npos)
      << messages(p);
  EXPECT_NE(messages(p).find("did you mean 'two.hal'?"), std::string::npos);
}

TEST_F(PlanTest, TclFilesHaveArguments) {
  std::ofstream(dir_ + "/machine/one.tcl") << "puts 1\n";
  const LaunchPlan p =
      plan("[HAL]\nTWOPASS = on, verbose\nHALFILE = one.tcl -a \"b c\"\nHALFILE = one.hal x\n");
  EXPECT_TRUE(p.ok) << messages(p);
  ASSERT_EQ(p.hal.size(), 2U);
  EXPECT_TRUE(p.hal[0].is_tcl());
  EXPECT_EQ(p.hal[0].arguments, (std::vector<std::string>{"-a", "b c"}));
  EXPECT_FALSE(p.hal[1].is_tcl());
  EXPECT_EQ(p.two_pass, "on, verbose");
  EXPECT_NE(
      messages(p).find("m.ini:4: warning: [HAL]HALFILE = one.hal x: only Tcl files take arguments"),
      std::string::npos)
      << messages(p);
}

TEST_F(PlanTest, AMissingTclFileIsAnError) {
  const LaunchPlan p = plan("[HAL]\nHALFILE = LIB:basic_sim.tcl -no_make_ddts\n");
  EXPECT_FALSE(p.ok);
  EXPECT_NE(messages(p).find("m.ini:2: error: [HAL]HALFILE: no file 'basic_sim.tcl' in "),
            std::string::npos)
      << messages(p);
}

TEST_F(PlanTest, AnyTextTurnsTwoPassesOn) {
  EXPECT_EQ(plan("[HAL]\nTWOPASS =\nHALFILE = one.hal\n").two_pass, "");
  const LaunchPlan p = plan("[HAL]\nTWOPASS = Off\nHALFILE = one.hal\n");
  EXPECT_EQ(p.two_pass, "Off");
  EXPECT_NE(messages(p).find("m.ini:2: warning: [HAL]TWOPASS: 'Off' turns two passes on"),
            std::string::npos)
      << messages(p);
}

TEST_F(PlanTest, NoHalFileAtAll) {
  const LaunchPlan p = plan("[EMC]\nMACHINE = x\n");
  EXPECT_FALSE(p.ok);
  EXPECT_EQ(p.machine_name, "x");
}

TEST_F(PlanTest, KerfSection) {
  const LaunchPlan p = plan(
      "[HAL]\nHALFILE = one.hal\n[KERF]\nCLOCK = Virtual\nSEGMENT_MB = 128\nRT_CPUS = 2-3\n"
      "FUNCTION_TIMING = Every\n");
  ASSERT_TRUE(p.ok) << messages(p);
  EXPECT_TRUE(p.virtual_time);
  EXPECT_EQ(p.segment_mb, 128U);
  EXPECT_EQ(p.rt_cpus, "2-3");
  EXPECT_EQ(p.function_timing, "every");
}

TEST_F(PlanTest, BadValuesOfTheKerfSection) {
  const LaunchPlan p = plan(
      "[HAL]\nHALFILE = one.hal\n[KERF]\nCLOCK = vritual\nSEGMENT_MB = 1\nRT_CPUS = all\nSEGMENT = "
      "3\n");
  EXPECT_FALSE(p.ok);
  const std::string text = messages(p);
  EXPECT_NE(text.find("m.ini:4: error"), std::string::npos) << text;
  EXPECT_NE(text.find("m.ini:5: error"), std::string::npos) << text;
  EXPECT_NE(text.find("m.ini:6: error"), std::string::npos) << text;
  EXPECT_NE(text.find("m.ini:7: warning"), std::string::npos) << text;
}

TEST_F(PlanTest, KeysOfOthersInTheKerfSectionAreKnown) {
  EXPECT_EQ(messages(plan("[HAL]\nHALFILE = one.hal\n[KERF]\nHEARTBEAT_TIMEOUT = 0.2\n")), "");
}

TEST_F(PlanTest, Programs) {
  const LaunchPlan p = plan(
      "[HAL]\nHALFILE = one.hal\nHALUI = halui\n[TASK]\nTASK = mytask\n[DISPLAY]\nDISPLAY = axis "
      "-x \"a b\"\n"
      "OPEN_FILE = part.ngc\n[APPLICATIONS]\nDELAY = 2.5\nAPP = sim_pin one\nAPP = other\n");
  EXPECT_EQ(p.task_program, "mytask");
  EXPECT_EQ(p.halui, "halui");
  EXPECT_EQ(p.display, (std::vector<std::string>{"axis", "-x", "a b"}));
  EXPECT_EQ(p.open_file, dir_ + "/machine/part.ngc");
  ASSERT_EQ(p.applications.size(), 2U);
  EXPECT_EQ(p.applications[0], "sim_pin one");
  EXPECT_EQ(p.applications_delay_s, 2.5);
  EXPECT_EQ(plan("[HAL]\nHALFILE = one.hal\n[DISPLAY]\nOPEN_FILE = \"\"\n").open_file, "");
}

TEST_F(PlanTest, EveryKeyIsHeldAgainstTheTable) {
  std::ofstream(dir_ + "/machine/one.hal") << "setp pid.0.x [JOINT_0]MY_SCALE\n";
  const std::string text = messages(
      plan("[HAL]\nHALFILE = one.hal\nHALCMD = setp y [JOINT_0]OTHER\n[JOINT_0]\nMY_SCALE = 1\n"
           "OTHER = 2\nHOME_SERCH_VEL = 3\nMAX_VELOCITY = fast\n"));
  EXPECT_EQ(text.find("MY_SCALE"), std::string::npos) << text;
  EXPECT_EQ(text.find("OTHER"), std::string::npos) << text;
  EXPECT_NE(text.find("m.ini:7: warning: unknown key [JOINT_0]HOME_SERCH_VEL; did you mean "
                      "'HOME_SEARCH_VEL'?"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("m.ini:8: error: [JOINT_0]MAX_VELOCITY = 'fast'"), std::string::npos) << text;
}

TEST_F(PlanTest, FiltersByExtension) {
  const auto loaded = ini::IniFile::parse(
      "[FILTER]\nPROGRAM_EXTENSION = .png,.gif Depth Image\nPROGRAM_EXTENSION = .py Script\n"
      "png = image-to-gcode -x\npy = python3\njpg = never\n",
      "m.ini");
  const ini::IniFile& file = loaded.file;
  EXPECT_EQ(filter_for(file, "/a/b.png"), (std::vector<std::string>{"image-to-gcode", "-x"}));
  EXPECT_EQ(filter_for(file, "b.py"), (std::vector<std::string>{"python3"}));
  EXPECT_TRUE(filter_for(file, "b.gif").empty()) << "no program for it";
  EXPECT_TRUE(filter_for(file, "b.jpg").empty()) << "not among the extensions";
  EXPECT_TRUE(filter_for(file, "b.ngc").empty());
  EXPECT_TRUE(filter_for(file, "noext").empty());
}

TEST(SplitWords, QuotesKeepBlanks) {
  EXPECT_EQ(split_words("  a  'b c'd \"\" e"), (std::vector<std::string>{"a", "b cd", "", "e"}));
  EXPECT_TRUE(split_words(" \t ").empty());
}

TEST(ResolveFrom, RelativeAbsoluteAndHome) {
  EXPECT_EQ(resolve_from("/a/b", "c/../d"), "/a/b/d");
  EXPECT_EQ(resolve_from("/a/b", "/d"), "/d");
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(resolve_from("/a/b", "~/d"), "/home/me/d");
}

}  // namespace
}  // namespace kerf::launcher
