// linuxcnctop's rows: every attribute has a text and a JSON value under its documented name.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "clients/top/rows.hpp"

namespace kerf::clients::top {
namespace {

Stat machine() {
  Stat s;
  s.axis_mask = 0b101;
  s.joints = 2;
  s.spindles = 1;
  s.task_state = 4;
  s.exec_state = 10;
  s.position.x = 1.5;
  s.position.z = -2;
  s.gcodes = {800, 170, 591, -1};
  std::fill(s.gcodes.begin() + 3, s.gcodes.end(), -1);
  s.mcodes.fill(-1);
  s.mcodes[0] = 5;
  s.file = "part \"1\".ngc";
  s.joint[1].homed = true;
  s.tool_table = {ToolStat{}};
  return s;
}

TEST(Top, NamesAreSortedAndThoseOfTheStatus) {
  const auto all = names();
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  EXPECT_GT(all.size(), 85U);
  for (const char* name :
       {"position", "task_state", "tool_table", "joint", "velocity", "g92_offset"})
    EXPECT_NE(std::find(all.begin(), all.end(), name), all.end()) << name;
}

TEST(Top, TextNamesStatesAndLetters) {
  const Stat s = machine();
  EXPECT_EQ(text(s, "task_state"), "STATE_ON");
  EXPECT_EQ(text(s, "exec_state"), "EXEC_WAITING_FOR_SPINDLE_ORIENTED");
  EXPECT_EQ(text(s, "position"), "X1.5 Z-2");
  EXPECT_EQ(text(s, "gcodes"), "G80 G17 G59.1");
  EXPECT_EQ(text(s, "mcodes"), "M5");
  EXPECT_EQ(text(s, "estop"), "yes");
  EXPECT_NE(text(s, "joint").find("\n1: "), std::string::npos) << text(s, "joint");
  EXPECT_EQ(text(s, "motion_type"), "0") << "a number without a name";
  EXPECT_EQ(text(s, "nonsense"), "");
  EXPECT_EQ(text(s, "waiting_for"), "-");
}

TEST(Top, SaysWhatItWaitsFor) {
  Stat s = machine();
  s.waiting_for.object = rtapi::FixedString<63>("the probe");
  s.waiting_for.pin = rtapi::FixedString<63>("motion.probe-input");
  s.waiting_for.net = rtapi::FixedString<63>("touched");
  EXPECT_EQ(text(s, "waiting_for"), "the probe: motion.probe-input, net touched");
  const auto all = nlohmann::json::parse(json(s, {}));
  EXPECT_EQ(all["waiting_for"]["pin"], "motion.probe-input");
  EXPECT_TRUE(nlohmann::json::parse(json(machine(), {}))["waiting_for"].is_null());
}

TEST(Top, JsonHasPythonsNumbersAndShapes) {
  const auto all = nlohmann::json::parse(json(machine(), {}));
  EXPECT_EQ(all.size(), names().size());
  EXPECT_EQ(all["task_state"], 4);
  EXPECT_EQ(all["position"].size(), 9U);
  EXPECT_EQ(all["axis"].size(), 9U);
  EXPECT_EQ(all["joint"].size(), 2U);
  EXPECT_EQ(all["joint"][1]["homed"], true);
  EXPECT_EQ(all["gcodes"].size(), 17U);
  EXPECT_EQ(all["file"], "part \"1\".ngc");
  EXPECT_EQ(all["tool_table"][0]["id"], -1);
  const std::vector<std::string> two{"position", "file"};
  EXPECT_EQ(nlohmann::json::parse(json(machine(), two)).size(), 2U);
}

}  // namespace
}  // namespace kerf::clients::top
