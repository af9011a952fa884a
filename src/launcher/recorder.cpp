#include "launcher/recorder.hpp"

#include "hal/core/view.hpp"

namespace kerf::launcher {

rtapi::Status Recorder::attach(rtapi::Segment& segment, const std::string& log_path) {
  KERF_TRY(log_, hal::View(segment).block<motion::JointLog>(motion::kJointLogBlock,
                                                            motion::kJointLogAbi));
  if (!log_path.empty()) return file_.open(log_path);
  return {};
}

void Recorder::drain() {
  if (log_ == nullptr) return;
  while (const motion::JointSample* sample = log_->ring.front()) {
    file_.add(*sample);
    if (in_run_) {
      statistics_.add(*sample);
      toolpath_.add(*sample);
    }
    log_->ring.pop();
  }
}

void Recorder::begin_run() {
  drain();
  statistics_ = {};
  toolpath_ = {};
  in_run_ = true;
}

void Recorder::end_run() {
  drain();
  toolpath_.finish();
  in_run_ = false;
}

std::uint64_t Recorder::dropped() const { return log_ == nullptr ? 0 : log_->dropped.get(); }

rtapi::Status Recorder::close() {
  drain();
  return file_.close();
}

}  // namespace kerf::launcher
