// motion-logger: each command as a line, and the answers that task gets.
#include <gtest/gtest.h>

#include "clients/motion_logger/stand_in.hpp"
#include "machine/kerf_process.hpp"

namespace kerf::motion_logger {
namespace {

using motion::MotionShared;
using motion::MotionStatus;

class MotionLogger : public testing::Test {
 protected:
  void SetUp() override {
    motion::MachineConfig config;
    config.joints = 2;
    config.axis_mask = 5;  // X Z
    config.joint[1].home = -3;
    shared->config.write(config);
    step();
    lines.clear();
  }
  void step() {
    rtapi::WaitSpec next;
    stand_in.step(now += rtapi::kMillisecond, next);
  }
  void push(motion::PathItems::Variant body, int line = 1, std::uint64_t block = 1) {
    motion::PathItem item;
    item.epoch = shared->intent.abort_epoch.observe();
    item.seq = ++seq;
    item.tag.line = line;
    item.tag.id = block;
    item.body = body;
    ASSERT_TRUE(shared->path.push(item));
  }
  MotionStatus status() {
    MotionStatus out;
    EXPECT_TRUE(shared->status.read(out));
    return out;
  }
  motion::Intent wishes;
  void write() { shared->intent.values.write(wishes); }

  std::unique_ptr<MotionShared> shared{std::make_unique<MotionShared>()};
  std::vector<std::string> lines;
  StandIn stand_in{*shared, [this](const std::string& line) { lines.push_back(line); }};
  rtapi::Nanos now{0};
  std::uint64_t seq{0};
};

TEST_F(MotionLogger, LogsAndCarriesOutMoves) {
  motion::LinearMove move;
  move.end.x = 10;
  move.end.z = -0.0000001;
  move.vel_mm_s = 2.5;
  push(move, 7);
  step();
  EXPECT_EQ(
      lines,
      (std::vector<std::string>{"linear-move line=7 end=10,0,0,0,0,0,0,0,0 vel=2.5 kind=feed"}));
  const MotionStatus s = status();
  EXPECT_EQ(s.executed_seq, 1U);
  EXPECT_EQ(s.current.line, 7);
  EXPECT_EQ(s.pos_cmd.x, 10);
  EXPECT_EQ(s.joint[0].pos_fb, 10);
  EXPECT_TRUE(s.path_empty);
}

TEST_F(MotionLogger, HomesToTheHomePositions) {
  wishes.home_seq = 1;
  write();
  step();
  EXPECT_EQ(lines, std::vector<std::string>{"home joint=-1"});
  EXPECT_TRUE(status().all_homed);
  EXPECT_EQ(status().pos_cmd.z, -3);
  wishes.unhome_seq = 1;
  wishes.unhome_joint = 0;
  write();
  step();
  EXPECT_EQ(lines.back(), "unhome joint=0");
  EXPECT_FALSE(status().all_homed);
  EXPECT_TRUE(status().joint[1].homed);
}

TEST_F(MotionLogger, AnAbortDropsWhatIsOlderAndAHoldHolds) {
  shared->intent.hold.publish(1);
  push(motion::Dwell{1});
  step();
  EXPECT_EQ(lines, std::vector<std::string>{"hold on=1"});
  EXPECT_FALSE(status().path_empty);
  shared->intent.abort_epoch.publish(2);
  shared->intent.hold.publish(0);
  push(motion::Dwell{2});
  step();
  EXPECT_EQ(lines, (std::vector<std::string>{"hold on=1", "abort", "hold on=0",
                                             "dwell line=1 seconds=2"}));
  EXPECT_EQ(status().acked_epoch, 2U);
  EXPECT_EQ(status().executed_seq, 2U);
}

TEST_F(MotionLogger, ASingleStepIsOneBlock) {
  wishes.single_step = true;
  write();
  push(motion::Dwell{1}, 1, 10);
  push(motion::Dwell{2}, 1, 10);
  push(motion::Dwell{3}, 2, 11);
  step();
  EXPECT_EQ(status().executed_seq, 2U);
  shared->intent.hold.publish(1);
  step();
  shared->intent.hold.publish(0);
  step();
  EXPECT_EQ(status().executed_seq, 3U);
}

TEST_F(MotionLogger, SpindlesTurnAtOnce) {
  motion::SpindleChange change;
  change.action = motion::SpindleChange::Action::reverse;
  change.speed_rpm = 500;
  push(change);
  step();
  EXPECT_EQ(status().spindle[0].direction, -1);
  EXPECT_EQ(status().spindle[0].speed_rpm, -500);
  ++wishes.spindle_stop_seq[0];
  write();
  step();
  EXPECT_EQ(lines.back(), "spindle-stop spindle=0");
  EXPECT_FALSE(status().spindle[0].on);
}

TEST_F(MotionLogger, SaysNothingWhenNothingChanges) {
  write();
  step();
  const std::size_t before = lines.size();
  for (int n = 0; n < 5; ++n) {
    shared->intent.heartbeat.add(1);
    write();
    step();
  }
  EXPECT_EQ(lines.size(), before);
}

TEST(MotionLoggerManual, HasEachLine) {
  const std::string page =
      launcher::test::read_file(std::string(KERF_SOURCE_DIR) + "/docs/man/man1/motion-logger.1");
  EXPECT_NE(page.find(manual_list()), std::string::npos)
      << "put the output of motion-logger --man into docs/man/man1/motion-logger.1";
}

/// The true processes: a machine without motmod, and a screen that is a script.
TEST(MotionLoggerProcess, WritesWhatTaskTellsMotion) {
  const std::string folder = std::string(KERF_SOURCE_DIR) + "/tests/clients/motion_logger/program/";
  launcher::test::Mill mill("motion_logger");
  mill.write("logger.hal",
             "loadusr -W motion-logger motion.log\n"
             "net estop iocontrol.0.user-enable-out iocontrol.0.emc-enable-in\n"
             "net prepare iocontrol.0.tool-prepare iocontrol.0.tool-prepared\n"
             "net change iocontrol.0.tool-change iocontrol.0.tool-changed\n");
  mill.write("part.ngc", launcher::test::read_file(folder + "part.ngc"));
  mill.write("session", launcher::test::read_file(folder + "session"));
  ASSERT_EQ(chmod(mill.path("session").c_str(), 0755), 0);
  mill.change("HALFILE = mill.hal", "HALFILE = logger.hal");
  mill.change("HALFILE = spindle.hal", "");
  mill.change("HALFILE = panel.hal", "");
  mill.change("HALCMD = ", "# HALCMD = ");
  mill.change("[DISPLAY]", "[DISPLAY]\nDISPLAY = ./session");
  launcher::test::Kerf kerf(mill, "mlog", {});
  EXPECT_EQ(kerf.wait_exit(), 0) << kerf.output();
  std::string got = launcher::test::read_file(mill.path("motion.log"));
  // What the end of the machine asks for is no part of the session.
  const std::string last = "max-velocity value=20\n";
  ASSERT_NE(got.find(last), std::string::npos) << got << kerf.output();
  got.resize(got.find(last) + last.size());
  if (std::getenv("KERF_GOLDEN_UPDATE") != nullptr) {
    std::ofstream(folder + "expected") << got;
    GTEST_SKIP() << "written anew";
  }
  EXPECT_EQ(got, launcher::test::read_file(folder + "expected"));
}

}  // namespace
}  // namespace kerf::motion_logger
