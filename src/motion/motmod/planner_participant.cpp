#include "motion/motmod/planner_participant.hpp"

#include "rtapi/sync/patient_read.hpp"

namespace kerf::motion {
void PlannerParticipant::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(shared_.path_cell);
  next.watch(link_.cell);
  ServoView& view = view_;
  const bool published = link_.view.version() != 0;
  const std::uint64_t passes = link_.slots.gate.passes();
  const bool seen = link_.slots.gate.pass([&] { return published && link_.view.read(view); });
  if (published && !seen) next.wake_at(now + rtapi::kReadAgain);
  const bool parked = seen && view.config_wish != 0;
  link_.parked.publish(parked ? view.config_wish : 0);
  // The servo writes new limits only while the planner is parked, so these are those of the view.
  if (seen && !parked && view.config_version != config_version_) {
    MachineConfig config;
    if (link_.config.read(config)) {
      planner_.configure(config);
      config_version_ = view.config_version;
    } else {
      next.wake_at(now + rtapi::kReadAgain);
    }
  }
  // Until the machine is described and the servo has said where it stands, items wait.
  if (parked || config_version_ == 0 || !seen || view.config_version != config_version_) {
    link_.waits.set(static_cast<std::uint32_t>(Planner::Waits::servo));
    return;
  }
  const Planner::Waits waits =
      planner_.run(shared_.path, view, shared_.intent.abort_epoch.get(), now, passes);
  if (waits == Planner::Waits::turn) next.wake_at(now);
  if (waits == Planner::Waits::time) next.wake_at(planner_.wake_ns());
  if (planner_.comes_back_soon()) next.wake_at(now + Planner::kSoon);
  link_.seen.set(view.executed_seq);
  link_.waits.set(static_cast<std::uint32_t>(waits));
}

void tell_planner(PlannerLink& link, const ServoView& view, std::span<const rtapi::WordPart> parts,
                  const ServoView& last) noexcept {
  link.view.write(view, parts);
  // What the planner waits for is looked at in every cycle, so nothing is lost when it begins to wait just now.
  const auto waits = static_cast<Planner::Waits>(link.waits.get());
  bool wake = view.acked_epoch != last.acked_epoch || view.void_epoch != last.void_epoch ||
              view.place != last.place || view.takes_moves != last.takes_moves ||
              view.config_version != last.config_version || view.config_wish != last.config_wish ||
              !(view.scale == last.scale) || view.law.number != last.law.number ||
              view.law.rest_span != last.law.rest_span || view.law.stands != last.law.stands ||
              view.single_step != last.single_step;
  // Until the planner has answered: it may not have been able to read the wish.
  wake = wake || (view.config_wish != 0 && link.parked.observe() != view.config_wish);
  if (waits == Planner::Waits::room)
    wake = wake || link.spans.size() + Planner::kRoomWorthSending <= SpanRing::capacity();
  if (waits == Planner::Waits::servo) wake = wake || view.executed_seq != link.seen.get();
  if (!wake) return;
  link.waits.set(static_cast<std::uint32_t>(Planner::Waits::items));
  link.cell.notify();
}

}  // namespace kerf::motion
