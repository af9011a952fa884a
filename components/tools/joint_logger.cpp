// joint-logger: keeps a record of every servo cycle for `kerf --log-joints` and its summary.
#include <new>

#include "hal/component.hpp"
#include "motion/api/joint_log.hpp"
#include "motion/api/shared.hpp"

namespace kerf::components {

class JointLogger final : public hal::Component<JointLogger> {
 public:
  static constexpr hal::Info kInfo{
      .name = "joint-logger",
      .summary = "Records the commanded motion of every servo cycle",
      .notes =
          "Load it after motmod and add its function behind motion-controller in the servo thread. "
          "The records go through a ring in shared memory, which kerf empties into the file of "
          "--log-joints and into the summary of a program run. A cycle that finds the ring full is "
          "lost and counted in dropped.",
      .singleton = true};

  explicit JointLogger(hal::Builder& b) noexcept : Component(b) {
    motion_ = static_cast<const motion::MotionShared*>(b.find_service(motion::kMotionService));
    if (motion_ == nullptr) {
      b.fail("joint-logger: load motmod first");
      return;
    }
    std::byte* block =
        b.shared_block(motion::kJointLogBlock, sizeof(motion::JointLog), motion::kJointLogAbi);
    if (block != nullptr) log_ = new (block) motion::JointLog();
  }

 private:
  void update(const hal::Period&) noexcept {
    if (motion_ == nullptr || log_ == nullptr) return;
    if (!motion_->status.read(status_) || status_.cycle == sample_.cycle) return;
    take(status_);
    if (!log_->ring.push(sample_)) dropped_ = static_cast<std::int32_t>(log_->dropped.add(1));
    depth_ = static_cast<std::int32_t>(log_->ring.size());
  }

  void take(const motion::MotionStatus& s) noexcept {
    sample_.cycle = s.cycle;
    sample_.time_ns = s.time_ns;
    sample_.block = s.current.id;
    sample_.line = s.current.line;
    sample_.kind = s.kind;
    sample_.joints = s.joints;
    sample_.period_ns = static_cast<std::int32_t>(s.servo_period_ns);
    sample_.vel_mm_s = s.vel_mm_s;
    sample_.requested_vel_mm_s = s.requested_vel_mm_s;
    for (std::size_t i = 0; i < 3; ++i) sample_.position[i] = s.pos_cmd[i];
    for (std::size_t i = 0; i < motion::kMaxJoints; ++i) sample_.joint[i] = s.joint[i].pos_cmd;
  }

  const motion::MotionShared* motion_{nullptr};
  motion::JointLog* log_{nullptr};
  motion::MotionStatus status_;  // members, not locals: too large for a realtime stack frame
  motion::JointSample sample_;
  hal::Out<std::int32_t> depth_{
      pin<hal::Out<std::int32_t>>("curr-depth", "Records that wait to be read")};
  hal::Out<std::int32_t> dropped_{
      pin<hal::Out<std::int32_t>>("dropped", "Cycles lost because the ring was full")};
  hal::Function update_{function<&JointLogger::update>("", "Records one cycle")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::JointLogger)
