#include "launcher/program_run.hpp"

#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "hal/core/view.hpp"
#include "launcher/svg.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/clock/real_clock.hpp"
#include "rtapi/sync/patient_read.hpp"

namespace kerf::launcher {

using rtapi::Status;

namespace {

constexpr rtapi::Nanos kLookEvery = 100 * rtapi::kMillisecond;

double to_seconds(rtapi::Nanos ns) { return static_cast<double>(ns) * 1e-9; }

/// Takes a line from the terminal, if one is there.
bool enter_was_pressed() {
  pollfd p{STDIN_FILENO, POLLIN, 0};
  if (isatty(STDIN_FILENO) == 0 || ::poll(&p, 1, 0) <= 0) return false;
  char text[256];
  return ::read(STDIN_FILENO, text, sizeof text) > 0;
}

Status write_file(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "we");
  bool good = file != nullptr && std::fputs(text.c_str(), file) >= 0;
  if (file != nullptr) good = std::fclose(file) == 0 && good;
  if (!good) return rtapi::fail(rtapi::Errc::system, "cannot write " + path);
  return {};
}

}  // namespace

Status ProgramRun::prepare() {
  p_.console.detail("switching the machine on");
  KERF_CHECK(p_.task.perform({"state", "estop-reset"}));
  KERF_CHECK(p_.task.perform({"state", "on"}));
  // Startup code and what else the start has set going comes to its end first.
  KERF_CHECK(p_.task.perform({"wait"}));
  p_.console.say("homing");
  return p_.task.perform({"home"});
}

Status ProgramRun::run() {
  KERF_CHECK(prepare());
  if (job_.program.empty()) return {};
  KERF_CHECK(p_.task.perform({"mode", "auto"}));
  KERF_CHECK(p_.task.perform({"open", job_.program}));
  p_.console.say("running " + std::filesystem::path(job_.program).filename().string());
  p_.recorder.begin_run();
  begun_ns_ = p_.clock.now();
  const Status result = p_.task.perform(
      {"run"}, [this] { watch(); }, kLookEvery);
  p_.recorder.end_run();
  p_.console.end_progress();
  if (!result.ok()) return result;
  return report();
}

void ProgramRun::watch() {
  task::TaskStatus status;
  if (!p_.task.status(status)) return;
  program_lines_ = status.program_lines;
  fraction_ = status.progress;
  if (begun_fraction_ < 0 && status.current_line > 0) begun_fraction_ = status.progress;
  ProgressState progress;
  progress.fraction = status.progress;
  progress.from_fraction = begun_fraction_ < 0 ? 0 : begun_fraction_;
  progress.elapsed_s = to_seconds(p_.clock.now() - begun_ns_);
  progress.line = status.current_line;
  progress.lines = status.call_level == 0 ? status.program_lines : 0;
  if (!status.waiting_for.object.empty() &&
      p_.clock.now() - status.waiting_for.since_ns > 2 * rtapi::kSecond) {
    progress.waiting = task::wait_text(status.waiting_for);
  }
  p_.console.progress(progress, to_seconds(rtapi::monotonic_now()));
  answer_pause(status);
}

void ProgramRun::answer_pause(const task::TaskStatus& status) {
  if (!status.paused) {
    pause_answered_ = false;
    return;
  }
  const std::string where = "the program pauses at line " + std::to_string(status.current_line);
  if (!pause_answered_) {
    p_.console.say(where + (job_.go_on_at_pauses ? "; nobody is there, so it goes on"
                                                 : "; press Enter to go on"));
    pause_answered_ = true;
    if (job_.go_on_at_pauses) (void)p_.task.send({"resume"});
  }
  if (!job_.go_on_at_pauses && enter_was_pressed()) (void)p_.task.send({"resume"});
}

std::vector<JointLimits> ProgramRun::joint_limits() const {
  std::vector<JointLimits> limits;
  auto shared =
      hal::View(p_.segment).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  motion::MachineConfig config;
  if (!shared.ok() || !rtapi::read_patiently((*shared)->config, config)) return limits;
  for (std::int32_t i = 0; i < config.joints && i < static_cast<std::int32_t>(motion::kMaxJoints);
       ++i) {
    const motion::JointConfig& joint = config.joint[i];
    limits.push_back({joint.max_vel, joint.max_acc, joint.rotary});
  }
  return limits;
}

Status ProgramRun::report() {
  if (!p_.recorder.attached()) return {};
  const RunStatistics& run = p_.recorder.statistics();
  SummaryInput input;
  input.program = std::filesystem::path(job_.program).filename().string();
  input.program_lines = program_lines_;
  input.lines_executed = static_cast<int>(std::lround(fraction_ * program_lines_));
  input.dropped = p_.recorder.dropped();
  input.limits = joint_limits();
  p_.console.print(format_summary(run, input));
  char subtitle[200];
  std::snprintf(subtitle, sizeof subtitle, "%.0f mm at feed, %.0f mm at rapid, machine time %s",
                run.feed_length_mm(), run.rapid_length_mm(),
                format_duration(run.seconds()).c_str());
  KERF_CHECK(write_file(job_.svg,
                        draw_toolpath(p_.recorder.toolpath().pieces(), {input.program, subtitle})));
  std::error_code ignored;
  p_.console.print("  drawing       " + job_.svg + "\n");
  return {};
}

}  // namespace kerf::launcher
