// A whole machine: from the INI file to joint positions.
#include <gtest/gtest.h>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

TEST(Machine, StartsHomesAndMovesByMdi) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_TRUE(m->motion().all_homed);
  EXPECT_TRUE(m->mdi("G0 X10 Y20 Z-5")) << m->errors();
  EXPECT_NEAR(m->joint(0), 10, 1e-9);
  EXPECT_NEAR(m->joint(1), 20, 1e-9);
  EXPECT_NEAR(m->joint(2), -5, 1e-9);
  EXPECT_NEAR(m->get("joint.0.motor-pos-cmd"), m->get("joint.0.motor-pos-fb"), 1.0);
}

TEST(Machine, CutsTheFirstPart) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto reply = m->run_program(KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << "\n" << m->errors();
  EXPECT_GT(m->now(), 30 * rtapi::kSecond);
}

TEST(Machine, StartsFromTclFilesInTwoPasses) {
  MachineOptions options;
  options.ini = KERF_SOURCE_DIR "/configs/sim/tcl-mill/two-pass.ini";
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_TRUE(m->mdi("G0 X10")) << m->errors();
  EXPECT_NEAR(m->joint(0), 10, 1e-9);
  EXPECT_EQ(m->pin_kind("acc-2.out"), "float OUT");
  EXPECT_EQ(m->pin_kind("spindle-acc.out"), "float OUT");
}

TEST(Machine, AWrongTclFileIsNamed) {
  MachineOptions options;
  options.ini = KERF_SOURCE_DIR "/configs/sim/tcl-mill/tcl-mill.ini";
  options.replace = {{"spindle-motor 100", "spindle-motor fast"}};
  auto m = Machine::start(options);
  EXPECT_FALSE(m->ready());
  EXPECT_NE(m->errors().find("spindle.tcl:7: invalid bareword \"fast\""), std::string::npos)
      << m->errors();
}

}  // namespace
}  // namespace kerf::harness
