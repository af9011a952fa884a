#include "launcher/session.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "launcher/hal_link.hpp"
#include "launcher/program_run.hpp"
#include "launcher/prompt.hpp"
#include "launcher/task_check.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/virtual_clock.hpp"
#include "rtapi/shm/process.hpp"
#include "task/api/status.hpp"

namespace kerf::launcher {

using rtapi::Errc;
using rtapi::Status;

namespace {

/// Real time that a part may take to come up.
constexpr int kStartPatienceMs = 20'000;
constexpr int kDeathNoticeMs = 200;
/// A process that was killed closes its connections before it has ended; on a busy computer long before. Motion does
/// not wait for this: it stops by itself when task has been silent for HEARTBEAT_TIMEOUT.
constexpr int kBusyDeathNoticeMs = 3000;

/// Command, interpreter and io: the threads of milltask that run on the instance's clock.
constexpr int kTaskParticipants = 3;

bool has_joined(const rtapi::Segment& segment, pid_t pid) {
  auto block = segment.find<rtapi::ClockBlock>(rtapi::ClockBlock::kName);
  if (!block.ok()) return false;
  int joined = 0;
  for (const rtapi::ClockSlot& slot : (*block)->slot)
    if (slot.state != rtapi::ClockSlot::State::free && slot.pid == pid) ++joined;
  return joined >= kTaskParticipants;
}

Status died(const SupervisedClock& clock, const std::string& what) {
  const StopReason& reason = clock.reason();
  if (reason.kind == StopReason::Kind::none)
    return rtapi::fail(Errc::busy, what + " did not come up in 20 s");
  if (reason.kind == StopReason::Kind::signal) return rtapi::fail(Errc::cancelled, "interrupted");
  return rtapi::fail(Errc::dead, reason.text);
}

}  // namespace

Session::Session(Options options, Console& console)
    : options_(std::move(options)), console_(console), installation_(find_installation()) {}

Session::~Session() {
  std::error_code ignored;
  if (!filtered_.empty()) std::filesystem::remove(filtered_, ignored);
  if (supervisor_end_ >= 0) close(supervisor_end_);
  if (children_end_ >= 0) close(children_end_);
}

bool Session::at_terminal() const {
  return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
}

int Session::run() {
  if (!read_files()) return kExitFailure;
  if (options_.check_only) return check();
  Status result = filter_program();
  if (result.ok()) result = start();
  if (result.ok()) {
    remember_ini(plan_.ini_path);
    note_user_components();
    clock_->watch_strays([this](pid_t pid, const ExitState& state) { tell_of_end(pid, state); });
    result = operate();
  }
  // A closed connection, and what fails by it, is seen before the end of the process behind it; that says more.
  if (!result.ok() && clock_ != nullptr)
    (void)clock_->wait_until([] { return false; }, result.error().code == Errc::dead
                                                       ? kBusyDeathNoticeMs
                                                       : kDeathNoticeMs);
  const StopReason reason = clock_ != nullptr ? clock_->reason() : StopReason{};
  if (reason.kind == StopReason::Kind::part_died)
    console_.error(reason.text + "; taking the machine down");
  tear_down(reason);
  return finish(result, reason);
}

int Session::check() {
  TaskCheck task;
  const std::string program = installation_.bin + "/milltask";
  if (plan_.task_program == "milltask" && access(program.c_str(), X_OK) == 0)
    task = check_task(program, plan_.ini_path);
  for (const std::string& line : task.lines) {
    // Task reads many of the same keys.
    if (std::none_of(plan_.diagnostics.begin(), plan_.diagnostics.end(),
                     [&](const ini::Diagnostic& d) { return d.message() == line; }))
      console_.line(line);
  }
  if (!task.ok || !plan_.ok) return kExitFailure;
  console_.say(plan_.ini_path + ": no errors found");
  return kExitOk;
}

int Session::finish(const Status& result, const StopReason& reason) {
  if (reason.kind == StopReason::Kind::part_died) return kExitFailure;
  const bool asked = reason.kind != StopReason::Kind::none;
  if (asked && !options_.once) return kExitOk;
  if (asked) {
    console_.error("interrupted before the end of the program");
    return kExitFailure;
  }
  if (result.ok()) return kExitOk;
  const std::string text = result.error().message();
  if (task_ == nullptr || !task_->was_shown(text)) console_.error(text);
  return kExitFailure;
}

bool Session::read_files() {
  ini::LoadResult loaded = ini::IniFile::load(options_.ini);
  for (const ini::Diagnostic& d : loaded.diagnostics) console_.diagnostic(d);
  if (!loaded.ok) {
    console_.error("the INI file cannot be used");
    return false;
  }
  ini_ = std::move(loaded.file);
  plan_ = make_plan(ini_, {options_.hal_dirs, installation_.hallib});
  for (const ini::Diagnostic& d : plan_.diagnostics) console_.diagnostic(d);
  if (options_.virtual_time) plan_.virtual_time = true;
  if (options_.program.empty() && options_.once) options_.program = plan_.open_file;
  if (!options_.program.empty() && access(options_.program.c_str(), R_OK) != 0) {
    console_.error("cannot read the program " + options_.program + ": " + std::strerror(errno));
    return false;
  }
  // A check goes on, to tell what task finds, too.
  return plan_.ok || options_.check_only;
}

Status Session::start() {
  KERF_CHECK(make_instance());
  KERF_CHECK(start_realtime());
  KERF_CHECK(start_task());
  KERF_CHECK(run_start_steps());
  if (!options_.program.empty() || !options_.log_joints.empty()) KERF_CHECK(start_recorder());
  start_applications();
  KERF_CHECK(check_safe_state());
  KERF_CHECK(start_threads());
  keep_flight_records();
  return start_screen();
}

Status Session::make_instance() {
  instance_ = options_.instance.empty() ? rtapi::default_instance() : options_.instance;
  int pair[2];
  // Children inherit their end; ours closes with this process, however it ends.
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
    return rtapi::fail(Errc::system, std::string("no socket: ") + std::strerror(errno));
  supervisor_end_ = pair[0];
  children_end_ = pair[1];
  rtapi::MakeHooks hooks;
  hooks.waits = [this](const std::string& text) { console_.say(text); };
  hooks.taken = [this](const std::string& run_id) {
    run_id_ = run_id;
    return guard_.start(instance_, run_id_, supervisor_end_, plan_.safe_pins, plan_.safe_commands);
  };
  KERF_TRY(segment_, rtapi::Segment::create(instance_, plan_.segment_mb << 20U, hooks));
  KERF_CHECK(rtapi::make_clock(
      *segment_, plan_.virtual_time ? rtapi::ClockMode::virtual_time : rtapi::ClockMode::real,
      options_.speed));
  // Made here, since only one process at a time may make blocks.
  auto block = segment_->make<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
  if (!block.ok()) return rtapi::Failure{block.error()};
  if (chdir(plan_.ini_dir.c_str()) != 0)
    return rtapi::fail(Errc::system, "cannot enter " + plan_.ini_dir + ": " + std::strerror(errno));
  (void)fcntl(supervisor_end_, F_SETFD, FD_CLOEXEC);
  (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
  const int signal_fd = catch_stop_signals();
  std::vector<std::string> hal_path = options_.hal_dirs;
  hal_path.push_back(plan_.ini_dir);
  set_environment(installation_, {instance_, run_id_, plan_.ini_path, plan_.ini_dir, plan_.rt_cpus,
                                  plan_.function_timing, children_end_, std::move(hal_path)});
  KERF_TRY(auto clock, rtapi::join_clock(*segment_, rtapi::Role::launcher, "kerf"));
  clock_ = std::make_unique<SupervisedClock>(*segment_, std::move(clock), signal_fd);
  if (plan_.virtual_time && core_.take()) console_.detail("all parts share a processor core");
  console_.detail("instance " + instance_ + (plan_.virtual_time ? ", virtual time" : ""));
  return {};
}

Child& Session::add_child(Child child) {
  children_.push_back(std::make_unique<Child>(std::move(child)));
  console_.detail("started " + children_.back()->name() + ", process " +
                  std::to_string(children_.back()->pid()));
  return *children_.back();
}

Status Session::start_realtime() {
  KERF_TRY(Child child, Child::start({installation_.bin + "/rtapi_app"}));
  realtime_ = &add_child(std::move(child));
  clock_->watch_child(*realtime_);
  const auto connected = [this] {
    auto link = HalLink::connect(*segment_, *clock_, ini_);
    if (link.ok()) hal_ = std::move(*link);
    return hal_ != nullptr;
  };
  if (!clock_->hold_until(connected, kStartPatienceMs)) return died(*clock_, "rtapi_app");
  hal_->set_keep_going(options_.ignore_hal_errors);
  return {};
}

Status Session::start_task() {
  KERF_TRY(Child child, Child::start({plan_.task_program, "--ini", plan_.ini_path}));
  task_process_ = &add_child(std::move(child));
  clock_->watch_child(*task_process_);
  // HAL files connect these pins.
  const auto has_pins = [this] { return hal_->is_ready("iocontrol.0"); };
  if (!clock_->hold_until(has_pins, kStartPatienceMs)) return died(*clock_, plan_.task_program);
  if (!plan_.halui.empty()) {
    std::vector<std::string> words = split_words(plan_.halui);
    // LinuxCNC's program of this name knows nothing of our task.
    if (words.front() == "halui") words.front() = installation_.bin + "/halui";
    if (find_program(words.front()).empty()) {
      console_.say("[HAL]HALUI = " + plan_.halui + ": not found; going on without it");
      return {};
    }
    words.insert(words.end(), {"-ini", plan_.ini_path});
    KERF_TRY(Child halui, Child::start(words));
    Child& started = add_child(std::move(halui));
    clock_->watch_child(started);
    if (!clock_->hold_until([&] { return hal_->is_ready("halui"); }, kStartPatienceMs))
      return died(*clock_, plan_.halui);
  }
  return {};
}

Status Session::run_start_steps() {
  const auto& asked = options_.homing_module;
  KERF_CHECK(run_hal_steps(asked.empty() ? plan_.modules : homing_steps(asked, {})));
  const auto commands = std::find_if(plan_.hal.begin(), plan_.hal.end(),
                                     [](const HalStep& step) { return !step.is_file; });
  const std::vector<HalStep> files(plan_.hal.begin(), commands);
  if (plan_.two_pass.empty() || files.empty()) return run_hal_steps(plan_.hal);
  console_.detail("HAL files in two passes, the first is " + files.front().text);
  const bool good = hal_->run_two_pass(files, plan_.two_pass);
  if (clock_->stopped()) return died(*clock_, "HAL");
  if (!good && !options_.ignore_hal_errors) {
    return rtapi::fail(Errc::bad_argument,
                       files.front().at.text() + ": the HAL files failed ([HAL]TWOPASS)");
  }
  return run_hal_steps({commands, plan_.hal.end()});
}

Status Session::run_hal_steps(const std::vector<HalStep>& steps) {
  for (const HalStep& step : steps) {
    console_.detail((step.is_file ? "HAL file " : "HAL command ") + step.text);
    const bool good = hal_->run(step);
    if (clock_->stopped()) return died(*clock_, "HAL");
    if (!good && !options_.ignore_hal_errors) {
      return rtapi::fail(
          Errc::bad_argument,
          step.at.text() + ": " + (step.is_file ? step.text : "this HAL command") + " failed");
    }
  }
  return {};
}

Status Session::start_recorder() {
  const std::string thread = hal_->thread_of("motion-controller");
  if (thread.empty())
    return rtapi::fail(Errc::not_found,
                       "no thread runs motion-controller; a HAL file must say: addf "
                       "motion-controller servo-thread");
  KERF_CHECK(hal_->command({"loadrt", "joint-logger"}));
  KERF_CHECK(hal_->command({"addf", "joint-logger", thread}));
  KERF_CHECK(recorder_.attach(*segment_, options_.log_joints));
  const rtapi::Nanos period = (plan_.virtual_time ? 100 : 20) * rtapi::kMillisecond;
  clock_->set_chore([this] { recorder_.drain(); }, period);
  return {};
}

Status Session::check_safe_state() {
  safe_ = std::make_unique<SafeState>(*segment_, plan_.safe_pins);
  std::vector<std::string> warnings;
  if (Status checked = safe_->check(warnings); !checked.ok()) {
    safe_.reset();
    return checked;
  }
  for (const std::string& warning : warnings) console_.say("warning: " + warning);
  if (safe_->empty()) return {};
  safe_->apply(true);  // from the beginning, as the machine is off
  clock_->set_lookout([this](rtapi::WaitSpec& spec) { safe_->add_to(spec); },
                      [this] { safe_->look(); });
  return {};
}

Status Session::start_threads() {
  // motmod is loaded: task finds it and takes clients, before time moves.
  task_ = std::make_unique<TaskLink>(*clock_, console_);
  const auto connected = [this] {
    if (plan_.virtual_time && !has_joined(*segment_, task_process_->pid())) return false;
    return task_->connect(*segment_).ok();
  };
  if (!clock_->hold_until(connected, kStartPatienceMs)) return died(*clock_, plan_.task_program);
  return hal_->command({"start"});
}

void Session::keep_flight_records() {
  FlightKeeper::Options options;
  options.folder = plan_.record_dir.empty() ? default_flight_folder() : plan_.record_dir;
  options.keep = plan_.record_keep;
  options.ini = plan_.ini_path;
  if (const ini::Entry* entry = ini_.find("KINS", "KINEMATICS"); entry != nullptr)
    options.kinematics = entry->value;
  options.pins = plan_.record_pins;
  flights_ = std::make_unique<FlightKeeper>(*segment_, std::move(options));
  look_for_faults();
}

void Session::look_for_faults() {
  if (flights_ == nullptr) return;
  constexpr rtapi::Nanos kBetweenLooks = 500 * rtapi::kMillisecond;
  if (const std::string file = flights_->look(); !file.empty())
    console_.say("flight record: " + file);
  // Those of HAL files that come after the screen's start are there a little later.
  constexpr int kLooksForPins = 10;
  if (looks_for_pins_ < kLooksForPins) {
    const std::vector<std::string> missing = flights_->choose_pins();
    if (++looks_for_pins_ == kLooksForPins)
      for (const std::string& what : missing) console_.say("warning: " + what);
  }
  clock_->call_after(kBetweenLooks, [this] { look_for_faults(); });
}

/// The rings outlive whoever wrote them.
void Session::keep_last_flight_record(FlightKeeper& flights, const StopReason& reason) {
  const bool died = reason.kind == StopReason::Kind::part_died;
  if (const std::string file = flights.look(); !file.empty())
    console_.say("flight record: " + file);
  if (!died && !flights.pending()) return;
  const auto file = flights.keep(died ? "process-died" : "fault", reason.text);
  if (file.ok()) console_.say("flight record: " + *file);
}

Status Session::filter_program() {
  const std::vector<std::string> filter = filter_for(ini_, options_.program);
  if (filter.empty()) return {};
  const std::string name = std::filesystem::path(options_.program).filename().string();
  filtered_ =
      (std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "-" + name + ".ngc"))
          .string();
  std::vector<std::string> words = filter;
  words.push_back(options_.program);
  console_.say("[FILTER] " + filter.front() + " makes G-code of " + name);
  KERF_TRY(Child child, Child::start(words, {.output = filtered_}));
  for (;;) {
    const auto exit = child.poll_exit();
    if (!exit) {
      pause_ms(5);
      continue;
    }
    if (!exit->by_signal && exit->number == 0) break;
    return rtapi::fail(Errc::bad_argument, "[FILTER] " + filter.front() + " " +
                                               describe_exit(*exit) + ": no program of " + name);
  }
  options_.program = filtered_;
  return {};
}

void Session::note_user_components() { user_components_ = hal_->user_components(); }

void Session::tell_of_end(pid_t pid, const ExitState& state) {
  if (pid == guard_.pid()) {
    const Status again =
        guard_.start(instance_, run_id_, supervisor_end_, plan_.safe_pins, plan_.safe_commands);
    console_.say(
        "kerf's guard " + describe_exit(state) +
        (again.ok() ? "; there is a new one" : "; nobody cleans up should kerf be killed"));
    return;
  }
  const auto component = user_components_.find(pid);
  const std::string name = rtapi::process_name(pid);
  if (component != user_components_.end())
    console_.say("warning: " + name + " (process " + std::to_string(pid) + ", HAL component " +
                 component->second + ") " + describe_exit(state) +
                 "; the machine goes on without it");
  else if (state.by_signal || state.number != 0)
    console_.say("warning: " + name + " (process " + std::to_string(pid) + ") " +
                 describe_exit(state));
  else
    console_.detail(name + " (process " + std::to_string(pid) + ") " + describe_exit(state));
  note_user_components();
}

void Session::start_applications() {
  if (plan_.applications.empty()) return;
  if (plan_.applications_delay_s > 0)
    clock_->call_after(rtapi::seconds(plan_.applications_delay_s), [this] { run_applications(); });
  else
    run_applications();
}

void Session::run_applications() {
  for (const std::string& line : plan_.applications) {
    std::vector<std::string> words = split_words(line);
    // Redirections and the like are the shell's.
    if (line.find_first_of("<>|&;$*`") != std::string::npos)
      words = {"/bin/sh", "-c", "exec " + line};
    auto child = Child::start(words, {.cores = core_.all()});
    if (child.ok())
      add_child(std::move(*child));
    else
      console_.say("[APPLICATIONS]APP = " + line + ": " + child.error().message());
  }
}

Status Session::start_screen() {
  if (!plan_.display.empty() && !options_.once) {
    std::vector<std::string> words = plan_.display;
    if (find_program(words.front()).empty()) {
      console_.say("[DISPLAY]DISPLAY = " + words.front() + ": not found: staying in the terminal");
    } else {
      words.insert(words.begin() + 1, {"-ini", plan_.ini_path});
      KERF_TRY(Child child, Child::start(words, {.terminal = true, .cores = core_.all()}));
      clock_->watch_child(add_child(std::move(child)), true);
      screen_runs_ = true;
    }
  }
  // A screen that runs does these files itself, when its pins are there (manual: POSTGUI_HALFILE).
  if (screen_runs_ || plan_.postgui.empty()) return {};
  if (plan_.display.empty() || options_.ignore_hal_errors) return run_hal_steps(plan_.postgui);
  hal_->set_keep_going(true);
  for (const HalStep& step : plan_.postgui)
    if (!hal_->run(step))
      console_.say(step.at.text() + ": warning: " + step.text + " is for the screen " +
                   plan_.display.front() + ", which does not run; what needs its pins is left out");
  hal_->set_keep_going(false);
  return clock_->stopped() ? died(*clock_, "HAL") : Status{};
}

Status Session::operate() {
  if (options_.once || !options_.program.empty()) {
    ProgramRun run({*clock_, *task_, recorder_, console_, *segment_},
                   {options_.program, options_.svg, options_.once || !at_terminal()});
    Status result = run.run();
    if (options_.once) {
      // The log ends here, and not at whatever moment the teardown has come to.
      const Status closed = recorder_.close();
      if (result.ok() && !closed.ok()) result = closed;
    }
    if (options_.once || clock_->stopped()) return result;
    if (!result.ok() && !task_->was_shown(result.error().message()))
      console_.error(result.error().message());
  }
  return stay_up();
}

Status Session::stay_up() {
  if (at_terminal() && !screen_runs_) {
    std::string text = plan_.machine_name + ": type G-code, 'help' for commands, Ctrl-D to end.\n";
    task::TaskStatus status;
    if (task_->status(status) && status.task_state != task::TaskState::on)
      text += "Switch the machine on with: state estop-reset, state on, home (a line each).\n";
    console_.print(text);
    return run_prompt(*clock_, *task_, console_);
  }
  console_.say(plan_.machine_name + " runs; end it with Ctrl-C or SIGTERM");
  while (!clock_->stopped()) {
    rtapi::WaitSpec spec;
    task_->add_to(spec);
    (void)task_->client().poll();
    task_->show_messages();
    clock_->wait(spec);
  }
  return {};
}

}  // namespace kerf::launcher
