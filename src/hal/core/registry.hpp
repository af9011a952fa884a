// Registry: the one writer of HAL's structure. It lives in the realtime host's ordinary thread (or in a test).
//
// Every call either does all that it was asked for or changes nothing and says why. Values of pins are read and written by
// others meanwhile. What was removed is reused only when every realtime thread has finished a cycle since, and what a process
// may hold the address of (see Holds) only when that process is gone too.
//
// Cost: all look-ups are hashed; adding, linking and removing an item take a time that does not depend on how many there are.
#pragma once

#include <cstdint>
#include <deque>
#include <initializer_list>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "hal/component.hpp"
#include "hal/core/arena.hpp"
#include "hal/core/records.hpp"
#include "hal/core/slot_pool.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// What a pin or parameter is declared as.
struct ItemSpec {
  std::string_view name;
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::uint64_t initial{0};
  /// A pin of a realtime component or of the C API: the owner's pointer to the value. It gets owner_base + place of the value in
  /// effect, at each link and unlink, and must live as long as the component. For a realtime component it may be any memory of this
  /// process, else only memory in `shared`.
  std::uint64_t* cell{nullptr};
  std::uint64_t owner_base{0};  ///< where the owner maps the segment
  /// A parameter of the C API: its value, memory of the owner in the segment, in the width of its C type. `initial` is not used.
  void* native{nullptr};
};

/// What a process may have the addresses of.
enum class Holds {
  /// Its own pins, the signals that they were linked to, its own and named memory.
  own,
  /// Any value whatever: it asked for values by name.
  everything
};

class Registry {
 public:
  using Region = rtapi::Region;

  /// Makes the block "hal" of a segment that has none.
  static rtapi::Result<std::unique_ptr<Registry>> create(rtapi::Segment& segment);
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Name taken: exists. `args`: what loadrt was given. A user component is a holder of its own while it is there.
  rtapi::Result<ComponentRecord*> add_component(std::string_view name, ComponentKind kind,
                                                std::int64_t pid = 0, std::string_view args = {},
                                                bool by_loadrt = false);
  void set_ready(ComponentRecord& component);
  void set_unready(ComponentRecord& component);
  /// With all its pins (unlinked first), parameters, functions and threads. Functions must not be in a run list any more.
  void remove_component(ComponentRecord& component);

  rtapi::Result<ItemRecord*> add_pin(ComponentRecord& owner, const ItemSpec& spec);
  rtapi::Result<ItemRecord*> add_param(ComponentRecord& owner, const ItemSpec& spec);
  rtapi::Result<ItemRecord*> add_pin(ComponentRecord& owner, std::string_view name, Type type,
                                     Dir dir, std::uint64_t initial) {
    return add_pin(owner, {.name = name, .type = type, .dir = dir, .initial = initial});
  }
  rtapi::Result<ItemRecord*> add_param(ComponentRecord& owner, std::string_view name, Type type,
                                       Dir dir, std::uint64_t initial) {
    return add_param(owner, {.name = name, .type = type, .dir = dir, .initial = initial});
  }
  /// Gives a pin or parameter a second name, in place of an earlier alias. Both names find it.
  rtapi::Status alias(Kind pin_or_param, std::string_view name, std::string_view alias);
  rtapi::Status unalias(Kind pin_or_param, std::string_view name);

  rtapi::Result<FunctionRecord*> add_function(ComponentRecord& owner, std::string_view name,
                                              std::uint64_t code, std::uint64_t argument);
  rtapi::Result<ThreadRecord*> add_thread(ComponentRecord& owner, std::string_view name,
                                          std::int64_t period_ns);
  /// Shows a thread's functions to readers and counts their users.
  rtapi::Status set_run_list(ThreadRecord& thread, std::span<FunctionRecord* const> functions);
  /// The same for one more function before the one at `index`; at the end it takes constant time.
  rtapi::Status insert_in_run_list(ThreadRecord& thread, std::size_t index,
                                   FunctionRecord& function);
  void erase_from_run_list(ThreadRecord& thread, std::size_t index);

  rtapi::Status new_signal(std::string_view name, Type type);
  /// Unlinks all its pins.
  rtapi::Status delete_signal(std::string_view name);
  /// Links all pins to the signal, making it first if need be; or does nothing.
  rtapi::Status net(std::string_view signal, std::span<const std::string> pins);
  rtapi::Status link(std::string_view pin, std::string_view signal);
  rtapi::Status link_pins(std::string_view first, std::string_view second);
  rtapi::Status unlink(std::string_view pin);

  /// setp: a parameter that is rw, else an unlinked pin that is not an output. For a port: as set_signal().
  rtapi::Status set_item(std::string_view name, std::string_view value);
  /// sets: a signal without writers. For a port the value is the size of its queue, which is made, once; 0 does nothing.
  rtapi::Status set_signal(std::string_view name, std::string_view value);

  void set_running(bool on) noexcept;
  void set_lock(std::uint32_t bits) noexcept;
  /// Busy, with a text that names the lock, when one of the bits is locked.
  [[nodiscard]] rtapi::Status check_lock(std::uint32_t bits) const;

  // ---- memory
  /// Zero-filled, aligned to 64, until free_memory(). Memory in `shared` waits for the holders before it is reused.
  rtapi::Result<std::byte*> allocate_memory(std::size_t bytes, Region region);
  void free_memory(std::byte* memory);
  /// Memory that any process finds by its name (View::find_memory), in `shared`. exists: the name is taken.
  /// `hidden`: nobody finds it before show_memory(), so that no other process writes what its maker is about to construct.
  rtapi::Result<MemoryRecord*> add_memory(std::string_view name, std::size_t bytes,
                                          std::uint64_t abi, bool hidden = false);
  void show_memory(MemoryRecord& memory);
  void remove_memory(MemoryRecord& memory);
  /// A process that may keep addresses of what is removed later; give the number back when it is gone.
  std::uint64_t add_holder(Holds what = Holds::own);
  void remove_holder(std::uint64_t holder);
  /// Gives back what nobody can hold any more. Called by every change; also when nothing else happens.
  void reclaim();
  /// Bytes taken from the segment; constant over repeated load and unload.
  [[nodiscard]] std::uint64_t arena_bytes() const noexcept {
    return structure_.bytes_taken() + functions_.bytes_taken() + shared_.bytes_taken();
  }

  [[nodiscard]] ComponentRecord* find_component(std::string_view name) const noexcept;
  /// By either name.
  [[nodiscard]] ItemRecord* find_pin(std::string_view name) const noexcept;
  [[nodiscard]] ItemRecord* find_param(std::string_view name) const noexcept;
  [[nodiscard]] SignalRecord* find_signal(std::string_view name) const noexcept;
  [[nodiscard]] FunctionRecord* find_function(std::string_view name) const noexcept;
  [[nodiscard]] ThreadRecord* find_thread(std::string_view name) const noexcept;
  [[nodiscard]] MemoryRecord* find_memory(std::string_view name) const noexcept;
  /// Names of all of a kind, for "did you mean". Valid until the next change.
  [[nodiscard]] std::vector<std::string_view> names(Kind kind) const;

  [[nodiscard]] SlotRef slot_ref(const ItemRecord& item) const noexcept {
    return slot_at(segment_, item.link);
  }
  /// Of a parameter that is not `native`.
  [[nodiscard]] FixedSlot fixed_slot(const ItemRecord& param) const noexcept {
    return {segment_.at<std::atomic<std::uint64_t>>(param.value)};
  }
  /// Where the value of a signal stands.
  [[nodiscard]] std::atomic<std::uint64_t>& slot(const SignalRecord& signal) const noexcept {
    return *segment_.at<std::atomic<std::uint64_t>>(signal.value);
  }
  [[nodiscard]] rtapi::Segment& segment() noexcept { return segment_; }
  [[nodiscard]] Root& root() noexcept { return root_; }
  template <class T>
  [[nodiscard]] T* at(Offset offset) const noexcept {
    return offset == 0 ? nullptr : segment_.at<T>(offset);
  }

  /// For tests: walks everything and says what contradicts what.
  [[nodiscard]] rtapi::Status check_invariants() const;

 private:
  Registry(rtapi::Segment& segment, Root& root) : segment_(segment), root_(root) {}
  class Change;  ///< makes the generation odd while it lives
  class Checker;
  enum class Store : std::uint8_t { structure, shared, link, value, signal_value };
  struct Block {
    Offset offset;
    std::size_t bytes;
    Kind kind;  ///< of a record; none otherwise
    Store store;
  };
  struct HeldBlock {
    Block block;
    std::uint64_t before;  ///< holders with a lower number may have its address
  };
  /// Blocks that wait for the end of processes. `before` rises along the queue, so only its front is ever looked at.
  struct HeldQueue {
    std::set<std::uint64_t> holders;
    std::deque<HeldBlock> blocks;
    [[nodiscard]] bool busy(const HeldBlock& held) const {
      return !holders.empty() && *holders.begin() < held.before;
    }
  };
  struct Seen {
    ThreadRecord* thread;
    std::uint64_t cycles;
  };
  struct Queue {
    Offset offset;
    std::uint32_t bytes;
  };
  struct Piece {
    std::size_t bytes;
    Region region;
  };

  // Memory: registry_memory.cpp
  rtapi::Result<Offset> allocate(std::size_t bytes, Region region, Kind kind);
  rtapi::Result<Offset> take_slot(SlotPool& pool);
  void retire(const Block& block);
  /// For what a process may have the address of: with `own`, also an ordinary holder.
  void retire_held(const Block& block, Holds least);
  void retire_record(Record& record, std::size_t bytes);
  void give_back(const Block& block);

  template <class T>
  rtapi::Result<T*> make(Kind kind, std::string_view name);
  template <class T>
  [[nodiscard]] T* find(Kind kind, std::string_view name) const noexcept;
  [[nodiscard]] ItemRecord* find_item(Kind kind, std::string_view name) const noexcept;
  rtapi::Status check_spec(const ComponentRecord& owner, const ItemSpec& spec) const;
  rtapi::Result<ItemRecord*> add_item(Kind kind, ComponentRecord& owner, const ItemSpec& spec);
  void retire_item(ItemRecord& item, bool of_user);
  void insert(Record& record);
  void erase(Record& record, std::size_t bytes);
  void insert_in_hash(Record& record, Kind kind);
  void erase_from_hash(Record& record, Kind kind);
  void erase_original(ItemRecord& item);
  rtapi::Result<SignalRecord*> make_signal(std::string_view name, Type type);
  [[nodiscard]] rtapi::Status check_link(const ItemRecord& pin, const SignalRecord& signal) const;
  void attach(ItemRecord& pin, SignalRecord& signal) noexcept;
  void detach(ItemRecord& pin) noexcept;
  void point(ItemRecord& pin, Offset slot) noexcept;
  [[nodiscard]] const ItemRecord* pin_with(const SignalRecord& signal, Dir dir) const noexcept;
  void erase_signal(SignalRecord& signal);
  rtapi::Status make_queue(const Record& record, Offset value, std::string_view size);
  void retire_queue(const Record& record, Holds least);
  [[nodiscard]] std::string suggestion(std::string_view name,
                                       std::initializer_list<Kind> kinds) const;
  void erase_thread(ThreadRecord& thread);
  void retire_run_list(ThreadRecord& thread);
  rtapi::Result<RunListRecord*> run_list_with_room(ThreadRecord& thread, std::size_t functions);
  [[nodiscard]] Offset offset_of(const void* p) const noexcept { return segment_.offset_of(p); }

  rtapi::Segment& segment_;
  Root& root_;
  std::uint32_t next_id_{1};
  Arena structure_{segment_, Region::structure};
  /// Records of functions stand together: threads write times to them.
  Arena functions_{segment_, Region::structure};
  Arena shared_{segment_, Region::shared};
  SlotPool links_{structure_};
  SlotPool values_{shared_};
  SlotPool signal_values_{shared_};
  std::unordered_map<Offset, Piece> pieces_;         ///< of allocate_memory()
  std::unordered_map<const Record*, Queue> queues_;  ///< of port signals and pins
  std::vector<Block> pending_;  ///< removed since the last snapshot of the threads' cycles
  std::vector<Block> in_grace_;
  std::vector<Seen> snapshot_;
  std::uint64_t next_holder_{1};
  HeldQueue held_by_any_;  ///< waits for holders of both sorts
  HeldQueue held_by_all_;  ///< waits for those with Holds::everything
  std::map<const ComponentRecord*, std::uint64_t> user_holders_;
};

/// Empty, or why the text cannot be the name of a HAL object.
std::string bad_name_reason(std::string_view name);

}  // namespace kerf::hal
