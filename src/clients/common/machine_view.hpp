// MachineView: what every client shows of the machine. It only reads; commands go through task::Client.
//
//   auto view = clients::MachineView::attach(rtapi::default_instance());
//   if (!view.ok()) ...
//   if ((*view)->poll()) std::printf("X %f\n", (*view)->stat().position.x);
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "clients/common/stat.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/status.hpp"

namespace kerf::clients {

class MachineView {
 public:
  /// Maps the segment of an instance. not_found: it does not run, or task or motion are not there yet; protocol: another build
  /// made it.
  [[nodiscard]] static rtapi::Result<std::unique_ptr<MachineView>> attach(
      const std::string& instance);
  /// The same on a segment that is attached already, and outlives the view.
  [[nodiscard]] static rtapi::Result<std::unique_ptr<MachineView>> over(rtapi::Segment& segment);
  MachineView(const MachineView&) = delete;
  MachineView& operator=(const MachineView&) = delete;

  /// Takes a new copy of everything. False, with the old one kept, when a writer died in the middle of a write.
  bool poll();

  /// In the peer's terms and units.
  [[nodiscard]] const Stat& stat() const noexcept { return stat_; }
  /// What Kerf's own programs may want beside: as task and motion wrote it, in mm and degrees.
  [[nodiscard]] const task::TaskStatus& task() const noexcept { return task_; }
  [[nodiscard]] const motion::MotionStatus& motion() const noexcept { return motion_; }
  [[nodiscard]] const motion::MachineConfig& config() const noexcept { return config_; }
  [[nodiscard]] const task::MachineFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] rtapi::Segment& segment() const noexcept { return *segment_; }
  [[nodiscard]] const task::TaskShared& task_shared() const noexcept { return *task_shared_; }
  [[nodiscard]] const motion::MotionShared& motion_shared() const noexcept {
    return *motion_shared_;
  }

  // --- units ---
  /// Machine units from mm or degrees; limits beyond +-1e98 stay as they are.
  [[nodiscard]] double from_axis(std::size_t axis, double value) const noexcept;
  [[nodiscard]] double from_joint(std::size_t joint, double value) const noexcept;
  [[nodiscard]] double from_mm(double mm) const noexcept { return mm / facts_.linear_unit_mm; }
  [[nodiscard]] rtapi::Pose from_pose(const rtapi::Pose& pose) const noexcept;

 private:
  MachineView() = default;
  rtapi::Status open(rtapi::Segment& segment);
  void read_tools();
  [[nodiscard]] ToolStat tool(const task::ToolRecord& record) const;
  void fill_task();
  void fill_machine();
  void fill_motion();
  void fill_joint(std::size_t j);
  void fill_io();

  std::unique_ptr<rtapi::Segment> own_;
  rtapi::Segment* segment_{nullptr};
  task::TaskShared* task_shared_{nullptr};
  motion::MotionShared* motion_shared_{nullptr};
  task::TaskStatus task_;
  motion::MotionStatus motion_;
  motion::MachineConfig config_;
  task::MachineFacts facts_;
  std::uint64_t tools_version_{0};
  Stat stat_;
};

}  // namespace kerf::clients
