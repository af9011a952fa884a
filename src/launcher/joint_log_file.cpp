#include "launcher/joint_log_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstring>

namespace kerf::launcher {

std::string joint_log_header(int joints) {
  std::string out =
      "# kerf joint log 1: one line a servo cycle; time in ns, then the commanded position of each "
      "joint in mm or degrees\n# time";
  for (int i = 0; i < joints; ++i) out += " joint." + std::to_string(i);
  return out + "\n";
}

std::string joint_log_line(const motion::JointSample& sample) {
  char text[40];
  std::snprintf(text, sizeof text, "%" PRId64, sample.time_ns);
  std::string line = text;
  const int n = std::clamp<int>(sample.joints, 0, static_cast<int>(motion::kMaxJoints));
  for (int i = 0; i < n; ++i) {
    // 17 digits give the very same double back.
    std::snprintf(text, sizeof text, " %.17g", sample.joint[i]);
    line += text;
  }
  return line + "\n";
}

rtapi::Status JointLogFile::open(const std::string& path) {
  path_ = path;
  file_ = std::fopen(path.c_str(), "we");
  if (file_ == nullptr)
    return rtapi::fail(rtapi::Errc::system,
                       "--log-joints: cannot write " + path + ": " + std::strerror(errno));
  return {};
}

void JointLogFile::add(const motion::JointSample& sample) {
  // Before task has told motion what the machine is, there are no joints.
  if (file_ == nullptr || sample.joints == 0) return;
  if (!headed_ && std::fputs(joint_log_header(sample.joints).c_str(), file_) < 0) failed_ = true;
  headed_ = true;
  if (std::fputs(joint_log_line(sample).c_str(), file_) < 0) failed_ = true;
}

rtapi::Status JointLogFile::close() {
  if (file_ == nullptr) return {};
  const bool bad = std::fclose(file_) != 0 || failed_;
  file_ = nullptr;
  if (bad) return rtapi::fail(rtapi::Errc::system, "--log-joints: could not write all of " + path_);
  return {};
}

}  // namespace kerf::launcher
