#include "task/position_file.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>
#include <vector>

#include "io/tool_table.hpp"

namespace kerf::task {

using rtapi::Errc;

rtapi::Status load_positions(const std::string& file, MachineSetup& setup) {
  auto text = io::read_file(file);
  if (!text.ok()) {
    if (text.error().code == Errc::not_found) return {};
    return rtapi::Failure{text.error()};
  }
  const auto joints = static_cast<std::size_t>(setup.motion.joints);
  std::istringstream in(*text);
  std::vector<double> positions;
  for (double value = 0; positions.size() < joints && in >> value && std::isfinite(value);)
    positions.push_back(value);
  if (positions.size() < joints)
    return rtapi::fail(Errc::syntax, file + ":" + std::to_string(positions.size() + 1) +
                                         ": expected the position of each of " +
                                         std::to_string(joints) +
                                         " joints, a number a line; joints begin at their motors' "
                                         "positions");
  for (std::size_t j = 0; j < joints; ++j) {
    setup.motion.joint[j].start = positions[j] * setup.joint_unit[j];
    setup.motion.joint[j].has_start = true;
  }
  return {};
}

rtapi::Status save_positions(const std::string& file, const MachineSetup& setup,
                             const motion::MotionStatus& status) {
  std::string text;
  for (std::size_t j = 0; j < static_cast<std::size_t>(setup.motion.joints); ++j) {
    char line[64];
    // Seventeen digits behind the point, as LinuxCNC writes them: nothing is lost from one run to the next.
    std::snprintf(line, sizeof line, "%.17f\n", status.joint[j].pos_fb / setup.joint_unit[j]);
    text += line;
  }
  return io::write_file_whole(file, text);
}

}  // namespace kerf::task
