// Components, signals, functions and threads.
#include "hal/capi/hal_lib.hpp"

#include <hal.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hal/capi/format.hpp"
#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_view.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal::capi {

using rtapi::Errc;

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

int errno_of(Errc code) noexcept {
  switch (code) {
    case Errc::ok: return 0;
    case Errc::no_memory: return ENOMEM;
    case Errc::permission: return EPERM;
    case Errc::dead: return ENOTCONN;
    case Errc::system: return EIO;
    case Errc::protocol: return EPROTO;
    case Errc::cancelled: return EINTR;
    default: return EINVAL;
  }
}

int refuse(int error, const std::string& text) {
  say(RTAPI_MSG_ERR, "HAL: ERROR: %s\n", text.c_str());
  return -error;
}

int refuse(const rtapi::Error& error) { return refuse(errno_of(error.code), error.message()); }

Call::Call() : lock_(library_mutex()) {
  if (!in_ordinary_thread()) {
    error_ = refuse(EPERM, "not to be called by realtime functions or threads of a module's own");
    return;
  }
  auto found = backend();
  if (!found.ok()) {
    error_ = refuse(found.error());
    return;
  }
  backend_ = *found;
}

bool Call::locked(unsigned bits, const char* what, const char* how) const {
  if ((View(backend_->segment()).lock_bits() & bits) == 0) return false;
  (void)refuse(EPERM, std::string(what) + " called " + how);
  return true;
}

Component* Call::open_component(int id, const char* what) const {
  Component* component = backend_->find_component(id);
  if (component == nullptr) {
    (void)refuse(EINVAL, "component " + std::to_string(id) + " not found");
    return nullptr;
  }
  if (component->ready) {
    (void)refuse(EINVAL, std::string(what) + " called after hal_ready");
    return nullptr;
  }
  return component;
}

int Call::command(std::initializer_list<std::string> argv, const std::string& text) const {
  auto reply = backend_->command(std::span<const std::string>(argv.begin(), argv.size()));
  if (!reply.ok()) return refuse(reply.error());
  if (reply->ok()) return 0;
  return refuse(errno_of(static_cast<Errc>(reply->status)), text.empty() ? reply->text : text);
}

std::string bad_name(const char* what, const char* name) {
  if (name == nullptr) return std::string("no ") + what + " name";
  if (std::strlen(name) > HAL_NAME_LEN)
    return std::string(what) + " name " + quoted(name) + " is too long";
  return {};
}

std::string format_name(const char* fmt, std::va_list args) {
  char text[4 * HAL_NAME_LEN];
  format_text(text, sizeof text, fmt, args);
  return text;
}

Type type_of(int type) noexcept {
  return type >= HAL_BIT && type <= HAL_U64 ? static_cast<Type>(type) : Type::unspecified;
}

}  // namespace kerf::hal::capi

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::View;
namespace hal = kerf::hal;

namespace {

int set_component_ready(int comp_id, bool ready) {
  const Call call;
  if (call.error() != 0) return call.error();
  Component* component = call->find_component(comp_id);
  if (component == nullptr)
    return refuse(EINVAL, "component " + std::to_string(comp_id) + " not found");
  if (component->ready == ready) {
    return refuse(EINVAL, "Component " + quoted(component->name) +
                              (ready ? " already ready" : " already unready"));
  }
  if (auto status = call->set_ready(*component, ready); !status.ok()) return refuse(status.error());
  component->ready = ready;
  return 0;
}

/// Name of the thread or function that is missing, for calls that HAL has refused.
int change_run_list(const char* command, const char* what, const char* funct_name,
                    const char* thread_name, std::initializer_list<int> position) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, what, "while HAL is locked")) return -EPERM;
  for (const int p : position) {
    if (p == 0) return refuse(EINVAL, "bad position: 0");
  }
  if (funct_name == nullptr) return refuse(EINVAL, "missing function name");
  if (thread_name == nullptr) return refuse(EINVAL, "missing thread name");
  const View view(call->segment());
  const auto functions = view.names(hal::Kind::function);
  if (std::find(functions.begin(), functions.end(), funct_name) == functions.end())
    return refuse(EINVAL, "function " + quoted(funct_name) + " not found");
  if (!view.find_thread(thread_name))
    return refuse(EINVAL, "thread " + quoted(thread_name) + " not found");
  if (position.size() == 0) return call.command({command, funct_name, thread_name});
  return call.command({command, funct_name, thread_name, std::to_string(*position.begin())});
}

}  // namespace

extern "C" {

// ---- components ---------------------------------------------------------------------------------

int hal_init(const char* name) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (auto bad = bad_name("component", name); !bad.empty()) return refuse(EINVAL, bad);
  auto made = call->add_component(name);
  if (!made.ok() && made.error().code == kerf::rtapi::Errc::exists)
    return refuse(EEXIST, "duplicate component name " + quoted(name));
  if (!made.ok()) return refuse(made.error());
  return *made;
}

int hal_exit(int comp_id) {
  const Call call;
  if (call.error() != 0) return call.error();
  Component* component = call->find_component(comp_id);
  if (component == nullptr)
    return refuse(ENOENT, "component " + std::to_string(comp_id) + " not found");
  if (auto status = call->remove_component(*component); !status.ok()) return refuse(status.error());
  return 0;
}

int hal_ready(int comp_id) { return set_component_ready(comp_id, true); }

void* hal_malloc(long size) {
  const Call call;
  if (call.error() != 0) return nullptr;
  if (size < 0) {
    (void)refuse(EINVAL, "hal_malloc of " + std::to_string(size) + " bytes");
    return nullptr;
  }
  auto memory = call->allocate(size == 0 ? 1 : static_cast<std::size_t>(size));
  if (!memory.ok()) {
    (void)refuse(memory.error());
    return nullptr;
  }
  return *memory;
}

char* hal_comp_name(int comp_id) {
  const Call call;
  if (call.error() != 0) return nullptr;
  Component* component = call->find_component(comp_id);
  return component == nullptr ? nullptr : component->name.data();
}

int hal_is_init(void) {
  const std::unique_lock lock(library_mutex());
  return realtime_view().base != nullptr ? 1 : 0;
}

const char* hal_strerror(int error) { return ::strerrordesc_np(error < 0 ? -error : error); }

hal_realtime_type_t hal_get_realtime_type(void) { return rtapi_get_realtime_type(); }

int hal_set_unready(int comp_id) { return set_component_ready(comp_id, false); }
#ifdef ULAPI
int hal_unready(int comp_id) { return set_component_ready(comp_id, false); }
#endif

// ---- signals ------------------------------------------------------------------------------------

int hal_signal_new(const char* name, hal_type_t type) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "signal_new", "while HAL is locked")) return -EPERM;
  if (auto bad = bad_name("signal", name); !bad.empty()) return refuse(EINVAL, bad);
  if (type_of(type) == hal::Type::unspecified)
    return refuse(EINVAL, "illegal signal type " + std::to_string(static_cast<int>(type)));
  return call.command({"newsig", name, std::string(hal::type_name(type_of(type)))});
}

int hal_signal_delete(const char* name) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "signal_delete")) return -EPERM;
  if (name == nullptr) return refuse(EINVAL, "no signal name");
  if (!View(call->segment()).find_signal(name))
    return refuse(EINVAL, "signal " + quoted(name) + " not found");
  return call.command({"delsig", name});
}

int hal_link(const char* pin_name, const char* sig_name) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "link")) return -EPERM;
  if (pin_name == nullptr) return refuse(EINVAL, "pin name not given");
  if (sig_name == nullptr) return refuse(EINVAL, "signal name not given");
  const View view(call->segment());
  const auto pin = view.find_pin(pin_name);
  if (!pin) return refuse(EINVAL, "pin " + quoted(pin_name) + " not found");
  const auto signal = view.find_signal(sig_name);
  if (!signal) return refuse(EINVAL, "signal " + quoted(sig_name) + " not found");
  if (pin->signal == sig_name) return 0;
  if (!pin->signal.empty()) {
    return refuse(EINVAL, "pin " + quoted(pin_name) + " is linked to " + quoted(pin->signal) +
                              ", cannot link to " + quoted(sig_name));
  }
  if (pin->type != signal->type)
    return refuse(EINVAL, "type mismatch " + quoted(pin_name) + " <- " + quoted(sig_name));
  return call.command({"linkps", pin_name, sig_name});
}

int hal_unlink(const char* pin_name) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "unlink")) return -EPERM;
  if (pin_name == nullptr) return refuse(EINVAL, "pin name not given");
  if (!View(call->segment()).find_pin(pin_name))
    return refuse(EINVAL, "pin " + quoted(pin_name) + " not found");
  return call.command({"unlinkp", pin_name});
}

// ---- functions and threads ----------------------------------------------------------------------

#ifdef RTAPI
int hal_export_funct(const char* name, void (*funct)(void*, long), void* arg, int /*uses_fp*/,
                     int reentrant, int comp_id) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_LOAD, "export_funct", "while HAL is locked")) return -EPERM;
  if (auto bad = bad_name("function", name); !bad.empty()) return refuse(EINVAL, bad);
  if (funct == nullptr) return refuse(EINVAL, "function " + quoted(name) + " has no code");
  Component* component = call.open_component(comp_id, "export_funct");
  if (component == nullptr) return -EINVAL;
  if (auto status = call->add_function(*component, name, funct, arg, reentrant != 0); !status.ok())
    return refuse(status.error());
  return 0;
}

int hal_export_functf(void (*funct)(void*, long), void* arg, int uses_fp, int reentrant,
                      int comp_id, const char* fmt, ...) {
  std::va_list args;
  va_start(args, fmt);
  const std::string name = format_name(fmt, args);
  va_end(args);
  return hal_export_funct(name.c_str(), funct, arg, uses_fp, reentrant, comp_id);
}

int hal_create_thread(const char* name, unsigned long period_nsec, int /*uses_fp*/) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "create_thread", "while HAL is locked")) return -EPERM;
  if (auto bad = bad_name("thread", name); !bad.empty()) return refuse(EINVAL, bad);
  if (View(call->segment()).find_thread(name))
    return refuse(EEXIST, std::string("duplicate thread name ") + name);
  for (const auto& thread : View(call->segment()).threads()) {
    if (static_cast<std::int64_t>(period_nsec) >= thread.period_ns) continue;
    say(RTAPI_MSG_ERR, "HAL_LIB: ERROR: new thread period %ld is less than clock period %ld\n",
        static_cast<long>(period_nsec), static_cast<long>(thread.period_ns));
    return -EINVAL;
  }
  auto made = call->add_thread(name, static_cast<std::int64_t>(period_nsec));
  if (!made.ok()) {
    say(RTAPI_MSG_ERR, "HAL_LIB: ERROR: %s\n", made.error().message().c_str());
    return -errno_of(made.error().code);
  }
  return *made;
}
#endif

int hal_thread_delete(const char* name) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_CONFIG, "thread_delete", "while HAL is locked")) return -EPERM;
  if (name == nullptr) return refuse(EINVAL, "no thread name");
  if (!View(call->segment()).find_thread(name))
    return refuse(EINVAL, "thread " + quoted(name) + " not found");
  if (auto status = call->remove_thread(name); !status.ok()) return refuse(status.error());
  return 0;
}

int hal_add_funct_to_thread(const char* funct_name, const char* thread_name, int position) {
  return change_run_list("addf", "add_funct_to_thread", funct_name, thread_name, {position});
}

int hal_init_funct_to_thread(const char* funct_name, const char* thread_name, int position) {
  return change_run_list("initf", "init_funct_to_thread", funct_name, thread_name, {position});
}

int hal_del_funct_from_thread(const char* funct_name, const char* thread_name) {
  return change_run_list("delf", "del_funct_from_thread", funct_name, thread_name, {});
}

int hal_start_threads(void) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_RUN, "start_threads", "while HAL is locked")) return -EPERM;
  return call.command({"start"});
}

int hal_stop_threads(void) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_RUN, "stop_threads", "while HAL is locked")) return -EPERM;
  return call.command({"stop"});
}

// ---- locks --------------------------------------------------------------------------------------

#ifdef ULAPI
int hal_set_lock(unsigned char lock_type) {
  const Call call;
  if (call.error() != 0) return call.error();
  return call.command({"lock-bits", std::to_string(static_cast<int>(lock_type))});
}

unsigned char hal_get_lock(void) {
  const Call call;
  if (call.error() != 0) return 0;
  return static_cast<unsigned char>(View(call->segment()).lock_bits());
}

int hal_lib_init(void) {
  const Call call;
  return call.error();
}
#endif

}  // extern "C"
