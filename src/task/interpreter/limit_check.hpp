// LimitCheck: the whole program against the soft limits of the axes, before it runs. It is read by an interpreter of its own
// (ProgramSeek), so nothing of it is left.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "task/interpreter/program_seek.hpp"

namespace kerf::task {

class LimitCheck {
 public:
  struct Finding {
    std::string file;
    std::int32_t line{0};
    std::string text;
  };

  /// `from` and `now`: where canon and interpreter stand, and with what.
  LimitCheck(TaskEnvironment& environment, const MachineSetup& setup,
             const motion::MachineConfig& limits, interp::Interpreter& now, const CanonState& from,
             int tool, int pocket);
  /// False: this program cannot be read without running it. `most_blocks`: what it executes at most, for programs without end.
  [[nodiscard]] bool open(const std::string& path, std::int64_t most_blocks) {
    blocks_left_ = most_blocks;
    return seek_.open_whole(path);
  }
  /// Reads one block. False: that was the last, or what follows depends on what only a run finds out.
  [[nodiscard]] bool step();
  /// The first move beyond each limit, in the program's order.
  [[nodiscard]] const std::vector<Finding>& findings() const noexcept { return findings_; }

 private:
  void look(const TaskItem& item);
  void look_at_arc(const motion::ArcMove& arc, const motion::SourceTag& tag);
  void look_at_cubic(const motion::CubicMove& cubic, const motion::SourceTag& tag);
  /// `from`: where the move begins; the way back from outside a limit is open.
  void look_at_place(const rtapi::Pose& from, const rtapi::Pose& place,
                     const motion::SourceTag& tag);

  [[nodiscard]] std::string joints_of(std::size_t axis) const;

  const MachineSetup& setup_;
  const motion::MachineConfig limits_;
  std::deque<TaskItem> list_;
  CanonToPath canon_;
  ProgramSeek seek_;
  rtapi::Pose at_;
  std::int64_t blocks_left_{0};
  std::uint32_t told_{0};  ///< a bit for each axis and side
  std::vector<Finding> findings_;
};

}  // namespace kerf::task
