// HAL files in Tcl and [HAL]TWOPASS, with the true programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "machine/kerf_process.hpp"

namespace kerf::launcher::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two lines that move, so that a whole run is short.
constexpr const char* kProgram = "G21 G90\nG0 X5\nM2\n";

/// The mill with other lines in [HAL], and what it printed.
class TclMachine : public testing::Test {
 protected:
  TclMachine() : mill_(testing::UnitTest::GetInstance()->current_test_info()->name()) {
    mill_.write("report.tcl",
                "puts \"functions: [hal list funct]\"\nputs \"signals: [hal list sig]\"\n"
                "show thread servo-thread\n");
  }
  /// `hal`: lines instead of the HALFILEs.
  int run(const std::string& hal, std::vector<std::string> more = {}) {
    mill_.change("HALFILE = mill.hal\nHALFILE = spindle.hal\nHALFILE = panel.hal\n",
                 hal + "POSTGUI_HALFILE = report.tcl\n");
    more.insert(more.end(), {"--virtual", "--once", "--program", mill_.write("p.ngc", kProgram)});
    Kerf kerf(mill_, "tcl", more);
    const int status = kerf.wait_exit();
    output_ = kerf.output();
    EXPECT_EQ(kerf.leftovers(), "");
    return status;
  }
  Mill mill_;
  std::string output_;
};

class TclExample : public testing::TestWithParam<const char*> {};
TEST_P(TclExample, RunsAProgramToItsEnd) {
  Mill mill(GetParam(), "tcl-mill", std::string(GetParam()) + ".ini");
  Kerf kerf(mill, "tclexample",
            {"--virtual", "--once", "--program",
             std::string(KERF_SOURCE_DIR) + "/nc_files/examples/first_part.ngc"});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  EXPECT_THAT(kerf.output(), HasSubstr("lines         141 of 141 executed"));
  EXPECT_THAT(kerf.output(), HasSubstr("machine time  1 min 40.6 s"));
  EXPECT_THAT(kerf.output(), Not(HasSubstr("flight record")));  // its end is no fault
  EXPECT_EQ(kerf.leftovers(), "");
}
INSTANTIATE_TEST_SUITE_P(All, TclExample, testing::Values("tcl-mill", "two-pass", "xyza"),
                         [](const testing::TestParamInfo<const char*>& test) {
                           std::string name = test.param;
                           replace(name, "-", "_");
                           return name;
                         });

constexpr const char* kEstimate =
    "# velocities\nloadrt ddt names=x-vel,y-vel\nloadrt and2 count=1\n"
    "addf x-vel servo-thread\naddf and2.0 servo-thread\nnet x-pos-cmd => x-vel.in\n";
constexpr const char* kMoreTcl =
    "loadrt ddt names=x-acc\nloadrt and2 count=2\n"
    "if {[lindex $::argv 0] eq {-not}} {loadrt not}\n"
    "addf x-acc servo-thread\nnet x-vel x-vel.out => x-acc.in\n";

TEST_F(TclMachine, TwoPassesPutTheLoadsOfAllFilesTogether) {
  mill_.write("estimate.hal", kEstimate);
  mill_.write("more.tcl", kMoreTcl);
  mill_.write("last.hal", "loadrt not\nloadrt ddt names=z-vel\nnet x-acc x-acc.out\n");
  ASSERT_EQ(run("TWOPASS = on, verbose, nodelete\nHALFILE = mill.hal\nHALFILE = spindle.hal\n"
                "HALFILE = estimate.hal\nHALFILE = more.tcl -not\nHALFILE = last.hal\n"
                "HALFILE = panel.hal\nHALCMD = newsig after-all-files bit\n"),
            0)
      << output_;
  // One line a module, all names, the sum of the counts.
  EXPECT_THAT(output_, HasSubstr("twopass: loadrt ddt names=x-vel,y-vel,x-acc,z-vel\n"));
  EXPECT_THAT(output_, HasSubstr("twopass: loadrt and2 count=3\n"));
  EXPECT_THAT(output_, HasSubstr("twopass: loadrt not\n"));
  EXPECT_THAT(output_, HasSubstr("functions: and2.0 and2.1 and2.2 "));
  EXPECT_THAT(output_, HasSubstr(" not.0 "));
  EXPECT_THAT(output_, HasSubstr(" x-acc x-motor x-vel y-motor y-vel z-motor z-vel"));
  EXPECT_THAT(output_, HasSubstr("after-all-files"));
  // addf in the order of the files.
  const auto first = output_.find(" x-vel\n"), second = output_.find(" and2.0\n"),
             third = output_.find(" x-acc\n");
  EXPECT_LT(first, second);
  EXPECT_LT(second, third);
  EXPECT_NE(third, std::string::npos);
}

TEST_F(TclMachine, WithoutTwoPassesASecondLoadIsAnError) {
  mill_.write("estimate.hal", kEstimate);
  mill_.write("more.tcl", kMoreTcl);
  EXPECT_EQ(run("HALFILE = mill.hal\nHALFILE = estimate.hal\nHALFILE = more.tcl\n"), 1);
  EXPECT_THAT(output_, HasSubstr("more.tcl:1: ddt: already exists"));
  EXPECT_THAT(output_, HasSubstr(mill_.ini() + ":" +
                                 std::to_string(mill_.line_of("HALFILE = more.tcl")) + ": "));
}

TEST_F(TclMachine, AnExcludedFileIsDoneFirstAndOnItsOwn) {
  mill_.write("special.hal",
              "# notwopass: order matters\nloadrt not names=inverter\nsetp nosuch 1\nloadrt or2\n");
  mill_.write("more.tcl", "loadrt ddt names=a\nputs \"or2: [llength [hal list pin or2.*]]\"\n");
  ASSERT_EQ(run("TWOPASS = on\nHALFILE = mill.hal\nHALFILE = spindle.hal\nHALFILE = more.tcl\n"
                "HALFILE = special.hal\nHALFILE = panel.hal\n"),
            0)
      << output_;
  EXPECT_THAT(output_, HasSubstr("special.hal:3: parameter or pin 'nosuch' not found"));
  EXPECT_THAT(output_, Not(HasSubstr("or2: 0")));
  EXPECT_THAT(output_, HasSubstr(" inverter "));
}

TEST_F(TclMachine, TwoPassesNameBothLinesOfAConflict) {
  mill_.write("a.hal", "\nloadrt and2 names=a\n");
  mill_.write("b.tcl", "\n\nloadrt and2 count=1\n");
  EXPECT_EQ(run("TWOPASS = on\nHALFILE = mill.hal\nHALFILE = a.hal\nHALFILE = b.tcl\n"), 1);
  EXPECT_THAT(output_, HasSubstr("b.tcl:3: loadrt and2: count= here and names= at "));
  EXPECT_THAT(output_, HasSubstr("a.hal:2; a module takes one of count="));
}

TEST_F(TclMachine, AScriptErrorNamesFileAndLineAndTakesAllDown) {
  mill_.write("bad.tcl", "puts \"pins: [llength [hal list pin joint.0.*]]\"\n\nnet x nosuch.pin\n");
  EXPECT_EQ(run("HALFILE = mill.hal\nHALFILE = bad.tcl\n"), 1);
  EXPECT_THAT(output_, HasSubstr("bad.tcl:3: Pin 'nosuch.pin' does not exist"));
  EXPECT_THAT(output_, HasSubstr(mill_.ini() + ":" +
                                 std::to_string(mill_.line_of("HALFILE = bad.tcl")) + ": "));
}

TEST_F(TclMachine, FilesAreFoundByTheSearchAndShutdownMayBeTcl) {
  const std::string more = mill_.path("more");
  fs::create_directories(more);
  std::ofstream(more + "/extra.tcl")
      << "puts \"extra $::argv in [pwd] path [lindex [split $::env(HALLIB_PATH) :] 0]\"\n"
         "newsig from-extra bit\n";
  mill_.write("down.tcl", "puts \"shutdown: [hal gets from-extra]\"\n");
  ASSERT_EQ(run("HALFILE = mill.hal\nHALFILE = spindle.hal\nHALFILE = panel.hal\n"
                "HALFILE = extra.tcl one 'two three'\nSHUTDOWN = down.tcl\n",
                {"-H", more}),
            0)
      << output_;
  EXPECT_THAT(output_, HasSubstr("extra one {two three} in "));
  EXPECT_THAT(output_, HasSubstr("path " + more));
  EXPECT_THAT(output_, HasSubstr("shutdown: FALSE"));
}

TEST_F(TclMachine, TimeInAScriptIsVirtual) {
  mill_.write("slow.tcl", "after 30000\nhal sleep 30\nputs slept\n");
  ASSERT_EQ(run("HALFILE = mill.hal\nHALFILE = spindle.hal\nHALFILE = panel.hal\n"
                "HALFILE = slow.tcl\n"),
            0)
      << output_;
  EXPECT_THAT(output_, HasSubstr("slept"));
}

TEST_F(TclMachine, AKilledScriptTakesAllDown) {
  mill_.write("hang.tcl", "puts hanging\nflush stdout\nloadusr -w sleep 1000\n");
  mill_.change("HALFILE = panel.hal\n", "HALFILE = panel.hal\nHALFILE = hang.tcl\n");
  for (const int signal : {SIGKILL, SIGTERM, SIGSEGV}) {
    Kerf kerf(mill_, "tclkill" + std::to_string(signal), {"--once"});
    // By then there is one process of the name, not one and its child that has yet to become sleep.
    for (int waited = 0; kerf.parts("sleep").empty() && waited < Kerf::kLimitMs; waited += 5)
      pause_ms(5);
    const auto scripts = kerf.parts("haltcl");
    ASSERT_EQ(scripts.size(), 1U);
    kill(scripts[0], signal);
    EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
    EXPECT_THAT(kerf.output(), HasSubstr("hang.tcl failed"));
    EXPECT_EQ(kerf.leftovers(), "");
  }
}

TEST_F(TclMachine, ASignalDuringAScriptTakesAllDown) {
  // A script that computes, and one that waits.
  for (const char* text : {"puts hanging\nflush stdout\nwhile 1 {}\n",
                           "puts hanging\nflush stdout\nloadusr -w sleep 1000\n"}) {
    mill_.write("hang.tcl", text);
    Mill other("tclsignal");
    other.write("hang.tcl", text);
    other.change("HALFILE = panel.hal\n", "HALFILE = panel.hal\nHALFILE = hang.tcl\n");
    Kerf kerf(other, "tclsig", {"--once"});
    ASSERT_TRUE(kerf.wait_output("hanging")) << kerf.output();
    kerf.signal(SIGINT);
    EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
    EXPECT_EQ(kerf.leftovers(), "");
  }
}

}  // namespace
}  // namespace kerf::launcher::test
