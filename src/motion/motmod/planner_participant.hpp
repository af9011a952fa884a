// PlannerParticipant: gives the planner its turns, beside the realtime threads.
#pragma once

#include <cstdint>
#include <span>

#include "motion/core/planner/planner.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::motion {

/// What planner and servo share besides the spans; private memory of the realtime host.
struct PlannerLink {
  SpanRing spans;
  PlanSlots slots;
  FaultRing faults;
  rtapi::SeqCell<ServoView> view;       ///< servo -> planner
  rtapi::Cell cell;                     ///< notified by servo when the planner should look
  rtapi::Word<std::uint32_t> waits{0};  ///< Planner::Waits of its last turn
  rtapi::Word<std::uint64_t> seen{0};  ///< executed_seq that the planner knew when it began to wait
  rtapi::SeqCell<MachineConfig>
      config;  ///< servo -> planner: the limits of ServoView::config_version
  /// Planner -> servo: the ServoView::config_wish for which the planner stands still; 0: none. Published after its last span.
  rtapi::Word<std::uint64_t> parked{0};
};

/// Planner and servo change their limits together, so that no move is planned by the one set and watched by the other. The servo
/// gives each wish a number of its own; the planner parks for that number and goes on when the wish is gone. A number is never
/// used twice, so an old answer is not taken for a new one.
class PlannerParticipant final : public rtapi::Participant {
 public:
  PlannerParticipant(const Kinematics& kinematics, MotionShared& shared, PlannerLink& link) noexcept
      : planner_(kinematics, link.spans, link.slots, link.faults), shared_(shared), link_(link) {}
  [[nodiscard]] const char* name() const noexcept override { return "planner"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::planner; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;
  [[nodiscard]] Planner& planner() noexcept { return planner_; }

 private:
  Planner planner_;
  MotionShared& shared_;
  PlannerLink& link_;
  std::uint64_t config_version_{0};
  ServoView view_;  ///< as it was read last
};

/// Servo side, once a cycle: publishes these parts of `view`, the only ones that change, and wakes the planner if it waits for what
/// happened since `last`.
void tell_planner(PlannerLink& link, const ServoView& view, std::span<const rtapi::WordPart> parts,
                  const ServoView& last) noexcept;

}  // namespace kerf::motion
