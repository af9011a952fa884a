// Recorder: empties joint-logger's ring into the log file, the statistics and the drawing of a run.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "launcher/joint_log_file.hpp"
#include "launcher/run_statistics.hpp"
#include "launcher/toolpath.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

class Recorder {
 public:
  /// `log_path` "": no file. not_found: joint-logger is not loaded.
  rtapi::Status attach(rtapi::Segment& segment, const std::string& log_path);
  [[nodiscard]] bool attached() const { return log_ != nullptr; }
  /// Takes what is there.
  void drain();
  /// What has been drained so far is not part of the run, what follows is.
  void begin_run();
  void end_run();
  [[nodiscard]] const RunStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const ToolpathRecorder& toolpath() const { return toolpath_; }
  /// Cycles lost because the ring was full.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Ends the log file.
  rtapi::Status close();

 private:
  motion::JointLog* log_{nullptr};
  JointLogFile file_;
  RunStatistics statistics_;
  ToolpathRecorder toolpath_;
  bool in_run_{false};
};

}  // namespace kerf::launcher
