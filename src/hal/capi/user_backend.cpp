// The C API's backend in programs: requests over the instance's socket, values and memory in the mapped segment.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>

#include "hal/capi/backend.hpp"
#include "hal/capi/hal_lib.hpp"
#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_view.hpp"
#include "hal/client/session.hpp"
#include "hal/core/value_text.hpp"
#include "rtapi/clock/join_clock.hpp"

namespace kerf::hal::capi {
namespace {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

std::string exact_text(Type type, std::uint64_t raw) {
  if (type == Type::port) return {};
  if (type != Type::floating) return plain_value_text(type, raw);
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", from_raw<double>(raw));
  return text;
}

class UserBackend final : public Backend {
 public:
  static Result<std::unique_ptr<UserBackend>> connect() {
    auto segment = rtapi::Segment::attach(rtapi::default_instance());
    if (!segment.ok()) {
      return fail(Errc::dead, "HAL does not run (start the program by halrun or loadusr): " +
                                  segment.error().message());
    }
    auto session = SocketSession::connect(**segment);
    if (!session.ok()) {
      return fail(Errc::dead, "the realtime host of instance '" + (*segment)->instance() +
                                  "' does not answer: " + session.error().message());
    }
    return std::unique_ptr<UserBackend>(new UserBackend(std::move(*segment), std::move(*session)));
  }
  /// False in a child that fork() made: the connection is its parent's.
  [[nodiscard]] bool ours() const { return pid_ == ::getpid(); }
  [[nodiscard]] bool idle() const { return components_.empty(); }

  [[nodiscard]] rtapi::Segment& segment() override { return *segment_; }
  [[nodiscard]] const rtapi::Clock& clock() override { return *clock_; }

  Result<int> add_component(const std::string& name) override {
    const auto base = reinterpret_cast<std::uintptr_t>(segment_->base());
    KERF_TRY(const std::string id, ask(*session_, {"comp-new", name, std::to_string(base)}));
    const int number = std::atoi(id.c_str());
    components_[number] = {number, name, false};
    return number;
  }
  [[nodiscard]] Component* find_component(int id) override {
    const auto it = components_.find(id);
    return it == components_.end() ? nullptr : &it->second;
  }
  Status set_ready(Component& component, bool ready) override {
    return done({ready ? "comp-ready" : "comp-unready", component.name});
  }
  Status remove_component(Component& component) override {
    const std::string name = component.name;
    components_.erase(component.id);
    return done({"comp-exit", name});
  }

  Result<std::byte*> allocate(std::size_t bytes) override {
    KERF_TRY(const std::string offset, ask(*session_, {"mem-new", std::to_string(bytes)}));
    auto* memory = segment_->base() + std::strtoull(offset.c_str(), nullptr, 10);
    memory_[memory] = bytes;
    return memory;
  }
  [[nodiscard]] bool owns(const void* memory, std::size_t bytes) override {
    const auto* begin = static_cast<const std::byte*>(memory);
    auto it = memory_.upper_bound(begin);
    if (it == memory_.begin()) return false;
    --it;
    return begin + bytes <= it->first + it->second;
  }

  Result<rtapi::Offset> add_item(Component& owner, const NewItem& item) override {
    const bool is_pin = item.dir == Dir::in || item.dir == Dir::out || item.dir == Dir::io;
    std::vector<std::string> argv{
        is_pin ? "pin-new" : "param-new", owner.name,
        std::string(item.name),           std::string(type_name(item.type)),
        std::string(dir_name(item.dir)),  exact_text(item.type, item.initial)};
    if (item.cell != nullptr) argv.push_back(std::to_string(segment_->offset_of(item.cell)));
    if (item.native != nullptr) argv.push_back(std::to_string(segment_->offset_of(item.native)));
    KERF_TRY(const Reply reply, session_->request(argv));
    if (!reply.ok()) return fail(static_cast<Errc>(reply.status), reply.text);
    return rtapi::Offset{std::strtoull(reply.text.c_str(), nullptr, 10)};
  }

  Result<Reply> command(std::span<const std::string> argv) override {
    return session_->request(argv);
  }

  Result<std::byte*> add_memory(const std::string& name, std::size_t bytes,
                                std::uint64_t abi) override {
    KERF_TRY(const std::string offset,
             ask(*session_, {"shm-new", name, std::to_string(bytes), std::to_string(abi)}));
    return segment_->base() + std::strtoull(offset.c_str(), nullptr, 10);
  }
  Status drop_memory(const std::string& name) override {
    auto dropped = done({"shm-drop", name});
    // A realtime component's memory is not counted here: it ends with that.
    if (!dropped.ok() && dropped.error().code == Errc::not_found) return {};
    return dropped;
  }
  void hold_values() override {
    if (!holds_values_) holds_values_ = done({"hold-values"}).ok();
  }

  Status add_function(Component& /*owner*/, const std::string& name,
                      void (* /*function*/)(void*, long), void* /*argument*/,
                      bool /*reentrant*/) override {
    return fail(Errc::bad_argument, "function '" + name + "': programs have none");
  }
  Result<int> add_thread(const std::string& name, std::int64_t /*period_ns*/) override {
    return fail(Errc::bad_argument, "thread '" + name + "': programs make none");
  }
  Status remove_thread(const std::string& name) override {
    return fail(Errc::permission, "thread '" + name + "' is not this program's");
  }

 private:
  UserBackend(std::unique_ptr<rtapi::Segment> segment, std::unique_ptr<SocketSession> session)
      : segment_(std::move(segment)),
        session_(std::move(session)),
        clock_(rtapi::read_clock(*segment_)) {}
  Status done(std::initializer_list<std::string> argv) {
    auto answer = ask(*session_, argv);
    if (!answer.ok()) return rtapi::Failure{answer.error()};
    return {};
  }

  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<SocketSession> session_;
  std::unique_ptr<rtapi::Clock> clock_;
  pid_t pid_{::getpid()};
  std::map<int, Component> components_;
  std::map<const std::byte*, std::size_t> memory_;
  bool holds_values_{false};
};

/// Never destroyed at the end of the program: its threads may still read pins. The kernel closes the connection, and the host takes
/// the components out.
UserBackend*& the_backend() {
  static UserBackend* backend = nullptr;
  return backend;
}

void print(int level, const char* text) {
  std::fputs(text, level >= RTAPI_MSG_ALL ? stdout : stderr);
}

const bool messages_started = (start_messages(&print, false), true);

}  // namespace

Result<Backend*> backend() {
  UserBackend*& present = the_backend();
  if (present != nullptr && !present->ours()) {
    return fail(
        Errc::permission,
        "HAL belongs to the process that this one was forked from; fork before hal_init, or "
        "exec a program of its own");
  }
  if (present == nullptr) {
    KERF_TRY(auto made, UserBackend::connect());
    present = made.release();
    realtime_view() = {present->segment().base(), &present->clock()};
  }
  return present;
}

void wait_a_little() {
  const auto clock = rtapi::make_real_clock();
  rtapi::WaitSpec spec;
  spec.wake_at(clock->now() + rtapi::kMillisecond);
  clock->wait(spec);
}

}  // namespace kerf::hal::capi

extern "C" void hal_lib_exit(void) {
  using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published name
  const std::unique_lock lock(library_mutex());
  UserBackend*& present = the_backend();
  if (present == nullptr || !present->ours() || !present->idle()) return;
  realtime_view() = {};
  delete present;
  present = nullptr;
}
