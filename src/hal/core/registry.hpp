// Registry: the one writer of HAL's structure. It lives in the realtime host's ordinary thread (or in a test).
//
// Every call either does all that it was asked for or changes nothing and says why. Values of pins are read and written by
// others meanwhile; a removed record's memory is reused only when every realtime thread has finished a cycle since, and a
// signal's slot, once seen by a user component, only when the user components of that time have gone.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/component.hpp"
#include "hal/core/records.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

class Registry {
 public:
  /// Makes the block "hal" of a segment that has none.
  static rtapi::Result<std::unique_ptr<Registry>> create(rtapi::Segment& segment);
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Name taken: exists. `args`: what loadrt was given.
  rtapi::Result<ComponentRecord*> add_component(std::string_view name, ComponentKind kind,
                                                std::int64_t pid = 0, std::string_view args = {},
                                                bool by_loadrt = false);
  void set_ready(ComponentRecord& component);
  /// With all its pins (unlinked first), parameters, functions and threads. Functions must not be in a run list any more.
  void remove_component(ComponentRecord& component);
  rtapi::Result<ItemRecord*> add_pin(ComponentRecord& owner, std::string_view name, Type type,
                                     Dir dir, std::uint64_t initial);
  rtapi::Result<ItemRecord*> add_param(ComponentRecord& owner, std::string_view name, Type type,
                                       Dir dir, std::uint64_t initial);
  rtapi::Result<FunctionRecord*> add_function(ComponentRecord& owner, std::string_view name,
                                              std::uint64_t code, std::uint64_t argument);
  rtapi::Result<ThreadRecord*> add_thread(ComponentRecord& owner, std::string_view name,
                                          std::int64_t period_ns);
  /// Shows a thread's functions to readers and counts their users.
  rtapi::Status set_run_list(ThreadRecord& thread, std::span<FunctionRecord* const> functions);

  rtapi::Status new_signal(std::string_view name, Type type);
  /// Unlinks all its pins.
  rtapi::Status delete_signal(std::string_view name);
  /// Links all pins to the signal, making it first if need be; or does nothing.
  rtapi::Status net(std::string_view signal, std::span<const std::string> pins);
  rtapi::Status link(std::string_view pin, std::string_view signal);
  rtapi::Status link_pins(std::string_view first, std::string_view second);
  rtapi::Status unlink(std::string_view pin);

  /// setp: a parameter that is rw, else an unlinked pin that is not an output.
  rtapi::Status set_item(std::string_view name, std::string_view value);
  /// sets: a signal without writers.
  rtapi::Status set_signal(std::string_view name, std::string_view value);

  void set_running(bool on) noexcept;
  void set_lock(std::uint32_t bits) noexcept;
  /// Busy, with a text that names the lock, when one of the bits is locked.
  [[nodiscard]] rtapi::Status check_lock(std::uint32_t bits) const;

  [[nodiscard]] ComponentRecord* find_component(std::string_view name) const noexcept;
  [[nodiscard]] ItemRecord* find_pin(std::string_view name) const noexcept;
  [[nodiscard]] ItemRecord* find_param(std::string_view name) const noexcept;
  [[nodiscard]] SignalRecord* find_signal(std::string_view name) const noexcept;
  [[nodiscard]] FunctionRecord* find_function(std::string_view name) const noexcept;
  [[nodiscard]] ThreadRecord* find_thread(std::string_view name) const noexcept;
  /// Names of all of a kind, for "did you mean".
  [[nodiscard]] std::vector<std::string> names(Kind kind) const;

  [[nodiscard]] SlotRef slot_ref(const ItemRecord& item) const noexcept {
    return {segment_.base(), &item.link};
  }
  [[nodiscard]] rtapi::Segment& segment() noexcept { return segment_; }
  [[nodiscard]] Root& root() noexcept { return root_; }
  template <class T>
  [[nodiscard]] T* at(Offset offset) const noexcept {
    return offset == 0 ? nullptr : segment_.at<T>(offset);
  }
  /// Gives back what nobody can hold any more. Called by every change; also when nothing else happens.
  void reclaim();
  /// Bytes taken from the segment; constant over repeated load and unload.
  [[nodiscard]] std::uint64_t arena_bytes() const noexcept { return arena_bytes_; }

 private:
  Registry(rtapi::Segment& segment, Root& root) : segment_(segment), root_(root) {}
  class Change;  ///< makes the generation odd while it lives
  struct Block {
    Offset offset;
    std::size_t bytes;
    Kind kind;
  };
  struct HeldBlock {
    Block block;
    std::uint32_t before_id;  ///< user components with a lower id may hold its address
  };
  struct Seen {
    ThreadRecord* thread;
    std::uint64_t cycles;
  };

  template <class T>
  rtapi::Result<T*> make(Kind kind, std::string_view name);
  template <class T>
  [[nodiscard]] T* find(Kind kind, std::string_view name) const noexcept;
  rtapi::Result<Offset> allocate(std::size_t bytes, Kind kind);
  void retire(Offset offset, std::size_t bytes, Kind kind);
  void give_back(const Block& block);
  [[nodiscard]] bool user_component_before(std::uint32_t id) const noexcept;
  rtapi::Result<ItemRecord*> add_item(Kind kind, ComponentRecord& owner, std::string_view name,
                                      Type type, Dir dir, std::uint64_t initial);
  void insert(Record& record);
  void erase(Record& record, std::size_t bytes);
  [[nodiscard]] rtapi::Status check_link(const ItemRecord& pin, const SignalRecord& signal) const;
  void attach(ItemRecord& pin, SignalRecord& signal) noexcept;
  void detach(ItemRecord& pin) noexcept;
  [[nodiscard]] const ItemRecord* pin_with(const SignalRecord& signal, Dir dir) const noexcept;
  void erase_signal(SignalRecord& signal);
  void erase_thread(ThreadRecord& thread);
  [[nodiscard]] Offset offset_of(const void* p) const noexcept { return segment_.offset_of(p); }

  rtapi::Segment& segment_;
  Root& root_;
  std::uint32_t next_id_{1};
  std::byte* chunk_{nullptr};
  std::size_t chunk_left_{0};
  int chunks_{0};
  std::uint64_t arena_bytes_{0};
  std::map<std::size_t, std::vector<Offset>> free_;
  std::vector<Block> pending_;  ///< removed since the last snapshot of the threads' cycles
  std::vector<Block> in_grace_;
  std::vector<Seen> snapshot_;
  std::vector<HeldBlock> held_;
};

/// Empty, or why the text cannot be the name of a HAL object.
std::string bad_name_reason(std::string_view name);

}  // namespace kerf::hal
