// Session: one life of a machine, from the INI file to the last process.
//
// Order of the start: segment and clock, rtapi_app, milltask (its iocontrol pins are needed by HAL files), halui, HAL files and
// commands, the recorder, threads, screen and post-GUI files. The end takes the same way back. On the virtual clock time
// stands still until the threads start, so that every start is the same.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "launcher/console.hpp"
#include "launcher/environment.hpp"
#include "launcher/flight_keeper.hpp"
#include "launcher/guard.hpp"
#include "launcher/one_core.hpp"
#include "launcher/options.hpp"
#include "launcher/plan.hpp"
#include "launcher/process.hpp"
#include "launcher/recorder.hpp"
#include "launcher/safe_state.hpp"
#include "launcher/supervised_clock.hpp"
#include "launcher/task_link.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

class HalLink;

class Session {
 public:
  Session(Options options, Console& console);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// All of it; gives the exit code.
  int run();

 private:
  bool read_files();
  /// `kerf check`: what read_files() found is on the screen already.
  int check();
  rtapi::Status start();
  rtapi::Status make_instance();
  rtapi::Status start_realtime();
  rtapi::Status start_task();
  rtapi::Status run_start_steps();
  rtapi::Status run_hal_steps(const std::vector<HalStep>& steps);
  rtapi::Status start_recorder();
  rtapi::Status check_safe_state();
  rtapi::Status start_threads();
  void keep_flight_records();
  void look_for_faults();
  void keep_last_flight_record(FlightKeeper& flights, const StopReason& reason);
  rtapi::Status start_screen();
  void start_applications();
  void run_applications();
  rtapi::Status filter_program();
  void note_user_components();
  void tell_of_end(pid_t pid, const ExitState& state);
  Child& add_child(Child child);

  rtapi::Status operate();
  rtapi::Status stay_up();
  [[nodiscard]] bool at_terminal() const;

  void tear_down(const StopReason& reason);
  void stop_machine();
  void reach_safe_state(bool host_lives);
  void end_processes();
  int finish(const rtapi::Status& result, const StopReason& reason);

  Options options_;
  Console& console_;
  Installation installation_;
  ini::IniFile ini_;
  LaunchPlan plan_;
  std::string instance_;
  std::string run_id_;
  std::unique_ptr<rtapi::Segment> segment_;
  int supervisor_end_{-1};  ///< ours of the pair whose end of file tells children that we are dead
  int children_end_{-1};
  Guard guard_;
  OneCore core_;
  std::unique_ptr<SupervisedClock> clock_;
  std::vector<std::unique_ptr<Child>> children_;
  Child* realtime_{nullptr};
  Child* task_process_{nullptr};
  std::unique_ptr<HalLink> hal_;
  std::unique_ptr<SafeState> safe_;
  std::unique_ptr<TaskLink> task_;
  Recorder recorder_;
  std::unique_ptr<FlightKeeper> flights_;
  int looks_for_pins_{0};
  bool screen_runs_{false};
  std::string filtered_;  ///< G-code that a filter has made, removed at the end
  std::map<pid_t, std::string> user_components_;
};

}  // namespace kerf::launcher
