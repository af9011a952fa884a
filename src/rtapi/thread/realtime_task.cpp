#include "rtapi/thread/realtime_task.hpp"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

namespace {

constexpr std::size_t kStack = 1U << 20U;
/// A sleeping task looks for its end at least so often.
constexpr Nanos kLongestSleep = 50 * kMillisecond;
constexpr Nanos kPausedSleep = kMillisecond;
constexpr int kPatienceMs = 3000;  ///< as for a HAL thread that does not end its cycle
/// On the virtual clock, in real time: one that holds it so long is taken for hung.
constexpr std::chrono::seconds kLongestTurn{5};

}  // namespace

CycleNow*& cycle_now() noexcept {
  static thread_local constinit CycleNow* current = nullptr;
  return current;
}

struct RealtimeTask::State {
  enum class Turn { host, task };

  Config config;
  RealtimeTask* self{nullptr};
  CycleNow cycle;  ///< of the task's own thread
  pthread_t thread{};
  bool made{false};
  Word<std::uint32_t> paused{1};
  Word<std::int64_t> period{0};
  Word<Nanos> due{0};
  Word<std::uint32_t> ended{0};
  /// Of wait(): odd while the task is in it.
  Word<std::uint64_t> waits{0};
  StopWord stop;
  // The baton, on the virtual clock only.
  std::mutex mutex;
  std::condition_variable changed;
  Turn turn{Turn::host};
  bool hung{false};  ///< has kept the baton too long, and was named

  static RealtimeTask*& of_this_thread() noexcept {
    static thread_local constinit RealtimeTask* current = nullptr;
    return current;
  }

  [[nodiscard]] bool is_virtual() const noexcept { return config.clock->is_virtual(); }

  /// The thread's last act, also when it ends within wait().
  struct AtEnd {
    State& state;
    ~AtEnd() {
      const std::lock_guard lock(state.mutex);
      state.ended.publish(1);
      state.turn = Turn::host;
      state.changed.notify_all();
    }
  };

  static void* main(void* argument) {
    State& state = *static_cast<State*>(argument);
    const AtEnd at_end{state};
    of_this_thread() = state.self;
    cycle_now() = &state.cycle;
    if (state.is_virtual()) {
      std::unique_lock lock(state.mutex);
      state.changed.wait(lock, [&] { return state.turn == Turn::task; });
    } else {
      sched_param param{};
      param.sched_priority = state.config.priority;
      (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &param);
    }
    if (!state.stop.requested()) {
      state.begin(state.config.clock->now());
      state.config.code(state.config.argument);
    }
    return nullptr;
  }

  void begin(Nanos at) noexcept {
    cycle.reference = at;
    cycle.period = period.get();
    cycle.correction = 0;
  }

  void end_if_told() {
    if (stop.requested()) pthread_exit(nullptr);
  }

  /// Gives the baton back and waits for it.
  void yield() {
    std::unique_lock lock(mutex);
    turn = Turn::host;
    changed.notify_all();
    changed.wait(lock, [this] { return turn == Turn::task; });
  }

  /// Lets the task run until it waits or ends. False: it does neither, now or since a turn before.
  bool run_task() {
    std::unique_lock lock(mutex);
    if (ended.observe() != 0) return true;
    if (turn == Turn::host) {
      turn = Turn::task;
      hung = false;
      changed.notify_all();
    }
    // Nobody waits a second time for one that is hung.
    const auto patience = hung ? std::chrono::seconds{0} : kLongestTurn;
    const bool waits_again =
        changed.wait_for(lock, patience, [this] { return turn == Turn::host; });
    if (!waits_again && !hung)
      log_message(Level::error,
                  "realtime %s does not call rtapi_wait; the virtual clock goes on without it",
                  config.name.c_str());
    hung = !waits_again;
    return waits_again;
  }

  /// True when the code stands in wait(), or in none any more.
  [[nodiscard]] bool rests(std::uint64_t waits_before) {
    if (!made || ended.observe() != 0) return true;
    if (is_virtual()) {
      const std::lock_guard lock(mutex);
      return turn == Turn::host;
    }
    const std::uint64_t now = waits.observe();
    return now % 2 == 1 || now != waits_before;
  }

  void wait_real() {
    const auto clock = config.clock;
    while (!stop.requested()) {
      const Nanos now = clock->now();
      const bool stands = paused.get() != 0;
      if (!stands && now >= cycle.reference) return;
      sleep_to(std::min(now + kLongestSleep, stands ? now + kPausedSleep : cycle.reference));
    }
    pthread_exit(nullptr);
  }

  static void sleep_to(Nanos at) noexcept {
    const timespec until{static_cast<time_t>(at / kSecond), static_cast<long>(at % kSecond)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
};

RealtimeTask::RealtimeTask(const Config& config) : state_(std::make_unique<State>()) {
  state_->config = config;
  state_->self = this;
}

RealtimeTask::~RealtimeTask() {
  // A thread that does not end keeps what it stands on.
  if (!stop()) (void)state_.release();
}

int RealtimeTask::id() const noexcept { return state_->config.id; }

const char* RealtimeTask::name() const noexcept { return state_->config.name.c_str(); }

RealtimeTask* RealtimeTask::current() noexcept { return State::of_this_thread(); }

Status RealtimeTask::start(Nanos period) {
  State& s = *state_;
  if (s.paused.get() == 0 && s.ended.observe() == 0)
    return fail(Errc::busy, s.config.name + " runs already");
  if (s.ended.observe() != 0)
    return fail(Errc::bad_argument, "the code of " + s.config.name + " has ended");
  s.period.set(period);
  s.due.set(s.config.clock->now());
  s.paused.publish(0);
  if (s.made) return {};
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStack);
  const int error = pthread_create(&s.thread, &attributes, &State::main, &s);
  pthread_attr_destroy(&attributes);
  if (error != 0)
    return fail(Errc::system, std::string("cannot start a realtime task: ") + std::strerror(error));
  s.made = true;
  return {};
}

void RealtimeTask::pause() noexcept { state_->paused.publish(1); }

bool RealtimeTask::stop() {
  State& s = *state_;
  s.stop.request();
  if (!s.made) return true;
  // After the first turn it may stand in the wait() in which it was when it was told.
  while (s.is_virtual() && s.ended.observe() == 0)
    if (!s.run_task()) return false;
  for (int ms = 0; s.ended.observe() == 0; ++ms) {
    if (ms == kPatienceMs) return false;
    State::sleep_to(monotonic_now() + kMillisecond);
  }
  pthread_join(s.thread, nullptr);
  s.made = false;
  return true;
}

bool RealtimeTask::comes_to_wait() const {
  State& s = *state_;
  const std::uint64_t before = s.waits.observe();
  for (int ms = 0; !s.rests(before); ++ms) {
    if (ms == kPatienceMs) return false;
    State::sleep_to(monotonic_now() + kMillisecond);
  }
  return true;
}

void RealtimeTask::wait() {
  State& s = *state_;
  s.end_if_told();
  s.waits.publish(s.waits.get() + 1);
  const Nanos now = s.config.clock->now();
  const Nanos period = s.period.get();
  Nanos next = s.cycle.period == period ? s.cycle.next() : now + period;
  // Cycles that are lost are lost, as on HAL's threads.
  if (period > 0 && next < now) next += (now - next) / period * period + period;
  if (period == 0) next = s.is_virtual() ? now + kMillisecond : now;
  s.begin(next);
  if (s.is_virtual()) {
    s.due.set(next);
    s.yield();
    s.end_if_told();
  } else if (period > 0 || s.paused.get() != 0) {
    s.wait_real();
  }
  s.waits.publish(s.waits.get() + 1);
}

void RealtimeTask::resync() noexcept { state_->begin(state_->config.clock->now()); }

void RealtimeTask::step(Nanos now, WaitSpec& next) {
  State& s = *state_;
  if (!s.made || s.paused.get() != 0 || s.ended.observe() != 0) return;
  if (now >= s.due.get() && !s.run_task()) return;
  if (s.paused.get() == 0 && s.ended.observe() == 0) next.wake_at(s.due.get());
}

}  // namespace kerf::rtapi
