#include "launcher/one_core.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "launcher/process.hpp"

namespace kerf::launcher {
namespace {

cpu_set_t cores_now() {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
  return set;
}

/// What a program that is started with these cores says of them.
std::string cores_of_a_child(const cpu_set_t* cores) {
  const std::string file = testing::TempDir() + "one-core-" + std::to_string(getpid());
  auto child = Child::start({"grep", "Cpus_allowed:", "/proc/self/status"},
                            {.output = file, .cores = cores});
  EXPECT_TRUE(child.ok());
  for (int i = 0; i < 2000 && child->running(); ++i) pause_ms(5);
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::filesystem::remove(file);
  return text.str();
}

TEST(OneCore, StaysOnACoreThatNobodyElseHasAndOthersHaveAll) {
  const cpu_set_t before = cores_now();
  const std::string usual = cores_of_a_child(nullptr);
  {
    OneCore first, second;
    EXPECT_EQ(first.all(), nullptr);
    const bool taken = first.take();
    const cpu_set_t mine = cores_now();
    if (!taken) {
      // One core only, or other machines have all of them: nothing changes.
      EXPECT_EQ(first.all(), nullptr);
      EXPECT_TRUE(CPU_EQUAL(&mine, &before));
      return;
    }
    EXPECT_EQ(CPU_COUNT(&mine), 1);
    EXPECT_NE(cores_of_a_child(nullptr), usual);
    ASSERT_NE(first.all(), nullptr);
    EXPECT_EQ(cores_of_a_child(first.all()), usual);
    EXPECT_FALSE(first.take()) << "twice";

    // Another machine.
    ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
    if (second.take()) {
      const cpu_set_t other = cores_now();
      EXPECT_EQ(CPU_COUNT(&other), 1);
      EXPECT_FALSE(CPU_EQUAL(&mine, &other));
    }
  }
  EXPECT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

}  // namespace
}  // namespace kerf::launcher
