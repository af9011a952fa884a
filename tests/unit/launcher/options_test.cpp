#include "launcher/options.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace kerf::launcher {
namespace {

TEST(Options, AllOfThem) {
  const auto o = parse_options({"a.ini", "--program", "b.ngc", "--once", "--virtual", "--instance",
                                "m-1", "--log-joints", "c.log", "--svg", "/tmp/d.svg", "-H", "h1",
                                "-H", "h2", "-k", "-v", "-r"});
  ASSERT_TRUE(o.ok());
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(o->ini, here + "/a.ini");
  EXPECT_EQ(o->program, here + "/b.ngc");
  EXPECT_EQ(o->log_joints, here + "/c.log");
  EXPECT_EQ(o->svg, "/tmp/d.svg");
  EXPECT_EQ(o->hal_dirs,
            (std::vector<std::string>{here + "/h2", here + "/h1"}));  // each before the others
  EXPECT_EQ(o->instance, "m-1");
  EXPECT_TRUE(o->once && o->virtual_time && o->ignore_hal_errors && o->verbose);
  EXPECT_FALSE(o->check_only);
}

TEST(Options, Defaults) {
  const auto o = parse_options({"a.ini"});
  ASSERT_TRUE(o.ok());
  EXPECT_FALSE(o->once || o->virtual_time);
  EXPECT_EQ(o->program, "");
  EXPECT_EQ(o->svg, std::filesystem::current_path().string() + "/toolpath.svg");
}

TEST(Options, SpeedMeansVirtualTime) {
  const auto o = parse_options({"a.ini", "--speed", "10"});
  ASSERT_TRUE(o.ok());
  EXPECT_TRUE(o->virtual_time);
  EXPECT_EQ(o->speed, 10);
}

TEST(Options, Check) {
  const auto o = parse_options({"check", "a.ini"});
  ASSERT_TRUE(o.ok());
  EXPECT_TRUE(o->check_only);
}

TEST(Options, PlannerAndHomingModules) {
  EXPECT_TRUE(parse_options({"-t", "tpmod", "-m", "homemod", "a.ini"}).ok());
  EXPECT_TRUE(parse_options({"-t", "tpmod", "x=1", "y=2", "a.ini"}).ok()) << "with parameters";
  const auto homing = parse_options({"-m", "myhome", "slow=1", "a.ini"});
  ASSERT_TRUE(homing.ok());
  EXPECT_EQ(homing->homing_module, "myhome slow=1");
  const auto other = parse_options({"-t", "mytp", "a.ini"});
  ASSERT_FALSE(other.ok());
  EXPECT_NE(other.error().text.find("mytp"), std::string::npos);
  EXPECT_NE(other.error().text.find("cannot be exchanged"), std::string::npos);
}

TEST(Options, TheLastIniFileAgain) {
  const std::string state = testing::TempDir() + "kerf_state_" + std::to_string(getpid());
  setenv("XDG_STATE_HOME", state.c_str(), 1);
  const auto none = parse_options({"-l"});
  ASSERT_FALSE(none.ok());
  EXPECT_NE(none.error().text.find("no machine was started yet"), std::string::npos);
  remember_ini("/m/mill.ini");
  const auto last = parse_options({"-l"});
  ASSERT_TRUE(last.ok());
  EXPECT_EQ(last->ini, "/m/mill.ini");
  EXPECT_EQ(parse_options({"-l", "/m/other.ini"})->ini, "/m/other.ini");
  unsetenv("XDG_STATE_HOME");
  std::filesystem::remove_all(state);
}

TEST(Options, WrongUseIsNamed) {
  for (const auto& [arguments, expected] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "INI"},
           {{"a.ini", "b.ini"}, "b.ini"},
           {{"a.ini", "--onse"}, "--onse"},
           {{"a.ini", "--speed", "-1"}, "--speed"},
           {{"a.ini", "--speed", "fast"}, "--speed"},
           {{"a.ini", "--instance", "a/b"}, "a/b"},
           {{"a.ini", "--program"}, "--program"}}) {
    const auto o = parse_options(arguments);
    ASSERT_FALSE(o.ok()) << expected;
    EXPECT_EQ(o.error().exit_code, kExitUsage);
    EXPECT_NE(o.error().text.find(expected), std::string::npos) << o.error().text;
  }
}

TEST(Options, HelpDocumentsExitCodes) {
  const auto o = parse_options({"--help"});
  ASSERT_FALSE(o.ok());
  EXPECT_EQ(o.error().exit_code, kExitOk);
  EXPECT_NE(o.error().text.find("Exit codes"), std::string::npos);
  const auto version = parse_options({"--version"});
  ASSERT_FALSE(version.ok());
  EXPECT_EQ(version.error().exit_code, kExitOk);
  EXPECT_EQ(version.error().text.rfind("kerf ", 0), 0U);
}

}  // namespace
}  // namespace kerf::launcher
