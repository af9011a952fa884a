// Session: the way down. Every step works whatever has died before it.
#include <signal.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "launcher/hal_link.hpp"
#include "launcher/session.hpp"
#include "rtapi/shm/leftovers.hpp"

namespace kerf::launcher {

namespace {
constexpr int kPatienceMs = 1000;
/// Servo cycles that carry what SHUTDOWN has set to the hardware.
constexpr int kProgramsSettleMs = 100;  ///< of user components, when nobody else is left
constexpr rtapi::Nanos kOutputsSettle = 20 * rtapi::kMillisecond;
}  // namespace

void Session::tear_down(const StopReason& reason) {
  if (segment_ == nullptr) return;
  // No file is written while outputs wait for their safe values.
  const std::unique_ptr<FlightKeeper> flights = std::move(flights_);
  if (flights != nullptr) flights->closing();
  segment_->begin_end();
  console_.end_progress();
  if (clock_ != nullptr) {
    clock_->watch_strays({});
    clock_->begin_teardown();
    if (!clock_->stopped()) stop_machine();
    clock_->set_chore({}, rtapi::kForever);
  }
  if (const rtapi::Status closed = recorder_.close(); !closed.ok())
    console_.error(closed.error().message());
  if (task_ != nullptr) task_->close();
  safe_.reset();
  hal_.reset();
  clock_.reset();  // the others need no turn of ours to end
  end_processes();
  if (flights != nullptr) keep_last_flight_record(*flights, reason);
  segment_.reset();
  guard_.release();
}

void Session::stop_machine() {
  const bool task_lives = task_process_ != nullptr && task_process_->running();
  // It may die under way, too; the safe state is then nobody's but ours.
  const auto host_lives = [this] {
    return realtime_ != nullptr && realtime_->running() && hal_ != nullptr;
  };
  if (task_lives && host_lives() && task_ != nullptr && task_->connected()) {
    console_.detail("stopping motion");
    if (task_->send({"state", "estop"}).ok()) {
      const auto stopped = [&] {
        task::TaskStatus status;
        return !host_lives() || !task_->status(status) ||
               (status.task_state == task::TaskState::estop && status.idle);
      };
      (void)clock_->wait_until(stopped, kPatienceMs);
    }
    task_->show_messages();
  }
  clock_->set_lookout({}, {});
  if (!task_lives && host_lives() && safe_ != nullptr) {
    // Motion sees by itself that task is silent, stops on the path and switches off.
    (void)clock_->wait_until([&] { return !host_lives() || !safe_->enabled(); }, kPatienceMs);
    safe_->disable();
  }
  reach_safe_state(host_lives());
  if (!host_lives() || clock_->stopped()) return;
  hal_->set_keep_going(true);
  // Threads still run, so that drivers write what the file sets.
  for (const HalStep& step : plan_.shutdown) {
    console_.detail("HAL file " + step.text);
    if (!hal_->run(step)) console_.error("[HAL]SHUTDOWN: " + step.text + " failed");
  }
  if (!plan_.shutdown.empty() || !plan_.safe_pins.empty()) (void)clock_->pass(kOutputsSettle);
  (void)hal_->command({"stop"});
}

/// What is left to do it by: motion and drivers while the realtime process lives; else user components, and programs of the
/// INI file's own.
void Session::reach_safe_state(bool host_lives) {
  if (safe_ == nullptr) return;
  safe_->apply(host_lives);
  if (host_lives || realtime_ == nullptr) return;
  std::string text =
      "the realtime process is dead: its drivers write nothing any more, and their outputs are "
      "what "
      "the hardware makes of that (docs/safety.md)";
  for (const SafePin& pin : plan_.safe_pins)
    text += "\n  " + pin.name + " should be " + pin.value + ": set for programs that read it";
  console_.say(text);
  for (const std::string& complaint : run_safe_commands(plan_.safe_commands))
    console_.error(complaint);
  if (!plan_.safe_pins.empty()) pause_ms(kProgramsSettleMs);
}

void Session::end_processes() {
  console_.detail("ending processes");
  const auto end = [this](Child& child) {
    if (!child.running()) return;
    child.signal(SIGTERM);
    for (int waited = 0; child.running() && waited < kPatienceMs; waited += 2) pause_ms(2);
    if (!child.running()) return;
    console_.say(child.name() + " did not end within a second and is killed");
    child.signal(SIGKILL);
    for (int waited = 0; child.running() && waited < kPatienceMs; waited += 2) pause_ms(2);
  };
  // Last started first, the realtime host last of all: user components take their pins away from it.
  for (auto at = children_.rbegin(); at != children_.rend(); ++at)
    if (at->get() != realtime_) end(**at);
  const pid_t host = realtime_ != nullptr && realtime_->running() ? realtime_->pid() : -1;
  const std::vector<std::string> killed = rtapi::end_processes_of_run(run_id_, kPatienceMs, host);
  for (const std::string& name : killed)
    console_.say(name + " did not end within a second and was killed");
  if (realtime_ != nullptr) end(*realtime_);
  (void)rtapi::end_processes_of_run(run_id_, kPatienceMs);
}

}  // namespace kerf::launcher
