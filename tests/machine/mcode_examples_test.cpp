// Each example of docs/m-codes.md runs on the simulated mill and does what its comments say:
//   ; hal: COMMAND                  before it starts
//   ; pauses: N                     how often the operator must resume it
//   ; at some time: PIN VALUE       in some servo cycle of the run
//   ; at the end: PIN VALUE
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

namespace fs = std::filesystem;
const std::string kFolder = KERF_SOURCE_DIR "/nc_files/examples/m-codes";

struct Expected {
  std::string pin;
  double value{0};
  bool seen{false};
};

struct Example {
  std::vector<std::string> hal;
  std::vector<Expected> at_some_time, at_the_end;
  int pauses{0};
};

Expected expected(const std::string& text) {
  std::istringstream in(text);
  Expected e;
  std::string value;
  in >> e.pin >> value;
  e.value = value == "TRUE" ? 1 : value == "FALSE" ? 0 : std::stod(value);
  return e;
}

Example read(const std::string& file) {
  Example example;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto behind = [&](const std::string& key) {
      return line.rfind("; " + key + ": ", 0) == 0 ? line.substr(key.size() + 4) : std::string();
    };
    if (const auto text = behind("hal"); !text.empty()) example.hal.push_back(text);
    if (const auto text = behind("pauses"); !text.empty()) example.pauses = std::stoi(text);
    if (const auto text = behind("at some time"); !text.empty())
      example.at_some_time.push_back(expected(text));
    if (const auto text = behind("at the end"); !text.empty())
      example.at_the_end.push_back(expected(text));
  }
  return example;
}

class MCodeExample : public testing::TestWithParam<std::string> {};

TEST_P(MCodeExample, DoesWhatItSays) {
  Example example = read(kFolder + "/" + GetParam() + ".ngc");
  EXPECT_FALSE(example.at_some_time.empty() && example.at_the_end.empty()) << "it says nothing";
  MachineOptions options;
  options.replace = {{"TOOL_CHANGE_POSITION = 0 0 0\n", ""}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  for (const auto& line : example.hal) EXPECT_TRUE(m->hal(line)) << line;
  m->on_cycle([&](const motion::MotionStatus&) {
    for (auto& e : example.at_some_time)
      e.seen = e.seen || std::abs(m->get(e.pin) - e.value) < 1e-6;
  });
  const auto run = m->start_program(kFolder + "/" + GetParam() + ".ngc");
  int pauses = 0;
  for (int i = 0; i < 6000 && !task::is_terminal(m->outcome(run).state); ++i) {
    m->run_for(0.01);
    if (!m->task().paused) continue;
    ++pauses;
    m->does({"resume"});
  }
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_EQ(pauses, example.pauses);
  m->run_for(0.05);
  for (const auto& e : example.at_some_time) EXPECT_TRUE(e.seen) << e.pin << ' ' << e.value;
  for (const auto& e : example.at_the_end) EXPECT_NEAR(m->get(e.pin), e.value, 1e-6) << e.pin;
}

std::vector<std::string> examples() {
  std::vector<std::string> out;
  for (const auto& file : fs::directory_iterator(kFolder))
    if (file.path().extension() == ".ngc") out.push_back(file.path().stem());
  return out;
}

INSTANTIATE_TEST_SUITE_P(All, MCodeExample, testing::ValuesIn(examples()),
                         [](const auto& example) { return example.param; });

}  // namespace
}  // namespace kerf::harness
