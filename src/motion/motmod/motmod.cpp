#include "motion/motmod/motmod.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include "hal/segment_service.hpp"
#include "motion/api/joint_log.hpp"
#include "motion/motmod/read_orders.hpp"

namespace kerf::motion {
namespace {

template <class T, class... A>
T* make_part(hal::Builder& b, A&&... args) noexcept {
  void* memory = b.allocate(sizeof(T), alignof(T));
  return memory == nullptr ? nullptr : new (memory) T(static_cast<A&&>(args)...);
}

/// The planner's memory is the component's.
class BuilderMemory final : public path::Memory {
 public:
  explicit BuilderMemory(hal::Builder& b) noexcept : builder_(b) {}
  void* allocate(std::size_t bytes, std::size_t align) noexcept override {
    return builder_.allocate(bytes, align);
  }

 private:
  hal::Builder& builder_;
};

hal::Name prefixed(std::string_view prefix, std::string_view name) noexcept {
  hal::Name out(prefix);
  out.append(name);
  return out;
}

/// Pins of one direction: first those with names, then numbered ones up to `count`.
template <class Pin, std::size_t N>
void add_pins(hal::Builder& b, hal::PinArray<Pin, N>& pins, std::string_view names,
              std::string_view name_prefix, std::string_view pattern, std::size_t count,
              std::string_view doc) noexcept {
  std::size_t n = 0;
  for (std::string_view name = take_name(names); !name.empty() && n < count;
       name = take_name(names), ++n)
    pins.add(b, prefixed(name_prefix, name), doc);
  for (std::size_t number = 0; n < count; ++n, ++number)
    pins.add(b, hal::numbered(pattern, number), doc);
}

}  // namespace

void IoPins::create(hal::Builder& b, const MotmodArgs& a) noexcept {
  const auto dio = static_cast<std::size_t>(a.dio), aio = static_cast<std::size_t>(a.aio);
  add_pins(b, digital_in_, a.names_din, "motion.din-", "motion.digital-in-##", dio,
           "Input for M66 P");
  add_pins(b, digital_out_, a.names_dout, "motion.dout-", "motion.digital-out-##", dio,
           "Output of M62-M65 P");
  add_pins(b, analog_in_, a.names_ain, "motion.ain-", "motion.analog-in-##", aio,
           "Input for M66 E");
  add_pins(b, analog_out_, a.names_aout, "motion.aout-", "motion.analog-out-##", aio,
           "Output of M67 and M68 E");
  const std::size_t errors =
      std::max(count_names(a.names_misc), static_cast<std::size_t>(a.misc_errors));
  add_pins(b, error_, a.names_misc, "motion.err-", "motion.misc-error-##", errors,
           "True: machine off");
}

std::uint64_t IoPins::digital_in() const noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < digital_in_.size(); ++i)
    bits |= digital_in_[i].get() ? std::uint64_t{1} << i : 0U;
  return bits;
}

void IoPins::read_analog(double* values) const noexcept {
  for (std::size_t i = 0; i < analog_in_.size(); ++i) values[i] = analog_in_[i].get();
}

std::uint64_t IoPins::errors() const noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < error_.size(); ++i)
    bits |= error_[i].get() ? std::uint64_t{1} << i : 0U;
  return bits;
}

void IoPins::write(const OutputBank& bank) noexcept {
  if (bank.digital != written_.digital) {
    for (std::size_t i = 0; i < digital_out_.size(); ++i)
      digital_out_[i] = (bank.digital >> i & 1U) != 0;
    written_.digital = bank.digital;
  }
  for (std::size_t i = 0; i < analog_out_.size(); ++i) {
    if (bank.analog[i] == written_.analog[i]) continue;
    analog_out_[i] = written_.analog[i] = bank.analog[i];
  }
}

Motmod::Motmod(hal::Builder& b) noexcept
    : Component(b),
      args_(read_args(b)),
      clock_(b.clock()),
      pins_(b),
      joint_(hal::make_array<JointPins>(b, static_cast<std::size_t>(args_.joints))),
      axis_(hal::make_array<AxisPins>(b, rtapi::kAxes)),
      spindle_(hal::make_array<SpindlePins>(b, static_cast<std::size_t>(args_.spindles))) {
  std::fill(std::begin(joint_scale_), std::end(joint_scale_), 1.0);
  orders_.values = &intent_;
  pins_.add_debug_params();
  io_.create(b, args_);
  create_unlock_pins(b);
  for (std::size_t j = joint_.size() - static_cast<std::size_t>(args_.extra_joints);
       j < joint_.size(); ++j)
    posthome_cmd_.add(b, detail::pin_name("joint.#.", j, "posthome-cmd"),
                      "Where the extra joint goes once it is homed");
  create_parts(b);
  handler_ = function_named<&Motmod::command_handler>(
      "motion-command-handler", "Reads what task wants; first in servo-thread");
  function_ = function_named<&Motmod::motion_controller>(
      "motion-controller", "Runs the motion controller for one cycle");
  if (args_.base_period_ns > 0) b.add_thread("base-thread", args_.base_period_ns);
  b.add_thread("servo-thread", args_.servo_period_ns);
}

void Motmod::create_unlock_pins(hal::Builder& b) noexcept {
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    if (!has_unlock(j)) continue;
    unlock_[j].declare(b, detail::pin_name("joint.#.", j, "unlock"), "Unlock the indexer");
    is_unlocked_[j].declare(b, detail::pin_name("joint.#.", j, "is-unlocked"),
                            "The indexer is unlocked");
  }
}

namespace {

/// The flight record takes half of what is free at most: the rest is for pins.
std::size_t flight_words(const rtapi::Segment* segment) noexcept {
  if (segment == nullptr) return FlightRecord::kLeastServoWords;
  const rtapi::RegionHead& shared = segment->region(rtapi::Region::shared);
  const std::size_t room = (shared.end - shared.used.get()) / 2;
  std::size_t words = FlightRecord::kServoWords;
  while (words > FlightRecord::kLeastServoWords && FlightRecord::bytes(words) > room) words /= 2;
  return words;
}

}  // namespace

void Motmod::create_parts(hal::Builder& b) noexcept {
  auto* kinematics = static_cast<Kinematics*>(b.find_service(kKinematicsService));
  auto* in_c = kinematics == nullptr
                   ? make_part<CKinematics>(b, b, args_.joints - args_.extra_joints)
                   : nullptr;
  if (in_c != nullptr && in_c->found()) {
    kinematics = in_c;
    asked_ = make_part<AskedKinematics>(b, *in_c);
  }
  if (b.failed()) return;
  if (kinematics == nullptr) {
    b.fail(
        "motmod: no kinematics are loaded; load a kinematics module first, for example: loadrt "
        "trivkins coordinates=xyz");
    return;
  }
  if (args_.extra_joints > 0 && kinematics->type() != KinematicsType::both) {
    b.fail("MOTION: nonzero num_extrajoints requires KINEMATICS_BOTH");
    return;
  }
  kinematics_ = kinematics;
  if (kinematics->kinds() > 1)
    switchkins_type_.declare(b, "motion.switchkins-type",
                             "The kind of kinematics, from 0; in force when the machine stands");
  axis_mask_ = kinematics->axis_mask();
  std::byte* block = b.shared_block(kMotionBlock, sizeof(MotionShared), kMotionAbi);
  link_ = make_part<PlannerLink>(b);
  if (block == nullptr || link_ == nullptr) return;
  shared_ = new (block) MotionShared();
  b.provide(kMotionService, shared_);
  b.provide(hal::kSwitchOff, &switch_off_);
  recorder_ = make_part<FlightRecorder>(b);
  const auto* segment = static_cast<const rtapi::Segment*>(b.find_service(hal::kSegmentService));
  const std::size_t words = flight_words(segment);
  std::byte* record = b.shared_block(kFlightBlock, FlightRecord::bytes(words), kFlightAbi);
  if (recorder_ == nullptr || record == nullptr) return;
  recorder_->begin(new (record) FlightRecord(), words, segment, args_.servo_period_ns, args_.joints,
                   args_.spindles, args_.extra_joints, args_.dio, args_.aio);
  choose_axes();
  const Kinematics& asked =
      asked_ != nullptr ? static_cast<const Kinematics&>(*asked_) : *kinematics;
  planner_ = make_part<PlannerParticipant>(b, asked, *shared_, *link_);
  controller_ = make_part<Controller>(b, *kinematics, link_->spans, link_->slots, link_->faults,
                                      args_.joints, args_.spindles);
  BuilderMemory memory(b);
  if (planner_ == nullptr || controller_ == nullptr || !planner_->planner().create(memory)) {
    controller_ = nullptr;
    return;
  }
  controller_->use_screws(screw_);
  homing_ = make_part<CHoming>(b, b, args_.joints, args_.extra_joints,
                               static_cast<double>(args_.servo_period_ns) * 1e-9);
  if (b.failed()) {
    controller_ = nullptr;
    return;
  }
  if (homing_ != nullptr && !homing_->found()) homing_ = nullptr;
  if (homing_ != nullptr) controller_->use_homing(*homing_);
  planner_->planner().set_counts(args_.dio, args_.aio, args_.spindles);
  planner_->planner().set_tap(recorder_);
  planner_->planner().set_unlock_pins(args_.unlock_mask);
  controller_->status().digital_count = args_.dio;
  controller_->status().analog_count = args_.aio;
  controller_->status().extra_joints = args_.extra_joints;
  controller_->status().misc_error_count = static_cast<std::int32_t>(io_.error_count());
  begin_cells();
  b.add_participant(*planner_);
}

void Motmod::begin_cells() noexcept {
  using rtapi::unused;
  const std::size_t joints = joint_.size(), analog = io_.analog_count();
  using S = MotionStatus;
  status_parts_ = rtapi::words_but<S>(
      unused(offsetof(S, analog_in), sizeof(double), analog, kMaxAnalog),
      unused(offsetof(S, analog_out), sizeof(double), analog, kMaxAnalog),
      unused(offsetof(S, joint), sizeof(JointStatus), joints, kMaxJoints),
      unused(offsetof(S, spindle), sizeof(SpindleStatus), spindle_.size(), kMaxSpindles));
  using V = ServoView;
  view_parts_ = rtapi::words_but<V>(unused(offsetof(V, skew), sizeof(double), joints, kMaxJoints),
                                    unused(offsetof(V, joint), sizeof(double), joints, kMaxJoints));
  shared_->status.write(S{});
  link_->view.write(V{});
}

/// New limits come into force when nothing moves and nothing is planned; what bears on no move does at once.
void Motmod::take_config() noexcept {
  const std::uint64_t version = shared_->config.version();
  std::int32_t kind = 0;
  const bool other_kind = config_version_ != 0 && wants_switch(kind);
  const bool moved = config_version_ != 0 && controller_->kinematics_moved();
  const bool wish = (version != config_version_ && controller_->may_configure()) ||
                    ((other_kind || moved) && controller_->may_switch());
  if (!wish)
    config_wish_ = 0;
  else if (config_wish_ == 0)
    config_wish_ = ++last_wish_;
  // Acquire, before the look at the spans below: all that the planner had pushed is there.
  const bool parked = wish && link_->parked.observe() == config_wish_;
  const bool all = parked && controller_->may_configure();
  if (!all && version == adopted_version_) return;
  // A writer in the middle of a write is asked again in the next cycle.
  MachineConfig config;
  if (!shared_->config.read(config, 2)) return;
  adopted_version_ = version;
  const bool switches = all && other_kind && controller_->may_switch();
  recorder_->config(*controller_, {config, all, switches, {}, kind});
  if (!all) {
    controller_->adopt(config);
    if (homing_ != nullptr && !controller_->homing()) homing_->configure(config, false);
    return;
  }
  if (switches) refused_kind_ = controller_->switch_kinematics(*kinematics_, kind) ? kNoKind : kind;
  if (moved && !switches && controller_->may_switch()) controller_->take_up_kinematics();
  take_screws();
  controller_->configure(config);
  if (homing_ != nullptr) homing_->configure(config, true);
  link_->config.write(config);
  config_version_ = version;
  ++limits_version_;
  config_wish_ = 0;
  scale_ = config.linear_units_per_mm > 0 ? config.linear_units_per_mm : 1.0;
  kinematics_->use_unit(1.0 / scale_);
  std::uint32_t rotary = 0;
  for (std::size_t j = 0; j < kMaxJoints; ++j) rotary |= config.joint[j].rotary ? 1U << j : 0U;
  kinematics_->use_machine(rotary, config.axis_mask);
  choose_axes();
  for (std::size_t j = 0; j < kMaxJoints; ++j)
    joint_scale_[j] = config.joint[j].rotary ? 1.0 : scale_;
  if (config.axis_mask != 0) axis_mask_ = config.axis_mask;
}

/// Pins of an axis that the kinematics do not have move nothing, and most machines have three of nine. Where there are kinds to switch between an axis may
/// come with any of them, and its counts have to be known by then.
void Motmod::choose_axes() noexcept {
  constexpr std::uint32_t kAll = (1U << rtapi::kAxes) - 1;
  axes_read_ = kinematics_->kinds() > 1 ? kAll : kinematics_->axis_mask();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((axes_read_ >> i & 1U) != 0) continue;
    inputs_.in.axis_wheel[i] = {};
    inputs_.in.offset[i] = {};
  }
  recorder_->use_axes(static_cast<std::size_t>(std::bit_width(axes_read_)));
}

void Motmod::take_screws() noexcept {
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    const std::uint64_t version = shared_->screw[j].version();
    if (version != screw_version_[j] && shared_->screw[j].read(screw_[j], 2))
      screw_version_[j] = version;
  }
}

std::int32_t Motmod::wanted_kind() const noexcept {
  const double value = switchkins_type_.get();
  // What is no number asks for nothing; all else is cut to a whole one (manual, "HAL Pins").
  if (!(std::abs(value) < 1e6)) return kinematics_->kind();
  return static_cast<std::int32_t>(value);
}

bool Motmod::wants_switch(std::int32_t& kind) const noexcept {
  if (kinematics_->kinds() < 2) return false;
  kind = wanted_kind();
  return kind != kinematics_->kind() && kind != refused_kind_;
}

void Motmod::command_handler(const hal::Period&) noexcept {
  if (controller_ == nullptr) return;
  // Here and not where it is needed: on the way from far memory a line takes a tenth of a cycle's work.
  controller_->executor().fetch();
  recorder_->fetch();
  const IntentCell& cell = shared_->intent;
  take_config();
  const std::uint64_t version = cell.values.version();
  if (version != intent_version_ && cell.values.read(intent_, 2)) intent_version_ = version;
  read_orders(cell, orders_);
  // Task may live a little longer than the supervisor, and somebody may press its buttons.
  if (forsaken_.requested()) orders_.enable = false;
  orders_.path_ring_empty = shared_->path.empty();
}

void Motmod::motion_controller(const hal::Period& period) noexcept {
  if (controller_ == nullptr) return;
  inputs_.in.plan_passes =
      link_->slots.gate.done();  // before anything of the planner's is looked at
  read_inputs();
  MotionStatus& status = controller_->status();
  status.digital_in = io_.digital_in();
  io_.read_analog(status.analog_in);
  inputs_.in.since_last_s = period.actual_seconds();
  controller_->step(inputs_.in, orders_, period.seconds(), clock_.now());
  for (std::size_t j = 0; j < joint_.size(); ++j) write_joint(j);
  write_axes();
  for (std::size_t n = 0; n < spindle_.size(); ++n) write_spindle(n);
  write_motion(period);
  io_.write(controller_->outputs());
  // Behind the outputs: M68 may have asked for it in this cycle, and who waits for the program's end must see both at once.
  if (std::int32_t kind = 0; kinematics_->kinds() > 1) {
    status.kinematics_pending = status.kinematics_pending || wants_switch(kind);
    if (wanted_kind() != refused_kind_) refused_kind_ = kNoKind;
  }
  for (std::size_t i = 0; i < io_.analog_count(); ++i)
    status.analog_out[i] = controller_->outputs().analog[i];
  if (homing_ != nullptr) homing_->write_pins();
  answer_planner();
  // Before the planner hears of the cycle.
  recorder_->cycle(*controller_, inputs_, orders_, intent_version_, status.time_ns);
  publish();
}

void Motmod::answer_planner() noexcept {
  if (asked_ != nullptr && asked_->serve()) link_->cell.notify();
}

void Motmod::publish() noexcept {
  FaultLog& log = shared_->faults;
  for (const FaultRecord& record : controller_->faults()) {
    log.slot[record.number % FaultLog::kSlots].write(record);
    log.newest.publish(record.number);
  }
  shared_->status.write(controller_->status(), status_parts_);
  const ServoView& last = view_[view_now_];
  view_now_ ^= 1U;
  ServoView& view = view_[view_now_];
  controller_->fill(view);
  view.config_version = limits_version_;
  view.config_wish = config_wish_;
  tell_planner(*link_, view, view_parts_, last);
  if (task_should_look()) shared_->status_cell.notify();
}

/// While plenty of items wait before the planner, and while task waits for a later one, that some more are done is told now and then.
bool Motmod::task_should_look() noexcept {
  const MotionStatus& status = controller_->status();
  const bool pending = status.kinematics_pending;
  const bool news =
      (controller_->changed() && !controller_->only_went_on()) || pending != pending_before_;
  pending_before_ = pending;
  untold_ = untold_ || news || controller_->changed();
  const std::uint64_t awaited = shared_->awaited_seq.get();
  const bool soon = news || (awaited > 0 ? status.executed_seq >= awaited
                                         : shared_->path.size() < PathRing::capacity() / 2);
  if (!untold_ || (!soon && status.time_ns / kTellEvery == told_ns_ / kTellEvery)) return false;
  untold_ = false;
  told_ns_ = status.time_ns;
  return true;
}

}  // namespace kerf::motion

using Motmod = kerf::motion::Motmod;
KERF_HAL_MODULE(Motmod)
