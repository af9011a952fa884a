// How HAL stands in the segment: plain records reached by offset, changed by one writer (Registry) and read by anybody (View).
//
// Structure (names, types, lists) is guarded by a generation count: odd while the writer changes something, so that a reader
// copies, looks again and retries. Values and links are relaxed atomics of their own and are not covered by the count.
//
// Records and link slots stand in the region `structure`, value slots in `shared`. Slots are 8 bytes each, in pools of their
// own and in order of creation, so that the values of one instance share cache lines and no thread drags names through its cache.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hal/component.hpp"
#include "hal/core/timing.hpp"
#include "hal/core/types.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::hal {

using rtapi::Offset;
using rtapi::Word;

enum class Kind : std::uint32_t {
  none = 0,
  pin,
  param,
  signal,
  component,
  function,
  thread,
  memory,
  original  ///< the name of a pin or parameter that has an alias
};
inline constexpr std::size_t kKinds = 9;

enum class ComponentKind : std::uint32_t { user = 0, realtime = 1, other = 2 };

/// Bits of the HAL lock, as the published C API numbers them.
enum LockBits : std::uint32_t {
  lock_none = 0,
  lock_load = 1,
  lock_config = 2,
  lock_tune = 3,
  lock_params = 4,
  lock_run = 8,
  lock_all = 255,
};

/// Head of every record.
struct Record {
  Word<Offset> next{0};  ///< list of all of its kind, in order of creation
  Word<Offset> previous{0};
  Word<Offset> hash_next{0};  ///< chain of its bucket
  Kind kind{Kind::none};
  std::uint32_t id{
      0};  ///< handle shown by `show`; never given twice, rises along the list; 0 when removed
  Name name;
};

/// A pin or a parameter. `name` is the alias when it has one.
struct ItemRecord : Record {
  /// Of the link slot, which holds the way from itself to the value in effect: `value` or the signal's.
  Offset link{0};
  Offset value{0};  ///< of the item's own value: a value slot, or with `native` memory of its owner
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::uint32_t native{
      0};  ///< 1: the value stands in the owner's memory, in the width of its C type
  std::uint32_t reserved{0};
  Offset owner{0};             ///< ComponentRecord
  Word<Offset> owner_next{0};  ///< chain of the items of one component, in order of creation
  Word<Offset> signal{0};
  Word<Offset> signal_next{0};  ///< chain of the pins of one signal, the last linked first
  Word<Offset> signal_previous{0};
  Word<Offset> original{0};  ///< OriginalRecord; 0: no alias
  std::uint64_t cell{
      0};  ///< address, in the writer's process, of the owner's pointer to the value; 0: it has none
  std::uint64_t owner_base{0};  ///< where the owner maps the segment
};

/// The original name of an item with an alias; its kind in the hash is that of the item.
struct OriginalRecord : Record {
  Kind of{Kind::none};
  std::uint32_t reserved{0};
  Offset item{0};
};

struct SignalRecord : Record {
  Offset value{0};  ///< of the value slot
  Type type{Type::unspecified};
  std::uint32_t readers{0}, writers{0}, bidirs{0};
  /// A pin of a user component was linked: its process may hold the slot's address.
  std::uint32_t user_seen{0};
  Word<Offset> first_pin{0};
};

/// Memory that processes find by its name; it stands in `shared`.
struct MemoryRecord : Record {
  Offset memory{0};
  std::uint64_t bytes{0};
  std::uint64_t abi{0};
  std::uint64_t hidden{0};  ///< 1: its component is still at work on it, so nobody finds it
};

struct ComponentRecord : Record {
  ComponentKind type{ComponentKind::user};
  std::uint32_t ready{0};
  std::int64_t pid{0};  ///< of a user component
  std::uint32_t loaded_by_loadrt{0};
  std::uint32_t args_size{0};
  Offset args{0};  ///< text of the loadrt arguments
  Word<Offset> first_item{0};
  Offset last_item{0};
  Word<Offset> first_function{0};
  Offset last_function{0};
};

/// Where a function's times are shown. The thread that runs it writes them.
struct FunctionTimes {
  Out<std::int32_t> time;        ///< NAME.time, ns
  Param<std::int32_t> tmax;      ///< NAME.tmax, ns
  RoParam<bool> tmax_increased;  ///< NAME.tmax-increased
};

struct FunctionRecord : Record {
  Offset owner{0};
  Word<Offset> owner_next{0};  ///< chain of the functions of one component
  std::uint64_t code{0};       ///< addresses in the realtime host, for `show` only
  std::uint64_t argument{0};
  std::uint32_t users{0};  ///< places in threads' lists; more than 1 only when reentrant
  std::uint16_t reentrant{
      0};  ///< 1: its maker says that two threads may run it at once; its times are then of either
  std::uint16_t runs_once{0};  ///< 1: added by initf
  /// From here on what each timed run touches: for a small function one cache line.
  alignas(64) FunctionTimes times;
  TimingRecord timing;
};

/// The functions of a thread, in order. For readers of the structure only: the thread itself runs a list of its own.
struct RunListRecord {
  std::uint64_t capacity{0};
  // Offsets of `capacity` FunctionRecords follow.
  [[nodiscard]] Offset* functions() noexcept { return reinterpret_cast<Offset*>(this + 1); }
  [[nodiscard]] const Offset* functions() const noexcept {
    return reinterpret_cast<const Offset*>(this + 1);
  }
};

struct ThreadRecord : Record {
  std::int64_t period_ns{0};
  Offset owner{0};
  Word<Offset> run_list{0};
  Word<std::uint64_t> run_count{0};  ///< functions in it
  /// Cycles ended, counted also while functions do not run (`stop`): the grace of whoever gives memory back.
  Word<std::uint64_t> cycles{0};
  /// 1: a thread of its own runs the cycles, so memory may be in use at any moment; 0: cycles run in the writer's thread.
  Word<std::uint32_t> ticking{0};
  std::int32_t priority{0};  ///< SCHED_FIFO priority of that thread; 0 on the virtual clock
  /// Breadcrumb: the FunctionRecord that runs now, 0 between functions.
  Word<Offset> running{0};
  ThreadTimingRecord timing;        ///< of whole cycles
  ThreadTimingRecord wake_up;       ///< from the planned to the real start of a cycle
  rtapi::SeqCell<Overrun> overrun;  ///< the last one
};

/// What of the records' layout changes with their size; kLayout is raised by hand when the meaning of a field changes and no size does.
inline constexpr std::uint64_t kLayout = 5;
constexpr std::uint64_t records_abi() noexcept {
  std::uint64_t h = 0x6b68616c'00000000ULL + kLayout;
  for (const std::size_t size :
       {sizeof(Record), sizeof(ItemRecord), sizeof(OriginalRecord), sizeof(SignalRecord),
        sizeof(MemoryRecord), sizeof(ComponentRecord), sizeof(FunctionTimes),
        sizeof(FunctionRecord), sizeof(RunListRecord), sizeof(ThreadRecord), sizeof(TimingRecord),
        sizeof(ThreadTimingRecord), sizeof(Overrun)})
    h = (h ^ size) * 1099511628211ULL;
  return h;
}

/// The block "hal".
struct Root {
  static constexpr const char* kBlock = "hal";
  static constexpr std::uint64_t kAbi = records_abi();
  static constexpr std::size_t kBuckets = 32768;
  Word<std::uint64_t> generation{0};  ///< odd: being changed
  std::int64_t writer_pid{0};
  std::uint64_t writer_start{0};
  rtapi::Cell changed;  ///< notified after each change of structure
  Word<std::uint32_t> lock{lock_none};
  Word<std::uint32_t> running{0};  ///< 1 after `start`
  Word<std::uint32_t> timing_mode{static_cast<std::uint32_t>(TimingMode::sampled)};
  Word<std::uint32_t> timing_epoch{0};  ///< raised by each reset of the times
  Word<std::uint64_t> bytes_used{0};    ///< of the arena, reusable ones not counted
  Word<std::uint64_t> bytes_free{0};    ///< reusable
  Word<std::uint32_t> count[kKinds];
  Word<std::uint32_t> recycled[kKinds];
  Word<Offset> head[kKinds];
  Word<Offset> tail[kKinds];
  Word<Offset> bucket[kBuckets];
};

/// A link made of plain memory, for handles that must work though the item could not be made.
inline const std::atomic<std::uint64_t>* slot_link(std::uint64_t* words) noexcept {
  return reinterpret_cast<const std::atomic<std::uint64_t>*>(words);
}

/// The handle of an item whose link stands at `link`.
inline SlotRef slot_at(const rtapi::Segment& segment, Offset link) noexcept {
  return {segment.at<const std::atomic<std::uint64_t>>(link)};
}

/// Bucket of a name. FNV-1a; pins and parameters of one name are different objects.
inline std::size_t bucket_of(Kind kind, std::string_view name) noexcept {
  std::uint64_t h = 14695981039346656037ULL ^ static_cast<std::uint64_t>(kind);
  for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return static_cast<std::size_t>((h ^ (h >> 32U)) % Root::kBuckets);
}

}  // namespace kerf::hal
