// What LinuxCNC's components do, cycle by cycle, recorded by tests/hal/compare_with_peer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

namespace fs = std::filesystem;

struct Column {
  std::string pin;
  bool pulse{false};    ///< sets the pin where the row has a 1, else leaves it alone
  bool elapsed{false};  ///< no pin: time since the last call [ns]
};

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) out.push_back(part);
  return out;
}

double number(const hal::TestBuilder& hal, const std::string& name) {
  switch (hal.type(name)) {
    case hal::Type::bit: return hal.get<bool>(name) ? 1.0 : 0.0;
    case hal::Type::floating: return hal.get<double>(name);
    case hal::Type::s32: return hal.get<std::int32_t>(name);
    case hal::Type::u32: return hal.get<std::uint32_t>(name);
    default: throw std::logic_error(name + " has a type that LinuxCNC 2.9 does not have");
  }
}

void set(hal::TestBuilder& hal, const std::string& name, double value) {
  if (hal.type(name) == hal::Type::floating)
    hal.set(name, value);
  else
    hal.set(name, static_cast<std::int64_t>(value));
}

double parse(const std::string& word) {
  if (word == "TRUE") return 1.0;
  if (word == "FALSE") return 0.0;
  if (word.starts_with("0x")) return static_cast<double>(std::stoul(word, nullptr, 16));
  return std::stod(word);
}

/// `loadrt NAME words...` as the loader does it.
bool load(hal::TestBuilder& hal, const std::string& line) {
  auto words = split(line, ' ');
  const hal::Module& m = module(words[0]);
  std::vector<std::string> names;
  std::vector<std::string> personalities;
  std::size_t count = 1;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto equals = words[i].find('=');
    const std::string key = words[i].substr(0, equals), value = words[i].substr(equals + 1);
    if (key == "personality")
      personalities = split(value, ',');
    else if (key == "count" && !m.info.singleton)
      count = std::stoul(value);
    else if (key == "names" && !m.info.singleton)
      names = split(value, ',');
    else
      hal.set_arg(key, value);
  }
  if (names.empty()) {
    for (std::size_t i = 0; i < count; ++i) {
      names.emplace_back(m.info.name);
      if (!m.info.singleton) names.back() += "." + std::to_string(i);
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double personality = i < personalities.size() ? parse(personalities[i]) : 0.0;
    if (!hal.create(m, names[i], static_cast<std::int64_t>(personality))) return false;
  }
  return true;
}

class PeerRows : public testing::TestWithParam<fs::path> {};

TEST_P(PeerRows, AreOurs) {
  std::ifstream file(GetParam());
  hal::TestBuilder hal;
  std::int64_t period_ns = 1'000'000;
  std::vector<std::string> functions;
  std::vector<Column> inputs;
  std::vector<std::string> outputs;
  std::vector<std::vector<std::string>> nets;  // the first pin writes, the others read
  const auto connect = [&] {
    for (const auto& pins : nets)
      for (std::size_t i = 1; i < pins.size(); ++i) set(hal, pins[i], number(hal, pins[0]));
  };
  for (std::string line; std::getline(file, line) && line != "rows";) {
    if (line.starts_with("#")) continue;
    const auto blank = line.find(' ');
    const std::string word = line.substr(0, blank), rest = line.substr(blank + 1);
    if (word == "loadrt") {
      ASSERT_TRUE(load(hal, rest)) << hal.error();
    } else if (word == "period") {
      period_ns = std::stoll(rest);
    } else if (word == "setp") {
      const auto at = rest.find(' ');
      set(hal, rest.substr(0, at), parse(rest.substr(at + 1)));
    } else if (word == "net") {
      nets.push_back(split(rest, ' '));
    } else if (word == "addf") {
      functions.push_back(rest);
    } else if (word == "elapsed") {
      inputs.push_back({.pin = {}, .pulse = false, .elapsed = true});
    } else if (word == "in" || word == "pulse") {
      inputs.push_back({.pin = rest, .pulse = word == "pulse", .elapsed = false});
    } else if (word == "out") {
      outputs.push_back(rest);
    } else {
      FAIL() << "unknown word " << word;
    }
  }
  std::size_t row = 0;
  for (std::string line; std::getline(file, line); ++row) {
    const auto words = split(line, ' ');
    ASSERT_EQ(words.size(), inputs.size() + outputs.size());
    hal::Period period{period_ns, period_ns};
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const double value = parse(words[i]);
      if (inputs[i].elapsed)
        period.actual_ns = static_cast<std::int64_t>(value);
      else if (!inputs[i].pulse || value != 0.0)
        set(hal, inputs[i].pin, value);
    }
    for (const std::string& f : functions) {
      hal.run_once(f, period);
      connect();
    }
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const double theirs = parse(words[inputs.size() + i]), ours = number(hal, outputs[i]);
      const bool same = hal.type(outputs[i]) == hal::Type::floating
                            ? ours == theirs || (std::isnan(ours) && std::isnan(theirs)) ||
                                  std::abs(ours - theirs) <= 2e-6 + 1e-6 * std::abs(theirs)
                            : ours == theirs;
      ASSERT_TRUE(same) << outputs[i] << " in cycle " << row << ": ours " << ours << ", LinuxCNC "
                        << theirs << "\n"
                        << line;
    }
  }
  EXPECT_GT(row, 10U);
}

std::vector<fs::path> files() {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(KERF_SOURCE_DIR "/tests/hal/components"))
    if (entry.path().extension() == ".rows") out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

INSTANTIATE_TEST_SUITE_P(Components, PeerRows, testing::ValuesIn(files()),
                         [](const auto& file) { return file.param.stem().string(); });

}  // namespace
}  // namespace kerf::components
