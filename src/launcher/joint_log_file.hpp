// The text file of --log-joints.
#pragma once

#include <cstdio>
#include <string>

#include "motion/api/joint_log.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::launcher {

/// Head of the file, ended lines.
[[nodiscard]] std::string joint_log_header(int joints);
/// One cycle: time in ns, then each joint's commanded position with all its digits; an ended line.
[[nodiscard]] std::string joint_log_line(const motion::JointSample& sample);

class JointLogFile {
 public:
  /// Makes the file anew.
  [[nodiscard]] rtapi::Status open(const std::string& path);
  ~JointLogFile() { (void)close(); }
  JointLogFile() = default;
  JointLogFile(const JointLogFile&) = delete;
  JointLogFile& operator=(const JointLogFile&) = delete;

  [[nodiscard]] bool is_open() const { return file_ != nullptr; }
  void add(const motion::JointSample& sample);
  /// The first error of all writes.
  [[nodiscard]] rtapi::Status close();

 private:
  std::FILE* file_{nullptr};
  std::string path_;
  bool headed_{false};
  bool failed_{false};
};

}  // namespace kerf::launcher
