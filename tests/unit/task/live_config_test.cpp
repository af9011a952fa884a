// The ini.* pins as numbers: what each stands for, and what is refused.
#include "task/live_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig.hpp"

namespace kerf::task {
namespace {

struct Live {
  explicit Live(std::string text = testing::kMillIni) {
    loaded = ini::IniFile::load(folder.write("test.ini", text));
    auto read = read_machine_setup(loaded.file);
    EXPECT_TRUE(read.ok) << read.text();
    setup = std::move(read.setup);
    machine = setup.motion;
    config = std::make_unique<LiveConfig>(setup, loaded.file);
    for (const auto& pin : config->pins()) values.push_back(pin.initial);
  }
  double& value(const std::string& name) {
    const auto& pins = config->pins();
    const auto at =
        std::find_if(pins.begin(), pins.end(), [&](const auto& pin) { return pin.name == name; });
    EXPECT_NE(at, pins.end()) << name;
    return values[static_cast<std::size_t>(at - pins.begin()) % values.size()];
  }
  bool take() {
    complaints.clear();
    return config->take(values, machine, complaints);
  }
  testing::TempFolder folder;
  ini::LoadResult loaded;
  MachineSetup setup;
  motion::MachineConfig machine;
  std::unique_ptr<LiveConfig> config;
  std::vector<double> values;
  std::vector<std::string> complaints;
};

std::string inch(std::string text) {
  const std::string mm = "LINEAR_UNITS = mm";
  return text.replace(text.find(mm), mm.size(), "LINEAR_UNITS = inch");
}

TEST(LiveConfig, BeginsWithTheIniFileAndChangesNothing) {
  Live live;
  EXPECT_EQ(live.value("ini.0.max_velocity"), 50);
  EXPECT_EQ(live.value("ini.z.max_velocity"), 30);
  EXPECT_EQ(live.value("ini.traj_max_velocity"), 50);
  EXPECT_EQ(live.value("ini.a.max_velocity"), 0) << "an axis that the machine has not";
  EXPECT_EQ(live.value("ini.traj_arc_blend_enable"), 1);
  EXPECT_FALSE(live.take());
  EXPECT_TRUE(live.complaints.empty());
}

TEST(LiveConfig, EachPinReachesItsOwnValueOnly) {
  Live live(inch(testing::kMillIni));
  const motion::MachineConfig before = live.machine;
  live.value("ini.1.max_acceleration") = 100;
  EXPECT_TRUE(live.take());
  motion::MachineConfig want = before;
  want.joint[1].max_acc = 2540;
  const auto& now = live.machine;
  EXPECT_NEAR(now.joint[1].max_acc, want.joint[1].max_acc, 1e-9);
  EXPECT_EQ(now.joint[0].max_acc, before.joint[0].max_acc);
  EXPECT_EQ(now.joint[1].max_vel, before.joint[1].max_vel);
  live.value("ini.x.max_velocity") = 1;
  live.value("ini.2.home_sequence") = -3;
  live.value("ini.2.home") = 2;
  live.value("ini.traj_max_velocity") = 0.5;
  EXPECT_TRUE(live.take());
  EXPECT_NEAR(now.axis[0].max_vel, 25.4, 1e-12);
  EXPECT_EQ(now.joint[2].home_sequence, -3);
  EXPECT_NEAR(now.joint[2].home, 50.8, 1e-12);
  EXPECT_NEAR(now.traj_max_vel_mm_s, 12.7, 1e-12);
  EXPECT_FALSE(live.take()) << "nothing new";
}

TEST(LiveConfig, BadValuesAreNamedOnceAndTheOldOnesStay) {
  Live live;
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    live.value("ini.0.max_velocity") = bad;
    EXPECT_FALSE(live.take());
    ASSERT_EQ(live.complaints.size(), 1U);
    EXPECT_NE(live.complaints[0].find("ini.0.max_velocity"), std::string::npos);
    EXPECT_NE(live.complaints[0].find("50 stays"), std::string::npos) << live.complaints[0];
    EXPECT_FALSE(live.take());
    EXPECT_TRUE(live.complaints.empty()) << "said twice";
  }
  EXPECT_EQ(live.machine.joint[0].max_vel, 50);
  live.value("ini.0.max_velocity") = 40;
  EXPECT_TRUE(live.take());
  EXPECT_EQ(live.machine.joint[0].max_vel, 40);
}

TEST(LiveConfig, LimitsThatCrossStayUntilBothAreRight) {
  Live live;
  live.value("ini.0.min_limit") = -10;
  live.value("ini.0.max_limit") = 10;
  EXPECT_TRUE(live.take());
  live.value("ini.0.min_limit") = 20;
  live.take();
  ASSERT_EQ(live.complaints.size(), 1U);
  EXPECT_NE(live.complaints[0].find("stay -10 and 10"), std::string::npos) << live.complaints[0];
  EXPECT_EQ(live.machine.joint[0].min_limit, -10);
  live.value("ini.1.home") = 1;
  live.take();
  EXPECT_TRUE(live.complaints.empty()) << "said twice";
  live.value("ini.0.max_limit") = 30;
  EXPECT_TRUE(live.take());
  EXPECT_EQ(live.machine.joint[0].min_limit, 20);
  EXPECT_EQ(live.machine.joint[0].max_limit, 30);
}

TEST(LiveConfig, MinFerrorIsNeverAboveFerror) {
  Live live;
  live.value("ini.0.ferror") = 1;
  live.value("ini.0.min_ferror") = 2;
  live.take();
  EXPECT_EQ(live.machine.joint[0].min_ferror, 1);
  live.value("ini.0.ferror") = 3;
  live.take();
  EXPECT_EQ(live.machine.joint[0].min_ferror, 2);
}

TEST(LiveConfig, TellsWhoStandsBeyondANewLimit) {
  Live live;
  motion::MachineConfig before = live.machine, after = before;
  after.joint[1].max_limit = 5;
  const double at[] = {7, 7, 7};
  const bool homed[] = {true, true, true};
  const auto told = beyond_new_limits(before, after, at, homed, live.setup);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("joint 1 stands at 7, beyond ini.1.max_limit = 5"), std::string::npos)
      << told[0];
}

}  // namespace
}  // namespace kerf::task
