// What task sends to motion, as text: one line a command, made from the declarations in motion/api.
//
//   linear-move line=2 end=5,0,0,0,0,0,0,0,0 vel=10 kind=feed
//
// A name, then NAME=VALUE for each field in the order of its declaration. Lengths in mm, angles in degrees, velocities in mm/s; poses are
// X,Y,Z,A,B,C,U,V,W in machine coordinates. Numbers have at most six decimals.
#pragma once

#include <string>
#include <vector>

#include "motion/api/config.hpp"
#include "motion/api/intent.hpp"
#include "motion/api/path_items.hpp"

namespace kerf::motion_logger {

[[nodiscard]] std::string text_of(const motion::PathItem& item);

/// The words of the intent cell that stand beside its values.
struct IntentWords {
  std::uint32_t abort_epoch{1};
  bool enable{false}, hold{false};
};

/// A line for each wish that differs.
[[nodiscard]] std::vector<std::string> changes(const IntentWords& before, const IntentWords& now);
/// `spindles`: how many the machine has.
[[nodiscard]] std::vector<std::string> changes(const motion::Intent& before,
                                               const motion::Intent& now, std::int32_t spindles);
/// A line for the machine, and for each joint, axis and spindle that differs.
[[nodiscard]] std::vector<std::string> changes(const motion::MachineConfig& before,
                                               const motion::MachineConfig& now);

/// All lines that there are, with their fields, for the manual page (roff).
[[nodiscard]] std::string manual_list();

}  // namespace kerf::motion_logger
