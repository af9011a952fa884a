// Realtime tasks, and what a realtime function may know of its thread. Only modules of the realtime host have these.
#include <hal.h>

#include <algorithm>
#include <cerrno>

#include "hal/capi/hal_lib.hpp"
#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_backend.hpp"
#include "hal/loader/c_modules.hpp"
#include "rtapi/thread/cycle_now.hpp"
#include "rtapi/thread/realtime_task.hpp"

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::View;
using kerf::rtapi::RealtimeTask;

namespace {

constexpr int kHighestPriority = 80;  ///< as RealDriver gives them
constexpr int kLowestPriority = 50;

RealtimeTask* task_of(int id) noexcept {
  const auto* modules = modules_of_host();
  return modules == nullptr ? nullptr : modules->find_task(id);
}

int start_task(int task_id, kerf::rtapi::Nanos period) {
  RealtimeTask* task = task_of(task_id);
  if (task == nullptr) return -EINVAL;
  if (!modules_of_host()->tasks_may_run()) return 0;
  return task->start(period).ok() ? 0 : -EINVAL;
}

}  // namespace

extern "C" {

int rtapi_prio_highest(void) { return kHighestPriority; }
int rtapi_prio_lowest(void) { return kLowestPriority; }
int rtapi_prio_next_higher(int prio) { return std::min(prio + 1, kHighestPriority); }
int rtapi_prio_next_lower(int prio) { return std::max(prio - 1, kLowestPriority); }

int rtapi_task_new(void (*taskcode)(void*), void* arg, int prio, int /*owner*/,
                   unsigned long /*stacksize*/, int /*uses_fp*/) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (taskcode == nullptr) return refuse(EINVAL, "rtapi_task_new without code");
  if (prio < kLowestPriority || prio > kHighestPriority) {
    return refuse(EINVAL,
                  "priority " + std::to_string(prio) + " of a realtime task is not between " +
                      std::to_string(kLowestPriority) + " and " + std::to_string(kHighestPriority));
  }
  auto made = modules_of_host()->add_task(taskcode, arg, prio);
  return made.ok() ? (*made)->id() : refuse(made.error());
}

int rtapi_task_delete(int task_id) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (task_of(task_id) == nullptr) return -EINVAL;
  auto status = modules_of_host()->remove_task(task_id);
  return status.ok() ? 0 : refuse(status.error());
}

int rtapi_task_start(int task_id, unsigned long period_nsec) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (period_nsec == 0) return refuse(EINVAL, "rtapi_task_start without a period");
  return start_task(task_id, static_cast<kerf::rtapi::Nanos>(period_nsec));
}

int rtapi_task_resume(int task_id) { return start_task(task_id, 0); }

int rtapi_task_pause(int task_id) {
  RealtimeTask* task = task_of(task_id);
  if (task == nullptr) return -EINVAL;
  task->pause();
  return 0;
}

int rtapi_wait(void) {
  if (RealtimeTask* task = RealtimeTask::current(); task != nullptr) task->wait();
  return 0;
}

int rtapi_task_self_resync(void) {
  if (RealtimeTask* task = RealtimeTask::current(); task != nullptr) task->resync();
  return 0;
}

int rtapi_task_self(void) {
  if (const RealtimeTask* task = RealtimeTask::current(); task != nullptr) return task->id();
  static kerf::rtapi::Word<const void*> known[32];
  if (in_ordinary_thread()) return -EINVAL;
  const void* self = __builtin_thread_pointer();
  // Only this thread writes its own pointer, so a place is free or taken by another for good.
  static kerf::rtapi::Word<int> used{0};
  for (int i = 0; i < 32; ++i) {
    if (known[i].get() == self) return i;
  }
  const int mine = used.add(1) - 1;
  if (mine >= 32) return -EINVAL;
  known[mine].set(self);
  return mine;
}

long long rtapi_task_pll_get_reference(void) {
  const auto* cycle = kerf::rtapi::cycle_now();
  return cycle == nullptr ? 0 : cycle->reference;
}

int rtapi_task_pll_set_correction(long value) {
  auto* cycle = kerf::rtapi::cycle_now();
  if (cycle == nullptr) return -EINVAL;
  cycle->correct(value);
  return 0;
}

long rtapi_clock_set_period(long nsec) {
  const Call call;
  if (call.error() != 0) return call.error();
  long fastest = 0;
  for (const auto& thread : View(call->segment()).threads()) {
    if (fastest == 0 || thread.period_ns < fastest) fastest = static_cast<long>(thread.period_ns);
  }
  if (nsec == 0) return fastest;
  return fastest == 0 && nsec > 0 ? nsec : -EINVAL;
}

}  // extern "C"
