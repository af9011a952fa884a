// What holds for every component, and the list of documented names, types, directions and defaults.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

struct Documented {
  std::string name, type, dir, value;
};

/// Component name to its documented items.
std::map<std::string, std::vector<Documented>> documented() {
  std::ifstream file(KERF_SOURCE_DIR "/tests/unit/components/documented_items.tsv");
  std::map<std::string, std::vector<Documented>> table;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    std::string component;
    Documented item;
    fields >> component >> item.name >> item.type >> item.dir >> item.value;
    table[component].push_back(item);
  }
  return table;
}

/// The loadrt parameters of the component's own example.
void set_sample_args(hal::TestBuilder& hal, const hal::Module& m) {
  std::istringstream words{std::string(m.info.example)};
  for (std::string word; words >> word;)
    hal.set_arg(word.substr(0, word.find('=')), word.substr(word.find('=') + 1));
}

/// Makes the component with the loadrt parameters of the table, "NAME=VALUE" with the type "loadrt".
void create_all(hal::TestBuilder& hal, const std::string& component,
                const std::vector<Documented>& items) {
  std::string personality = "0";
  for (const Documented& item : items) {
    if (item.type != "loadrt") continue;
    const auto equals = item.name.find('=');
    const std::string key = item.name.substr(0, equals), value = item.name.substr(equals + 1);
    if (key == "personality")
      personality = value;
    else
      hal.set_arg(key, value);
  }
  const hal::Module& m = module(component);
  hal.create(m, first_prefix(m), std::stol(personality, nullptr, 0));
}

std::string dir_text(hal::Dir dir) {
  switch (dir) {
    case hal::Dir::in: return "in";
    case hal::Dir::out: return "out";
    case hal::Dir::io: return "io";
    case hal::Dir::ro: return "ro";
    case hal::Dir::rw: return "rw";
    default: return "?";
  }
}

std::string type_text(hal::Type type) {
  switch (type) {
    case hal::Type::bit: return "bit";
    case hal::Type::floating: return "float";
    case hal::Type::s32: return "s32";
    case hal::Type::u32: return "u32";
    default: return "?";
  }
}

double value_of(const hal::TestBuilder& hal, const std::string& name) {
  switch (hal.type(name)) {
    case hal::Type::bit: return hal.get<bool>(name) ? 1.0 : 0.0;
    case hal::Type::floating: return hal.get<double>(name);
    case hal::Type::s32: return hal.get<std::int32_t>(name);
    case hal::Type::u32: return hal.get<std::uint32_t>(name);
    default: return -12345.0;
  }
}

TEST(Components, ExportWhatTheManualPagesName) {
  const auto table = documented();
  ASSERT_GT(table.size(), 10U);
  for (const auto& [component, items] : table) {
    SCOPED_TRACE(component);
    hal::TestBuilder hal;
    create_all(hal, component, items);
    ASSERT_TRUE(hal.error().empty()) << hal.error();
    const auto functions = hal.functions();
    for (const Documented& item : items) {
      if (item.type == "loadrt") continue;
      SCOPED_TRACE(item.name);
      if (item.type == "function") {
        EXPECT_EQ(std::count(functions.begin(), functions.end(), item.name), 1);
        continue;
      }
      ASSERT_TRUE(hal.has(item.name));
      EXPECT_EQ(type_text(hal.type(item.name)), item.type);
      EXPECT_EQ(dir_text(hal.dir(item.name)), item.dir);
      EXPECT_DOUBLE_EQ(value_of(hal, item.name), std::stod(item.value));
    }
  }
}

TEST(Components, DescribeThemselvesAndAllTheirPins) {
  std::set<std::string_view> names;
  for (const hal::Module* m : all_modules()) {
    SCOPED_TRACE(m->info.name);
    EXPECT_TRUE(names.insert(m->info.name).second) << "two components have this name";
    EXPECT_EQ(m->abi, hal::kModuleAbi);
    EXPECT_GT(m->info.summary.size(), 5U);
    EXPECT_FALSE(m->info.summary.ends_with('.')) << "a summary is a title";
    EXPECT_TRUE(m->info.notes.ends_with('.')) << "notes are whole sentences";
    EXPECT_EQ(m->info.license, "MIT");
    hal::TestBuilder hal;
    set_sample_args(hal, *m);
    ASSERT_TRUE(hal.create(*m, first_prefix(*m))) << hal.error();
    for (const std::string& item : hal.items()) {
      EXPECT_GT(hal.doc(item).size(), 4U) << item;
      EXPECT_FALSE(hal.doc(item).ends_with('.')) << item;
    }
  }
}

TEST(Components, RunOnDefaultValuesForASecond) {
  for (const hal::Module* m : all_modules()) {
    SCOPED_TRACE(m->info.name);
    hal::TestBuilder hal;
    set_sample_args(hal, *m);
    ASSERT_TRUE(hal.create(*m, first_prefix(*m))) << hal.error();
    for (const std::string& function : hal.functions()) hal.run(function, 1'000'000, 1000);
    for (const std::string& item : hal.items()) {
      EXPECT_EQ(value_of(hal, item), value_of(hal, item)) << item << " is not a number";
    }
  }
}

}  // namespace
}  // namespace kerf::components
