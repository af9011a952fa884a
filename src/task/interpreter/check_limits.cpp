// The open program against the soft limits, while the machine is homed and nothing else is to be done (LimitCheck).
#include "rtapi/sync/patient_read.hpp"
#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {
namespace {
constexpr int kBlocksPerStep = 2048;
constexpr rtapi::Nanos kCheckTime = 100'000;  ///< these blocks cost this time
constexpr std::size_t kMostFindings = 6;
}  // namespace

void InterpreterParticipant::check_limits(rtapi::WaitSpec& next) {
  const bool idle = !aborting_ && !seek_ && !run_.active && status_.path_empty &&
                    status_.all_homed && !status_.homing_active;
  if (!idle) check_.reset();  // it begins anew
  if (!idle || !check_due_) return;
  if (!check_) {
    motion::MachineConfig limits;
    if (!p_.motion.config.read(limits)) return next.wake_at(now_ + rtapi::kReadAgain);
    const io::IoState io = p_.io.state();
    CanonState from = canon_.state();
    from.position = status_.pos_cmd;
    check_ = std::make_unique<LimitCheck>(p_.environment, p_.setup, limits, interp_, from,
                                          io.tool_in_spindle, io.pocket_in_spindle);
    // Loops and subs count; a program without end is read for about a second.
    constexpr std::int64_t kLoops = 1'000'000;
    if (!check_->open(file_, kLoops + 4 * std::int64_t{program_lines_})) {
      check_.reset();
      check_due_ = false;
      return;
    }
  }
  bool more = true;
  for (int i = 0; more && i < kBlocksPerStep && !abort_came(); ++i) more = check_->step();
  if (more) {
    next.wake_at(now_ + kCheckTime);
    return;
  }
  std::size_t told = 0;
  for (const LimitCheck::Finding& finding : check_->findings()) {
    if (++told > kMostFindings) break;
    Report report;
    report.message = MessageKind::error;
    report.text = finding.text;
    report.file = finding.file;
    report.line = finding.line;
    reports_.push_back(std::move(report));
  }
  check_.reset();
  check_due_ = false;
}

}  // namespace kerf::task
