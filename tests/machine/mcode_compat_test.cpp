// What [RS274NGC]COMPAT brings back of older manuals, at the pins of a running machine. Names of the tests stand in
// tests/seeds.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

class MCodeCompat : public testing::Test {
 protected:
  void start(const std::string& compat, MachineOptions options = {}) {
    options.replace.emplace_back("[RS274NGC]\n", "[RS274NGC]\nCOMPAT = " + compat + "\n");
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  /// HAL as written for 2.7; the drive's answer to M19 comes from the test.
  static MachineOptions drive_by_hand() {
    MachineOptions o;
    o.hal = {"unlinkp motion.spindle-is-oriented"};
    return o;
  }
  static MachineOptions three_spindles() {
    MachineOptions o;
    o.replace = {{"SPINDLES = 1", "SPINDLES = 3"}};
    return o;
  }
  bool ends(std::uint64_t id, double limit_s) {
    return m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, limit_s);
  }
  /// An executable M150 in the folder where the sample machine looks for them.
  void failing_m150() const {
    namespace fs = std::filesystem;
    const fs::path script = m->write_program("#!/bin/sh\nexit 3\n", "M150");
    fs::permissions(script, fs::perms::owner_all);
  }
  std::unique_ptr<Machine> m;
};

TEST_F(MCodeCompat, TheOneSpindleOf27TurnsAndStopsAtItsOldPins) {
  start("2.7");
  EXPECT_TRUE(m->mdi("M3 S1200"));
  m->run_for(0.1);
  EXPECT_TRUE(m->bit("motion.spindle-on") && m->bit("motion.spindle-forward"));
  EXPECT_FALSE(m->bit("motion.spindle-reverse"));
  EXPECT_NEAR(m->get("motion.spindle-speed-out"), 1200, 1e-6);
  EXPECT_NEAR(m->get("motion.spindle-speed-out-rps"), 20, 1e-6);
  EXPECT_TRUE(m->mdi("M4 S600"));
  m->run_for(0.1);
  EXPECT_TRUE(m->bit("motion.spindle-on") && m->bit("motion.spindle-reverse"));
  EXPECT_FALSE(m->bit("motion.spindle-forward"));
  EXPECT_NEAR(m->get("motion.spindle-speed-out"), -600, 1e-6);
  EXPECT_NEAR(m->get("motion.spindle-speed-out-abs"), 600, 1e-6);
  EXPECT_TRUE(m->mdi("M5"));
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("motion.spindle-on"));
  EXPECT_EQ(m->get("motion.spindle-speed-out"), 0);
  EXPECT_TRUE(m->bit("motion.spindle-brake"));
}

TEST_F(MCodeCompat, OldAndNewPinNamesAreTheSamePin) {
  start("2.7");
  for (const char* pin : {"at-speed",  "brake",         "forward",       "index-enable",
                          "inhibit",   "is-oriented",   "locked",        "on",
                          "orient",    "orient-angle",  "orient-fault",  "orient-mode",
                          "reverse",   "revs",          "speed-cmd-rps", "speed-in",
                          "speed-out", "speed-out-abs", "speed-out-rps", "speed-out-rps-abs"}) {
    const std::string older = m->pin_kind(std::string("motion.spindle-") + pin);
    EXPECT_NE(older, "") << pin;
    EXPECT_EQ(older, m->pin_kind(std::string("spindle.0.") + pin)) << pin;
  }
  EXPECT_TRUE(m->hal("setp motion.spindle-inhibit 1"));
  EXPECT_TRUE(m->bit("spindle.0.inhibit"));
}

TEST_F(MCodeCompat, OldPinNamesAreThereIn27Only) {
  for (const char* compat : {"2.8", "2.9", "2.10"}) {
    start(compat);
    EXPECT_EQ(m->pin_kind("motion.spindle-on"), "") << compat;
    EXPECT_NE(m->pin_kind("spindle.0.on"), "") << compat;
  }
}

TEST_F(MCodeCompat, In27NoBlockTakesADollar) {
  start("2.7");
  for (const char* line : {"M3 S100 $0", "M4 $0", "M5 $0", "M19 R0 Q1 $0", "M51 $0", "S100 $0"})
    EXPECT_EQ(m->command({"mdi", line}).state, task::CommandState::error) << line;
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("motion.spindle-on"));
}

TEST_F(MCodeCompat, OrientationOf27ShowsAngleModeAndStart) {
  MachineOptions o = drive_by_hand();
  o.replace.emplace_back("[RS274NGC]\n", "[RS274NGC]\nORIENT_OFFSET = 30\n");
  start("2.7", o);
  struct Row {
    const char* line;
    double angle;
    int mode;
  };
  for (const Row& row : {Row{"M19 R90 Q5", 120, 0}, Row{"M19 R10 Q5 P0", 40, 0},
                         Row{"M19 R15 Q5 P1", 45, 1}, Row{"M19 R20.5 Q5 P2", 50.5, 2}}) {
    const auto id = m->send({"mdi", row.line});
    m->run_for(0.2);
    EXPECT_FALSE(task::is_terminal(m->outcome(id).state)) << row.line;
    EXPECT_TRUE(m->bit("motion.spindle-orient")) << row.line;
    EXPECT_EQ(m->get("motion.spindle-orient-angle"), row.angle) << row.line;
    EXPECT_EQ(m->get("motion.spindle-orient-mode"), row.mode) << row.line;
    EXPECT_FALSE(m->bit("motion.spindle-locked")) << row.line;
    m->hal("setp motion.spindle-is-oriented 1");
    EXPECT_TRUE(ends(id, 1)) << row.line;
    EXPECT_FALSE(m->bit("motion.spindle-orient")) << row.line;
    EXPECT_TRUE(m->bit("motion.spindle-locked")) << row.line;
    m->hal("setp motion.spindle-is-oriented 0");
  }
}

TEST_F(MCodeCompat, OrientationOf27ThatDoesNotComeWithinQIsAnError) {
  start("2.7", drive_by_hand());
  const auto id = m->send({"mdi", "M19 R90 Q2"});
  m->run_for(1.9);
  EXPECT_FALSE(task::is_terminal(m->outcome(id).state));
  EXPECT_TRUE(ends(id, 0.3));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::error);
  EXPECT_FALSE(m->bit("motion.spindle-locked"));
}

TEST_F(MCodeCompat, FaultOfTheDriveOf27EndsTheOrientation) {
  start("2.7", drive_by_hand());
  const auto id = m->send({"mdi", "M19 R90 Q9"});
  m->run_for(0.2);
  m->hal("setp motion.spindle-orient-fault 3");
  EXPECT_TRUE(ends(id, 0.2));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::error);
  EXPECT_FALSE(m->bit("motion.spindle-locked"));
}

TEST_F(MCodeCompat, SpindleOverrideOf27IsSwitchedByM51) {
  start("2.7");
  EXPECT_TRUE(m->does({"spindle-override", "0.5"}));
  EXPECT_TRUE(m->mdi("M3 S1000"));
  const std::pair<const char*, double> steps[] = {
      {"M51 P0", 1000}, {"M51", 500}, {"M51 P0", 1000}, {"M51 P1", 500}};
  for (const auto& [line, rpm] : steps) {
    EXPECT_TRUE(m->mdi(line)) << line;
    m->run_for(0.1);
    EXPECT_NEAR(m->get("motion.spindle-speed-out"), rpm, 1e-6) << line;
  }
}

TEST_F(MCodeCompat, AdaptiveFeedOfOlderManualsOnlySlows) {
  for (const char* compat : {"2.7", "2.8"}) {
    start(compat);
    m->hal("setp motion.adaptive-feed 0.5");
    m->start_program(m->write_program("M52\nG1 X250 F1200\nM2\n"));
    const std::pair<const char*, double> steps[] = {
        {"0.5", 10}, {"0", 0}, {"1", 20}, {"1.4", 20}, {"9", 20}};
    for (const auto& [factor, mm_s] : steps) {
      m->hal(std::string("setp motion.adaptive-feed ") + factor);
      m->run_for(0.4);
      EXPECT_NEAR(m->motion().vel_mm_s, mm_s, 1e-6) << compat << " " << factor;
    }
    // The operator's own override goes on top of it.
    EXPECT_TRUE(m->does({"feed-override", "1.5"}));
    m->run_for(0.4);
    EXPECT_NEAR(m->motion().vel_mm_s, 30, 1e-6) << compat;
  }
}

TEST_F(MCodeCompat, NegativeAdaptiveFeedReversesSince28) {
  for (const char* compat : {"2.7", "2.8", "2.10"}) {
    start(compat);
    m->start_program(m->write_program("M52\nG1 X250 F1200\nM2\n"));
    EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 60; }, 20));
    m->hal("setp motion.adaptive-feed -1.5");
    m->run_for(1);
    const double mm_s = std::string(compat) == "2.7" ? 0 : std::string(compat) == "2.8" ? 20 : 30;
    EXPECT_NEAR(m->motion().vel_mm_s, mm_s, 1e-6) << compat;
    EXPECT_EQ(m->joint(0) < 55, mm_s > 0) << compat;
  }
}

TEST_F(MCodeCompat, ExitStatusOfAUserCodeCountsSince28) {
  for (const char* compat : {"2.7", "2.8", "2.10"}) {
    MachineOptions o;
    o.replace = {{"USER_M_PATH = ", "USER_M_PATH = .:"}};
    start(compat, o);
    failing_m150();
    const bool counts = std::string(compat) != "2.7";
    EXPECT_EQ(m->run_text("M150 P1\nG0 X4\nM2\n").state,
              counts ? task::CommandState::error : task::CommandState::done)
        << compat << m->errors();
    EXPECT_NEAR(m->joint(0), counts ? 0 : 4, 1e-9) << compat;
  }
}

TEST_F(MCodeCompat, In28NoDollarMeansAllSpindles) {
  start("2.8", three_spindles());
  EXPECT_TRUE(m->mdi("S100 $0") && m->mdi("S200 $1") && m->mdi("S300 $2"));
  struct Row {
    const char* line;
    double rpm[3];
  };
  for (const Row& row :
       {Row{"M3", {100, 200, 300}}, Row{"M4", {-100, -200, -300}}, Row{"M5", {0, 0, 0}},
        Row{"M3 $1", {0, 200, 0}}, Row{"M3", {100, 200, 300}}, Row{"M5 $2", {100, 200, 0}}}) {
    EXPECT_TRUE(m->mdi(row.line));
    m->run_for(0.1);
    for (int n = 0; n < 3; ++n) {
      const std::string spindle = "spindle." + std::to_string(n);
      EXPECT_NEAR(m->get(spindle + ".speed-out"), row.rpm[n], 1e-6) << row.line << n;
      EXPECT_EQ(m->bit(spindle + ".on"), row.rpm[n] != 0) << row.line << n;
    }
  }
}

}  // namespace
}  // namespace kerf::harness
