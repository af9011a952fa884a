// View: reads HAL from any process that has the segment mapped, and never waits for the writer.
//
//   hal::View view(segment);
//   const auto pin = view.find_pin("motion.in-position");
//   if (pin) std::puts(hal::value_text(pin->type, pin->raw).c_str());
//
// Each call gives a copy as it stood at one moment; a copy that the writer disturbed is made again. Only a long list that is read
// while the writer never rests is put together from pieces of several moments: each entry is whole, none comes twice, and all that
// were there from beginning to end are in it. Values are read when the copy is made.
#pragma once

#include <cstdint>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/component.hpp"
#include "hal/core/records.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// A pin or a parameter.
struct ItemInfo {
  std::string name;           ///< the alias, when it has one
  std::string original_name;  ///< empty: no alias
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::uint64_t raw{0};  ///< a port: bytes of its queue
  std::uint32_t owner_id{0};
  std::string owner;
  std::string signal;  ///< empty: not linked
  Offset place{0};     ///< of the item's own value slot; 0: it stands in memory of its owner
};

struct SignalInfo {
  struct Pin {
    std::string name;
    Dir dir{Dir::unspecified};
  };
  std::string name;
  Type type{Type::unspecified};
  std::uint64_t raw{0};
  std::uint32_t readers{0}, writers{0}, bidirs{0};
  std::vector<Pin> pins;  ///< by name
};

struct ComponentInfo {
  std::string name;
  std::uint32_t id{0};
  ComponentKind type{ComponentKind::user};
  std::int64_t pid{0};
  bool ready{false};
  bool loaded_by_loadrt{false};
  std::string args;
};

struct FunctionInfo {
  std::string name;
  std::uint32_t owner_id{0};
  std::string owner;
  std::uint64_t code{0}, argument{0};
  std::uint32_t users{0};
  bool reentrant{false};
  bool runs_once{false};  ///< added by initf
};

struct ThreadInfo {
  std::string name;
  std::uint32_t owner_id{0};
  std::string owner;
  std::int64_t period_ns{0};
  std::int32_t priority{0};  ///< 0: cycles run in no thread of their own
  std::uint64_t cycles{0};
  std::vector<std::string> functions;
};

/// Memory with a name.
struct MemoryInfo {
  std::string name;
  Offset offset{0};  ///< from the base of the segment
  std::uint64_t bytes{0};
  std::uint64_t abi{0};
};

struct FunctionTiming {
  std::string name;
  FunctionStats stats;
};

/// The last cycle of a thread that did not end in time.
struct LastOverrun {
  std::uint64_t cycle{0};
  std::int64_t took_ns{0};
  std::int64_t woken_late_ns{0};
  std::string function;       ///< to blame; empty: the thread was woken too late
  std::string last_function;  ///< other than `function`: one of those from there to here
  std::int64_t function_ns{0};
  std::int64_t function_usual_ns{0};
  FunctionStats function_stats;
};

/// What a thread and its functions cost, since start or since `timing reset`.
struct ThreadTiming {
  std::string name;
  std::int64_t period_ns{0};
  FunctionStats stats;                    ///< of whole cycles
  FunctionStats wake_up;                  ///< from the planned to the real start
  std::vector<FunctionTiming> functions;  ///< in the order in which they run
  std::optional<LastOverrun> last_overrun;
};

class View {
 public:
  /// `piece`: records of a list that are read at one moment, at most; smaller in tests of just that.
  explicit View(const rtapi::Segment& segment, std::size_t piece = 4096)
      : segment_(segment), largest_piece_(piece) {}

  /// False until the realtime host has made HAL in this segment.
  [[nodiscard]] bool attached() const { return root() != nullptr; }

  /// Pins and parameters are found by either name.
  [[nodiscard]] std::optional<ItemInfo> find_pin(std::string_view name) const;
  [[nodiscard]] std::optional<ItemInfo> find_param(std::string_view name) const;
  /// The parameter, if both a pin and a parameter have the name.
  [[nodiscard]] std::optional<ItemInfo> find_item(std::string_view name) const;
  [[nodiscard]] std::optional<SignalInfo> find_signal(std::string_view name) const;
  [[nodiscard]] std::optional<ComponentInfo> find_component(std::string_view name) const;
  [[nodiscard]] std::optional<ThreadInfo> find_thread(std::string_view name) const;

  [[nodiscard]] std::optional<MemoryInfo> find_memory(std::string_view name) const;
  /// A block by its name, whether a component or the instance's maker made it. not_found; protocol when the abi differs.
  template <class T>
  [[nodiscard]] rtapi::Result<T*> block(const char* name, std::uint64_t abi = sizeof(T)) const {
    auto found = block_bytes(name, abi);
    if (!found.ok()) return rtapi::Failure{found.error()};
    return std::launder(reinterpret_cast<T*>(*found));
  }

  /// All of a kind. Pins, parameters, signals, functions by name; components and threads newest first.
  [[nodiscard]] std::vector<ItemInfo> pins() const { return items(Kind::pin); }
  [[nodiscard]] std::vector<ItemInfo> params() const { return items(Kind::param); }
  [[nodiscard]] std::vector<SignalInfo> signals() const;
  [[nodiscard]] std::vector<ComponentInfo> components() const;
  [[nodiscard]] std::vector<FunctionInfo> functions() const;
  [[nodiscard]] std::vector<ThreadInfo> threads() const;
  [[nodiscard]] std::vector<MemoryInfo> memories() const;
  /// What functions cost, threads newest first.
  [[nodiscard]] std::vector<ThreadTiming> timings() const;
  [[nodiscard]] TimingMode timing_mode() const;
  /// Names of a kind, in order of creation, for "did you mean".
  [[nodiscard]] std::vector<std::string> names(Kind kind) const;

  /// The value of a pin, parameter or signal as text (plain_value_text); not_found names the nearest.
  [[nodiscard]] rtapi::Result<std::string> value(std::string_view name) const;
  /// Where a pin's or parameter's value stands, for readers within the realtime host's process (tests, the harness): valid
  /// while its component is loaded. `link` is null when there is no such item.
  [[nodiscard]] SlotRef slot(std::string_view name) const;
  /// The same for a pin, and for a parameter, in the process whose segment this is.
  [[nodiscard]] SlotRef pin_slot(std::string_view name) const { return slot(Kind::pin, name); }
  [[nodiscard]] SlotRef param_slot(std::string_view name) const { return slot(Kind::param, name); }
  /// Where a signal's value stands in the segment; 0: no such signal.
  [[nodiscard]] Offset signal_place(std::string_view name) const;

  [[nodiscard]] std::uint32_t lock_bits() const;
  [[nodiscard]] bool running() const;
  /// Notified after each change of structure; nullptr while not attached.
  [[nodiscard]] const rtapi::Cell* changed() const;
  struct Counts {
    std::uint64_t bytes_used{0}, bytes_free{0}, bytes_total{0};
    std::uint32_t active[kKinds]{};
    std::uint32_t recycled[kKinds]{};
  };
  [[nodiscard]] Counts counts() const;
  /// True when the last call found that the writer died in the middle of a change: it gave nothing, and no other will.
  [[nodiscard]] bool stuck() const { return stuck_; }
  /// dead, with what to do, in that case; not_found before HAL is made.
  [[nodiscard]] rtapi::Status health() const;

 private:
  [[nodiscard]] const Root* root() const;
  template <class T>
  [[nodiscard]] const T* at(Offset offset) const;
  struct Wait {
    std::int64_t since{0};
    std::uint64_t generation{0};
    bool asked{false};
  };
  /// Whether it is no use to try again; says so in stuck_.
  bool give_up(const Root& root, Wait& wait) const;
  /// True when nothing changed while `copy` ran.
  template <class F>
  bool attempt(const Root& root, F&& copy) const;
  /// Calls `copy` until it saw one state from beginning to end.
  template <class F>
  auto consistent(F&& copy) const;
  /// What `make` gives for each record of a kind, in order of creation.
  template <class T, class F>
  auto list(Kind kind, F&& make) const;
  template <class T>
  [[nodiscard]] const T* lookup(const Root& root, Kind kind, std::string_view name) const;
  [[nodiscard]] std::vector<ItemInfo> items(Kind kind) const;
  [[nodiscard]] std::optional<ItemInfo> find(Kind kind, std::string_view name) const;
  [[nodiscard]] rtapi::Result<std::byte*> block_bytes(const char* name, std::uint64_t abi) const;
  [[nodiscard]] std::uint64_t value_at(Type type, Offset offset) const;
  [[nodiscard]] const ItemRecord* lookup_item(const Root& root, Kind kind,
                                              std::string_view name) const;
  [[nodiscard]] SlotRef slot(Kind kind, std::string_view name) const;
  [[nodiscard]] std::string name_at(Offset offset) const;
  [[nodiscard]] ItemInfo info(const ItemRecord& r) const;
  [[nodiscard]] SignalInfo info(const SignalRecord& r) const;
  [[nodiscard]] ComponentInfo info(const ComponentRecord& r) const;
  [[nodiscard]] ThreadInfo info(const ThreadRecord& r) const;
  [[nodiscard]] ThreadTiming timing_of(const ThreadRecord& r, std::uint32_t epoch) const;
  [[nodiscard]] FunctionInfo info(const FunctionRecord& r) const;
  [[nodiscard]] MemoryInfo info(const MemoryRecord& r) const;

  const rtapi::Segment& segment_;
  std::size_t largest_piece_;
  mutable const Root* root_{nullptr};
  mutable bool stuck_{false};
};

}  // namespace kerf::hal
