// Host: the realtime host without its threads. Owns HAL's structure, loads components, and answers every command that changes
// something. Programs (rtapi_app) and tests give it a clock, a source of components and a driver for its threads.
//
// Everything here but ThreadRunner::run_cycle is @nonrt and belongs to one thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/core/registry.hpp"
#include "hal/loader/module_source.hpp"
#include "hal/loader/thread_runner.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

class CModules;
struct CModulePart;
struct OnceFunction;

/// Answer to a command. `status` 0 or an rtapi::Errc; `text` is the error, or what was asked for.
struct Reply {
  int status{0};
  std::string text;
  [[nodiscard]] bool ok() const noexcept { return status == 0; }
};

/// Who asks. Components leave with the client (a connection), memory with the process.
struct Caller {
  std::uint64_t client{0};  ///< 0: nobody's, its components stay
  std::int64_t pid{0};      ///< what `show comp` prints
  std::uint64_t process{
      0};  ///< number of a process that may hold addresses of the segment; 0: this one
};

/// Who runs the threads and participants that loaded components bring.
class HostDriver {
 public:
  virtual ~HostDriver() = default;
  /// A thread to be run from now on, each period. An error undoes the loadrt.
  virtual rtapi::Status thread_added(ThreadRunner& /*thread*/) { return {}; }
  /// Returns when the thread runs no more.
  virtual void thread_removed(ThreadRunner& /*thread*/) {}
  virtual rtapi::Status participant_added(rtapi::Participant& /*participant*/) { return {}; }
  virtual void participant_removed(rtapi::Participant& /*participant*/) {}
  /// Lets some time pass while Host waits for the threads to finish a cycle; false: waited long enough.
  virtual bool wait_for_threads(int /*attempt*/) { return false; }
  /// True: components are only to be looked at, see Builder::declares_only().
  [[nodiscard]] virtual bool declares_only() const { return false; }
};

class Host {
 public:
  /// Makes HAL in the segment. All references must outlive the host; `driver` may be null in tests that run cycles themselves.
  static rtapi::Result<std::unique_ptr<Host>> create(rtapi::Segment& segment,
                                                     const rtapi::Clock& clock,
                                                     ModuleSource& modules,
                                                     HostDriver* driver = nullptr);
  /// Unloads everything, last loaded first. No function may hang: see unload_all().
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// One command of any kind, whole words. Whatever they are, nothing worse happens than an error.
  Reply command(std::span<const std::string> argv, const Caller& caller = {});
  Reply command(std::initializer_list<std::string> argv) {
    return command(std::span<const std::string>(argv.begin(), argv.size()));
  }
  /// The client is dead: its components leave, their pins are unlinked.
  void client_gone(std::uint64_t client);
  /// The process is dead and has no connection any more: nobody holds the addresses that it had.
  void process_gone(std::uint64_t process);
  /// True when the process has been given anything that lasts until process_gone().
  [[nodiscard]] bool holds(std::uint64_t process) const { return processes_.count(process) > 0; }

  /// Threads by period, fastest first; equal ones in order of creation.
  [[nodiscard]] std::vector<ThreadRunner*> threads() const;
  /// Objects that components registered with Builder::add_participant, in order.
  [[nodiscard]] std::vector<rtapi::Participant*> participants() const;
  /// Raised when a thread comes or goes, so that schedulers look again.
  [[nodiscard]] std::uint64_t thread_changes() const noexcept { return thread_changes_; }
  [[nodiscard]] Registry& registry() noexcept { return *registry_; }
  [[nodiscard]] rtapi::Segment& segment() noexcept { return registry_->segment(); }
  [[nodiscard]] const rtapi::Clock& clock() const noexcept { return clock_; }
  [[nodiscard]] bool running() const noexcept { return registry_->root().running.get() != 0; }
  /// What a component offers under this name (Builder::provide), or null.
  [[nodiscard]] void* service(std::string_view name) const {
    const auto it = services_.find(name);
    return it == services_.end() ? nullptr : it->second.object;
  }
  /// Modules of the C API; for their side of it (src/hal/capi).
  [[nodiscard]] CModules& c_modules() noexcept { return *c_modules_; }
  void set_driver(HostDriver* driver) noexcept { driver_ = driver; }
  /// What threads made from now on time their functions with. Default: CLOCK_MONOTONIC, on the virtual clock nothing.
  void set_cycle_counter(const rtapi::CycleCounter& counter) noexcept { counter_ = counter; }
  void set_timing_mode(TimingMode mode) noexcept {
    registry_->root().timing_mode.set(static_cast<std::uint32_t>(mode));
  }
  /// Stops, then unloads all realtime components, last first, and ends all threads. busy: a function or a realtime task hangs; it is named, and
  /// nothing has been unloaded.
  rtapi::Status unload_all();

 private:
  friend class LiveBuilder;
  friend class CModules;

  struct Memory {
    void* data;
    std::size_t bytes;
    std::size_t align;
  };
  struct Instance {
    void* object;
  };
  struct Loaded;
  struct Service {
    void* object;
    Loaded* provider;
  };
  /// Room for a run list to grow in: entries beyond a list's count are nobody's yet.
  struct RunStore {
    std::vector<RunEntry> entries;
  };
  struct Thread {
    std::unique_ptr<ThreadRunner> runner;
    ComponentRecord* component;
    std::vector<FunctionRecord*> functions;
    std::shared_ptr<RunStore> store;
    std::unique_ptr<RunList> list;
    Loaded* owner;  ///< null: its maker has been unloaded, and it stands on its own
  };
  /// A list that a thread may still be in.
  struct OldList {
    const ThreadRecord* thread;
    std::uint64_t cycles;
    std::shared_ptr<RunStore> store;
    std::unique_ptr<RunList> list;
  };
  /// A realtime component that is loaded.
  struct Loaded {
    std::string name;
    const Module* module{nullptr};
    ComponentRecord* record{nullptr};
    std::vector<Instance> instances;
    std::vector<Memory> memory;
    std::vector<FunctionRecord*> functions;
    std::vector<std::string> services;
    std::vector<MemoryRecord*> blocks;
    std::vector<rtapi::Participant*> participants;
    std::set<Loaded*> uses;  ///< whose services it has
    std::vector<std::unique_ptr<std::string>> texts;
    std::unique_ptr<CModulePart> c;  ///< of a C module only; then `record` is null
    Loaded();
    ~Loaded();
    Loaded(const Loaded&) = delete;
    Loaded& operator=(const Loaded&) = delete;
  };
  struct UserComponent {
    ComponentRecord* record;
    std::uint64_t client;
    std::uint64_t base;  ///< where its process maps the segment; 0: not told
  };
  /// Another process that has components or memory: it may hold addresses until it is gone.
  struct Process {
    std::uint64_t holder;
    std::uint64_t value_holder;            ///< 0: has not asked for values by name
    std::map<Offset, std::size_t> memory;  ///< of mem-new
    std::map<std::string, int> named;      ///< of shm-new: how many times
  };
  /// Memory of shm-new, until the last user has dropped it.
  struct NamedMemory {
    MemoryRecord* record;
    int users;
  };
  using Words = std::span<const std::string>;
  struct Row;
  static std::span<const Row> rows();

  Host(const rtapi::Clock& clock, ModuleSource& modules, HostDriver* driver);

  Reply batch(Words argv);
  Reply debug(Words argv);
  /// A command from within another one.
  Reply nested_command(Words argv);
  Reply load(Words argv);
  Reply unload(Words argv);
  Reply list_parameters(Words argv);
  Reply net(Words argv);
  Reply new_signal(Words argv);
  Reply delete_signal(Words argv);
  Reply link_pin_signal(Words argv);
  Reply link_signal_pin(Words argv);
  Reply link_pins(Words argv);
  Reply unlink(Words argv);
  Reply alias(Words argv);
  Reply unalias(Words argv);
  /// An alias of a pin that may not exist yet: it gets it when its component is loaded.
  Reply alias_later(Words argv);
  void give_later_aliases();
  Reply set_item(Words argv);
  Reply set_signal(Words argv);
  Reply add_function(Words argv);
  Reply add_init_function(Words argv);
  Reply put_in_list(Words argv);
  /// An initf that was taken out of its thread is an ordinary function again.
  void run_always(FunctionRecord& function);
  Reply delete_function(Words argv);
  Reply start(Words argv);
  Reply stop(Words argv);
  Reply lock(Words argv);
  Reply unlock(Words argv);
  Reply lock_bits(Words argv);
  Reply timing(Words argv);
  Reply component_new(Words argv);
  Reply pin_new(Words argv);
  Reply param_new(Words argv);
  Reply component_ready(Words argv);
  Reply component_unready(Words argv);
  Reply component_exit(Words argv);
  Reply item_new(Words argv, bool pin);
  Reply memory_new(Words argv);
  Reply named_memory_new(Words argv);
  Reply named_memory_drop(Words argv);
  Reply hold_values(Words argv);
  Reply check_invariants(Words argv);

  rtapi::Status add_thread(Loaded& owner, std::string_view name, std::int64_t period_ns);
  void remove_threads(const Loaded& owner);
  void remove_thread(Thread& thread);
  rtapi::Status unload_one(Loaded& loaded);
  /// Ends a thread that stands on its own.
  rtapi::Status unload_thread(Thread& thread);
  void forget_function(FunctionRecord* function);
  /// Takes functions out of all run lists.
  rtapi::Status drop_functions(const Loaded& loaded);
  rtapi::Status publish_list(Thread& thread, std::vector<FunctionRecord*> functions);
  /// Returns when no thread can still be in a function of an old list.
  rtapi::Status wait_for_grace();
  /// busy: its code does not end, and it is as it was but for its threads.
  rtapi::Status destroy(Loaded& loaded);
  /// Takes out a component that could not be destroyed. All that its code may use stays.
  void abandon(Loaded& loaded);
  Thread* find_thread(std::string_view name);
  [[nodiscard]] Loaded* find_loaded(std::string_view name) const;
  rtapi::Result<UserComponent*> own_component(const std::string& name);
  /// The asking process, a holder from now on.
  Process& own_process();
  /// A place in memory that the asking process got by mem-new, `bytes` long and aligned so.
  rtapi::Result<std::byte*> own_place(const std::string& offset, std::size_t bytes);
  void drop_named(const std::string& name, int times);

  const rtapi::Clock& clock_;
  ModuleSource& modules_;
  HostDriver* driver_;
  std::unique_ptr<Registry> registry_;
  std::unique_ptr<CModules> c_modules_;
  std::vector<std::unique_ptr<Loaded>> loaded_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::vector<OldList> old_lists_;
  std::map<std::string, std::string> later_aliases_;  ///< of alias-later: pin, alias
  std::set<std::string, std::less<>> abandoned_;      ///< with '_' for '-'
  std::map<FunctionRecord*, RunEntry> functions_;
  rtapi::CycleCounter counter_;
  /// Functions that were added by initf, with what they ran before.
  std::map<FunctionRecord*, std::vector<std::unique_ptr<OnceFunction>>> once_;
  std::map<std::string, Service, std::less<>> services_;
  std::map<std::string, UserComponent, std::less<>> user_components_;
  std::map<std::uint64_t, Process> processes_;
  std::map<std::string, NamedMemory, std::less<>> named_;
  std::uint64_t thread_changes_{0};
  Caller caller_;  ///< of the command being done
};

}  // namespace kerf::hal
