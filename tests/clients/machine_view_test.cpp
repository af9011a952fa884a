// What clients show of a machine: the peer's terms, in machine units.
#include "clients/common/machine_view.hpp"

#include <gtest/gtest.h>

#include "harness/machine.hpp"

namespace kerf::clients {
namespace {

std::unique_ptr<MachineView> view_of(harness::Machine& machine) {
  auto view = MachineView::over(machine.segment());
  EXPECT_TRUE(view.ok()) << (view.ok() ? std::string() : view.error().message());
  return view.ok() ? std::move(*view) : nullptr;
}

TEST(MachineView, ShowsAMachineFromEstopToItsProgramsEnd) {
  auto machine = harness::Machine::start();
  ASSERT_TRUE(machine->ready()) << machine->errors();
  const auto view = view_of(*machine);
  ASSERT_NE(view, nullptr);
  const Stat& s = view->stat();
  EXPECT_EQ(s.task_state, 1);
  EXPECT_TRUE(s.estop);
  EXPECT_FALSE(s.enabled);
  EXPECT_EQ(s.joints, 3);
  EXPECT_EQ(s.spindles, 1);
  EXPECT_EQ(s.axis_mask, 7U);
  EXPECT_EQ(s.kinematics_type, 1);
  EXPECT_DOUBLE_EQ(s.linear_units, 1);
  EXPECT_DOUBLE_EQ(s.max_velocity, 120);
  EXPECT_DOUBLE_EQ(s.joint[0].max_position_limit, 300);
  EXPECT_DOUBLE_EQ(s.axis[2].min_position_limit, -120);
  EXPECT_EQ(s.joint[0].joint_type, 1);
  EXPECT_EQ(s.joint[3].max_position_limit, 1);
  EXPECT_NE(s.ini_filename.find("mill.ini"), std::string::npos);

  ASSERT_TRUE(machine->power_on_and_home());
  ASSERT_TRUE(view->poll());
  EXPECT_EQ(s.task_state, 4);
  EXPECT_FALSE(s.estop);
  EXPECT_EQ(s.homed[0] + s.homed[1] + s.homed[2], 3);
  EXPECT_EQ(s.homed[3], 0);

  ASSERT_TRUE(machine->mdi("T1 M6"));
  ASSERT_TRUE(machine->mdi("G43 G0 X10 Y20"));
  ASSERT_TRUE(view->poll());
  EXPECT_EQ(s.state, RcsState::done);
  EXPECT_EQ(s.task_mode, 3);
  EXPECT_NEAR(s.position.x, 10, 1e-9);
  EXPECT_NEAR(s.joint_position[1], 20, 1e-9);
  EXPECT_EQ(s.command, "");
  EXPECT_EQ(s.tool_in_spindle, 1);
  ASSERT_GT(s.tool_table.size(), 1U);
  EXPECT_EQ(s.tool_table[0].id, 1);
  EXPECT_EQ(s.tool_table[1].id, 1);
  EXPECT_DOUBLE_EQ(s.tool_table[0].diameter, s.tool_table[1].diameter);
  EXPECT_GT(s.tool_offset.z, 0);

  const std::uint64_t program = machine->start_program(machine->write_program("G1 X50 F600\nM2\n"));
  machine->run_for(1);
  ASSERT_TRUE(view->poll());
  EXPECT_EQ(s.state, RcsState::exec);
  EXPECT_EQ(s.motion_type, 2);
  EXPECT_EQ(s.motion_line, 1);
  EXPECT_NEAR(s.current_vel, 10, 1e-6);
  EXPECT_GT(s.dtg.x, 0);
  EXPECT_TRUE(
      machine->run_until([&] { return task::is_terminal(machine->outcome(program).state); }));
}

TEST(MachineView, TellsAnInchMachineInInches) {
  harness::MachineOptions options;
  options.replace = {{"LINEAR_UNITS = mm", "LINEAR_UNITS = inch"},
                     {"TOOL_TABLE = mill.tbl", "TOOL_TABLE ="}};
  auto machine = harness::Machine::start(options);
  ASSERT_TRUE(machine->ready()) << machine->errors();
  const auto view = view_of(*machine);
  ASSERT_NE(view, nullptr);
  const Stat& s = view->stat();
  EXPECT_NEAR(s.linear_units, 1 / 25.4, 1e-12);
  EXPECT_NEAR(s.joint[0].units, 1 / 25.4, 1e-12);
  EXPECT_NEAR(s.joint[0].max_position_limit, 300, 1e-9);
  EXPECT_NEAR(s.axis[2].min_position_limit, -120, 1e-9);
  EXPECT_NEAR(s.max_velocity, 120, 1e-9);
}

TEST(MachineView, CommandsOfTheOperatorShow) {
  auto machine = harness::Machine::start();
  ASSERT_TRUE(machine->ready()) << machine->errors();
  ASSERT_TRUE(machine->power_on_and_home());
  const auto view = view_of(*machine);
  ASSERT_NE(view, nullptr);
  const Stat& s = view->stat();
  ASSERT_TRUE(machine->does({"digital-out", "1", "on"}));
  // Two wishes within one servo cycle are both carried out.
  const auto first = machine->send({"analog-out", "0", "1.5"});
  const auto second = machine->send({"analog-out", "2", "-3"});
  ASSERT_TRUE(machine->does({"feed-override-enable", "off"}));
  ASSERT_TRUE(machine->does({"adaptive-feed", "on"}));
  ASSERT_TRUE(machine->does({"feed-hold", "off"}));
  ASSERT_TRUE(machine->does({"spindle-override-enable", "off"}));
  ASSERT_TRUE(machine->does({"brake", "off"}));
  ASSERT_TRUE(machine->does({"debug", "5"}));
  ASSERT_TRUE(machine->does({"joint-limit", "1", "min=-7", "max=250"}));
  machine->run_for(0.1);
  ASSERT_TRUE(view->poll());
  EXPECT_EQ(machine->outcome(first).state, task::CommandState::done);
  EXPECT_EQ(machine->outcome(second).state, task::CommandState::done);
  EXPECT_EQ(s.dout[1], 1);
  EXPECT_DOUBLE_EQ(s.aout[0], 1.5);
  EXPECT_DOUBLE_EQ(s.aout[2], -3);
  EXPECT_FALSE(s.feed_override_enabled);
  EXPECT_TRUE(s.adaptive_feed_enabled);
  EXPECT_FALSE(s.feed_hold_enabled);
  EXPECT_FALSE(s.spindle[0].override_enabled);
  EXPECT_EQ(s.spindle[0].brake, 0);
  EXPECT_EQ(s.debug, 5);
  EXPECT_DOUBLE_EQ(s.joint[1].min_position_limit, -7);
  EXPECT_DOUBLE_EQ(s.joint[1].max_position_limit, 250);

  ASSERT_TRUE(machine->does({"brake", "on"}));
  ASSERT_TRUE(machine->does({"tool-offset", "77", "12.5", "-1", "6", "10", "20", "3"}));
  ASSERT_TRUE(machine->does({"synch"}));
  ASSERT_TRUE(machine->does({"reset-interpreter"}));
  machine->run_for(0.1);
  ASSERT_TRUE(view->poll());
  EXPECT_EQ(s.spindle[0].brake, 1);
  ASSERT_FALSE(s.tool_table.empty());
  const ToolStat& tool = s.tool_table.back();
  EXPECT_EQ(tool.id, 77);
  EXPECT_DOUBLE_EQ(tool.offset.z, 12.5);
  EXPECT_DOUBLE_EQ(tool.offset.x, -1);
  EXPECT_DOUBLE_EQ(tool.diameter, 6);
  EXPECT_EQ(tool.orientation, 3);
  EXPECT_EQ(machine->command({"joint-limit", "1", "min=9", "max=8"}).state,
            task::CommandState::error);
  EXPECT_EQ(machine->command({"brake", "on", "4"}).state, task::CommandState::error);
  EXPECT_EQ(machine->command({"analog-out", "64", "1"}).state, task::CommandState::error);
}

}  // namespace
}  // namespace kerf::clients
