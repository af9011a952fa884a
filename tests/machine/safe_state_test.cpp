// The declared safe state while all processes live: set in the very cycle in which the machine goes off, whatever switched it off.
#include <gtest/gtest.h>

#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

MachineOptions declared() {
  MachineOptions options;
  options.append =
      "[SAFE_STATE]\nPIN = motion.digital-out-03 0\nPIN = motion.digital-out-02 TRUE\n"
      "PIN = motion.analog-out-01 0.25\n";
  return options;
}

bool safe(const motion::MotionStatus& s) {
  return (s.digital_out >> 3 & 1U) == 0 && (s.digital_out >> 2 & 1U) == 1 &&
         s.analog_out[1] == 0.25;
}

TEST(SafeState, IsThereFromTheStartAndComesWithEveryWayToGoOff) {
  auto m = Machine::start(declared());
  ASSERT_TRUE(m->ready()) << m->errors();
  m->run_for(0.05);
  EXPECT_TRUE(safe(m->motion())) << "before it is first on";
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto run = m->start_program(m->write_program(
      "M65 P2\nM64 P3\nM68 E1 Q7\nM64 P0\nG1 X20 F300\nM62 P3\nM67 E1 Q3\nG1 X200\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->task().current_line == 5; }));
  m->run_for(0.3);
  ASSERT_FALSE(safe(m->motion()));
  const std::pair<const char*, std::function<void()>> ways[] = {
      {"off",
       [&] {
         m->send({"state", "off"});
       }},
      {"estop",
       [&] {
         m->send({"state", "estop"});
       }},
      {"amplifier", [&] { EXPECT_TRUE(m->hal("setp joint.1.amp-fault-in 1")); }},
      {"motion.enable", [&] { EXPECT_TRUE(m->hal("setp motion.enable 0")); }},
  };
  for (const auto& [name, go] : ways) {
    EXPECT_EQ(m->branch([&] {
      bool wrong = false;
      m->on_cycle(
          [&](const motion::MotionStatus& s) { wrong = wrong || (!s.enabled && !safe(s)); });
      go();
      EXPECT_TRUE(m->run_until([&] { return !m->motion().enabled; }, 5)) << name;
      m->run_for(1);
      EXPECT_FALSE(wrong) << name;
      EXPECT_TRUE(safe(m->motion())) << name;
      EXPECT_EQ(m->motion().digital_out & 1U, 1U) << name << ": what is not declared stays";
      EXPECT_TRUE(task::is_terminal(m->outcome(run).state)) << name;
    }),
              0)
        << name;
  }
  // An abort leaves the drives on, and the outputs as they are.
  EXPECT_EQ(m->abort().state, task::CommandState::done);
  EXPECT_EQ(m->motion().digital_out >> 3 & 1U, 1U);
}

TEST(SafeState, MistakesInTheFileAreNamed) {
  for (const auto& [line, text] :
       {std::pair("motion.digital-out-03 maybe", "expected 0 or 1"),
        std::pair("motion.analog-out-01 much", "expected a number"),
        std::pair("motion.digital-out-99 0", "expected a number from")}) {
    MachineOptions options;
    options.append = std::string("[SAFE_STATE]\nPIN = ") + line + "\n";
    auto m = Machine::start(options);
    EXPECT_FALSE(m->ready()) << line;
    EXPECT_NE(m->errors().find(text), std::string::npos) << m->errors();
  }
}

}  // namespace
}  // namespace kerf::harness
