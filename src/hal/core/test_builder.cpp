#include "hal/core/test_builder.hpp"

#include <cstring>
#include <new>
#include <stdexcept>

#include "hal/port_pins.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

struct TestBuilder::Slot {
  std::atomic<std::uint64_t> own{0};
  std::atomic<std::uint64_t>* in_effect{nullptr};
  PinCell* cell{nullptr};
};

TestBuilder::TestBuilder() : slots_(new Slot[kSlots]) {}

TestBuilder::~TestBuilder() {
  for (auto it = instances_.rbegin(); it != instances_.rend(); ++it) it->destroy(it->object);
}

bool TestBuilder::create(const Module& module, std::string_view prefix, std::int64_t personality) {
  error_.clear();
  prefix_ = Name(prefix);
  personality_ = personality;
  void* storage = allocate(module.size, module.align);
  module.create(storage, *this);
  instances_.push_back({storage, module.destroy});
  return error_.empty();
}

void TestBuilder::point(std::size_t slot, std::atomic<std::uint64_t>& value) noexcept {
  slots_[slot].in_effect = &value;
  if (slots_[slot].cell != nullptr) slots_[slot].cell->point(value);
}

TestBuilder::Slot& TestBuilder::add_item(std::string_view name, Type type, Dir dir,
                                         std::uint64_t initial, std::string_view doc,
                                         PinCell* cell) noexcept {
  std::size_t slot = used_;
  if (used_ == kSlots) {
    fail("more pins than TestBuilder has room for");
    slot = kSlots - 1;
  } else {
    ++used_;
  }
  if (name.size() > kNameLength) fail("name longer than 55 characters: " + std::string(name));
  if (by_name_.count(name) > 0) fail("duplicate name '" + std::string(name) + "'");
  slots_[slot].own.store(initial, std::memory_order_relaxed);
  slots_[slot].cell = cell;
  point(slot, slots_[slot].own);
  by_name_.emplace(std::string(name), items_.size());
  items_.push_back({std::string(name), type, dir, std::string(doc), slot});
  return slots_[slot];
}

void TestBuilder::add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                          std::string_view doc, PinCell* cell) noexcept {
  (void)add_item(name, type, dir, initial, doc, cell);
}

FixedSlot TestBuilder::add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                                 std::string_view doc) noexcept {
  return {&add_item(name, type, dir, initial, doc, nullptr).own};
}

void TestBuilder::add_function(std::string_view name, FunctionThunk thunk, void* object,
                               std::string_view /*doc*/) noexcept {
  functions_.push_back({std::string(name), thunk, object});
}

std::string_view TestBuilder::arg(std::string_view name, std::string_view default_text,
                                  std::string_view /*doc*/) noexcept {
  auto it = args_.find(name);
  if (it == args_.end()) it = args_.emplace(std::string(name), std::string(default_text)).first;
  return it->second;
}

TestBuilder::Memory TestBuilder::zeroed(std::size_t bytes, std::size_t align) {
  auto* p = static_cast<std::byte*>(::operator new(bytes, std::align_val_t(align)));
  std::memset(p, 0, bytes);
  return {p, FreeAligned{align}};
}

void* TestBuilder::allocate(std::size_t bytes, std::size_t align) noexcept {
  memory_.push_back(zeroed(bytes, align));
  return memory_.back().get();
}

std::byte* TestBuilder::shared_block(std::string_view name, std::size_t bytes,
                                     std::uint64_t /*abi*/) noexcept {
  if (blocks_.count(name) > 0) {
    fail("duplicate block '" + std::string(name) + "'");
    return nullptr;
  }
  return blocks_.emplace(std::string(name), zeroed(bytes, 64)).first->second.get();
}

std::byte* TestBuilder::block(std::string_view name) const {
  const auto it = blocks_.find(name);
  return it == blocks_.end() ? nullptr : it->second.get();
}

void TestBuilder::provide(std::string_view service, void* object) noexcept {
  services_[std::string(service)] = object;
}

void* TestBuilder::find_service(std::string_view service) noexcept {
  if (service == kPortsService) {
    if (queues_ == nullptr) queues_ = zeroed(kQueueBytes, alignof(PortHeader));
    return queues_.get();
  }
  const auto it = services_.find(service);
  return it == services_.end() ? nullptr : it->second;
}

void TestBuilder::add_participant(rtapi::Participant& participant) noexcept {
  participants_.push_back(&participant);
}

void TestBuilder::add_thread(std::string_view name, std::int64_t period_ns) noexcept {
  threads_.push_back({std::string(name), period_ns});
}

void TestBuilder::fail(std::string_view what) noexcept {
  if (error_.empty()) error_ = what.empty() ? "error" : std::string(what);
}

const TestBuilder::Item& TestBuilder::find(std::string_view name) const {
  const auto it = by_name_.find(name);
  if (it == by_name_.end()) {
    throw std::logic_error("no pin or parameter '" + std::string(name) + "'" +
                           rtapi::did_you_mean(name, items()));
  }
  return items_[it->second];
}

std::uint64_t TestBuilder::raw(std::string_view name, Type type) const {
  const Item& item = find(name);
  if (item.type != type) throw std::logic_error("'" + item.name + "' has another type");
  return slots_[item.slot].in_effect->load(std::memory_order_relaxed);
}

void TestBuilder::store(const Item& item, std::uint64_t raw) {
  slots_[item.slot].in_effect->store(raw, std::memory_order_relaxed);
}

void TestBuilder::set_real(std::string_view name, double value) {
  const Item& item = find(name);
  if (item.type != Type::floating) throw std::logic_error("'" + item.name + "' is not a float");
  store(item, to_raw(value));
}

void TestBuilder::set_integer(std::string_view name, std::int64_t value) {
  const Item& item = find(name);
  switch (item.type) {
    case Type::bit: return store(item, to_raw(value != 0));
    case Type::floating: return store(item, to_raw(static_cast<double>(value)));
    case Type::s32: return store(item, to_raw(static_cast<std::int32_t>(value)));
    case Type::u32: return store(item, to_raw(static_cast<std::uint32_t>(value)));
    default: return store(item, to_raw(value));
  }
}

Type TestBuilder::type(std::string_view name) const { return find(name).type; }
Dir TestBuilder::dir(std::string_view name) const { return find(name).dir; }
std::string_view TestBuilder::doc(std::string_view name) const { return find(name).doc; }
bool TestBuilder::has(std::string_view name) const { return by_name_.count(name) > 0; }

std::vector<std::string> TestBuilder::items() const {
  std::vector<std::string> names;
  for (const auto& item : items_) names.push_back(item.name);
  return names;
}

std::vector<std::string> TestBuilder::functions() const {
  std::vector<std::string> names;
  for (const auto& f : functions_) names.push_back(f.name);
  return names;
}

void TestBuilder::link(const std::vector<std::string>& pins) {
  if (pins.empty()) return;
  const Item& first = find(pins.front());
  auto* const target = slots_[first.slot].in_effect;
  for (const auto& name : pins) {
    const Item& item = find(name);
    if (item.type != first.type) throw std::logic_error("'" + name + "' has another type");
    point(item.slot, *target);
  }
}

Port TestBuilder::make_queue(std::string_view pin, std::uint32_t bytes) {
  const Item& item = find(pin);
  if (item.type != Type::port) throw std::logic_error("'" + item.name + "' is no port");
  constexpr std::size_t kAlign = alignof(PortHeader);
  queues_used_ += kAlign;  // 0 is no queue
  if (queues_used_ + Port::bytes(bytes) > kQueueBytes)
    throw std::logic_error("more queues than TestBuilder has room for");
  auto* header = new (queues_.get() + queues_used_) PortHeader();
  header->size = bytes;
  store(item, queues_used_);
  queues_used_ += (Port::bytes(bytes) + kAlign - 1) / kAlign * kAlign;
  return Port(header);
}

void TestBuilder::run(std::string_view function, std::int64_t period_ns, int cycles) {
  for (int i = 0; i < cycles; ++i) run_once(function, {period_ns, period_ns});
}

void TestBuilder::run_once(std::string_view function, const Period& period) {
  for (const auto& f : functions_) {
    if (f.name != function) continue;
    clock_.advance(period.actual_ns);
    f.thunk(f.object, period);
    return;
  }
  throw std::logic_error("no function '" + std::string(function) + "'" +
                         rtapi::did_you_mean(function, functions()));
}

}  // namespace kerf::hal
