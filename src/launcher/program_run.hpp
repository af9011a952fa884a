// From a machine that has just started to a program that has run: switch on, home, open, run, summary and drawing.
#pragma once

#include <string>

#include "launcher/console.hpp"
#include "launcher/recorder.hpp"
#include "launcher/task_link.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

class ProgramRun {
 public:
  struct Parts {
    SupervisedClock& clock;
    TaskLink& task;
    Recorder& recorder;
    Console& console;
    rtapi::Segment& segment;
  };
  struct Job {
    std::string program;          ///< file, or "": only switch on and home
    std::string svg;              ///< file of the drawing
    bool go_on_at_pauses{false};  ///< nobody is there to press start after M0, M1, M60
  };
  ProgramRun(const Parts& parts, Job job) : p_(parts), job_(std::move(job)) {}

  /// The error that ended it; the operator's messages have been shown already.
  rtapi::Status run();

 private:
  rtapi::Status prepare();
  void watch();
  void answer_pause(const task::TaskStatus& status);
  rtapi::Status report();
  [[nodiscard]] std::vector<JointLimits> joint_limits() const;

  Parts p_;
  Job job_;
  rtapi::Nanos begun_ns_{0};
  int program_lines_{0};
  double begun_fraction_{-1};  ///< progress when the first line with motion began; below 0: not yet
  double fraction_{0};
  bool pause_answered_{false};
};

}  // namespace kerf::launcher
