// The rows of the table, by file (internal to src/ini).
#pragma once

#include "ini/keys.hpp"

namespace kerf::ini::keys {

inline constexpr std::string_view kUnits = "units";
inline constexpr std::string_view kPerSecond = "units/s";
inline constexpr std::string_view kPerSecond2 = "units/s^2";
inline constexpr std::string_view kPerSecond3 = "units/s^3";
inline constexpr std::string_view kSeconds = "s";
inline constexpr std::string_view kNanoseconds = "ns";
inline constexpr std::string_view kRpm = "rpm";
inline constexpr std::string_view kDegrees = "degrees";

extern const std::span<const Key> emc_keys, emcmot_keys, task_keys, hal_keys, halui_keys,
    applications_keys, emcio_keys, filter_keys, python_keys, wizard_keys, mtconnect_keys, kerf_keys,
    safe_state_keys;                              // programs.cpp
extern const std::span<const Key> display_keys;   // display.cpp
extern const std::span<const Key> rs274ngc_keys;  // interpreter.cpp
extern const std::span<const Key> traj_keys, kins_keys, axis_keys, joint_keys,
    spindle_keys;  // motion.cpp

}  // namespace kerf::ini::keys
