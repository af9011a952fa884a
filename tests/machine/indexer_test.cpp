// A dividing head that locks, on a whole machine: G0, G28, tool changes, aborts, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

/// A machine whose A is locked by an air cylinder that takes 0.2 s to open and 0.1 s to close.
class Indexing {
 public:
  explicit Indexing(bool cylinder = true) {
    MachineOptions options;
    options.ini = KERF_SOURCE_DIR "/configs/sim/mill-4axis/mill-4axis.ini";
    options.replace = {{"EMCMOT = motmod", "EMCMOT = motmod unlock_joints_mask=0x8"},
                       {"[AXIS_A]\n", "[AXIS_A]\nLOCKING_INDEXER_JOINT = 3\n"},
                       {"[JOINT_3]\n", "[JOINT_3]\nLOCKING_INDEXER = 1\n"},
                       {"TOOL_TABLE = ", "TOOL_CHANGE_AT_G30 = 1\nTOOL_TABLE = "}};
    options.hal = {"loadrt timedelay names=cylinder", "addf cylinder servo-thread",
                   "setp cylinder.on-delay 0.2", "setp cylinder.off-delay 0.1",
                   "net unlock joint.3.unlock cylinder.in"};
    if (cylinder) options.hal.emplace_back("net unlocked cylinder.out joint.3.is-unlocked");
    m = Machine::start(options);
    m->on_cycle([this](const motion::MotionStatus& s) {
      if (std::abs(s.joint[3].vel_cmd) > 1e-9 && !m->bit("joint.3.is-unlocked")) ++moved_locked;
    });
  }
  /// What the machine waits for, as all clients show it.
  [[nodiscard]] std::string waits_for() const {
    return std::string(m->task().waiting_for.pin.view());
  }
  std::unique_ptr<Machine> m;
  int moved_locked{0};
};

TEST(IndexerMachine, HomesTurnsAndLocks) {
  Indexing x;
  Machine& m = *x.m;
  ASSERT_TRUE(m.ready()) << m.errors();
  ASSERT_TRUE(m.power_on_and_home()) << m.errors();
  EXPECT_FALSE(m.bit("joint.3.unlock"));
  const double before = static_cast<double>(m.now());
  ASSERT_TRUE(m.mdi("G0 A90")) << m.errors();
  EXPECT_GT((static_cast<double>(m.now()) - before) * 1e-9, 0.2 + 0.5 + 0.1);
  EXPECT_NEAR(m.joint(3), 90, 1e-9);
  EXPECT_FALSE(m.bit("joint.3.unlock") || m.bit("joint.3.is-unlocked"));
  const auto reply = m.run_text(
      "G21 G90 G0 X10\nA180\nG1 X20 F1000\nG53 G0 A0\nG91 G0 A45\nG90 G28 X30 A10\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << m.errors();
  EXPECT_NEAR(m.joint(3), 0, 1e-9) << "G28: by way of 10 to 0";
  EXPECT_EQ(x.moved_locked, 0);
}

TEST(IndexerMachine, TheWayToTheToolTurnsItFirst) {
  Indexing x;
  Machine& m = *x.m;
  ASSERT_TRUE(m.ready() && m.power_on_and_home()) << m.errors();
  ASSERT_TRUE(m.mdi("G0 A30")) << m.errors();
  ASSERT_TRUE(m.mdi("G0 X50 Z100"));
  ASSERT_TRUE(m.mdi("G30.1"));
  ASSERT_TRUE(m.mdi("G0 A0"));
  ASSERT_TRUE(m.mdi("G0 X10"));
  ASSERT_TRUE(m.mdi("T1 M6")) << m.errors();
  EXPECT_NEAR(m.joint(3), 30, 1e-9);
  EXPECT_NEAR(m.joint(0), 50, 1e-9);
  EXPECT_EQ(x.moved_locked, 0);
}

TEST(IndexerMachine, SaysWhatItWaitsForAndAnAbortEndsTheWait) {
  Indexing x(false);
  Machine& m = *x.m;
  ASSERT_TRUE(m.ready()) << m.errors();
  ASSERT_TRUE(m.power_on());
  ASSERT_TRUE(m.hal("setp joint.3.is-unlocked 1"));
  // Homing locks it again at the end.
  m.send({"home", "-1"});
  ASSERT_TRUE(m.run_until(
      [&] { return m.motion().joint[3].home_state != 0 && m.bit("joint.3.unlock"); }, 60));
  ASSERT_TRUE(m.run_until([&] { return !m.bit("joint.3.unlock"); }, 60));
  ASSERT_TRUE(m.hal("setp joint.3.is-unlocked 0"));
  ASSERT_TRUE(m.run_until([&] { return m.motion().all_homed && !m.motion().homing_active; }, 60));
  const auto id = m.send({"mdi", "G0 A90"});
  m.run_for(2);
  EXPECT_TRUE(m.bit("joint.3.unlock"));
  EXPECT_EQ(x.waits_for(), "joint.3.is-unlocked");
  EXPECT_EQ(m.get("motion.motion-type"), 6);
  EXPECT_NEAR(m.joint(3), 0, 1e-9);
  EXPECT_EQ(m.abort().state, task::CommandState::done);
  m.run_for(0.1);
  EXPECT_FALSE(m.bit("joint.3.unlock"));
  EXPECT_NE(m.outcome(id).state, task::CommandState::done);
  // It opens, turns, and then does not close.
  (void)m.send({"mdi", "G0 A90"});
  m.run_for(0.5);
  ASSERT_TRUE(m.hal("setp joint.3.is-unlocked 1"));
  ASSERT_TRUE(m.run_until([&] { return !m.bit("joint.3.unlock"); }, 10));
  EXPECT_NEAR(m.joint(3), 90, 1e-9);
  m.run_for(1);
  EXPECT_EQ(x.waits_for(), "joint.3.is-unlocked");
  (void)m.abort();
  (void)m.send({"mdi", "G0 X10"});
  m.run_for(1);
  EXPECT_NEAR(m.joint(0), 0, 1e-9) << "X waits for the lock";
  EXPECT_EQ(x.waits_for(), "joint.3.is-unlocked");
  ASSERT_TRUE(m.hal("setp joint.3.is-unlocked 0"));
  ASSERT_TRUE(m.run_until([&] { return std::abs(m.joint(0) - 10) < 1e-9; }, 10));
}

TEST(IndexerMachine, RefusesWhatWouldTurnItOtherwise) {
  Indexing x;
  Machine& m = *x.m;
  ASSERT_TRUE(m.ready() && m.power_on_and_home()) << m.errors();
  const auto refused = [&](const std::string& line, const std::string& why) {
    const std::size_t from = m.errors().size();
    EXPECT_FALSE(m.mdi(line)) << line;
    const std::string said = m.errors().substr(from);
    EXPECT_NE(said.find(why), std::string::npos) << line << ": " << said;
    EXPECT_FALSE(m.bit("joint.3.unlock"));
  };
  refused("G0 X5 A10", "Indexing axis A can only be moved alone");
  refused("G53 G0 X5 A10", "Indexing axis A can only be moved alone");
  refused("G0 @5 A10", "Indexing axis A can only be moved alone");
  refused("G1 A10 F100", "Indexing axis A can only be moved with G0");
  refused("G2 X5 I2.5 A10 F100", "Indexing axis A can only be moved with G0");
  refused("G38.2 A10 F100", "Indexing axis A can only be moved with G0");
  refused("G33 Z1 A10 K1", "Indexing axis A can only be moved with G0");
  refused("G81 X1 Y1 Z10 R20 A10 F100", "canned cycle");
  ASSERT_TRUE(m.does({"mode", "manual"}));
  m.send({"jog", "a", "10"});
  m.run_for(0.3);
  EXPECT_NE(m.errors().find("Cannot jog axis A: it is a locking indexer"), std::string::npos)
      << m.errors();
  EXPECT_NEAR(m.joint(3), 0, 1e-9);
  EXPECT_EQ(x.moved_locked, 0);
}

TEST(IndexerMachine, WithoutPinsTheMoveIsRefused) {
  MachineOptions options;
  options.ini = KERF_SOURCE_DIR "/configs/sim/mill-4axis/mill-4axis.ini";
  options.replace = {{"[AXIS_A]\n", "[AXIS_A]\nLOCKING_INDEXER_JOINT = 3\n"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_NE(m->errors().find("[JOINT_3]LOCKING_INDEXER"), std::string::npos) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_FALSE(m->mdi("G0 A10"));
  EXPECT_NE(m->errors().find("unlock_joints_mask"), std::string::npos) << m->errors();
  EXPECT_NEAR(m->joint(3), 0, 1e-9);
}

}  // namespace
}  // namespace kerf::harness
