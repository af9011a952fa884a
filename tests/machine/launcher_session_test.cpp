// What the launcher does around a machine: screens, applications, filters, HAL files of the library, programs that end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "machine/kerf_process.hpp"

namespace kerf::launcher::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Session : public testing::Test {
 protected:
  Session() : mill_(testing::UnitTest::GetInstance()->current_test_info()->name()) {}
  std::string script(const std::string& name, const std::string& text) {
    const std::string path = mill_.write(name, "#!/bin/sh\n" + text);
    chmod(path.c_str(), 0755);
    return path;
  }
  Mill mill_;
};

TEST_F(Session, TheScreenGetsTheIniFileItsWordsAndTheEnvironment) {
  const std::string out = mill_.path("screen.txt");
  script("screen", "{ echo \"words $@\"; env; pwd; ps -o pgid= -p $$; ps -o pgid= -p $PPID; } > " +
                       out + "\n");
  mill_.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = ./screen -c \"two words\"");
  Kerf kerf(mill_, "screen", {"--virtual", "-H", "/first", "-H", "/second"});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  const std::string text = read_file(out);
  EXPECT_THAT(text, HasSubstr("words -ini " + mill_.ini() + " -c two words\n"));
  EXPECT_THAT(text, HasSubstr("INI_FILE_NAME=" + mill_.ini() + "\n"));
  EXPECT_THAT(
      text, HasSubstr("CONFIG_DIR=" + mill_.path("").substr(0, mill_.path("").size() - 1) + "\n"));
  EXPECT_THAT(text, HasSubstr("HALLIB_PATH=/second:/first:"));
  EXPECT_THAT(text, HasSubstr("/configs/hallib"));
  EXPECT_THAT(text, HasSubstr("PATH=" + mill_.path("bin") + ":" + KERF_BUILD_DIR + "/bin:"));
  // The launcher's group: only that may read at the terminal.
  const auto end = text.find_last_not_of('\n');
  const auto last = text.rfind('\n', end), before = text.rfind('\n', last - 1);
  EXPECT_EQ(text.substr(before + 1, last - before - 1), text.substr(last + 1, end - last));
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST_F(Session, AScreenThatRunsDoesThePostguiFilesItself) {
  script("screen", "exit 0\n");
  mill_.write("post.hal", "net nothing no.such.pin\n");
  mill_.change("[HAL]\n", "[HAL]\nPOSTGUI_HALFILE = post.hal\n");
  mill_.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = ./screen");
  Kerf kerf(mill_, "post", {"--virtual"});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_THAT(kerf.output(), Not(HasSubstr("no.such.pin")));
}

TEST_F(Session, FiltersMakeTheProgram) {
  script("twice", "echo G21 G90; echo G0 X$(cat \"$1\"); echo G0 X0; echo M2\n");
  mill_.write("part.size", "5\n");
  mill_.change("[DISPLAY]", "[FILTER]\nPROGRAM_EXTENSION = .size Sizes\nsize = " +
                                mill_.path("twice") + "\n[DISPLAY]");
  Kerf kerf(mill_, "filter", {"--virtual", "--once", "--program", mill_.path("part.size")});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_THAT(kerf.output(), HasSubstr("4 of 4 executed"));
}

TEST_F(Session, AFilterThatFailsIsNamed) {
  script("bad", "exit 3\n");
  mill_.write("part.size", "5\n");
  mill_.change("[DISPLAY]", "[FILTER]\nPROGRAM_EXTENSION = .size Sizes\nsize = " +
                                mill_.path("bad") + "\n[DISPLAY]");
  Kerf kerf(mill_, "badfilter", {"--virtual", "--once", "--program", mill_.path("part.size")});
  EXPECT_EQ(kerf.wait_exit(), 1);
  EXPECT_THAT(kerf.output(), HasSubstr("ended with exit code 3"));
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST_F(Session, TheEndOfALoadedProgramIsTold) {
  script("panel", "sleep 0.3\nexit 4\n");
  mill_.write("panel2.hal", "loadusr " + mill_.path("panel") + "\n");
  mill_.change("[HAL]\n", "[HAL]\nHALFILE = panel2.hal\n");
  Kerf kerf(mill_, "panel", {});
  EXPECT_TRUE(kerf.wait_output("ended with exit code 4")) << kerf.output();
  EXPECT_THAT(kerf.output(), HasSubstr("warning: panel (process "));
  kerf.signal(SIGTERM);
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
}

TEST_F(Session, ApplicationsStartAfterTheirDelayAndThroughTheShellWhereNeeded) {
  mill_.change("[DISPLAY]", "[APPLICATIONS]\nDELAY = 0.2\nAPP = echo started > app.txt\n[DISPLAY]");
  Kerf kerf(mill_, "apps", {});
  for (int i = 0; i < 400 && read_file(mill_.path("app.txt")).empty(); ++i) pause_ms(20);
  EXPECT_EQ(read_file(mill_.path("app.txt")), "started\n") << kerf.output();
  kerf.signal(SIGTERM);
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
}

TEST_F(Session, OtherPlannersAndHomingModulesAreRefused) {
  Kerf planner(mill_, "tp", {"-t", "mytp"});
  EXPECT_EQ(planner.wait_exit(), 2);
  EXPECT_THAT(planner.output(), HasSubstr("mytp"));
  Kerf own(mill_, "tp2",
           {"--virtual", "--once", "-t", "tpmod", "-m", "homemod", "--program",
            mill_.write("p.ngc", "G21\nG0 X1\nM2\n")});
  EXPECT_EQ(own.wait_exit(), 0) << own.output();
}

/// Each machine of the library's HAL files homes and runs a program.
struct Library {
  const char* name;
  const char* halfiles;
};
class HalLibrary : public testing::TestWithParam<Library> {};
TEST_P(HalLibrary, RunsAProgram) {
  Mill mill(std::string("lib_") + GetParam().name);
  std::string ini =
      "[EMC]\nMACHINE = library\n[DISPLAY]\n[TASK]\nTASK = milltask\n[EMCMOT]\nEMCMOT = "
      "motmod\nBASE_PERIOD = 50000\n"
      "SERVO_PERIOD = 1000000\n[HAL]\n" +
      std::string(GetParam().halfiles) +
      "[KINS]\nKINEMATICS = trivkins coordinates=XYZ\nJOINTS = 3\n[TRAJ]\nCOORDINATES = "
      "XYZ\nLINEAR_UNITS = mm\n[EMCIO]\nTOOL_TABLE = mill.tbl\n";
  for (const char* axis : {"X", "Y", "Z"})
    ini += std::string("[AXIS_") + axis +
           "]\nMIN_LIMIT = -50\nMAX_LIMIT = 50\nMAX_VELOCITY = 50\nMAX_ACCELERATION = 500\n";
  const std::vector<std::string> switches{"1", "0.5",
                                          "2"};  // X and Z share theirs, so each joint leaves it
  for (const std::string joint : {"0", "1", "2"})
    ini += "[JOINT_" + joint +
           "]\nMIN_LIMIT = -60\nMAX_LIMIT = 60\nMAX_VELOCITY = 50\nMAX_ACCELERATION = 500\nFERROR "
           "= 5\n"
           "HOME_SEARCH_VEL = 10\nHOME_LATCH_VEL = 2\nHOME_SEQUENCE = " +
           joint + "\nHOME_OFFSET = " + switches[static_cast<std::size_t>(std::stoi(joint))] + "\n";
  std::ofstream(mill.ini()) << ini;
  Kerf kerf(mill, "library",
            {"--virtual", "--once", "--program",
             mill.write("p.ngc", "G21 G90\nG0 X5 Y3\nG1 Z-2 F600\nM2\n")});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_THAT(kerf.output(), HasSubstr("4 of 4 executed"));
  EXPECT_EQ(kerf.leftovers(), "");
}
INSTANTIATE_TEST_SUITE_P(
    All, HalLibrary,
    testing::Values(Library{"core_sim",
                            "HALFILE = core_sim.hal\nHALFILE = LIB:simulated_home.hal\n"},
                    Library{"spindle",
                            "HALFILE = core_sim.hal\nHALFILE = sim_spindle_encoder.hal\nHALFILE = "
                            "simulated_home.hal\n"},
                    Library{"wheel",
                            "HALFILE = core_sim.hal\nHALFILE = simulated_home.hal\nHALFILE = "
                            "LIB:wheeljogpins.tcl 0.1\nHALFILE = LIB:halcheck.tcl nopopup\n"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace kerf::launcher::test
