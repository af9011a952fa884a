// JointWatch: what the joints of a machine are commanded to do, cycle by cycle, against the limits of its INI file.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "harness/machine.hpp"
#include "ini/ini_file.hpp"
#include "motion/api/status.hpp"

namespace kerf::harness {

/// One number of the INI file; absent, the test fails.
inline double ini_number(const ini::IniFile& file, const std::string& section,
                         const std::string& key) {
  const ini::Entry* entry = file.find(section, key);
  EXPECT_NE(entry, nullptr) << "[" << section << "]" << key;
  return entry != nullptr ? std::stod(entry->value) : 0.0;
}

/// Gives each joint of options.ini a limit of its jerk, with which it reaches its acceleration within `ramp_s`. Gives these limits.
inline std::vector<double> limit_jerk(MachineOptions& options, std::size_t joints, double ramp_s) {
  const auto loaded = ini::IniFile::load(options.ini);
  std::vector<double> jerk;
  for (std::size_t j = 0; j < joints; ++j) {
    const std::string section = "JOINT_" + std::to_string(j), head = "[" + section + "]\n";
    jerk.push_back(ini_number(loaded.file, section, "MAX_ACCELERATION") / ramp_s);
    options.replace.push_back({head, head + "MAX_JERK = " + std::to_string(jerk[j]) + "\n"});
  }
  return jerk;
}

/// Machines of 1 ms. A machine that is off, or homes, has no history.
class JointWatch {
 public:
  /// `jerk`: limits of each joint; empty, or 0: not limited.
  JointWatch(const std::string& ini, std::size_t joints, const std::vector<double>& jerk = {})
      : joints_(joints) {
    const auto loaded = ini::IniFile::load(ini);
    EXPECT_TRUE(loaded.ok);
    for (std::size_t j = 0; j < joints; ++j) {
      const std::string section = "JOINT_" + std::to_string(j);
      Joint& joint = joints_[j];
      joint.max_vel = ini_number(loaded.file, section, "MAX_VELOCITY") * 1.0001;
      joint.max_acc = ini_number(loaded.file, section, "MAX_ACCELERATION") * 1.001;
      if (j < jerk.size() && jerk[j] > 0) joint.max_jerk = jerk[j] * 1.01;
      joint.low = ini_number(loaded.file, section, "MIN_LIMIT");
      joint.high = ini_number(loaded.file, section, "MAX_LIMIT");
    }
  }
  /// What is broken in this cycle, or "". Rounding of differences is not.
  std::string look(const motion::MotionStatus& s) {
    constexpr double kDtS = 0.001;
    // Where motors have coasted to it begins to stand.
    if (!s.enabled || s.homing_active) known_ = -1;
    std::string broken;
    moves_ = false;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      Joint& joint = joints_[j];
      const double at = s.joint[j].pos_cmd, vel = (at - joint.at) / kDtS,
                   acc = (vel - joint.vel) / kDtS, jerk = (acc - joint.acc) / kDtS;
      const auto take = [&](int cycles, double value, double& peak, double limit, double rounding,
                            const char* what) {
        if (known_ < cycles) return;
        peak = std::max(peak, std::abs(value));
        if (std::abs(value) > limit + rounding)
          broken += " joint " + std::to_string(j) + " " + what + " " + std::to_string(value) +
                    " of " + std::to_string(limit) + ";";
      };
      take(1, vel, joint.peak_vel, joint.max_vel, 1e-6, "velocity");
      take(2, acc, joint.peak_acc, joint.max_acc, 1e-4, "acceleration");
      take(3, jerk, joint.peak_jerk, joint.max_jerk, 0.1, "jerk");
      if (known_ > 0) {
        joint.least = std::min(joint.least, at);
        joint.most = std::max(joint.most, at);
        // Back from where a motor has coasted to is no way out.
        const bool outside =
            (at < joint.low - 1e-6 && at < joint.at) || (at > joint.high + 1e-6 && at > joint.at);
        if (s.all_homed && outside)
          broken += " joint " + std::to_string(j) + " at " + std::to_string(at) + ";";
      }
      moves_ = moves_ || std::abs(at - joint.at) > kMoves;
      joint.at = at;
      joint.vel = vel;
      joint.acc = acc;
    }
    ++known_;
    ++cycles_;
    return broken;
  }
  /// A joint was commanded elsewhere in the last cycle.
  [[nodiscard]] bool moves() const { return moves_; }
  [[nodiscard]] std::uint64_t cycles() const { return cycles_; }
  /// All of it: within the limits, and every joint has moved.
  void check() const {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const Joint& joint = joints_[j];
      EXPECT_LE(joint.peak_vel, joint.max_vel) << "joint " << j;
      EXPECT_LE(joint.peak_acc, joint.max_acc) << "joint " << j;
      EXPECT_LE(joint.peak_jerk, joint.max_jerk) << "joint " << j;
      EXPECT_GE(joint.least, joint.low - 1e-9) << "joint " << j;
      EXPECT_LE(joint.most, joint.high + 1e-9) << "joint " << j;
      EXPECT_GT(joint.most - joint.least, 1.0) << "joint " << j << " hardly moved";
    }
  }

 private:
  static constexpr double kMoves = 1e-9;  ///< in a cycle; rounding is below
  struct Joint {
    double max_vel{0}, max_acc{0}, max_jerk{1e99}, low{0}, high{0};  ///< with what tests allow
    double at{0}, vel{0}, acc{0}, least{1e9}, most{-1e9};
    double peak_vel{0}, peak_acc{0}, peak_jerk{0};
  };
  std::vector<Joint> joints_;
  int known_{0};  ///< cycles since the last one without history
  bool moves_{false};
  std::uint64_t cycles_{0};
};

}  // namespace kerf::harness
