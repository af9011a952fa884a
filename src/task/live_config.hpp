// LiveConfig: the ini.* pins (manual: "INI settings", milltask(1)) as plain numbers, and what a change of them makes of the
// machine's description. Which pins there are, and what each stands for, is one table in live_config.cpp.
//
//   LiveConfig live(setup, ini);
//   ... make a pin for each of live.pins() ...
//   if (live.take(values, machine, complaints)) motion.config.write(machine);
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "motion/api/config.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

/// One pin of the component `inihal`. Values are in machine units, as in the INI file.
struct IniPin {
  enum class Type : std::uint8_t { real, integer, flag };
  std::string name;  ///< whole: "ini.0.max_velocity"
  Type type{Type::real};
  double initial{0};
};

class LiveConfig {
 public:
  /// What the INI file says is where all begins; `ini` only for keys that have a pin and no place in the setup.
  LiveConfig(const MachineSetup& setup, const ini::IniFile& ini);

  [[nodiscard]] const std::vector<IniPin>& pins() const noexcept { return pins_; }
  /// The pins' present values, in the order of pins(). What has changed goes into `machine`; true when that is anything. A value
  /// that cannot be is complained of once, and the last good one stays in force.
  bool take(std::span<const double> values, motion::MachineConfig& machine,
            std::vector<std::string>& complaints);

 private:
  enum class Rule : std::uint8_t { any, positive, not_negative };
  /// Where a value goes; none: the pin exists, and nothing depends on it here.
  enum class Kind : std::uint8_t { none, joint, axis, sequence, traj, planner_type };
  struct Place {
    Kind kind{Kind::none};
    Rule rule{Rule::any};
    std::size_t index{0};
    double unit{1};  ///< mm or degrees in one machine unit
    double motion::JointConfig::*joint{nullptr};
    double motion::AxisConfig::*axis{nullptr};
    double motion::MachineConfig::*traj{nullptr};
  };
  struct Table;

  void add(std::string name, IniPin::Type type, double initial, Place place);
  void add_joints(const MachineSetup& setup);
  void add_axes(const MachineSetup& setup);
  void add_traj(const MachineSetup& setup, const ini::IniFile& ini);
  /// "" or what is wrong with it.
  [[nodiscard]] static const char* wrong(const Place& place, double value) noexcept;
  static void apply(const Place& place, double value, motion::MachineConfig& machine);
  /// Pairs that belong together: keeps the last good ones of a pair that cannot be.
  void check_pairs(const motion::MachineConfig& old, motion::MachineConfig& next,
                   std::vector<std::string>& complaints) const;
  /// ini.traj_planner_type 0 switches all jerk limits off, 1 puts those of the pins in force.
  void apply_planner_type(motion::MachineConfig& machine) const;
  static bool same_object(const Place& a, const Place& b) noexcept;

  std::vector<IniPin> pins_;
  std::vector<Place> places_;
  std::size_t planner_type_{0};               ///< its pin
  std::vector<double> seen_;                  ///< of each pin, as last read
  std::vector<double> good_;                  ///< of each pin, as last accepted
  std::vector<bool> touched_;                 ///< pins that were ever changed
  std::vector<std::string> pair_complaints_;  ///< those that are true still, said before
  double linear_unit_mm_{1}, angular_unit_deg_{1};
};

/// What joints and axes that stand beyond a limit that has just changed are told of; a line each.
[[nodiscard]] std::vector<std::string> beyond_new_limits(const motion::MachineConfig& before,
                                                         const motion::MachineConfig& after,
                                                         std::span<const double> joint_position,
                                                         std::span<const bool> homed,
                                                         const MachineSetup& setup);

}  // namespace kerf::task
