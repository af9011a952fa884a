// StandIn: takes the place of the motion controller. It says yes to everything at once, and logs what it was told.
//
// Moves are done as soon as they come: positions jump to their ends, dwells take no time, spindles have their speed at once, probe moves meet
// something at their end, homing succeeds. A hold holds, a single step ends with its block, and an abort drops what was queued before it, as
// with motion itself.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "clients/motion_logger/command_text.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::motion_logger {

class StandIn final : public rtapi::Participant {
 public:
  static constexpr rtapi::Nanos kPeriod = rtapi::kMillisecond;
  using Sink = std::function<void(const std::string& line)>;

  StandIn(motion::MotionShared& shared, Sink sink) : shared_(shared), sink_(std::move(sink)) {}

  [[nodiscard]] const char* name() const noexcept override { return "motion-logger"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::planner; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  void log(const std::vector<std::string>& lines);
  void take_config();
  void take_wishes();
  void carry_out(const IntentWords& now);
  void carry_out(const motion::Intent& now);
  void carry_out_jogs(const motion::Intent& now);
  void carry_out_switches(const motion::Intent& now);
  void take_path();
  void execute(const motion::PathItem& item);
  void home(std::int32_t joint, bool homed);
  void stop_spindle(std::size_t spindle);
  void move_to(const motion::Pose& end);
  void set_digital(std::size_t index, bool on);

  motion::MotionShared& shared_;
  Sink sink_;
  motion::MotionStatus status_;
  motion::MachineConfig config_;
  motion::Intent intent_;
  IntentWords words_;
  std::uint64_t step_block_{0};  ///< the block that a single step carries out; 0: none yet
};

}  // namespace kerf::motion_logger
