#include "hal/loader/live_builder.hpp"

#include <cstring>
#include <new>
#include <utility>

#include "hal/core/value_access.hpp"
#include "hal/loader/c_modules.hpp"
#include "hal/operator_line.hpp"
#include "hal/port_pins.hpp"
#include "hal/segment_service.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal {

using rtapi::Result;

void LiveBuilder::fail(std::string_view what) noexcept {
  if (error_.empty()) error_ = what.empty() ? "error" : std::string(what);
}

void LiveBuilder::add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                          std::string_view /*doc*/, PinCell* cell) noexcept {
  if (cell != nullptr) cell->point(slot_of(dummy_));
  if (failed()) return;
  ItemSpec spec{.name = name, .type = type, .dir = dir, .initial = initial};
  if (cell != nullptr) spec.cell = cell->word();
  spec.owner_base = reinterpret_cast<std::uintptr_t>(host_.segment().base());
  if (auto made = host_.registry().add_pin(*loaded_.record, spec); !made.ok())
    fail(made.error().message());
}

FixedSlot LiveBuilder::add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                                 std::string_view /*doc*/) noexcept {
  if (failed()) return {&slot_of(dummy_)};
  auto made = host_.registry().add_param(*loaded_.record, name, type, dir, initial);
  if (made.ok()) return host_.registry().fixed_slot(**made);
  fail(made.error().message());
  return {&slot_of(dummy_)};
}

void LiveBuilder::add_function(std::string_view name, FunctionThunk thunk, void* object,
                               std::string_view /*doc*/) noexcept {
  if (failed()) return;
  auto& registry = host_.registry();
  auto made = registry.add_function(*loaded_.record, name, reinterpret_cast<std::uintptr_t>(thunk),
                                    reinterpret_cast<std::uintptr_t>(object));
  if (!made.ok()) return fail(made.error().message());
  loaded_.functions.push_back(*made);
  host_.functions_.emplace(*made, RunEntry{thunk, object, registry.segment().offset_of(*made)});
  without_times_.push_back(*made);
}

void LiveBuilder::show_times() noexcept {
  for (FunctionRecord* record : std::exchange(without_times_, {})) make_times(*record);
}

void LiveBuilder::make_times(FunctionRecord& record) noexcept {
  if (failed()) return;
  const std::string base(record.name.view());
  record.times.time.declare(*this, base + ".time", "Time of the last run [ns]");
  record.times.tmax.declare(*this, base + ".tmax", "Longest time of a run [ns]");
  record.times.tmax_increased.declare(*this, base + ".tmax-increased", "The last run raised tmax");
}

std::string_view LiveBuilder::arg(std::string_view name, std::string_view default_text,
                                  std::string_view /*doc*/) noexcept {
  asked_.emplace(name);
  const auto given = args_.find(name);
  // The text lives as long as the instance, so it is kept with the component.
  loaded_.texts.push_back(
      std::make_unique<std::string>(given == args_.end() ? default_text : given->second));
  return *loaded_.texts.back();
}

std::string LiveBuilder::unknown_arg() const {
  for (const auto& [name, text] : args_) {
    if (asked_.count(name) > 0) continue;
    std::vector<std::string> known(asked_.begin(), asked_.end());
    for (const std::string_view own : {"count", "names", "personality"})
      if (name != own) known.emplace_back(own);
    return std::string("Unknown parameter `")
        .append(name)
        .append("=")
        .append(text)
        .append("'")
        .append(rtapi::did_you_mean(name, known));
  }
  return {};
}

void* LiveBuilder::allocate(std::size_t bytes, std::size_t align) noexcept {
  if (failed()) return nullptr;
  void* data = ::operator new(bytes, std::align_val_t(align), std::nothrow);
  if (data == nullptr) {
    fail("no memory for a component");
    return nullptr;
  }
  std::memset(data, 0, bytes);  // also backs the pages before a realtime thread meets them
  loaded_.memory.push_back({data, bytes, align});
  return data;
}

std::byte* LiveBuilder::shared_block(std::string_view name, std::size_t bytes,
                                     std::uint64_t abi) noexcept {
  if (failed()) return nullptr;
  // Shown when the component is ready: who looks for it before then must not find half of it.
  auto block = host_.registry().add_memory(name, bytes, abi, true);
  if (!block.ok()) {
    fail(block.error().message());
    return nullptr;
  }
  loaded_.blocks.push_back(*block);
  return host_.segment().at<std::byte>((*block)->memory);
}

void LiveBuilder::provide(std::string_view service, void* object) noexcept {
  if (failed()) return;
  const auto [it, added] =
      host_.services_.emplace(std::string(service), Host::Service{object, &loaded_});
  if (!added) {
    return fail("service '" + it->first + "' is already provided by " + it->second.provider->name);
  }
  loaded_.services.emplace_back(service);
}

namespace {

/// In memory of the component that asks.
void* operator_line(Builder& b, rtapi::Segment& segment) noexcept {
  auto ring = rtapi::open_log(segment);
  if (!ring.ok()) {
    b.fail(ring.error().message());
    return nullptr;
  }
  void* memory = b.allocate(sizeof(OperatorLine), alignof(OperatorLine));
  if (memory == nullptr) return nullptr;
  return new (memory)
      OperatorLine{[](void* to, std::string_view text) noexcept {
                     static_cast<rtapi::LogRing*>(to)->write(rtapi::Level::error, text);
                   },
                   *ring};
}

}  // namespace

void* LiveBuilder::find_service(std::string_view service) noexcept {
  if (service == kOperatorLine) return operator_line(*this, host_.segment());
  if (service == kSegmentService) return &host_.segment();
  if (service == kPortsService) return host_.segment().base();
  const auto it = host_.services_.find(service);
  if (it == host_.services_.end()) return nullptr;
  if (it->second.provider != &loaded_) loaded_.uses.insert(it->second.provider);
  return it->second.object;
}

void* LiveBuilder::find_c_function(std::string_view name) noexcept {
  const auto [function, owner] = host_.c_modules_->find_function(std::string(name));
  if (function == nullptr) return nullptr;
  c_module_ = owner;
  loaded_.uses.insert(owner);
  return function;
}

void LiveBuilder::call_c(void (*code)(void*), void* argument) noexcept {
  if (c_module_ != nullptr) host_.c_modules_->run_as(*c_module_, code, argument);
}

void LiveBuilder::add_participant(rtapi::Participant& participant) noexcept {
  if (!failed()) loaded_.participants.push_back(&participant);
}

void LiveBuilder::add_thread(std::string_view name, std::int64_t period_ns) noexcept {
  if (!failed()) threads_.push_back({std::string(name), period_ns});
}

}  // namespace kerf::hal
