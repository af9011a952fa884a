#include "hal/capi/realtime_backend.hpp"

#include <hal.h>

#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>

#include "hal/capi/backend.hpp"
#include "hal/capi/hal_lib.hpp"
#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_view.hpp"
#include "hal/loader/c_modules.hpp"

namespace kerf::hal::capi {

void acquire_port_rights() noexcept;

namespace {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

class RealtimeBackend final : public Backend {
 public:
  explicit RealtimeBackend(Host& host) : modules_(host.c_modules()) {}

  [[nodiscard]] rtapi::Segment& segment() override { return modules_.host().segment(); }
  [[nodiscard]] const rtapi::Clock& clock() override { return modules_.host().clock(); }

  Result<int> add_component(const std::string& name) override {
    KERF_TRY(const ComponentRecord* record, modules_.add_component(name));
    return static_cast<int>(record->id);
  }
  [[nodiscard]] Component* find_component(int id) override {
    const auto* record = modules_.find_component(static_cast<std::uint32_t>(id));
    if (record == nullptr) {
      components_.erase(id);
      return nullptr;
    }
    components_[id] = {id, std::string(record->name.view()), record->ready != 0};
    return &components_[id];
  }
  Status set_ready(Component& component, bool ready) override {
    auto& registry = modules_.host().registry();
    if (ready)
      registry.set_ready(record_of(component));
    else
      registry.set_unready(record_of(component));
    return {};
  }
  Status remove_component(Component& component) override {
    KERF_CHECK(modules_.remove_component(record_of(component)));
    components_.erase(component.id);
    return {};
  }
  Result<std::byte*> allocate(std::size_t bytes) override { return modules_.allocate(bytes); }
  [[nodiscard]] bool owns(const void* memory, std::size_t bytes) override {
    return modules_.owns(memory, bytes);
  }
  Result<rtapi::Offset> add_item(Component& owner, const NewItem& item) override {
    ItemSpec spec;
    spec.name = item.name;
    spec.type = item.type;
    spec.dir = item.dir;
    spec.initial = item.initial;
    spec.cell = reinterpret_cast<std::uint64_t*>(item.cell);
    spec.native = item.native;
    const bool is_pin = item.dir == Dir::in || item.dir == Dir::out || item.dir == Dir::io;
    KERF_TRY(const ItemRecord* record, modules_.add_item(record_of(owner), spec, is_pin));
    return record->link;
  }
  Result<Reply> command(std::span<const std::string> argv) override {
    return modules_.command(argv);
  }
  Result<std::byte*> add_memory(const std::string& name, std::size_t bytes,
                                std::uint64_t abi) override {
    KERF_TRY(const MemoryRecord* record, modules_.add_memory(name, bytes, abi));
    return segment().at<std::byte>(record->memory);
  }
  Status drop_memory(const std::string& name) override { return modules_.drop_memory(name); }
  Status add_function(Component& owner, const std::string& name, void (*function)(void*, long),
                      void* argument, bool reentrant) override {
    return modules_.add_function(record_of(owner), name, function, argument, reentrant);
  }
  Result<int> add_thread(const std::string& name, std::int64_t period_ns) override {
    KERF_TRY(const ComponentRecord* record, modules_.add_thread(name, period_ns));
    return static_cast<int>(record->id);
  }
  Status remove_thread(const std::string& name) override { return modules_.remove_thread(name); }

  [[nodiscard]] CModules& modules() noexcept { return modules_; }

 private:
  /// `component` came from find_component(), so it is there.
  ComponentRecord& record_of(const Component& component) {
    return *modules_.find_component(static_cast<std::uint32_t>(component.id));
  }
  CModules& modules_;
  std::map<int, Component> components_;
};

std::unique_ptr<RealtimeBackend>& the_backend() {
  static std::unique_ptr<RealtimeBackend> backend;
  return backend;
}

void print(int level, const char* text) {
  std::fputs(text, level >= RTAPI_MSG_ALL ? stdout : stderr);
  if (level >= RTAPI_MSG_ALL) std::fflush(stdout);
}

}  // namespace

Result<Backend*> backend() {
  if (the_backend() == nullptr) return fail(Errc::dead, "HAL does not run");
  return the_backend().get();
}

void start_realtime() noexcept {
  acquire_port_rights();
  start_messages(&print, true);
}

void use_host(Host& host) {
  the_backend() = std::make_unique<RealtimeBackend>(host);
  host.c_modules().set_door({&library_mutex(), &let_this_thread_in});
  realtime_view() = {host.segment().base(), &host.clock()};
}

CModules* modules_of_host() noexcept {
  return the_backend() == nullptr ? nullptr : &the_backend()->modules();
}

void forget_host() {
  realtime_view() = {};
  the_backend().reset();
  (void)drain_messages();
}

}  // namespace kerf::hal::capi

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names

extern "C" {

int hal_set_constructor(int comp_id, constructor make) {
  const Call call;
  if (call.error() != 0) return call.error();
  auto& modules = the_backend()->modules();
  auto* record = modules.find_component(static_cast<std::uint32_t>(comp_id));
  if (record == nullptr)
    return refuse(EINVAL, "component " + std::to_string(comp_id) + " not found");
  modules.set_constructor(*record, make);
  return 0;
}

int hal_comp_invoke_make(const char* comp, const char* newname, const char* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (comp == nullptr || newname == nullptr) return refuse(EINVAL, "no component name");
  auto status = the_backend()->modules().construct(comp, newname, arg == nullptr ? "" : arg);
  return status.ok() ? 0 : refuse(status.error());
}

}  // extern "C"
