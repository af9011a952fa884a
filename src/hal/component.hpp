// The C++ API of HAL components: one struct with typed members; each member declares and exports itself.
//
//   class And2 final : public hal::Component<And2> {
//    public:
//     static constexpr hal::Info kInfo{.name = "and2", .summary = "Two-input AND gate", .license = "MIT"};
//     using Component::Component;
//
//    private:
//     hal::In<bool> in0_{pin<hal::In<bool>>("in0", "First input")};
//     hal::In<bool> in1_{pin<hal::In<bool>>("in1", "Second input")};
//     hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while both inputs are true")};
//     void update(const hal::Period&) noexcept { out_ = in0_ && in1_; }
//     hal::Function update_{function<&And2::update>("", "Recompute out")};
//   };
//   KERF_HAL_MODULE(And2)
//
// The loader, not the component, knows `count=`, `names=`, `personality=` and prefixes. Realtime functions are noexcept, or
// do not compile. Construction is load time: it may not throw; errors latch in the Builder and the loader reports the first.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string_view>
#include <type_traits>

#include "hal/core/types.hpp"

namespace kerf::rtapi {
class Clock;
class Participant;
}  // namespace kerf::rtapi

namespace kerf::hal {

/// What a function is told of time.
struct Period {
  std::int64_t nominal_ns{0};  ///< the thread's period
  std::int64_t actual_ns{
      0};  ///< since the thread's last start of a cycle; the nominal one in virtual time
  [[nodiscard]] constexpr double seconds() const noexcept {
    return static_cast<double>(nominal_ns) * 1e-9;
  }
  [[nodiscard]] constexpr double actual_seconds() const noexcept {
    return static_cast<double>(actual_ns) * 1e-9;
  }
};

using FunctionThunk = void (*)(void* object, const Period& period) noexcept;

/// The pointer of a realtime component's pin to its value, which is the pin's own or its signal's. It stands in the handle, in memory
/// of the realtime host alone; the registry's writer changes it when the pin is linked or unlinked. So it has a fixed place, and a
/// thread's functions read little more than their values.
class PinCell {
 public:
  PinCell() = default;
  PinCell(const PinCell&) = delete;
  PinCell& operator=(const PinCell&) = delete;
  /// @rt. The value itself is relaxed: each stands alone; nothing orders two pins across threads.
  [[nodiscard]] std::atomic<std::uint64_t>& slot() const noexcept {
    // Acquire: pairs with the writer's release store of a new address, so a new signal's first value is there before it is used.
    // Both the old and the new slot exist until every thread has finished a cycle.
    return *reinterpret_cast<std::atomic<std::uint64_t>*>(address_.load(std::memory_order_acquire));
  }
  /// For who makes the pin.
  [[nodiscard]] std::uint64_t* word() noexcept {
    return reinterpret_cast<std::uint64_t*>(&address_);
  }
  void point(std::atomic<std::uint64_t>& slot) noexcept {
    address_.store(reinterpret_cast<std::uintptr_t>(&slot), std::memory_order_release);
  }

 private:
  std::atomic<std::uint64_t> address_{0};
};

/// The value of a parameter, which stands where it is for ever.
struct FixedSlot {
  std::atomic<std::uint64_t>* value{nullptr};
  /// @rt.
  [[nodiscard]] std::atomic<std::uint64_t>& slot() const noexcept { return *value; }
};

/// The value of any item, from any process: `link` holds the way from itself to the slot, in bytes, which is the same wherever a
/// process maps the segment.
struct SlotRef {
  const std::atomic<std::uint64_t>* link{nullptr};

  /// @rt.
  [[nodiscard]] std::atomic<std::uint64_t>& slot() const noexcept {
    // Acquire: as in PinCell.
    const std::uint64_t way = link->load(std::memory_order_acquire);
    return *reinterpret_cast<std::atomic<std::uint64_t>*>(reinterpret_cast<std::uintptr_t>(link) +
                                                          way);
  }
};

struct Info {
  std::string_view name;     ///< component name as loadrt takes it
  std::string_view summary;  ///< one line, for man page and `halcmd show`
  std::string_view license{"MIT"};
  std::string_view notes{};       ///< more text for the man page
  bool singleton{false};          ///< one instance, named as the component, no count= or names=
  std::int32_t default_count{1};  ///< instances when neither count= nor names= is given
  /// loadrt parameters that show what the component can have, for one that has no pins without ("cfg=bf depth=100"): the man
  /// page describes it loaded so.
  std::string_view example{};
  /// Names, between blanks, of the loadrt parameters that take a list: with [HAL]TWOPASS those of several lines are joined.
  std::string_view lists{};
  /// A singleton that takes names= itself (hal/channels.hpp).
  bool own_names{false};
};

/// Collects what a component declares. The live one exports into the segment, others write docs or serve unit tests.
/// Names are whole HAL names. Errors latch: after the first, calls return harmless objects and do nothing.
class Builder {
 public:
  /// `cell` must stay where it is as long as the component lives. nullptr: the component does not touch the pin.
  virtual void add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                       std::string_view doc, PinCell* cell) noexcept = 0;
  virtual FixedSlot add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                              std::string_view doc) noexcept = 0;
  virtual void add_function(std::string_view name, FunctionThunk thunk, void* object,
                            std::string_view doc) noexcept = 0;
  /// Text of a loadrt parameter NAME=..., or "" when it was not given. Asking declares it; parameters that no component asked
  /// for are an error with the nearest name. The text lives as long as the instance.
  virtual std::string_view arg(std::string_view name, std::string_view default_text,
                               std::string_view doc) noexcept = 0;
  /// Zero-filled, locked memory that lives as long as the component. nullptr after an error.
  virtual void* allocate(std::size_t bytes, std::size_t align) noexcept = 0;
  /// A new block of the instance's segment, zero-filled, or nullptr after an error. Others find it once the component is ready.
  virtual std::byte* shared_block(std::string_view name, std::size_t bytes,
                                  std::uint64_t abi) noexcept = 0;
  /// Objects that one component offers to those loaded later (kinematics).
  virtual void provide(std::string_view service, void* object) noexcept = 0;
  virtual void* find_service(std::string_view service) noexcept = 0;
  /// A function that a loaded module in C exports (kinematics), of the module loaded last; nullptr: none does. That module stays
  /// loaded as long as this component.
  virtual void* find_c_function(std::string_view /*name*/) noexcept { return nullptr; }
  /// Calls code that belongs to the module of the function found last: it may make pins as in its rtapi_app_main.
  virtual void call_c(void (*code)(void*), void* argument) noexcept { code(argument); }
  /// A machine of the non-realtime kind that the host runs beside the realtime threads (the planner).
  virtual void add_participant(rtapi::Participant& participant) noexcept = 0;
  /// Makes a realtime thread. The fastest first.
  virtual void add_thread(std::string_view name, std::int64_t period_ns) noexcept = 0;
  [[nodiscard]] virtual const rtapi::Clock& clock() const noexcept = 0;
  virtual void fail(std::string_view what) noexcept = 0;
  [[nodiscard]] virtual bool failed() const noexcept = 0;

  [[nodiscard]] const Name& prefix() const noexcept { return prefix_; }
  [[nodiscard]] std::int64_t personality() const noexcept { return personality_; }
  /// True when nothing will ever run and the machine is perhaps another one (`halcmd check`, `hal describe`): a driver declares
  /// its pins as its parameters tell, and touches no device.
  [[nodiscard]] bool declares_only() const noexcept { return declares_only_; }
  /// "PREFIX.suffix", or the prefix itself for an empty suffix; too long is an error that names it.
  [[nodiscard]] Name full_name(std::string_view suffix) noexcept {
    Name name = prefix_;
    if (!suffix.empty()) {
      name.append(".");
      name.append(suffix);
    }
    if (name.truncated()) fail("name longer than 55 characters");
    return name;
  }

 protected:
  ~Builder() = default;
  Name prefix_;
  std::int64_t personality_{0};
  bool declares_only_{false};
};

namespace detail {
/// What all handles have. `Place` tells where the value stands: PinCell, FixedSlot or SlotRef.
template <class T, Dir kDirection, class Place>
class Handle {
 public:
  using Item = T;
  static constexpr Dir kDir = kDirection;
  static constexpr bool kIsOfAnyProcess = std::is_same_v<Place, SlotRef>;

  Handle() = default;
  /// A new item of the component.
  Handle(Builder& b, std::string_view whole_name, std::string_view doc, T initial = {}) noexcept
      requires(!kIsOfAnyProcess) {
    declare(b, whole_name, doc, initial);
  }
  explicit Handle(SlotRef ref) noexcept requires kIsOfAnyProcess : place_(ref) {}

  /// Makes the item of a handle that has none, once; for names that are known only in the constructor's body. `type` may differ from
  /// T's when T is std::uint64_t, which reads and writes slots as they are.
  void declare(Builder& b, std::string_view whole_name, std::string_view doc, T initial = {},
               Type type = TypeOf<T>::kType) noexcept requires(!kIsOfAnyProcess) {
    if constexpr (std::is_same_v<Place, PinCell>)
      b.add_pin(whole_name, type, kDir, to_raw<T>(initial), doc, &place_);
    else
      place_ = b.add_param(whole_name, type, kDir, to_raw<T>(initial), doc);
  }
  /// For who makes the item without a Builder.
  [[nodiscard]] Place& place() noexcept { return place_; }

 protected:
  [[nodiscard]] T load() const noexcept {
    return from_raw<T>(place_.slot().load(std::memory_order_relaxed));
  }
  void store(T v) const noexcept { place_.slot().store(to_raw<T>(v), std::memory_order_relaxed); }

 private:
  Place place_;
};

/// An item that the program reads.
template <class T, Dir kDirection, class Place>
class Reading : public Handle<T, kDirection, Place> {
 public:
  using Handle<T, kDirection, Place>::Handle;
  [[nodiscard]] T get() const noexcept { return this->load(); }
  operator T() const noexcept { return this->load(); }
};

/// One that it writes. `last()` is what stands there, normally the last value written.
template <class T, Dir kDirection, class Place>
class Writing : public Handle<T, kDirection, Place> {
 public:
  using Handle<T, kDirection, Place>::Handle;
  void set(T v) noexcept { this->store(v); }
  Writing& operator=(T v) noexcept {
    this->store(v);
    return *this;
  }
  [[nodiscard]] T last() const noexcept { return this->load(); }
};

/// One that it reads and writes.
template <class T, Dir kDirection, class Place>
class Sharing : public Handle<T, kDirection, Place> {
 public:
  using Handle<T, kDirection, Place>::Handle;
  [[nodiscard]] T get() const noexcept { return this->load(); }
  operator T() const noexcept { return this->load(); }
  void set(T v) noexcept { this->store(v); }
  Sharing& operator=(T v) noexcept {
    this->store(v);
    return *this;
  }
};
}  // namespace detail

// Pins of a realtime component. They cannot be copied or moved: HAL knows where they stand.
/// A pin that the component reads.
template <class T>
using In = detail::Reading<T, Dir::in, PinCell>;
/// A pin that the component writes.
template <class T>
using Out = detail::Writing<T, Dir::out, PinCell>;
/// A pin that several components write (index-enable).
template <class T>
using Io = detail::Sharing<T, Dir::io, PinCell>;
/// A parameter that users set (rw) and the component reads; the component may write it too.
template <class T>
using Param = detail::Sharing<T, Dir::rw, FixedSlot>;
/// A parameter that the component writes and users read (ro).
template <class T>
using RoParam = detail::Writing<T, Dir::ro, FixedSlot>;

// Pins of a component in an ordinary process (hal/client/user_component.hpp), and items of others.
template <class T>
using LinkIn = detail::Reading<T, Dir::in, SlotRef>;
template <class T>
using LinkOut = detail::Writing<T, Dir::out, SlotRef>;
template <class T>
using LinkIo = detail::Sharing<T, Dir::io, SlotRef>;

/// Declares pins with whole names: for components that are known by other names than their own (motion.*, joint.N.*). The result
/// must initialise the component's member itself.
template <class Pin>
[[nodiscard]] Pin make_pin(Builder& b, std::string_view whole_name, std::string_view doc,
                           typename Pin::Item initial = {}) noexcept {
  return Pin(b, whole_name, doc, initial);
}
template <class P>
[[nodiscard]] P make_param(Builder& b, std::string_view whole_name, std::string_view doc,
                           typename P::Item initial = {}) noexcept {
  return P(b, whole_name, doc, initial);
}
/// A pin that the component does not touch.
template <class Pin>
void declare_pin(Builder& b, std::string_view whole_name, std::string_view doc,
                 typename Pin::Item initial = {}) noexcept {
  using T = typename Pin::Item;
  b.add_pin(whole_name, TypeOf<T>::kType, Pin::kDir, to_raw<T>(initial), doc, nullptr);
}

/// n objects made as T(builder, index, args...) in the component's memory; for repeated groups of pins.
template <class T>
class Array {
 public:
  Array() = default;
  Array(T* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  T& operator[](std::size_t i) noexcept { return data_[i]; }
  const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  T* begin() noexcept { return data_; }
  T* end() noexcept { return data_ + size_; }

 private:
  T* data_{nullptr};
  std::size_t size_{0};
};
template <class T, class... A>
Array<T> make_array(Builder& b, std::size_t n, const A&... args) noexcept {
  static_assert(std::is_trivially_destructible_v<T>,
                "the loader gives the memory back without destructors");
  if (n == 0) return {};
  void* memory = b.allocate(n * sizeof(T), alignof(T));
  if (memory == nullptr) return {};
  T* items = static_cast<T*>(memory);
  for (std::size_t i = 0; i < n; ++i) new (items + i) T(b, i, args...);
  return {items, n};
}

/// Replaces the run of '#' in `pattern` by `index`, padded with zeros to the run's length: "in-##", 3 -> "in-03".
inline Name numbered(std::string_view pattern, std::size_t index) noexcept {
  const auto first = pattern.find('#');
  if (first == std::string_view::npos) return Name(pattern);
  auto last = first;
  while (last < pattern.size() && pattern[last] == '#') ++last;
  char digits[24];
  std::size_t n = 0;
  do {
    digits[n++] = static_cast<char>('0' + index % 10);
    index /= 10;
  } while (index > 0 && n < sizeof digits);
  Name name(std::string_view(pattern.data(), first));  // substr() could throw
  for (std::size_t width = last - first; width > n; --width) name.append("0");
  while (n > 0) name.append(std::string_view(&digits[--n], 1));
  name.append(std::string_view(pattern.data() + last, pattern.size() - last));
  return name;
}

/// Up to N pins of one kind, "in-##" style.
template <class Pin, std::size_t N>
class PinArray {
 public:
  PinArray() = default;
  /// `pattern` goes behind the component's prefix.
  PinArray(Builder& b, std::string_view pattern, std::size_t count, std::string_view doc,
           typename Pin::Item initial = {}) noexcept {
    for (std::size_t i = 0; i < count && !b.failed(); ++i)
      add(b, b.full_name(numbered(pattern, i)), doc, initial);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  Pin& operator[](std::size_t i) noexcept { return pins_[i]; }
  const Pin& operator[](std::size_t i) const noexcept { return pins_[i]; }
  void add(Builder& b, std::string_view whole_name, std::string_view doc,
           typename Pin::Item initial = {},
           Type type = TypeOf<typename Pin::Item>::kType) noexcept {
    if (size_ == N) return b.fail("more pins than the component has room for");
    pins_[size_++].declare(b, whole_name, doc, initial, type);
  }

 private:
  Pin pins_[N]{};
  std::size_t size_{0};
};

/// Token of a declared function; it has no state.
struct Function {};

/// Base of every component. Not movable: functions hold its address.
template <class Derived>
class Component {
 public:
  explicit Component(Builder& b) noexcept { building = &b; }
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

 protected:
  /// The builder is there while the component is constructed, and not after.
  [[nodiscard]] static Builder& builder() noexcept { return *building; }
  [[nodiscard]] static std::int64_t personality() noexcept { return building->personality(); }

  template <class Pin>
  [[nodiscard]] Pin pin(std::string_view suffix, std::string_view doc,
                        typename Pin::Item initial = {}) noexcept {
    return make_pin<Pin>(builder(), builder().full_name(suffix), doc, initial);
  }
  template <class P>
  [[nodiscard]] P param(std::string_view suffix, std::string_view doc,
                        typename P::Item initial = {}) noexcept {
    return make_param<P>(builder(), builder().full_name(suffix), doc, initial);
  }
  template <class Pin, std::size_t N>
  [[nodiscard]] PinArray<Pin, N> pins(std::string_view pattern, std::size_t count,
                                      std::string_view doc,
                                      typename Pin::Item initial = {}) noexcept {
    return PinArray<Pin, N>(builder(), pattern, count, doc, initial);
  }
  /// Suffix "" exports the function under the instance's own name.
  template <auto Method>
  Function function(std::string_view suffix, std::string_view doc) noexcept {
    return function_named<Method>(builder().full_name(suffix), doc);
  }
  template <auto Method>
  Function function_named(std::string_view whole_name, std::string_view doc) noexcept {
    static_assert(std::is_nothrow_invocable_v<decltype(Method), Derived&, const Period&>,
                  "realtime functions must be noexcept and take (const hal::Period&)");
    builder().add_function(
        whole_name,
        [](void* object, const Period& period) noexcept {
          (static_cast<Derived*>(object)->*Method)(period);
        },
        static_cast<Derived*>(this), doc);
    return {};
  }
  /// loadrt parameters, as text and as numbers. A number that does not parse is an error that names it.
  std::string_view text_arg(std::string_view name, std::string_view default_text,
                            std::string_view doc) noexcept {
    return builder().arg(name, default_text, doc);
  }
  std::int64_t int_arg(std::string_view name, std::int64_t default_value,
                       std::string_view doc) noexcept {
    char text[24];
    std::size_t n = sizeof text;
    const bool negative = default_value < 0;
    auto rest = negative ? 0 - static_cast<std::uint64_t>(default_value)
                         : static_cast<std::uint64_t>(default_value);
    do {
      text[--n] = static_cast<char>('0' + rest % 10);
      rest /= 10;
    } while (rest > 0);
    if (negative) text[--n] = '-';
    std::int64_t value = default_value;
    const std::string_view given =
        builder().arg(name, std::string_view(text + n, sizeof text - n), doc);
    if (!given.empty() && !parse_int(given, value))
      builder().fail("a loadrt parameter is not an integer");
    return value;
  }
  /// Decimal, 0x hexadecimal, with sign.
  static bool parse_int(std::string_view text, std::int64_t& out) noexcept {
    const bool negative = !text.empty() && text[0] == '-';
    if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
    std::uint64_t base = 10;
    if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
      base = 16;
      text.remove_prefix(2);
    }
    if (text.empty() || text.size() > 18) return false;
    std::uint64_t value = 0;
    for (const char c : text) {
      std::uint64_t digit = 99;
      if (c >= '0' && c <= '9') digit = static_cast<std::uint64_t>(c - '0');
      if (c >= 'a' && c <= 'f') digit = static_cast<std::uint64_t>(c - 'a') + 10;
      if (c >= 'A' && c <= 'F') digit = static_cast<std::uint64_t>(c - 'A') + 10;
      if (digit >= base) return false;
      value = value * base + digit;
    }
    out = negative ? -static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
    return true;
  }

 private:
  /// A member of the object would be 8 bytes of cache in each cycle. Components are made by one thread, one after the other.
  inline static Builder* building{nullptr};
};

/// What a component's shared object exports: its one symbol.
struct Module {
  std::uint64_t abi;
  Info info;
  std::size_t size;
  std::size_t align;
  void (*create)(void* storage, Builder& builder) noexcept;
  void (*destroy)(void* object) noexcept;
  void* c_library{
      nullptr};  ///< set by the loader: a module of the C API, for dlsym; the rest of it is empty
};
/// Raised when Builder, Module, Info or the handles change.
inline constexpr std::uint64_t kModuleAbi = 6;

/// Name of the symbol for component file ID (dashes as underscores): kerf_hal_module_ID.
inline constexpr std::string_view kModuleSymbolPrefix = "kerf_hal_module_";

}  // namespace kerf::hal

#define KERF_HAL_SYMBOL_OF(id) kerf_hal_module_##id
#define KERF_HAL_SYMBOL(id) KERF_HAL_SYMBOL_OF(id)
/// Exports the module. KERF_MODULE_ID is set by kerf_component() in CMake to the file's name.
#define KERF_HAL_MODULE(Class)                                                                  \
  extern "C"                                                                                    \
      [[gnu::visibility("default")]] const ::kerf::hal::Module KERF_HAL_SYMBOL(KERF_MODULE_ID); \
  extern "C" const ::kerf::hal::Module KERF_HAL_SYMBOL(KERF_MODULE_ID){                         \
      ::kerf::hal::kModuleAbi,                                                                  \
      Class::kInfo,                                                                             \
      sizeof(Class),                                                                            \
      alignof(Class),                                                                           \
      [](void* storage, ::kerf::hal::Builder& b) noexcept { new (storage) Class(b); },          \
      [](void* object) noexcept { std::destroy_at(static_cast<Class*>(object)); }};
