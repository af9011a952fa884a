#include "motion/motmod/planner_participant.hpp"

namespace kerf::motion {

void PlannerParticipant::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(shared_.path_cell);
  next.watch(link_.cell);
  ServoView view;
  const bool seen = link_.view.version() != 0 && link_.view.read(view);
  // Planner and servo go by the same limits: the servo takes new ones over when nothing is under way.
  if (seen && view.config_version != config_version_ &&
      shared_.config.version() == view.config_version) {
    MachineConfig config;
    if (shared_.config.read(config)) {
      planner_.configure(config);
      config_version_ = view.config_version;
    }
  }
  // Until the machine is described and the servo has said where it stands, items wait.
  if (config_version_ == 0 || !seen) {
    link_.waits.set(static_cast<std::uint32_t>(Planner::Waits::servo));
    return;
  }
  const Planner::Waits waits = planner_.run(shared_.path, view, shared_.intent.abort_epoch.get());
  if (waits == Planner::Waits::turn) next.wake_at(now);
  link_.seen.set(view.executed_seq);
  link_.waits.set(static_cast<std::uint32_t>(waits));
}

void tell_planner(PlannerLink& link, const ServoView& view, ServoView& last) noexcept {
  link.view.write(view);
  // What the planner waits for is looked at in every cycle, so nothing is lost when it begins to wait just now.
  const auto waits = static_cast<Planner::Waits>(link.waits.get());
  bool wake = view.acked_epoch != last.acked_epoch || view.void_epoch != last.void_epoch ||
              view.place != last.place || view.takes_moves != last.takes_moves ||
              view.config_version != last.config_version;
  if (waits == Planner::Waits::room) wake = wake || link.spans.size() <= SpanRing::capacity() / 2;
  if (waits == Planner::Waits::servo) wake = wake || view.executed_seq != link.seen.get();
  last = view;
  if (!wake) return;
  link.waits.set(static_cast<std::uint32_t>(Planner::Waits::items));
  link.cell.notify();
}

}  // namespace kerf::motion
