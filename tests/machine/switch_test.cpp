// Switchable kinematics on a whole machine: a mill with a table that tilts (A) and turns (C). Switching moves no joint, programs go
// on from where the tool is now, and what cannot be switched is refused with a message.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::string rotary_joint(int number) {
  const std::string n = std::to_string(number);
  return "[JOINT_" + n +
         "]\nTYPE = ANGULAR\nMIN_LIMIT = -400\nMAX_LIMIT = 400\nMAX_VELOCITY = 360\n"
         "MAX_ACCELERATION = 3600\nFERROR = 5\nMIN_FERROR = 5\nHOME_SEQUENCE = 0\n";
}
std::string linear_joint(int number) {
  const std::string n = std::to_string(number);
  return "[JOINT_" + n +
         "]\nTYPE = LINEAR\nMIN_LIMIT = -2000\nMAX_LIMIT = 2000\nMAX_VELOCITY = 500\n"
         "MAX_ACCELERATION = 5000\nFERROR = 5\nMIN_FERROR = 5\nHOME_SEQUENCE = 0\n";
}
std::string axis(char letter, int limit) {
  return std::string("[AXIS_") + letter + "]\nMIN_LIMIT = -" + std::to_string(limit) +
         "\nMAX_LIMIT = " + std::to_string(limit) +
         "\nMAX_VELOCITY = 360\nMAX_ACCELERATION = 3600\n" +
         (letter == 'Z' ? "OFFSET_AV_RATIO = 0.2\n" : "");
}

/// A machine of its own INI text, with motors that are where they should be.
std::unique_ptr<Machine> machine(const std::string& kinematics, const std::string& letters,
                                 const std::vector<std::string>& hal = {}) {
  MachineOptions options;
  const auto joints = letters.size();
  std::string spaced;
  for (const char c : letters) spaced += std::string(1, c) + " ";
  options.replace = {{"KINEMATICS = trivkins coordinates=XYZ", "KINEMATICS = " + kinematics},
                     {"JOINTS = 3", "JOINTS = " + std::to_string(joints)},
                     {"COORDINATES = X Y Z", "COORDINATES = " + spaced},
                     {"HALFILE = mill.hal", "HALFILE = loops.hal"},
                     {"MAX_LINEAR_VELOCITY = 120", "MAX_LINEAR_VELOCITY = 500\n[OLD]"}};
  // The joints and axes of the mill give way to those here.
  for (const char* name :
       {"[AXIS_X]", "[JOINT_0]", "[AXIS_Y]", "[JOINT_1]", "[AXIS_Z]", "[JOINT_2]"})
    options.replace.emplace_back(name, std::string("[OLD_") + (name + 1));
  for (std::size_t j = 0; j < joints; ++j) {
    const bool rotary = letters[j] >= 'A' && letters[j] <= 'C';
    options.append += axis(letters[j], rotary ? 400 : 2000);
    options.append +=
        rotary ? rotary_joint(static_cast<int>(j)) : linear_joint(static_cast<int>(j));
  }
  const std::string file = testing::TempDir() + "kerf-switch-" + std::to_string(getpid()) + ".hal";
  std::ofstream(file) << "loadrt " << kinematics
                      << "\nloadrt motmod servo_period_nsec=1000000 num_spindles=1 num_joints="
                      << joints
                      << "\naddf motion-command-handler servo-thread\n"
                         "addf motion-controller servo-thread\n";
  options.replace.emplace_back("HALFILE = loops.hal", "HALFILE = " + file);
  for (std::size_t j = 0; j < joints; ++j) {
    const std::string n = std::to_string(j);
    std::string loop = "net loop-";
    loop.append(n).append(" joint.").append(n).append(".motor-pos-cmd => joint.").append(n);
    options.hal.push_back(loop.append(".motor-pos-fb"));
  }
  options.hal.emplace_back("net kind motion.analog-out-03 => motion.switchkins-type");
  options.hal.insert(options.hal.end(), hal.begin(), hal.end());
  auto started = Machine::start(options);
  (void)std::remove(file.c_str());
  return started;
}

std::unique_ptr<Machine> table_mill() {
  auto m = machine("xyzac-trt-kins", "XYZAC",
                   {"setp xyzac-trt-kins.y-offset 20", "setp xyzac-trt-kins.z-offset -10"});
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  return m;
}

TEST(Switching, AThousandTimesAndNoJointMoves) {
  auto m = table_mill();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> length(-300, 300), angle(-120, 120);
  std::int32_t kind = 0;
  double before[5]{}, worst = 0;
  int switches = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.kinematics_kind != kind) {
      ++switches;
      for (int j = 0; j < 5; ++j)
        worst = std::max(worst, std::fabs(s.joint[j].pos_cmd - before[j]));
    }
    kind = s.kinematics_kind;
    for (int j = 0; j < 5; ++j) before[j] = s.joint[j].pos_cmd;
  });
  for (int n = 0; n < 1000; ++n) {
    char line[120];
    std::snprintf(line, sizeof line, "G53 G0 X%.3f Y%.3f Z%.3f A%.3f C%.3f", length(random),
                  length(random), length(random), angle(random), angle(random));
    ASSERT_TRUE(m->mdi(line)) << line << m->errors();
    const int next = n % 2 == 0 ? 1 : n % 4 == 1 ? 2 : 0;
    ASSERT_TRUE(m->mdi("M68 E3 Q" + std::to_string(next))) << m->errors();
    ASSERT_TRUE(m->mdi("M66 E0 L0")) << m->errors();
    ASSERT_EQ(m->motion().kinematics_kind, next);
    ASSERT_TRUE(m->bit("kinstype.is-" + std::to_string(next)));
  }
  EXPECT_EQ(switches, 1000);
  EXPECT_LT(worst, 1e-12) << "mm or degrees: a joint moved";
  std::printf(
      "result: kinematics switched %d times, largest motion of a joint in that cycle %.1e\n",
      switches, worst);
}

TEST(Switching, AProgramGoesOnFromWhereTheToolIsNow) {
  auto m = table_mill();
  double jump = 0, before[5]{};
  bool first = true;
  m->on_cycle([&](const motion::MotionStatus& s) {
    for (int j = 0; j < 5; ++j) {
      if (!first) jump = std::max(jump, std::fabs(s.joint[j].pos_cmd - before[j]));
      before[j] = s.joint[j].pos_cmd;
    }
    first = false;
  });
  const auto reply = m->run_text(
      "G21 G90 G64\nF6000\nG1 X10 Y20 Z30 A40 C50\n"
      "M68 E3 Q1\nM66 E0 L0\n"
      "#1 = #<_x> #2 = #<_y> #3 = #<_z>\n"
      "G1 X[#1 + 5]\n"
      "M68 E3 Q0\nM66 E0 L0\n"
      "#4 = #<_x>\nG91 G1 Y1 X1\nG90 M2\n");
  ASSERT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  // 500 mm/s and 360 degrees/s at most, a millisecond each.
  EXPECT_LT(jump, 0.51);
  EXPECT_EQ(m->motion().kinematics_kind, 0);
}

TEST(Switching, InIdentityEachAxisMovesItsJointAlone) {
  auto m = table_mill();
  ASSERT_TRUE(m->mdi("G0 X10 Y20 Z30 A40 C50"));
  ASSERT_TRUE(m->mdi("M68 E3 Q1"));
  double before[5];
  for (std::size_t j = 0; j < 5; ++j) before[j] = m->joint(j);
  ASSERT_TRUE(m->mdi("G91 G0 Y7"));
  for (std::size_t j = 0; j < 5; ++j)
    EXPECT_NEAR(m->joint(j), before[j] + (j == 1 ? 7 : 0), 1e-9) << j;
  ASSERT_TRUE(m->mdi("M68 E3 Q0"));
  const double x = m->motion().pos_cmd.x, z = m->motion().pos_cmd.z;
  ASSERT_TRUE(m->mdi("G91 G0 A10"));
  EXPECT_NEAR(m->motion().pos_cmd.x, x, 1e-9);
  EXPECT_NEAR(m->motion().pos_cmd.z, z, 1e-9);
  EXPECT_GT(std::fabs(m->joint(2) - before[2]), 0.1) << "the tool follows the table";
}

TEST(Switching, WaitsUntilTheMachineStands) {
  auto m = table_mill();
  ASSERT_TRUE(m->hal("unlinkp motion.switchkins-type"));
  const auto run = m->start_program(m->write_program("G21 G90\nF600\nG1 X100\nG1 Y10\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.x > 20; }));
  ASSERT_TRUE(m->hal("setp motion.switchkins-type 1"));
  m->run_for(0.5);
  EXPECT_EQ(m->motion().kinematics_kind, 0) << "under way nothing is switched";
  EXPECT_TRUE(m->motion().kinematics_pending);
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done);
  ASSERT_TRUE(m->run_until([&] { return m->motion().kinematics_kind == 1; }, 1));
  EXPECT_NEAR(m->joint(0), 100, 1e-9);
}

TEST(Switching, WhatIsNotThereIsRefusedOnce) {
  auto m = table_mill();
  EXPECT_FALSE(m->mdi("M68 E3 Q7"));
  ASSERT_TRUE(m->mdi("M66 E0 L0")) << "nobody waits for it for ever";
  EXPECT_EQ(m->motion().kinematics_kind, 0);
  const std::string errors = m->errors();
  EXPECT_NE(errors.find("Kinematics not switched to kind 7"), std::string::npos) << errors;
  m->run_for(1);
  EXPECT_EQ(m->errors(), errors) << "said once";
  EXPECT_FALSE(m->mdi("M68 E3 Q-1"));
  ASSERT_TRUE(m->mdi("M66 E0 L0"));
  EXPECT_NE(m->errors().find("Kinematics not switched to kind -1"), std::string::npos);
  ASSERT_TRUE(m->mdi("M68 E3 Q1.9")) << "cut to a whole number";
  ASSERT_TRUE(m->mdi("M66 E0 L0"));
  EXPECT_EQ(m->motion().kinematics_kind, 1);
}

TEST(Switching, WhereTheOthersHaveNoPositionIsRefused) {
  auto m = machine("scarakins sparm=identityfirst", "XYZABC");
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X20 Y30")) << m->errors();
  ASSERT_TRUE(m->mdi("M68 E3 Q1"));
  ASSERT_TRUE(m->mdi("M66 E0 L0"));
  EXPECT_EQ(m->motion().kinematics_kind, 1);
  // A scara's arms cannot be here; the move is refused before it begins.
  const double joint = m->joint(0);
  EXPECT_FALSE(m->mdi("G0 X900 Y0"));
  EXPECT_NE(m->errors().find("no joint positions"), std::string::npos) << m->errors();
  EXPECT_EQ(m->joint(0), joint);
}

TEST(Switching, AHexapodThatCannotBeWhereItsJointsStandStaysInJointMode) {
  auto m = machine("genhexkins", "XYZABC");
  ASSERT_TRUE(m->ready()) << m->errors();
  // All struts at length 0.
  ASSERT_TRUE(m->power_on()) << m->errors();
  ASSERT_TRUE(m->does({"home", "-1"})) << m->errors();
  double moved = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    for (int j = 0; j < 6; ++j) moved = std::max(moved, std::fabs(s.joint[j].pos_cmd));
  });
  EXPECT_FALSE(m->mdi("G0 X1"));
  m->run_for(1);
  EXPECT_EQ(moved, 0.0);
  EXPECT_NE(m->errors().find("stays in joint mode"), std::string::npos) << m->errors();
  // Identity has a position everywhere.
  ASSERT_TRUE(m->hal("unlinkp motion.switchkins-type"));
  ASSERT_TRUE(m->hal("setp motion.switchkins-type 1"));
  m->run_for(0.1);
  EXPECT_TRUE(m->mdi("G0 X1")) << m->errors();
  EXPECT_NEAR(m->joint(0), 1, 1e-9);
}

/// The table mill with the length of the tool in its kinematics, as its integrator wires it.
std::unique_ptr<Machine> table_mill_with_tools() {
  auto m = table_mill();
  EXPECT_TRUE(m->hal("net tool-length motion.tooloffset.z => xyzac-trt-kins.tool-offset"));
  return m;
}

TEST(PinsOfKinematics, MoveNoJointWhereTheMachineStands) {
  auto m = table_mill_with_tools();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> length(-100, 100), angle(-120, 120);
  const auto text = [](const char* format, auto... value) {
    char line[140];
    std::snprintf(line, sizeof line, format, value...);
    return std::string(line);
  };
  double tip_moved = 0;
  for (int n = 0; n < 200; ++n) {
    ASSERT_TRUE(m->mdi(text("G90 G53 G0 X%.3f Y%.3f Z%.3f A%.3f C%.3f", length(random),
                            length(random), length(random), angle(random), angle(random))))
        << m->errors();
    const motion::MotionStatus before = m->motion();
    double moved = 0;
    m->on_cycle([&](const motion::MotionStatus& s) {
      for (int j = 0; j < 5; ++j)
        moved = std::max(moved, std::fabs(s.joint[j].pos_cmd - before.joint[j].pos_cmd));
    });
    switch (n % 4) {
      case 0: EXPECT_TRUE(m->mdi(text("G43.1 Z%.3f", length(random)))); break;
      case 1: EXPECT_TRUE(m->mdi("G49")); break;
      case 2: EXPECT_TRUE(m->hal(text("setp xyzac-trt-kins.y-offset %.3f", length(random)))); break;
      default:
        EXPECT_TRUE(m->hal(text("setp xyzac-trt-kins.z-offset %.3f", length(random))));
        // Axes are jogged from where the tip is now.
        EXPECT_TRUE(m->does({"mode", "manual"}) && m->does({"teleop", "on"}));
    }
    m->run_for(0.1);
    EXPECT_LT(moved, 1e-9) << n;
    tip_moved = std::max(tip_moved, std::fabs(m->motion().pos_cmd.y - before.pos_cmd.y));
    // Nor does a line to where it is said to be.
    EXPECT_TRUE(m->mdi(m->line_to_shown_place())) << m->errors();
    for (std::size_t j = 0; j < 5; ++j)
      EXPECT_NEAR(m->joint(j), before.joint[j].pos_cmd, 1e-6) << n << ", joint " << j;
    m->on_cycle([](const motion::MotionStatus&) {});
  }
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_GT(tip_moved, 50.0);
}

TEST(PinsOfKinematics, LetAnOffsetThatIsMovingGoOn) {
  auto m = table_mill_with_tools();
  ASSERT_TRUE(m->mdi("G90 G53 G0 X30 Y-40 Z-60 A-35 C50")) << m->errors();
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-scale 1") && m->hal("setp axis.z.eoffset-enable 1"));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> length(-100, 100);
  double last[5]{}, speed[5]{}, worst = 0;
  int cycles = 0, moving = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    ++cycles;
    for (int j = 0; j < 5; ++j) {
      const double v = s.joint[j].pos_cmd - last[j];
      if (cycles > 2) worst = std::max(worst, std::fabs(v - speed[j]) * 1e6);
      last[j] = s.joint[j].pos_cmd;
      speed[j] = v;
    }
    moving += std::fabs(speed[2]) > 1e-3 ? 1 : 0;
  });
  for (int n = 0; n < 200; ++n) {
    ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts " + std::to_string(n % 2 == 0 ? 20 : -20)));
    m->run_for(0.01 * static_cast<double>(n % 30));
    const char* const name = n % 3 == 0 ? "y-offset " : "z-offset ";
    ASSERT_TRUE(
        m->hal(std::string("setp xyzac-trt-kins.") + name + std::to_string(length(random))));
    if (n % 5 == 0) {
      EXPECT_TRUE(m->mdi("G43.1 Z" + std::to_string(length(random))));
    }
    m->run_for(0.02);
  }
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_LE(worst, 3600 * 1.001);
  EXPECT_GT(moving, 2000) << "of " << cycles << " cycles";
}

/// Whatever the tools were before, a line ends where it does with the tool alone.
TEST(PinsOfKinematics, APathGoesOnToItsPlacesWithATheOtherTool) {
  const std::string to = "G0 X10 Y20 Z30 A-35 C40\nG1 X22 Y5 F3000\n";
  const auto ends = [&](const std::string& text) {
    auto m = table_mill_with_tools();
    double worst = 0, last[5]{};
    bool first = true;
    m->on_cycle([&](const motion::MotionStatus& s) {
      for (int j = 0; j < 5; ++j) {
        if (!first) worst = std::max(worst, std::fabs(s.joint[j].pos_cmd - last[j]));
        last[j] = s.joint[j].pos_cmd;
      }
      first = false;
    });
    const auto reply = m->run_text("G21 G90 G64 P0.1\n" + text + "M2\n");
    EXPECT_EQ(reply.state, task::CommandState::done) << text << reply.text << m->errors();
    EXPECT_EQ(m->motion().faults, 0U) << text << m->errors();
    EXPECT_LT(worst, 0.51) << text;
    std::vector<double> at;
    for (std::size_t j = 0; j < 5; ++j) at.push_back(m->joint(j));
    return at;
  };
  const std::vector<double> wanted = ends("G43 H3\n" + to);
  for (std::string before :
       {"G43.1 Z20\n@G43 H3\n@", "G43.1 Z20\n@G1 X30\nG43 H3 G1 X10\n@", "@G43 H3 G0 Z40\nG0 Y3\n@",
        "G43.1 Z-10\n@G49\nG91 G1 Y3\nG1 X3\nG90\nG43 H3\nG1 X0\n@"}) {
    for (std::size_t at; (at = before.find('@')) != std::string::npos;) before.replace(at, 1, to);
    const std::vector<double> at = ends(before);
    for (std::size_t j = 0; j < 5; ++j) EXPECT_NEAR(at[j], wanted[j], 1e-6) << before << j;
  }
  // A line that names one axis moves the tip along it alone.
  auto m = table_mill_with_tools();
  const auto reply = m->run_text("G21 G90 G43.1 Z20\n" + to +
                                 "G43 H3\nM68 E1 Q[#5420]\nM68 E2 Q[#5421]\nG91 G0 X5\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text;
  EXPECT_NEAR(m->motion().pos_cmd.x, m->motion().analog_out[1] + 5, 1e-6);
  EXPECT_NEAR(m->motion().pos_cmd.y, m->motion().analog_out[2], 1e-6);
}

}  // namespace
}  // namespace kerf::harness
