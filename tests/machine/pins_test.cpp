// The pins of the running machine against the documented ones, and the limits of every joint over a whole part.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

TEST(Pins, NoneOfTheDocumentedIsMissing) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  std::ifstream list(KERF_SOURCE_DIR "/tests/machine/documented_pins.tsv");
  std::string line;
  int checked = 0;
  while (std::getline(list, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string type, dir, name;
    words >> type >> dir >> name;
    type += " ";
    type += dir;
    EXPECT_EQ(m->pin_kind(name), type) << name;
    ++checked;
  }
  EXPECT_GT(checked, 380);
}

TEST(Pins, NoneOfTheDocumentedParametersIsMissing) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  std::ifstream list(KERF_SOURCE_DIR "/tests/machine/documented_parameters.tsv");
  std::string type, dir, name, line;
  int checked = 0;
  while (std::getline(list, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    words >> type >> dir >> name;
    type += " ";
    type += dir;
    EXPECT_EQ(m->parameter_kind(name), type) << name;
    ++checked;
  }
  EXPECT_GT(checked, 25);
}

TEST(Limits, NoJointExceedsThemInTheFirstPart) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const double max_v[3]{100, 100, 60};
  const double max_a[3]{1000, 1000, 600};
  double p[3]{}, v[3]{};
  double peak_v[3]{}, peak_a[3]{};
  std::uint64_t cycles = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    for (int j = 0; j < 3; ++j) {
      const double now = s.joint[j].pos_cmd;
      const double vel = (now - p[j]) / 0.001;
      if (cycles > 1) {
        peak_v[j] = std::max(peak_v[j], std::abs(vel) / max_v[j]);
        peak_a[j] = std::max(peak_a[j], std::abs(vel - v[j]) / 0.001 / max_a[j]);
      }
      p[j] = now;
      v[j] = vel;
    }
    ++cycles;
  });
  const auto reply = m->run_program(KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text;
  for (int j = 0; j < 3; ++j) {
    EXPECT_LE(peak_v[j], 1.0001) << "joint " << j;
    EXPECT_LE(peak_a[j], 1.001) << "joint " << j;
    EXPECT_GT(peak_a[j], 0.5) << "joint " << j << " hardly moved: this test sees nothing";
  }
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(Messages, OfRealtimeComponentsReachTheOperator) {
  MachineOptions options;
  options.hal = {"loadrt message messages=\"oil is low\"", "addf message.0 servo-thread"};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  m->run_for(0.1);
  EXPECT_EQ(m->errors().find("oil is low"), std::string::npos);
  ASSERT_TRUE(m->hal("setp message.0.trigger 1"));
  m->run_for(0.1);
  EXPECT_NE(m->errors().find("oil is low"), std::string::npos) << m->errors();
}

}  // namespace
}  // namespace kerf::harness
