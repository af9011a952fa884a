#include "launcher/safe_state.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "launcher/process.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/sync/patient_read.hpp"

namespace kerf::launcher {

using rtapi::Errc;
using rtapi::fail;

namespace {

constexpr std::string_view kDigitalOut = "motion.digital-out-", kAnalogOut = "motion.analog-out-";

bool is_motions_own(const std::string& name) {
  return name.rfind(kDigitalOut, 0) == 0 || name.rfind(kAnalogOut, 0) == 0;
}

motion::MotionShared* motion_of(const rtapi::Segment& segment) {
  const hal::View view(segment);
  if (!view.attached()) return nullptr;
  auto block = view.block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  return block.ok() ? *block : nullptr;
}

/// Where the value stands that the name means, and who writes it.
struct Found {
  hal::Type type{hal::Type::unspecified};
  hal::SlotRef slot{};
  std::string writer;  ///< pin of a component that drives it, or ""
};

std::string writer_of(const hal::SignalInfo& signal) {
  for (const auto& pin : signal.pins)
    if (pin.dir == hal::Dir::out) return pin.name;
  return {};
}

Found find(const hal::View& view, const std::string& name) {
  Found found;
  if (const auto signal = view.find_signal(name)) {
    found.type = signal->type;
    found.writer = writer_of(*signal);
    // Without a pin nobody reads it.
    if (!signal->pins.empty()) found.slot = view.pin_slot(signal->pins.front().name);
    return found;
  }
  const auto item = view.find_item(name);
  if (!item) return found;
  found.type = item->type;
  found.slot = view.slot(name);
  if (item->dir == hal::Dir::out || item->dir == hal::Dir::ro) found.writer = item->name;
  if (!item->signal.empty())
    if (const auto signal = view.find_signal(item->signal); signal && found.writer.empty())
      found.writer = writer_of(*signal);
  return found;
}

}  // namespace

SafeState::SafeState(const rtapi::Segment& segment, std::vector<SafePin> pins)
    : segment_(segment), pins_(std::move(pins)) {}

SafeState::~SafeState() = default;

rtapi::Status SafeState::check(std::vector<std::string>& warnings) const {
  const hal::View view(segment_);
  const std::vector<std::string> names = view.names(hal::Kind::pin);
  // Motion has not run yet, so its status does not tell how many it has.
  const auto count_of = [&](bool digital) {
    const std::string_view named = digital ? "motion.dout-" : "motion.aout-";
    return std::count_if(names.begin(), names.end(), [&](const std::string& name) {
      return name.rfind(digital ? kDigitalOut : kAnalogOut, 0) == 0 || name.rfind(named, 0) == 0;
    });
  };
  for (const SafePin& pin : pins_) {
    const std::string what = pin.at.text() + ": [SAFE_STATE]PIN: ";
    if (is_motions_own(pin.name)) {
      // By number, so that an output with a name has one too; task has read the value.
      const bool digital = pin.name.rfind(kDigitalOut, 0) == 0;
      const int index =
          std::atoi(pin.name.substr((digital ? kDigitalOut : kAnalogOut).size()).c_str());
      const auto count = count_of(digital);
      if (index >= count)
        return fail(Errc::not_found, what + pin.name + " does not exist: motmod has " +
                                         std::to_string(count) +
                                         (digital ? " digital outputs" : " analog outputs"));
      continue;
    }
    if (pin.name.rfind("motion.dout-", 0) == 0 || pin.name.rfind("motion.aout-", 0) == 0)
      return fail(Errc::bad_argument, what + pin.name +
                                          ": outputs of motion are told by number here, motion." +
                                          (pin.name[7] == 'd' ? "digital" : "analog") +
                                          "-out-NN: its place in the list of names");
    const Found found = find(view, pin.name);
    if (found.type == hal::Type::unspecified) {
      auto value = view.value(pin.name);
      return fail(Errc::not_found, what + (value.ok() ? pin.name + " has no value"
                                                      : std::string(value.error().what.view())));
    }
    auto raw = hal::parse_value(found.type, pin.value);
    if (!raw.ok())
      return fail(Errc::bad_argument,
                  what + pin.name + ": " + std::string(raw.error().what.view()));
    if (!found.writer.empty())
      warnings.push_back(what + pin.name + " is driven by " + found.writer +
                         ": its safe value is written only when the realtime process is dead");
  }
  return {};
}

void SafeState::apply(bool host_lives) const {
  const hal::View view(segment_);
  if (!view.attached()) return;
  for (const SafePin& pin : pins_) {
    if (host_lives && is_motions_own(pin.name)) continue;
    const Found found = find(view, pin.name);
    if (found.slot.link == nullptr || (host_lives && !found.writer.empty())) continue;
    if (const auto raw = hal::parse_value(found.type, pin.value); raw.ok())
      found.slot.slot().store(*raw);
  }
}

void SafeState::disable() const {
  if (motion::MotionShared* motion = motion_of(segment_); motion != nullptr)
    motion->intent.enable.publish(0);
}

bool SafeState::enabled() const {
  const motion::MotionShared* motion = motion_of(segment_);
  motion::MotionStatus status;
  return motion != nullptr && rtapi::read_patiently(motion->status, status) && status.enabled;
}

void SafeState::add_to(rtapi::WaitSpec& spec) const {
  if (const motion::MotionShared* motion = motion_of(segment_); motion != nullptr)
    spec.watch(motion->status_cell);
}

void SafeState::look() {
  const bool now = enabled();
  if (was_enabled_ && !now) apply(true);
  was_enabled_ = now;
}

std::vector<std::string> run_safe_commands(const std::vector<std::vector<std::string>>& commands) {
  constexpr int kPatienceMs = 1000;
  std::vector<std::string> complaints;
  std::vector<Child> started;
  for (const std::vector<std::string>& words : commands) {
    auto child = Child::start(words);
    if (child.ok())
      started.push_back(std::move(*child));
    else
      complaints.push_back("[SAFE_STATE]COMMAND: " + child.error().message());
  }
  const auto running = [&] {
    return std::any_of(started.begin(), started.end(), [](Child& c) { return c.running(); });
  };
  for (int waited = 0; waited < kPatienceMs && running(); waited += 2) pause_ms(2);
  for (Child& child : started) {
    const auto exit = child.poll_exit();
    if (!exit || exit->by_signal || exit->number != 0)
      complaints.push_back(
          "[SAFE_STATE]COMMAND: " + child.name() + " " +
          (exit ? describe_exit(*exit) : std::string("did not end within a second")));
  }
  return complaints;
}

}  // namespace kerf::launcher
