// TestBuilder: gives a unit test the pins of a component by name. Private memory, no segment, no threads.
//
//   extern "C" const kerf::hal::Module kerf_hal_module_and2;
//
//   hal::TestBuilder hal;
//   hal.create(kerf_hal_module_and2, "and2.0");
//   hal.set("and2.0.in0", true);
//   hal.set("and2.0.in1", true);
//   hal.run("and2.0");
//   EXPECT_TRUE(hal.get<bool>("and2.0.out"));
//
// A wrong name or type in the test throws std::logic_error that names the nearest known name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "hal/component.hpp"
#include "hal/core/port.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

/// A clock that stands still until the test moves it; run() moves it by the period.
class ManualClock final : public rtapi::Clock {
 public:
  [[nodiscard]] rtapi::Nanos now() const noexcept override { return now_; }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
  void advance(rtapi::Nanos ns) noexcept { now_ += ns; }

 private:
  rtapi::Nanos now_{0};
};

class TestBuilder final : public Builder {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  TestBuilder();
  ~TestBuilder();
  TestBuilder(const TestBuilder&) = delete;
  TestBuilder& operator=(const TestBuilder&) = delete;

  /// Gives a loadrt parameter to the instances created from now on.
  void set_arg(std::string name, std::string text) { args_[std::move(name)] = std::move(text); }
  /// Makes one instance. False when the component reported an error: see error().
  bool create(const Module& module, std::string_view prefix, std::int64_t personality = 0);
  /// The same for a class known to the test.
  template <class Component>
  bool create(std::string_view prefix, std::int64_t personality = 0) {
    const Module module{
        kModuleAbi,
        Component::kInfo,
        sizeof(Component),
        alignof(Component),
        [](void* storage, Builder& b) noexcept { new (storage) Component(b); },
        [](void* object) noexcept { std::destroy_at(static_cast<Component*>(object)); }};
    return create(module, prefix, personality);
  }

  /// Writes a pin or parameter of any direction, converting the number to the item's type.
  template <class T>
  void set(std::string_view name, T value) {
    static_assert(std::is_arithmetic_v<T>);
    if constexpr (std::is_floating_point_v<T>)
      set_real(name, static_cast<double>(value));
    else
      set_integer(name, static_cast<std::int64_t>(value));
  }
  /// Reads a pin or parameter; T must be the item's C++ type (bool, double, std::int32_t, ...).
  template <class T>
  [[nodiscard]] T get(std::string_view name) const {
    return from_raw<T>(raw(name, TypeOf<T>::kType));
  }
  [[nodiscard]] Type type(std::string_view name) const;
  [[nodiscard]] Dir dir(std::string_view name) const;
  [[nodiscard]] std::string_view doc(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;
  /// All pins and parameters in the order of export.
  [[nodiscard]] std::vector<std::string> items() const;
  [[nodiscard]] std::vector<std::string> functions() const;
  /// Gives several pins of one type one common slot, as a signal does. It starts with the first
  /// pin's value.
  void link(const std::vector<std::string>& pins);
  /// Gives a port pin a queue, as setp does; link() shares it. The test is at its other end.
  Port make_queue(std::string_view pin, std::uint32_t bytes);
  /// Runs a function `cycles` times and moves the clock by the period before each.
  void run(std::string_view function, std::int64_t period_ns = kPeriodNs, int cycles = 1);

  /// Once, at any time since the last call.
  void run_once(std::string_view function, const Period& period);

  [[nodiscard]] const std::string& error() const { return error_; }
  /// Forgets a latched error.
  void clear_error() { error_.clear(); }
  ManualClock& manual_clock() { return clock_; }
  /// A block made by shared_block(), or nullptr.
  [[nodiscard]] std::byte* block(std::string_view name) const;
  struct Thread {
    std::string name;
    std::int64_t period_ns;
  };
  [[nodiscard]] const std::vector<Thread>& threads() const { return threads_; }
  [[nodiscard]] const std::vector<rtapi::Participant*>& participants() const {
    return participants_;
  }

  void add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
               std::string_view doc, PinCell* cell) noexcept override;
  FixedSlot add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                      std::string_view doc) noexcept override;
  void add_function(std::string_view name, FunctionThunk thunk, void* object,
                    std::string_view doc) noexcept override;
  std::string_view arg(std::string_view name, std::string_view default_text,
                       std::string_view doc) noexcept override;
  void* allocate(std::size_t bytes, std::size_t align) noexcept override;
  std::byte* shared_block(std::string_view name, std::size_t bytes,
                          std::uint64_t abi) noexcept override;
  void provide(std::string_view service, void* object) noexcept override;
  void* find_service(std::string_view service) noexcept override;
  void add_participant(rtapi::Participant& participant) noexcept override;
  void add_thread(std::string_view name, std::int64_t period_ns) noexcept override;
  [[nodiscard]] const rtapi::Clock& clock() const noexcept override { return clock_; }
  void fail(std::string_view what) noexcept override;
  [[nodiscard]] bool failed() const noexcept override { return !error_.empty(); }

 private:
  struct Slot;
  struct Item {
    std::string name;
    Type type;
    Dir dir;
    std::string doc;
    std::size_t slot;
  };
  struct FunctionItem {
    std::string name;
    FunctionThunk thunk;
    void* object;
  };
  struct Instance {
    void* object;
    void (*destroy)(void*) noexcept;
  };
  struct FreeAligned {
    std::size_t align;
    void operator()(std::byte* p) const noexcept { ::operator delete(p, std::align_val_t(align)); }
  };
  using Memory = std::unique_ptr<std::byte, FreeAligned>;

  Slot& add_item(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                 std::string_view doc, PinCell* cell) noexcept;
  [[nodiscard]] const Item& find(std::string_view name) const;
  [[nodiscard]] std::uint64_t raw(std::string_view name, Type type) const;
  void set_real(std::string_view name, double value);
  void set_integer(std::string_view name, std::int64_t value);
  void store(const Item& item, std::uint64_t raw);
  void point(std::size_t slot, std::atomic<std::uint64_t>& value) noexcept;
  Memory zeroed(std::size_t bytes, std::size_t align);

  static constexpr std::size_t kSlots = 8192;
  static constexpr std::size_t kQueueBytes = 262144;
  std::unique_ptr<Slot[]> slots_;
  std::size_t used_{0};
  Memory queues_;  ///< of ports, whose values are places in it
  std::size_t queues_used_{0};
  std::vector<Item> items_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::vector<FunctionItem> functions_;
  std::map<std::string, std::string, std::less<>> args_;
  std::vector<Memory> memory_;
  std::map<std::string, Memory, std::less<>> blocks_;
  std::map<std::string, void*, std::less<>> services_;
  std::vector<rtapi::Participant*> participants_;
  std::vector<Thread> threads_;
  std::vector<Instance> instances_;
  std::string error_;
  ManualClock clock_;
};

}  // namespace kerf::hal
