#include "machines.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#define KERF_TEST_MODULE(id) extern "C" const kerf::hal::Module kerf_hal_module_##id;
#include "kinematics_modules.inc"
#undef KERF_TEST_MODULE

namespace kerf::motion::test {
namespace {

const std::map<std::string, const hal::Module*>& table() {
  static const std::map<std::string, const hal::Module*> all{
#define KERF_TEST_MODULE(id) {std::string(kerf_hal_module_##id.info.name), &kerf_hal_module_##id},
#include "kinematics_modules.inc"
#undef KERF_TEST_MODULE
  };
  return all;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

std::pair<std::string, std::string> halves(const std::string& text, char at) {
  const auto n = text.find(at);
  if (n == std::string::npos) throw std::logic_error("machines.tsv: " + text);
  return {text.substr(0, n), text.substr(n + 1)};
}

Range range_of(const std::string& text) {
  const auto [low, high] = halves(text, ':');
  return {std::stod(low), std::stod(high), text.back() == 'd', -1};
}

std::size_t axis_of(char letter) { return static_cast<std::size_t>(rtapi::axis_index(letter)); }

Machine read(const std::string& line) {
  std::vector<std::string> field;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, '\t');) field.push_back(part);
  if (field.size() != 8) throw std::logic_error("machines.tsv has 8 fields a line: " + line);
  Machine m;
  m.name = field[0];
  m.module = field[1];
  m.kind = std::stoi(field[2]);
  for (const auto& word : words(field[3])) m.args.push_back(halves(word, '='));
  for (const auto& word : words(field[4])) {
    const auto [pin, value] = halves(word, '=');
    m.pins.emplace_back(pin, std::stod(value));
  }
  for (const auto& word : words(field[5])) {
    if (word[0] == '=') {
      Range beside;
      beside.same_as = std::stoi(word.substr(1));
      m.joints.push_back(beside);
    } else if (std::isalpha(static_cast<unsigned char>(word[0])) != 0) {
      const std::size_t axis = axis_of(word[0]);
      Range range = range_of(word.substr(2));
      range.degrees = rtapi::is_rotary(axis);
      m.axes.emplace_back(axis, range);
    } else {
      m.joints.push_back(range_of(word));
    }
  }
  m.size_mm = std::stod(field[6]);
  if (field[7] != "-")
    m.out_of_reach.emplace_back(axis_of(field[7][0]), std::stod(field[7].substr(2)));
  return m;
}

}  // namespace

const std::vector<Machine>& machines() {
  static const std::vector<Machine> all = [] {
    std::ifstream in(KERF_SOURCE_DIR "/tests/property/components/kinematics/machines.tsv");
    std::vector<Machine> out;
    for (std::string line; std::getline(in, line);)
      if (!line.empty() && line[0] != '#') out.push_back(read(line));
    if (out.empty()) throw std::logic_error("machines.tsv is empty or missing");
    return out;
  }();
  return all;
}

const Machine& machine(const std::string& name) {
  for (const Machine& m : machines())
    if (m.name == name) return m;
  throw std::logic_error("no machine " + name + " in machines.tsv");
}

std::vector<std::string> modules() {
  std::vector<std::string> out;
  for (const auto& [name, module] : table()) out.push_back(name);
  return out;
}

Loaded::Loaded(const Machine& machine) {
  for (const auto& [name, text] : machine.args) hal_.set_arg(name, text);
  const auto module = table().find(machine.module);
  if (module == table().end()) throw std::logic_error("no module " + machine.module);
  EXPECT_TRUE(hal_.create(*module->second, machine.module)) << hal_.error();
  for (const auto& [pin, value] : machine.pins) {
    const std::string name = machine.module + "." + pin;
    if (hal_.type(name) == hal::Type::floating)
      hal_.set(name, value);
    else
      hal_.set(name, static_cast<std::int64_t>(value));
  }
  kinematics_ = static_cast<Kinematics*>(hal_.find_service(kKinematicsService));
  EXPECT_NE(kinematics_, nullptr);
  EXPECT_TRUE(kinematics_->switch_to(machine.kind));
}

bool random_pose(const Machine& m, const Kinematics& kinematics, std::mt19937_64& random,
                 JointVector& joint, Pose& world) {
  const auto some = [&](const Range& r) {
    return std::uniform_real_distribution<double>(r.low, r.high)(random);
  };
  joint = {};
  world = {};
  if (!m.axes.empty()) {
    for (const auto& [axis, range] : m.axes) world[axis] = some(range);
    return kinematics.inverse(world, joint);
  }
  for (std::size_t j = 0; j < m.joints.size(); ++j)
    joint[j] = m.joints[j].same_as >= 0 ? joint[static_cast<std::size_t>(m.joints[j].same_as)]
                                        : some(m.joints[j]);
  return kinematics.forward(joint, world);
}

}  // namespace kerf::motion::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto number = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
    if (std::string(argv[i]) == "--count") kerf::motion::test::poses = number;
    if (std::string(argv[i]) == "--seed") kerf::motion::test::seed = number;
  }
  return RUN_ALL_TESTS();
}
