// CModules: modules of the C API within Host: shared objects with rtapi_app_main, which make their components themselves.
//
// Host calls load() and stop(); while rtapi_app_main or rtapi_app_exit runs, the C API (src/hal/capi) calls back what is below.
// What a module made belongs to it, so that its end takes everything back, whatever its own code forgot. All @nonrt.
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "hal/loader/c_function.hpp"
#include "hal/loader/host.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/thread/realtime_task.hpp"

namespace kerf::hal {

/// A component that a module made.
struct CComponent {
  ComponentRecord* record{nullptr};
  int (*constructor)(const char* prefix, const char* arg){nullptr};
};

/// What Host::Loaded has besides for a C module.
struct CModulePart {
  void* library{nullptr};  ///< for dlsym
  std::string args;        ///< of loadrt
  bool started{false};     ///< rtapi_app_main said 0: rtapi_app_exit is to be called
  std::vector<CComponent> components;
  std::list<CFunction> functions;
  std::map<std::string, int> memory_names;     ///< how many times each was asked for
  std::vector<std::unique_ptr<char[]>> texts;  ///< values of string parameters
};

class CModules {
 public:
  explicit CModules(Host& host) : host_(host) {}
  ~CModules();
  CModules(const CModules&) = delete;
  CModules& operator=(const CModules&) = delete;

  // ---- Host's side
  /// The part of loadrt that follows the opening of the library. An error: everything is undone but the library itself.
  Reply load(const std::string& name, std::span<const std::string> args, const Module& module);
  /// Calls rtapi_app_exit, and takes out what is left of the module's components and memory. busy: that code does not return. Then
  /// all that it may use stays, and whatever it asks of HAL from now on is refused.
  rtapi::Status stop(Host::Loaded& module);
  /// busy, before anything is undone: the code of one of the module's realtime tasks does not come to rtapi_wait.
  [[nodiscard]] rtapi::Status check_tasks(const Host::Loaded& module) const;
  /// What a loaded module exports by this name, and whose it is; of several the one loaded last. {}: none does.
  [[nodiscard]] std::pair<void*, Host::Loaded*> find_function(const std::string& name) const;
  /// Calls code of the module, which may use the C API as in its rtapi_app_main.
  void run_as(Host::Loaded& module, void (*code)(void*), void* argument);
  [[nodiscard]] static bool has_component(const Host::Loaded& module, std::string_view name);

  // ---- the C API's side
  /// The lock of its calls, and what makes the calling thread the one that may call.
  struct Door {
    std::recursive_mutex* calls{nullptr};
    void (*let_this_thread_in)() noexcept {nullptr};
  };
  void set_door(Door door) noexcept { door_ = door; }
  rtapi::Result<ComponentRecord*> add_component(const std::string& name);
  /// nullptr: no such component of a C module.
  [[nodiscard]] ComponentRecord* find_component(std::uint32_t id) const;
  rtapi::Status remove_component(ComponentRecord& component);
  void set_constructor(ComponentRecord& component, int (*make)(const char*, const char*));
  /// Calls the component's constructor.
  rtapi::Status construct(std::string_view component, const std::string& prefix,
                          const std::string& arg);
  rtapi::Result<std::byte*> allocate(std::size_t bytes);
  [[nodiscard]] bool owns(const void* memory, std::size_t bytes) const;
  rtapi::Result<ItemRecord*> add_item(ComponentRecord& owner, const ItemSpec& spec, bool pin);
  rtapi::Status add_function(ComponentRecord& owner, const std::string& name,
                             void (*code)(void*, long), void* argument, bool reentrant);
  rtapi::Result<ComponentRecord*> add_thread(const std::string& name, std::int64_t period_ns);
  rtapi::Status remove_thread(const std::string& name);
  rtapi::Result<MemoryRecord*> add_memory(const std::string& name, std::size_t bytes,
                                          std::uint64_t abi);
  rtapi::Status drop_memory(const std::string& name);
  /// A realtime task of the module that runs now, paused. It is ended with the module.
  rtapi::Result<rtapi::RealtimeTask*> add_task(void (*code)(void*), void* argument, int priority);
  /// @rt. nullptr: no such task.
  [[nodiscard]] rtapi::RealtimeTask* find_task(int id) const noexcept;
  /// busy: its code does not end.
  rtapi::Status remove_task(int id);
  /// False while modules are only looked at: their tasks must not run.
  [[nodiscard]] bool tasks_may_run() const;
  /// A command as a client sends it, also from within loadrt.
  Reply command(std::span<const std::string> argv) { return host_.nested_command(argv); }
  [[nodiscard]] Host& host() noexcept { return host_; }

 private:
  struct Block {
    std::size_t bytes;
    std::set<const Host::Loaded*> users;  ///< it is given back when none is left
  };
  class Running;  ///< a module's code runs
  /// Error when no code of a module runs.
  rtapi::Result<Host::Loaded*> running() const;
  [[nodiscard]] Host::Loaded* owner_of(const ComponentRecord& component) const;
  void use(const void* memory, const Host::Loaded& user);
  rtapi::Status take_out_functions(Host::Loaded& module, const ComponentRecord* component);
  void erase_component(Host::Loaded& module, ComponentRecord& component);
  void stop_tasks(const Host::Loaded& module);
  /// False: it does not return.
  bool call_exit(void (*exit)());

  Host& host_;
  Door door_;
  Host::Loaded* running_{nullptr};
  std::map<const std::byte*, Block> blocks_;
  static constexpr int kTasks = 64;
  static constexpr int kFirstTask = 64;  ///< ids of tasks; HAL's threads have the numbers before
  struct TaskPlace {
    rtapi::Word<rtapi::RealtimeTask*> task{nullptr};
    Host::Loaded* owner{nullptr};
  };
  TaskPlace tasks_[kTasks];
};

}  // namespace kerf::hal
