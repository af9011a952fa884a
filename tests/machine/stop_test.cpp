// Stop means stop, at every cycle.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "harness/machine.hpp"
#include "task/api/client.hpp"

namespace kerf::harness {
namespace {

constexpr double kPeriod = 0.001;

std::unique_ptr<Machine> homed_machine() {
  auto m = Machine::start();
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  return m;
}

/// What every stop must keep, seen from the cycle at which it was asked for.
void expect_safe_stop(Machine& m, const std::string& where) {
  const auto before = m.motion();
  double last[3]{before.joint[0].pos_cmd, before.joint[1].pos_cmd, before.joint[2].pos_cmd};
  const double acc[3]{1000, 1000, 600};
  double vel[3]{before.joint[0].vel_cmd, before.joint[1].vel_cmd, before.joint[2].vel_cmd};
  const double start_speed = std::abs(before.vel_mm_s);
  const double speed =
      std::max({start_speed, std::abs(vel[0]), std::abs(vel[1]), std::abs(vel[2])});
  double travelled = 0;
  double worst_acc = 0;
  m.on_cycle([&](const motion::MotionStatus& s) {
    double step = 0;
    for (int j = 0; j < 3; ++j) {
      const double v = (s.joint[j].pos_cmd - last[j]) / kPeriod;
      worst_acc = std::max(worst_acc, std::abs(v - vel[j]) / kPeriod / acc[j]);
      step += (s.joint[j].pos_cmd - last[j]) * (s.joint[j].pos_cmd - last[j]);
      vel[j] = v;
      last[j] = s.joint[j].pos_cmd;
    }
    travelled += std::sqrt(step);
  });
  const auto asked = m.now();
  const auto reply = m.abort();
  EXPECT_EQ(reply.state, task::CommandState::done) << where << reply.text;
  // The slowest joint stops from full path speed within v/a; the path's own acceleration may be lower at a corner: 3 times that.
  const double stop_time = speed / 600 * 3 + 0.02;
  EXPECT_LE(static_cast<double>(m.now() - asked) * 1e-9, stop_time + 0.1) << where;
  EXPECT_LE(worst_acc, 1.001) << where;
  EXPECT_LE(travelled, speed * stop_time + 1e-9) << where;
  // Nothing moves any more, and no spindle turns.
  const auto at_rest = m.motion();
  m.run_for(0.3);
  const auto later = m.motion();
  for (int j = 0; j < 3; ++j)
    EXPECT_EQ(at_rest.joint[j].pos_cmd, later.joint[j].pos_cmd) << where << " joint " << j;
  EXPECT_FALSE(m.bit("spindle.0.on")) << where;
  EXPECT_TRUE(m.task().idle) << where;
  EXPECT_EQ(m.task().interp_state, task::InterpState::idle) << where;
  // What is shown is what is applied: a move to the shown work position moves nothing.
  const auto t = m.task();
  const double x = later.pos_cmd.x - t.g5x_offset.x - t.g92_offset.x - t.tool_offset.x;
  const double y = later.pos_cmd.y - t.g5x_offset.y - t.g92_offset.y - t.tool_offset.y;
  const double z = later.pos_cmd.z - t.g5x_offset.z - t.g92_offset.z - t.tool_offset.z;
  char line[120];
  const bool inch = t.program_units == 1;
  std::snprintf(line, sizeof line, "G90 G0 X%.13f Y%.13f Z%.13f", inch ? x / 25.4 : x,
                inch ? y / 25.4 : y, inch ? z / 25.4 : z);
  EXPECT_TRUE(m.mdi(line)) << where << m.errors();
  for (int j = 0; j < 3; ++j)
    EXPECT_NEAR(m.joint(static_cast<std::size_t>(j)), later.joint[j].pos_cmd, 1e-9)
        << where << line;
  EXPECT_TRUE(m.mdi("G91 G0 Z-0.001")) << where << m.errors();
}

void abort_all_along(const std::string& program, int every) {
  auto m = homed_machine();
  const auto path = m->write_program(program);
  const auto run = m->start_program(path);
  ASSERT_NE(run, 0U);
  int cases = 0;
  for (int n = 0; !task::is_terminal(m->outcome(run).state) && n < 200000; ++n) {
    if (n % every == 0) {
      const std::string where =
          "cycle " + std::to_string(n) + " line " + std::to_string(m->task().current_line) + ": ";
      const int failed = m->branch([&] { expect_safe_stop(*m, where); });
      ASSERT_EQ(failed, 0) << where;
      ++cases;
    }
    m->cycle();
  }
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->outcome(run).text << m->errors();
  EXPECT_GT(cases, 10);
}

TEST(Abort, AtManyCyclesOfLinesAndArcs) {
  abort_all_along(
      "G21 G90 G54 G17 G94\nG10 L2 P1 X20 Y30 Z-20\nS1000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F600\nG1 X30 "
      "F1500\nG2 X30 Y20 I0 J10\nG3 X10 Y20 "
      "R10\nG1 X0 Y0\nG0 Z5\nM5\nM2\n",
      37);
}

TEST(Abort, InOffsetsSubsAndToolChanges) {
  abort_all_along(
      "o<cut> sub\nG1 X[#1] F1200\nG1 Y[#1]\nG55\nG1 X5\nG54\no<cut> endsub\nG21 G90 G10 L2 P1 X20 "
      "Y20 Z-100\nG10 L2 P2 X40 Y10 "
      "Z-100\nT1 M6\nG43 H1\nS500 M3\nG0 X0 Y0 Z10\no<cut> call [10]\nG92 X100\nG1 X110 "
      "F900\nG92.1\nT2 M6\nG43 H2\nG81 X5 Y5 Z-1 R2 "
      "F400\nG80\nM70\nG91 G1 X3 F300\nG90\nM72\nG4 P0.2\nM2\n",
      53);
}

TEST(Abort, WhileHoming) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on());
  const auto home = m->send({"home", "-1"});
  int n = 0;
  for (; !task::is_terminal(m->outcome(home).state) && n < 60000; ++n) {
    if (n % 200 == 50) {
      const int failed = m->branch([&] {
        m->abort();
        m->run_for(0.3);
        const auto a = m->motion();
        m->run_for(0.5);
        const auto b = m->motion();
        for (int j = 0; j < 3; ++j) {
          EXPECT_EQ(a.joint[j].pos_cmd, b.joint[j].pos_cmd) << "joint " << j;
          EXPECT_FALSE(b.joint[j].homing);
        }
        EXPECT_FALSE(b.all_homed);
      });
      ASSERT_EQ(failed, 0) << "cycle " << n;
    }
    m->cycle();
  }
  EXPECT_TRUE(m->motion().all_homed);
}

TEST(Homing, EstopAndDeathOfItsClient) {
  MachineOptions options;
  options.clients = true;
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on());
  auto client = m->connect();
  ASSERT_NE(client, nullptr);
  ASSERT_TRUE(client->send({"home", "-1"}).ok());
  m->run_for(0.7);
  ASSERT_TRUE(m->motion().homing_active);
  EXPECT_EQ(m->task().waiting_for.object.view(), "the home switch of joint 2");
  EXPECT_EQ(m->task().waiting_for.pin.view(), "joint.2.home-sw-in");
  const int failed = m->branch([&] {
    m->send({"state", "estop"});
    m->run_for(0.01);
    const auto a = m->motion();
    EXPECT_FALSE(a.homing_active);
    EXPECT_FALSE(m->bit("joint.2.amp-enable-out"));
    m->run_for(0.3);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(m->motion().joint[j].pos_cmd, a.joint[j].pos_cmd);
    EXPECT_TRUE(m->power_on_and_home()) << m->errors();
    EXPECT_TRUE(m->mdi("G0 X1"));
  });
  EXPECT_EQ(failed, 0);
  // Nobody holds a lease on homing: it comes to its end, at its own bounds.
  client.reset();
  EXPECT_TRUE(m->run_until([&] { return m->motion().all_homed; }, 60));
  EXPECT_TRUE(m->mdi("G0 X1")) << m->errors();
}

TEST(Hold, APauseBehindAnAbortHoldsNothing) {
  auto m = homed_machine();
  const auto path = m->write_program("G0 X100\nG1 X0 F300\nM2\n");
  for (const char* late : {"pause", "step"}) {
    m->start_program(path);
    m->run_for(1);
    m->send({"abort"});
    const auto id = m->send({late});
    m->run_for(0.3);
    EXPECT_EQ(m->outcome(id).state, task::CommandState::error) << late;
    EXPECT_TRUE(m->task().idle) << late;
    EXPECT_FALSE(m->task().paused) << late;
    EXPECT_TRUE(m->mdi("G0 X1", 5)) << late << m->errors();
  }
}

TEST(Hold, APauseInTheLastCycleHoldsNothingLater) {
  auto m = homed_machine();
  const auto path = m->write_program("G0 X0.2\nM2\n");
  const auto run = m->start_program(path);
  for (int n = 0; n < 500 && !task::is_terminal(m->outcome(run).state); ++n) {
    const int failed = m->branch([&] {
      m->send({"pause"});
      m->run_for(0.3);
      if (!task::is_terminal(m->outcome(run).state)) return;  // held, as it should be
      EXPECT_FALSE(m->task().paused);
      EXPECT_TRUE(m->mdi("G0 X1", 5)) << m->errors();
    });
    ASSERT_EQ(failed, 0) << "cycle " << n;
    m->cycle();
  }
}

TEST(Waits, SayThePinAndItsNet) {
  MachineOptions options;
  options.hal = {"unlinkp iocontrol.0.tool-changed", "net asked iocontrol.0.tool-changed"};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  m->start_program(m->write_program("T1 M6\nM2\n"));
  m->run_for(2);
  EXPECT_EQ(task::wait_text(m->task().waiting_for),
            "the tool change: iocontrol.0.tool-changed, net asked");
}

TEST(Hold, PauseAndResumeFinishTheProgramOnThePath) {
  auto m = homed_machine();
  const auto run = m->start_program(
      m->write_program("G21 G90 G0 X10 Y10 Z-5\nG1 X60 F1200\nG2 X60 Y30 J10\nM2\n"));
  m->run_for(1.5);
  ASSERT_TRUE(m->does({"pause"}));
  m->run_for(0.5);
  const auto a = m->motion();
  m->run_for(0.5);
  const auto b = m->motion();
  EXPECT_EQ(a.joint[0].pos_cmd, b.joint[0].pos_cmd);
  EXPECT_TRUE(m->task().paused);
  ASSERT_TRUE(m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 60, 1e-9);
  EXPECT_NEAR(m->joint(1), 30, 1e-9);
}

TEST(Estop, ExternalEstopStopsDrivesAndSpindle) {
  MachineOptions options;
  options.hal = {"unlinkp iocontrol.0.emc-enable-in", "setp iocontrol.0.emc-enable-in 1"};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  m->start_program(m->write_program("S1000 M3\nM8\nG1 X80 F600\nM2\n"));
  m->run_for(3);
  EXPECT_TRUE(m->bit("iocontrol.0.coolant-flood"));
  ASSERT_TRUE(m->hal("setp iocontrol.0.emc-enable-in 0"));
  m->run_for(0.3);
  EXPECT_EQ(m->task().task_state, task::TaskState::estop);
  EXPECT_FALSE(m->bit("joint.0.amp-enable-out"));
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_FALSE(m->bit("iocontrol.0.coolant-flood"));
  EXPECT_FALSE(m->bit("motion.motion-enabled"));
}

/// A safety relay may take its time; what is waited for is shown, and an estop ends the wait.
TEST(Estop, ResetWaitsForTheChain) {
  MachineOptions options;
  options.hal = {"unlinkp iocontrol.0.emc-enable-in", "setp iocontrol.0.emc-enable-in 0"};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  const auto reset = m->send({"state", "estop-reset"});
  m->run_for(3);
  EXPECT_FALSE(task::is_terminal(m->outcome(reset).state)) << m->outcome(reset).text;
  EXPECT_EQ(m->task().waiting_for.pin.view(), "iocontrol.0.emc-enable-in");
  EXPECT_TRUE(m->bit("iocontrol.0.user-enable-out")) << "or a relay could never close";
  EXPECT_EQ(m->branch([&] {
    EXPECT_TRUE(m->hal("setp iocontrol.0.emc-enable-in 1"));
    m->run_for(0.1);
    EXPECT_EQ(m->outcome(reset).state, task::CommandState::done);
    EXPECT_EQ(m->task().task_state, task::TaskState::estop_reset);
    EXPECT_TRUE(m->task().waiting_for.object.empty());
  }),
            0);
  EXPECT_EQ(m->branch([&] {
    m->run_for(1.1);
    EXPECT_EQ(m->outcome(reset).state, task::CommandState::error);
    EXPECT_FALSE(m->bit("iocontrol.0.user-enable-out"));
  }),
            0);
  EXPECT_TRUE(m->does({"state", "estop"}));
  EXPECT_EQ(m->outcome(reset).state, task::CommandState::aborted);
  EXPECT_TRUE(m->task().waiting_for.object.empty());
  ASSERT_TRUE(m->hal("setp iocontrol.0.emc-enable-in 1"));
  m->run_for(5);
  EXPECT_EQ(m->task().task_state, task::TaskState::estop) << "nobody waits any more";
}

}  // namespace
}  // namespace kerf::harness
