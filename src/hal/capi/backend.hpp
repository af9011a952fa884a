// Backend: what the C API needs of HAL. One stands in the realtime host (the modules that it loads), one in each program.
//
// All of it is @nonrt and called under the library's lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "hal/core/types.hpp"
#include "hal/loader/host.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal::capi {

/// A component of this process, or of the module that is being loaded.
struct Component {
  int id{0};
  std::string name;
  bool ready{false};
};

/// A pin or parameter to be made.
struct NewItem {
  std::string_view name;
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::uint64_t initial{0};
  void** cell{nullptr};   ///< a pin's pointer to its value
  void* native{nullptr};  ///< where a parameter's value stands
};

class Backend {
 public:
  virtual ~Backend() = default;
  [[nodiscard]] virtual rtapi::Segment& segment() = 0;
  [[nodiscard]] virtual const rtapi::Clock& clock() = 0;

  virtual rtapi::Result<int> add_component(const std::string& name) = 0;
  /// nullptr: not one of ours.
  [[nodiscard]] virtual Component* find_component(int id) = 0;
  virtual rtapi::Status set_ready(Component& component, bool ready) = 0;
  virtual rtapi::Status remove_component(Component& component) = 0;
  /// Memory for hal_malloc, zero-filled.
  virtual rtapi::Result<std::byte*> allocate(std::size_t bytes) = 0;
  /// True when all of it is such memory.
  [[nodiscard]] virtual bool owns(const void* memory, std::size_t bytes) = 0;
  /// The place of the item's link slot in the segment.
  virtual rtapi::Result<rtapi::Offset> add_item(Component& owner, const NewItem& item) = 0;
  /// Any other change of HAL, as Host::command.
  virtual rtapi::Result<Reply> command(std::span<const std::string> argv) = 0;
  /// Memory with a name that all processes of the instance share.
  virtual rtapi::Result<std::byte*> add_memory(const std::string& name, std::size_t bytes,
                                               std::uint64_t abi) = 0;
  virtual rtapi::Status drop_memory(const std::string& name) = 0;
  /// From now on the process may keep addresses of any values.
  virtual void hold_values() {}

  // Only the realtime host has these.
  virtual rtapi::Status add_function(Component& owner, const std::string& name,
                                     void (*function)(void*, long), void* argument,
                                     bool reentrant) = 0;
  virtual rtapi::Result<int> add_thread(const std::string& name, std::int64_t period_ns) = 0;
  virtual rtapi::Status remove_thread(const std::string& name) = 0;
};

/// The backend of this process, made at the first use; an error when there is no HAL.
rtapi::Result<Backend*> backend();

}  // namespace kerf::hal::capi
