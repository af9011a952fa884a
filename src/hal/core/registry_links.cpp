// Registry: signals, links and values.
#include "hal/core/registry.hpp"

#include <algorithm>

#include "hal/core/port.hpp"
#include "hal/core/registry_change.hpp"
#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }
std::string type_of(Type type) { return quoted(type_name(type)); }

}  // namespace

Status Registry::new_signal(std::string_view name, Type type) {
  reclaim();
  if (find_pin(name) != nullptr) {
    return fail(Errc::exists, "Signal name " + quoted(name) + " must not be the same as a pin.");
  }
  if (type == Type::unspecified) return fail(Errc::bad_argument, "unknown signal type");
  if (auto made = make_signal(name, type); !made.ok()) return rtapi::Failure{made.error()};
  return {};
}

Result<SignalRecord*> Registry::make_signal(std::string_view name, Type type) {
  KERF_TRY(SignalRecord * signal, make<SignalRecord>(Kind::signal, name));
  auto value = take_slot(signal_values_);
  if (!value.ok()) {
    retire_record(*signal, sizeof *signal);
    return rtapi::Failure{value.error()};
  }
  signal->type = type;
  signal->value = *value;
  store_slot(segment_.at<std::byte>(*value), 0);
  const Change change(root_);
  insert(*signal);
  return signal;
}

void Registry::erase_signal(SignalRecord& signal) {
  while (signal.first_pin.get() != 0) detach(*at<ItemRecord>(signal.first_pin.get()));
  const Holds least = signal.user_seen != 0 ? Holds::own : Holds::everything;
  if (signal.type == Type::port) retire_queue(signal, least);
  retire_held({signal.value, SlotPool::kSlotBytes, Kind::none, Store::signal_value}, least);
  erase(signal, sizeof signal);
}

Status Registry::delete_signal(std::string_view name) {
  reclaim();
  SignalRecord* signal = find_signal(name);
  if (signal == nullptr) {
    return fail(Errc::not_found,
                "signal " + quoted(name) + " not found" + suggestion(name, {Kind::signal}));
  }
  const Change change(root_);
  erase_signal(*signal);
  return {};
}

const ItemRecord* Registry::pin_with(const SignalRecord& signal, Dir dir) const noexcept {
  // Most signals have no such pin and many readers: only look for one that is there.
  if ((dir == Dir::out ? signal.writers : signal.bidirs) == 0) return nullptr;
  for (auto* pin = at<ItemRecord>(signal.first_pin.get()); pin != nullptr;
       pin = at<ItemRecord>(pin->signal_next.get())) {
    if (pin->dir == dir) return pin;
  }
  return nullptr;
}

Status Registry::check_link(const ItemRecord& pin, const SignalRecord& signal) const {
  const std::string pin_name = quoted(pin.name);
  const std::string signal_name = quoted(signal.name);
  if (pin.type != signal.type) {
    return fail(Errc::type_mismatch, "Signal " + signal_name + " of type " + type_of(signal.type) +
                                         " cannot add pin " + pin_name + " of type " +
                                         type_of(pin.type));
  }
  if (pin.dir == Dir::in) return {};
  const char* label = pin.dir == Dir::out ? "OUT" : "I/O";
  const auto conflict = [&](Dir dir, const char* other) -> Status {
    const ItemRecord* p = pin_with(signal, dir);
    if (p == nullptr) return {};
    return fail(Errc::type_mismatch, "Signal " + signal_name + " can not add " + label + " pin " +
                                         pin_name + ", it already has " + other + " pin " +
                                         quoted(p->name));
  };
  KERF_CHECK(conflict(Dir::out, "OUT"));
  if (pin.dir == Dir::out) KERF_CHECK(conflict(Dir::io, "I/O"));
  return {};
}

void Registry::attach(ItemRecord& pin, SignalRecord& signal) noexcept {
  auto* value = segment_.at<std::byte>(signal.value);
  const auto* owner = at<ComponentRecord>(pin.owner);
  const bool of_user = owner != nullptr && owner->type != ComponentKind::realtime;
  if (pin.type == Type::port) {
    // The queue is that of the signal, from now on.
    retire_queue(pin, of_user ? Holds::own : Holds::everything);
  } else if (signal.first_pin.get() == 0) {
    // The first pin gives the signal its value, so that linking never makes a value jump.
    store_slot(value, load_value(pin.type, segment_.at<std::byte>(pin.value)));
  }
  if (auto* first = at<ItemRecord>(signal.first_pin.get()); first != nullptr)
    first->signal_previous.set(offset_of(&pin));
  pin.signal_next.set(signal.first_pin.get());
  signal.first_pin.set(offset_of(&pin));
  pin.signal.set(offset_of(&signal));
  if (pin.dir == Dir::in) ++signal.readers;
  if (pin.dir == Dir::out) ++signal.writers;
  if (pin.dir == Dir::io) ++signal.bidirs;
  if (of_user) signal.user_seen = 1;
  point(pin, signal.value);
}

void Registry::detach(ItemRecord& pin) noexcept {
  auto* signal = at<SignalRecord>(pin.signal.get());
  if (signal == nullptr) return;
  // A pin alone has no queue: that of the signal may end before the pin does.
  const std::uint64_t last =
      pin.type == Type::port ? 0 : load_value(pin.type, segment_.at<std::byte>(signal->value));
  store_slot(segment_.at<std::byte>(pin.value), last);
  point(pin, pin.value);
  const Offset next = pin.signal_next.get();
  const Offset previous = pin.signal_previous.get();
  if (previous == 0)
    signal->first_pin.set(next);
  else
    at<ItemRecord>(previous)->signal_next.set(next);
  if (next != 0) at<ItemRecord>(next)->signal_previous.set(previous);
  pin.signal_next.set(0);
  pin.signal_previous.set(0);
  pin.signal.set(0);
  if (pin.dir == Dir::in) --signal->readers;
  if (pin.dir == Dir::out) --signal->writers;
  if (pin.dir == Dir::io) --signal->bidirs;
}

Status Registry::net(std::string_view name, std::span<const std::string> pins) {
  reclaim();
  if (pins.empty()) return fail(Errc::bad_argument, "'net' requires at least one pin, none given");
  if (find_pin(name) != nullptr) {
    return fail(Errc::bad_argument,
                "Signal name " + quoted(name) +
                    " must not be the same as a pin.  Did you omit the signal name?");
  }
  if (const auto reason = bad_name_reason(name); !reason.empty()) {
    return fail(Errc::bad_argument, reason);
  }
  SignalRecord* signal = find_signal(name);
  std::vector<ItemRecord*> fresh;
  const ItemRecord* first = nullptr;
  // Check against the signal as it will be: what is there plus the pins named before.
  const ItemRecord* writer = signal != nullptr ? pin_with(*signal, Dir::out) : nullptr;
  const ItemRecord* bidir = signal != nullptr ? pin_with(*signal, Dir::io) : nullptr;
  for (const auto& pin_name : pins) {
    ItemRecord* pin = find_pin(pin_name);
    if (pin == nullptr) {
      return fail(Errc::not_found, "Pin " + quoted(pin_name) + " does not exist" +
                                       suggestion(pin_name, {Kind::pin}));
    }
    if (std::find(fresh.begin(), fresh.end(), pin) != fresh.end()) continue;
    if (const auto* linked = at<SignalRecord>(pin->signal.get()); linked != nullptr) {
      if (linked == signal) continue;
      return fail(Errc::busy, "Pin " + quoted(pin_name) + " was already linked to signal " +
                                  quoted(linked->name));
    }
    const Type type = signal != nullptr ? signal->type : first != nullptr ? first->type : pin->type;
    if (pin->type != type) {
      const std::string because =
          signal == nullptr ? " (from pin " + quoted(first->name) + ")" : std::string();
      return fail(Errc::type_mismatch, "Signal " + quoted(name) + " of type " + type_of(type) +
                                           because + " cannot add pin " + quoted(pin_name) +
                                           " of type " + type_of(pin->type));
    }
    const ItemRecord* other = pin->dir == Dir::in    ? nullptr
                              : writer != nullptr    ? writer
                              : pin->dir == Dir::out ? bidir
                                                     : nullptr;
    if (other != nullptr) {
      return fail(Errc::type_mismatch,
                  "Signal " + quoted(name) + " can not add " + std::string(dir_name(pin->dir)) +
                      " pin " + quoted(pin_name) + ", it already has " +
                      std::string(dir_name(other->dir)) + " pin " + quoted(other->name));
    }
    if (pin->dir == Dir::out) writer = pin;
    if (pin->dir == Dir::io && bidir == nullptr) bidir = pin;
    if (first == nullptr) first = pin;
    fresh.push_back(pin);
  }
  if (signal == nullptr) {
    auto made = make_signal(name, first->type);
    if (!made.ok()) return rtapi::Failure{made.error()};
    signal = *made;
  }
  const Change change(root_);
  for (auto* pin : fresh) attach(*pin, *signal);
  return {};
}

Status Registry::link(std::string_view pin_name, std::string_view signal_name) {
  reclaim();
  ItemRecord* pin = find_pin(pin_name);
  if (pin == nullptr) {
    return fail(Errc::not_found,
                "pin " + quoted(pin_name) + " not found" + suggestion(pin_name, {Kind::pin}));
  }
  SignalRecord* signal = find_signal(signal_name);
  if (signal == nullptr) {
    return fail(Errc::not_found, "signal " + quoted(signal_name) + " not found" +
                                     suggestion(signal_name, {Kind::signal}));
  }
  if (const auto* linked = at<SignalRecord>(pin->signal.get()); linked != nullptr) {
    if (linked == signal) return {};
    return fail(Errc::busy, "pin " + quoted(pin_name) + " is linked to " + quoted(linked->name) +
                                ", cannot link to " + quoted(signal_name));
  }
  KERF_CHECK(check_link(*pin, *signal));
  const Change change(root_);
  attach(*pin, *signal);
  return {};
}

Status Registry::link_pins(std::string_view first, std::string_view second) {
  reclaim();
  ItemRecord* a = find_pin(first);
  ItemRecord* b = find_pin(second);
  for (const auto& [pin, name] : {std::pair(a, first), std::pair(b, second)}) {
    if (pin == nullptr) {
      return fail(Errc::not_found,
                  "pin " + quoted(name) + " not found" + suggestion(name, {Kind::pin}));
    }
    if (const auto* linked = at<SignalRecord>(pin->signal.get()); linked != nullptr) {
      return fail(Errc::busy, "pin " + quoted(name) + " is linked to " + quoted(linked->name));
    }
  }
  if (a->type != b->type) {
    return fail(Errc::type_mismatch, "pin " + quoted(first) + " of type " + type_of(a->type) +
                                         " cannot link to pin " + quoted(second) + " of type " +
                                         type_of(b->type));
  }
  if (a != b && a->dir != Dir::in && b->dir != Dir::in &&
      (a->dir == Dir::out || b->dir == Dir::out)) {
    return fail(Errc::type_mismatch, "pins " + quoted(first) + " and " + quoted(second) +
                                         " both write, they cannot be linked");
  }
  // The signal bears the first pin's name, which `newsig` would refuse.
  KERF_TRY(SignalRecord * signal, make_signal(first, a->type));
  const Change change(root_);
  attach(*a, *signal);
  if (a != b) attach(*b, *signal);
  return {};
}

Status Registry::unlink(std::string_view name) {
  reclaim();
  ItemRecord* pin = find_pin(name);
  if (pin == nullptr) {
    return fail(Errc::not_found,
                "pin " + quoted(name) + " not found" + suggestion(name, {Kind::pin}));
  }
  const Change change(root_);
  detach(*pin);
  return {};
}

Status Registry::set_item(std::string_view name, std::string_view value) {
  if (ItemRecord* param = find_param(name); param != nullptr) {
    if (param->dir != Dir::rw) {
      return fail(Errc::permission, "param " + quoted(name) + " is not writable");
    }
    KERF_TRY(const std::uint64_t raw, parse_value(param->type, value));
    auto* at = segment_.at<std::byte>(param->value);
    if (param->native != 0)
      store_value(param->type, at, raw);
    else
      store_slot(at, raw);
    return {};
  }
  ItemRecord* pin = find_pin(name);
  if (pin == nullptr) {
    return fail(Errc::not_found, "parameter or pin " + quoted(name) + " not found" +
                                     suggestion(name, {Kind::pin, Kind::param}));
  }
  if (pin->dir == Dir::out)
    return fail(Errc::permission, "pin " + quoted(name) + " is not writable");
  if (const auto* signal = at<SignalRecord>(pin->signal.get()); signal != nullptr) {
    return fail(Errc::busy, "pin " + quoted(name) + " is connected to a signal; use sets " +
                                std::string(signal->name));
  }
  if (pin->type == Type::port) return make_queue(*pin, pin->value, value);
  KERF_TRY(const std::uint64_t raw, parse_value(pin->type, value));
  store_slot(segment_.at<std::byte>(pin->value), raw);
  return {};
}

Status Registry::set_signal(std::string_view name, std::string_view value) {
  SignalRecord* signal = find_signal(name);
  if (signal == nullptr) {
    return fail(Errc::not_found,
                "signal " + quoted(name) + " not found" + suggestion(name, {Kind::signal}));
  }
  if (signal->type == Type::port) return make_queue(*signal, signal->value, value);
  if (signal->writers > 0) {
    const auto* writer = pin_with(*signal, Dir::out);
    return fail(Errc::busy, "signal " + quoted(name) + " already has writer(s); it is " +
                                (writer != nullptr ? quoted(writer->name) : std::string("?")));
  }
  KERF_TRY(const std::uint64_t raw, parse_value(signal->type, value));
  store_slot(segment_.at<std::byte>(signal->value), raw);
  return {};
}

// ---- queues of ports ----------------------------------------------------------------------------

Status Registry::make_queue(const Record& record, Offset value, std::string_view size) {
  reclaim();
  KERF_TRY(const std::uint64_t bytes, parse_value(Type::port, size));
  if (const auto it = queues_.find(&record); it != queues_.end()) {
    return fail(Errc::busy,
                "port is already allocated with " + std::to_string(it->second.bytes) + " bytes.");
  }
  if (bytes == 0) return {};
  if (bytes > kPortBytesMax) {
    return fail(Errc::bad_argument, "port " + quoted(record.name) + " cannot have " +
                                        std::to_string(bytes) + " bytes; " +
                                        std::to_string(kPortBytesMax) + " is the most");
  }
  const auto width = static_cast<std::uint32_t>(bytes);
  KERF_TRY(const Offset offset, allocate(Port::bytes(width), Region::shared, Kind::none));
  auto* header = new (segment_.at<PortHeader>(offset)) PortHeader();
  header->size = width;
  queues_[&record] = {offset, width};
  // Release: the queue is there before a pin leads to it.
  segment_.at<std::atomic<std::uint64_t>>(value)->store(offset, std::memory_order_release);
  root_.changed.notify();
  return {};
}

void Registry::retire_queue(const Record& record, Holds least) {
  const auto it = queues_.find(&record);
  if (it == queues_.end()) return;
  retire_held({it->second.offset, Port::bytes(it->second.bytes), Kind::none, Store::shared}, least);
  queues_.erase(it);
}

}  // namespace kerf::hal
