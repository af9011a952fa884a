#include "motion/motmod/flight_recorder.hpp"

#include <cstring>
#include <type_traits>

#include "hal/component.hpp"
#include "hal/core/value_access.hpp"

namespace kerf::motion {
namespace {

/// While the machine stands, this many cycles lie between two records of it at least.
constexpr std::uint64_t kBetweenRests = 250, kStandingRests = 10'000;

/// Through a copy of words: a T is read as bytes only.
template <std::size_t N, class T>
void write_whole(std::uint64_t (&words)[N], const rtapi::OverwriteRing& ring, FlightKind kind,
                 std::uint64_t cycle, const T& value, std::uint32_t extra = 0) noexcept {
  static_assert(sizeof(T) % 8 == 0 && sizeof(T) / 8 <= N);
  std::memcpy(words, &value, sizeof(T));
  rtapi::OverwriteRing::Head head;
  head.kind = static_cast<std::uint16_t>(kind);
  head.number = cycle;
  head.extra = extra;
  ring.write(head, words, sizeof(T) / 8);
}

}  // namespace

std::uint32_t check_sum(const Controller& controller) noexcept {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (std::size_t j = 0; j < controller.joints(); ++j) {
    std::uint64_t bits = 0;
    const double at = controller.joint(j).pos_cmd + 0.0;  // both zeros are one place
    std::memcpy(&bits, &at, sizeof bits);
    h = (h ^ bits) * 0x100000001b3ULL;
    h ^= h >> 29U;
  }
  return static_cast<std::uint32_t>(h ^ h >> 32U);
}

void FlightRecorder::begin(FlightRecord* record, std::size_t servo_words,
                           const rtapi::Segment* segment, std::int64_t period_ns,
                           std::int32_t joints, std::int32_t spindles, std::int32_t extra_joints,
                           std::int32_t digital, std::int32_t analog) noexcept {
  record_ = record;
  if (record == nullptr) return;
  servo_ = record->servo(servo_words);
  path_ = record->path(servo_words);
  segment_ = segment;
  record->servo_words = servo_words;
  record->state_abi = kFlightStateAbi;
  record->period_ns = period_ns;
  record->joints = joints;
  record->spindles = spindles;
  record->extra_joints = extra_joints;
  record->digital = digital;
  record->analog = analog;
  use_axes(rtapi::kAxes);
  // What is not there is recorded as it is by default.
  inputs_.set(CycleInputs{});
}

void FlightRecorder::use_axes(std::size_t count) noexcept {
  if (record_ == nullptr) return;
  using rtapi::unused;
  using C = CycleInputs;
  const auto joints = static_cast<std::size_t>(record_->joints),
             spindles = static_cast<std::size_t>(record_->spindles);
  inputs_parts_ = rtapi::words_but<C>(
      unused(offsetof(C, in.joint), sizeof(JointInputs), joints, kMaxJoints),
      unused(offsetof(C, in.spindle), sizeof(SpindleInputs), spindles, kMaxSpindles),
      unused(offsetof(C, in.joint_wheel), sizeof(WheelInputs), joints, kMaxJoints),
      unused(offsetof(C, in.axis_wheel), sizeof(WheelInputs), count, rtapi::kAxes),
      unused(offsetof(C, in.offset), sizeof(OffsetInputs), count, rtapi::kAxes));
  looks_at_all_ = true;
}

void FlightRecorder::config(const Controller& controller, const ConfigRecord& change) noexcept {
  if (record_ == nullptr) return;
  write_whole(words_, servo_, FlightKind::config, controller.status().cycle + 1, change);
}

void FlightRecorder::cycle(const Controller& controller, CycleInputs& now, const Orders& orders,
                           std::uint64_t intent_version, std::int64_t now_ns) noexcept {
  if (record_ == nullptr) return;
  const MotionStatus& s = controller.status();
  const rtapi::OverwriteRing& ring = servo_;
  rtapi::OverwriteRing::Head head;
  head.number = s.cycle;
  if (intent_version != intent_version_) {
    intent_version_ = intent_version;
    if (const std::size_t n = intent_.changes(*orders.values, words_); n > 0) {
      head.kind = static_cast<std::uint16_t>(FlightKind::intent);
      ring.write(head, words_, n);
    }
  }
  now.heartbeat = orders.heartbeat;
  now.abort_epoch = orders.abort_epoch;
  now.enable_request = orders.enable_request;
  now.enable = orders.enable;
  now.hold = orders.hold;
  now.path_ring_empty = orders.path_ring_empty;
  const std::size_t n =
      looks_at_all_ ? inputs_.changes(now, words_) : inputs_.changes(now, words_, inputs_parts_);
  looks_at_all_ = false;
  head.kind = static_cast<std::uint16_t>(FlightKind::cycle);
  head.extra = check_sum(controller);
  ring.write(head, words_, n);
  head.extra = 0;
  for (const FaultRecord& fault : controller.faults())
    write_whole(words_, ring, FlightKind::fault, s.cycle, fault);
  if (s.cycle % FlightRecord::kStatusEvery == 0) status(s);
  pins(s.cycle);
  cycle_.publish(s.cycle);
  const bool at_rest = controller.may_switch() && orders.path_ring_empty;
  const std::uint64_t since = s.cycle - last_rest_;
  if (at_rest && (!any_rest_ || (!at_rest_ && since >= kBetweenRests) || since >= kStandingRests))
    rest(controller, now_ns);
  else if (at_rest)
    return;  // the next look is as if it had just come to rest, once kBetweenRests are over
  at_rest_ = at_rest;
}

void FlightRecorder::rest(const Controller& controller, std::int64_t now_ns) noexcept {
  const std::uint64_t cycle = controller.status().cycle;
  inputs_.get(rest_record_.inputs);
  intent_.get(rest_record_.intent);
  controller.save(rest_record_.state);
  rest_record_.time_ns = now_ns;
  write_whole(words_, servo_, FlightKind::rest, cycle, rest_record_);
  last_rest_ = cycle;
  any_rest_ = true;
}

void FlightRecorder::status(const MotionStatus& s) noexcept {
  StatusRecord r;
  r.time_ns = s.time_ns;
  r.line = s.current.line;
  r.kind = s.kind;
  r.waiting_for = s.waiting_for;
  r.mode = s.mode;
  r.enabled = s.enabled ? 1 : 0;
  r.held = s.held ? 1 : 0;
  r.vel_mm_s = s.vel_mm_s;
  r.feed_override = s.feed_override;
  r.spindle_rpm = s.spindle[0].speed_rpm;
  const auto joints = static_cast<std::size_t>(record_->joints);
  for (std::size_t j = 0; j < joints; ++j) {
    r.joint[j] = s.joint[j].pos_cmd;
    r.ferror[j] = s.joint[j].ferror;
  }
  write_whole(words_, servo_, FlightKind::status, s.cycle, r);
}

/// An address of the table is followed only within the segment: what another program has damaged costs a wrong value at most.
void FlightRecorder::pins(std::uint64_t cycle) noexcept {
  const std::size_t count = std::min<std::size_t>(record_->pin_count.observe(), kMaxRecordedPins);
  if (segment_ == nullptr || count == 0) return;
  const bool slow_too = cycle % FlightRecord::kStatusEvery == 0;
  for (std::size_t i = 0; i < count; ++i) {
    const RecordedPin& pin = record_->pin[i];
    const std::uint64_t link = pin.link;
    if ((pin.every_cycle == 0 && !slow_too) || link % 8 != 0 || !segment_->in_use(link, 8))
      continue;
    hal::SlotRef slot;
    slot.link = segment_->at<std::remove_pointer_t<decltype(slot.link)>>(link);
    const void* value = &slot.slot();
    const rtapi::Offset place = segment_->offset_of(value);
    if (place % 8 != 0 || !segment_->in_use(place, 8)) continue;
    pin_values_.raw[i] = hal::load_value(static_cast<hal::Type>(pin.type), value);
  }
  if (cycle % FlightRecord::kPinsEvery == 0) {
    write_whole(words_, servo_, FlightKind::pins, cycle, pin_values_, 1);
    pin_image_.set(pin_values_);
    return;
  }
  const std::size_t n = pin_image_.changes(pin_values_, words_);
  if (n == 0) return;
  rtapi::OverwriteRing::Head head;
  head.kind = static_cast<std::uint16_t>(FlightKind::pins);
  head.number = cycle;
  servo_.write(head, words_, n);
}

void FlightRecorder::turn(std::int64_t now_ns, std::uint64_t passes, std::uint32_t abort_epoch,
                          std::uint64_t view_cycle) noexcept {
  ++turn_;
  if (record_ == nullptr) return;
  const TurnRecord turn{now_ns, passes, abort_epoch, view_cycle};
  write_whole(path_words_, path_, FlightKind::turn, cycle_.observe(), turn, turn_);
}

void FlightRecorder::taken(const PathItem& item, const Planner::Modal& before, bool idle) noexcept {
  if (record_ == nullptr) return;
  const std::uint64_t cycle = cycle_.observe();
  if (idle) {
    ModalRecord modal;
    std::memset(static_cast<void*>(&modal), 0, sizeof modal);
    modal.modal = before;
    write_whole(path_words_, path_, FlightKind::modal, cycle, modal, turn_);
  }
  write_whole(path_words_, path_, FlightKind::item, cycle, item, turn_);
}

}  // namespace kerf::motion
