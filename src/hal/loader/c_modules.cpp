#include "hal/loader/c_modules.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "hal/loader/c_parameters.hpp"
#include "hal/loader/live_builder.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

/// In real time. A driver may have to wait for its device.
constexpr std::chrono::seconds kLongestExit{5};

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return x == y || ((x == '-' || x == '_') && (y == '-' || y == '_'));
  });
}

template <class F>
F symbol(void* library, const char* name) {
  return reinterpret_cast<F>(::dlsym(library, name));
}

}  // namespace

/// Calls of the C API belong to this module while the object lives.
class CModules::Running {
 public:
  Running(CModules& all, Host::Loaded& module) : all_(all), before_(all.running_) {
    all.running_ = &module;
  }
  ~Running() { all_.running_ = before_; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  CModules& all_;
  Host::Loaded* before_;
};

CModules::~CModules() {
  for (TaskPlace& place : tasks_)
    std::unique_ptr<rtapi::RealtimeTask>(place.task.observe()).reset();
}

// ---- Host's side --------------------------------------------------------------------------------

Reply CModules::load(const std::string& name, std::span<const std::string> args,
                     const Module& module) {
  auto loaded = std::make_unique<Host::Loaded>();
  loaded->name = name;
  loaded->module = &module;
  loaded->c = std::make_unique<CModulePart>();
  Host::Loaded& l = *loaded;
  l.c->library = module.c_library;
  for (const auto& word : args) l.c->args += (l.c->args.empty() ? "" : " ") + word;
  if (auto status = set_c_parameters(module.c_library, args, l.c->texts); !status.ok()) {
    host_.modules_.close(&module);
    return {static_cast<int>(status.error().code), name + ": " + status.error().message()};
  }
  host_.loaded_.push_back(std::move(loaded));
  int result = 0;
  {
    const Running running(*this, l);
    result = symbol<int (*)()>(module.c_library, "rtapi_app_main")();
  }
  if (result >= 0) {
    l.c->started = true;
    return {};
  }
  auto status = check_tasks(l);
  if (status.ok()) status = take_out_functions(l, nullptr);
  if (!status.ok()) {
    // A thread does not leave the module's code: its memory must stay.
    return {static_cast<int>(status.error().code), name + ": " + status.error().message()};
  }
  (void)host_.destroy(l);  // rtapi_app_exit is not called
  std::erase_if(host_.loaded_, [&](const auto& other) { return other.get() == &l; });
  return {
      static_cast<int>(Errc::bad_argument),
      name + ": rtapi_app_main: " + std::strerror(-result) + " (" + std::to_string(result) + ")"};
}

bool CModules::call_exit(void (*exit)()) {
  // A thread of its own can be left to itself. The two share this, and neither knows which ends first.
  struct Shared {
    std::mutex mutex;
    std::condition_variable changed;
    bool returned{false};
  };
  const auto shared = std::make_shared<Shared>();
  std::thread runner([exit, shared, let_in = door_.let_this_thread_in] {
    if (let_in != nullptr) let_in();
    exit();
    const std::lock_guard lock(shared->mutex);
    shared->returned = true;
    shared->changed.notify_all();
  });
  bool returned = false;
  {
    std::unique_lock lock(shared->mutex);
    returned = shared->changed.wait_for(lock, kLongestExit, [&] { return shared->returned; });
  }
  // A call that is under way ends first; the next one is refused.
  std::unique_lock<std::recursive_mutex> no_calls;
  if (door_.calls != nullptr) no_calls = std::unique_lock(*door_.calls);
  if (door_.let_this_thread_in != nullptr) door_.let_this_thread_in();
  if (!returned) {
    const std::lock_guard lock(shared->mutex);
    returned = shared->returned;
  }
  if (no_calls.owns_lock()) no_calls.unlock();
  if (returned)
    runner.join();
  else
    runner.detach();
  return returned;
}

Status CModules::stop(Host::Loaded& l) {
  if (l.c->started) {
    const Running running(*this, l);
    l.c->started = false;
    auto exit = symbol<void (*)()>(l.c->library, "rtapi_app_exit");
    if (exit != nullptr && !call_exit(exit)) {
      host_.remove_threads(l);
      return fail(Errc::busy, "component " + quoted(l.name) +
                                  " does not return from rtapi_app_exit: after " +
                                  std::to_string(kLongestExit.count()) +
                                  " s it is abandoned; what it made stays until HAL ends");
    }
  }
  stop_tasks(l);
  while (!l.c->components.empty()) erase_component(l, *l.c->components.back().record);
  host_.remove_threads(l);
  for (auto it = blocks_.begin(); it != blocks_.end();) {
    it->second.users.erase(&l);
    if (!it->second.users.empty()) {
      ++it;
      continue;
    }
    host_.registry_->free_memory(const_cast<std::byte*>(it->first));
    it = blocks_.erase(it);
  }
  {
    const Running running(*this, l);
    while (!l.c->memory_names.empty()) (void)drop_memory(l.c->memory_names.begin()->first);
  }
  return {};
}

std::pair<void*, Host::Loaded*> CModules::find_function(const std::string& name) const {
  for (auto it = host_.loaded_.rbegin(); it != host_.loaded_.rend(); ++it) {
    Host::Loaded& l = **it;
    if (l.c == nullptr) continue;
    if (void* const found = ::dlsym(l.c->library, name.c_str()); found != nullptr)
      return {found, &l};
  }
  return {};
}

void CModules::run_as(Host::Loaded& module, void (*code)(void*), void* argument) {
  const Running running(*this, module);
  code(argument);
}

bool CModules::has_component(const Host::Loaded& module, std::string_view name) {
  return std::any_of(module.c->components.begin(), module.c->components.end(),
                     [&](const CComponent& c) { return same_name(c.record->name, name); });
}

// ---- components ---------------------------------------------------------------------------------

Result<Host::Loaded*> CModules::running() const {
  if (running_ != nullptr) return running_;
  return fail(Errc::permission,
              "only rtapi_app_main and rtapi_app_exit may do this, while the module is loaded or "
              "unloaded");
}

Host::Loaded* CModules::owner_of(const ComponentRecord& component) const {
  for (const auto& l : host_.loaded_) {
    if (l->c == nullptr) continue;
    for (const auto& c : l->c->components)
      if (c.record == &component) return l.get();
  }
  return nullptr;
}

Result<ComponentRecord*> CModules::add_component(const std::string& name) {
  KERF_TRY(Host::Loaded * l, running());
  const bool own_name = same_name(name, l->name);
  KERF_TRY(ComponentRecord * record,
           host_.registry_->add_component(name, ComponentKind::realtime, 0,
                                          own_name ? l->c->args : std::string(), own_name));
  l->c->components.push_back({record, nullptr});
  return record;
}

ComponentRecord* CModules::find_component(std::uint32_t id) const {
  for (const auto& l : host_.loaded_) {
    if (l->c == nullptr) continue;
    for (const auto& c : l->c->components)
      if (c.record->id == id) return c.record;
  }
  return nullptr;
}

Status CModules::take_out_functions(Host::Loaded& module, const ComponentRecord* component) {
  Host::Loaded only;
  for (auto* function : module.functions) {
    if (component == nullptr || host_.registry_->at<ComponentRecord>(function->owner) == component)
      only.functions.push_back(function);
  }
  const bool used = std::any_of(only.functions.begin(), only.functions.end(),
                                [](const FunctionRecord* f) { return f->users > 0; });
  if (!used) return {};
  KERF_CHECK(host_.drop_functions(only));
  return host_.wait_for_grace();
}

void CModules::erase_component(Host::Loaded& module, ComponentRecord& component) {
  std::erase_if(module.functions, [&](FunctionRecord* function) {
    if (host_.registry_->at<ComponentRecord>(function->owner) != &component) return false;
    host_.forget_function(function);
    return true;
  });
  std::erase_if(module.c->components, [&](const CComponent& c) { return c.record == &component; });
  host_.registry_->remove_component(component);
}

Status CModules::remove_component(ComponentRecord& component) {
  Host::Loaded* l = owner_of(component);
  if (l == nullptr) return fail(Errc::not_found, "component not found");
  KERF_CHECK(take_out_functions(*l, &component));
  erase_component(*l, component);
  return {};
}

void CModules::set_constructor(ComponentRecord& component, int (*make)(const char*, const char*)) {
  Host::Loaded* l = owner_of(component);
  if (l == nullptr) return;
  for (auto& c : l->c->components)
    if (c.record == &component) c.constructor = make;
}

Status CModules::construct(std::string_view component, const std::string& prefix,
                           const std::string& arg) {
  for (const auto& l : host_.loaded_) {
    if (l->c == nullptr) continue;
    for (const auto& c : l->c->components) {
      if (c.record->name != component) continue;
      if (c.constructor == nullptr)
        return fail(Errc::bad_argument, "component " + quoted(component) + " has no constructor");
      const Running running(*this, *l);
      const int result = c.constructor(prefix.c_str(), arg.c_str());
      if (result >= 0) return {};
      return fail(Errc::bad_argument, quoted(component) + " could not make " + quoted(prefix) +
                                          ": " + std::strerror(-result));
    }
  }
  return fail(Errc::not_found, "component " + quoted(component) + " not found");
}

// ---- memory -------------------------------------------------------------------------------------

Result<std::byte*> CModules::allocate(std::size_t bytes) {
  KERF_TRY(Host::Loaded * l, running());
  KERF_TRY(std::byte * memory,
           host_.registry_->allocate_memory(bytes, Registry::Region::structure));
  blocks_[memory] = {bytes, {l}};
  return memory;
}

bool CModules::owns(const void* memory, std::size_t bytes) const {
  const auto* begin = static_cast<const std::byte*>(memory);
  auto it = blocks_.upper_bound(begin);
  if (it == blocks_.begin()) return false;
  --it;
  return begin + bytes <= it->first + it->second.bytes;
}

void CModules::use(const void* memory, const Host::Loaded& user) {
  auto it = blocks_.upper_bound(static_cast<const std::byte*>(memory));
  if (it != blocks_.begin()) std::prev(it)->second.users.insert(&user);
}

Result<MemoryRecord*> CModules::add_memory(const std::string& name, std::size_t bytes,
                                           std::uint64_t abi) {
  KERF_TRY(Host::Loaded * l, running());
  MemoryRecord* record = host_.registry_->find_memory(name);
  if (record == nullptr) {
    KERF_TRY(record, host_.registry_->add_memory(name, bytes, abi));
    host_.named_[name] = {record, 0};
  } else if (record->bytes != bytes || record->abi != abi) {
    return fail(Errc::exists, "memory " + quoted(name) + " is there already, with " +
                                  std::to_string(record->bytes) + " bytes");
  }
  // Counted with the programs that use it; what a C++ component made ends with that.
  if (const auto it = host_.named_.find(name); it != host_.named_.end()) {
    ++it->second.users;
    ++l->c->memory_names[name];
  }
  return record;
}

Status CModules::drop_memory(const std::string& name) {
  KERF_TRY(Host::Loaded * l, running());
  const auto own = l->c->memory_names.find(name);
  if (own == l->c->memory_names.end()) return {};
  if (--own->second == 0) l->c->memory_names.erase(own);
  host_.drop_named(name, 1);
  return {};
}

// ---- items, functions, threads ------------------------------------------------------------------

Result<ItemRecord*> CModules::add_item(ComponentRecord& owner, const ItemSpec& spec, bool pin) {
  const Host::Loaded* l = owner_of(owner);
  if (l == nullptr) return fail(Errc::not_found, "component not found");
  ItemSpec own = spec;
  own.owner_base = reinterpret_cast<std::uintptr_t>(host_.segment().base());
  KERF_TRY(ItemRecord * item,
           pin ? host_.registry_->add_pin(owner, own) : host_.registry_->add_param(owner, own));
  // The cell or value may stand in another module's memory, which then must outlive that module.
  if (own.cell != nullptr) use(own.cell, *l);
  if (own.native != nullptr) use(own.native, *l);
  return item;
}

Status CModules::add_function(ComponentRecord& owner, const std::string& name,
                              void (*code)(void*, long), void* argument, bool reentrant) {
  Host::Loaded* l = owner_of(owner);
  if (l == nullptr) return fail(Errc::not_found, "component not found");
  CFunction& function = l->c->functions.emplace_back(CFunction{code, argument});
  // The function's items belong to the component that exports it.
  ComponentRecord* before = l->record;
  l->record = &owner;
  LiveBuilder builder(host_, *l, {});
  builder.add_function(name, &run_c_function, &function, {});
  builder.show_times();
  l->record = before;
  if (builder.failed()) return fail(Errc::bad_argument, builder.error());
  // For `show funct`: the module's code, not the thunk that calls it.
  l->functions.back()->code = reinterpret_cast<std::uintptr_t>(code);
  l->functions.back()->argument = reinterpret_cast<std::uintptr_t>(argument);
  l->functions.back()->reentrant = reentrant ? 1 : 0;
  return {};
}

Result<ComponentRecord*> CModules::add_thread(const std::string& name, std::int64_t period_ns) {
  KERF_TRY(Host::Loaded * l, running());
  KERF_CHECK(host_.add_thread(*l, name, period_ns));
  return host_.find_thread(name)->component;
}

Status CModules::remove_thread(const std::string& name) {
  KERF_TRY(Host::Loaded * l, running());
  Host::Thread* thread = host_.find_thread(name);
  // A thread of a module that goes stands on its own already.
  if (thread == nullptr || (thread->owner != l && thread->owner != nullptr))
    return fail(Errc::permission, "thread " + quoted(name) + " is not this module's");
  KERF_CHECK(host_.publish_list(*thread, {}));
  host_.remove_thread(*thread);
  return {};
}

// ---- tasks --------------------------------------------------------------------------------------

Result<rtapi::RealtimeTask*> CModules::add_task(void (*code)(void*), void* argument, int priority) {
  KERF_TRY(Host::Loaded * l, running());
  auto* const place = std::find_if(std::begin(tasks_), std::end(tasks_),
                                   [](const TaskPlace& p) { return p.task.get() == nullptr; });
  if (place == std::end(tasks_))
    return fail(Errc::no_memory, "there are " + std::to_string(kTasks) + " realtime tasks already");
  const int id = kFirstTask + static_cast<int>(place - std::begin(tasks_));
  auto task = std::make_unique<rtapi::RealtimeTask>(rtapi::RealtimeTask::Config{
      code, argument, priority, id, "task " + std::to_string(id) + " of " + quoted(l->name),
      &host_.clock()});
  if (host_.clock().is_virtual()) l->participants.push_back(task.get());
  place->owner = l;
  place->task.publish(task.release());
  return place->task.get();
}

rtapi::RealtimeTask* CModules::find_task(int id) const noexcept {
  if (id < kFirstTask || id >= kFirstTask + kTasks) return nullptr;
  return tasks_[id - kFirstTask].task.observe();
}

Status CModules::remove_task(int id) {
  rtapi::RealtimeTask* task = find_task(id);
  if (task == nullptr) return fail(Errc::not_found, "no task " + std::to_string(id));
  if (!task->stop())
    return fail(Errc::busy, std::string(task->name()) + " does not call rtapi_wait");
  TaskPlace& place = tasks_[id - kFirstTask];
  std::erase(place.owner->participants, task);
  place.task.publish(nullptr);
  std::unique_ptr<rtapi::RealtimeTask>(task).reset();
  return {};
}

Status CModules::check_tasks(const Host::Loaded& module) const {
  for (const TaskPlace& place : tasks_) {
    const rtapi::RealtimeTask* task = place.task.get();
    if (task == nullptr || place.owner != &module || task->comes_to_wait()) continue;
    return fail(Errc::busy, std::string("realtime ") + task->name() +
                                " does not call rtapi_wait: nothing has been unloaded");
  }
  return {};
}

void CModules::stop_tasks(const Host::Loaded& module) {
  for (int i = 0; i < kTasks; ++i) {
    if (tasks_[i].task.get() == nullptr || tasks_[i].owner != &module) continue;
    if (auto status = remove_task(kFirstTask + i); !status.ok()) {
      // check_tasks() has seen it wait; since then it runs without end in code that goes away now.
      std::fprintf(stderr, "%s: %s; the realtime host cannot go on\n", module.name.c_str(),
                   status.error().message().c_str());
      std::abort();
    }
  }
}

bool CModules::tasks_may_run() const {
  return host_.driver_ == nullptr || !host_.driver_->declares_only();
}

}  // namespace kerf::hal
