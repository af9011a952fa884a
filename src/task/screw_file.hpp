// Screw compensation files: [JOINT_n]COMP_FILE (LinuxCNC manual, "JOINT_<num> Section").
#pragma once

#include <string>

#include "motion/api/screw.hpp"

namespace kerf::task {

enum class ScrewFileType {
  positions = 0,  ///< nominal, where the joint truly is when going up, when going down
  offsets = 1,    ///< nominal, how much farther the motor has to be when going up, when going down
};

/// Reads lines of three numbers, nominals ascending; text behind # or ; is passed over. `unit`: mm or degrees in one unit of the
/// file. Gives "" or what is wrong, with its line; then the table is empty.
[[nodiscard]] std::string read_screw_file(const std::string& path, ScrewFileType type, double unit,
                                          motion::ScrewTable& table);

}  // namespace kerf::task
