#include "harness/machine.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "hal/client/session.hpp"
#include "hal/cmd/commander.hpp"
#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/module_source.hpp"
#include "hal/loader/realtime_host.hpp"
#include "hal/tcl/script.hpp"
#include "hal/tcl/tcl_hal.hpp"
#include "ini/ini_file.hpp"
#include "launcher/plan.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/client.hpp"
#include "task/task.hpp"

namespace kerf::harness {

namespace fs = std::filesystem;

namespace {

/// Keeps what HAL commands print.
class TextSink final : public hal::CommandSink {
 public:
  void out(std::string_view text) override { text_ += text; }
  void err(std::string_view text) override { errors_ += text; }
  std::string text_, errors_;
};

/// Planner and other participants of components join the machine's scheduler.
class Driver final : public hal::HostDriver {
 public:
  explicit Driver(rtapi::LocalScheduler& scheduler) : scheduler_(scheduler) {}
  rtapi::Status participant_added(rtapi::Participant& p) override {
    scheduler_.add(p);
    return {};
  }
  void participant_removed(rtapi::Participant& p) override { scheduler_.remove(p); }

 private:
  rtapi::LocalScheduler& scheduler_;
};

/// Runs after the realtime host at each instant at which it is due, to show each cycle to a test.
class Watcher final : public rtapi::Participant {
 public:
  [[nodiscard]] const char* name() const noexcept override { return "watcher"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::realtime_host; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override {
    motion::MotionStatus status;
    if (shared != nullptr && on_cycle && shared->status.read(status) &&
        status.cycle != last_cycle) {
      last_cycle = status.cycle;
      on_cycle(status);
    }
    if (on_cycle) next.until = now + period_ns;
  }
  motion::MotionShared* shared{nullptr};
  std::function<void(const motion::MotionStatus&)> on_cycle;
  rtapi::Nanos period_ns{rtapi::kMillisecond};
  std::uint64_t last_cycle{0};
};

double real_value(hal::Type type, std::uint64_t raw) {
  switch (type) {
    case hal::Type::floating: return hal::from_raw<double>(raw);
    case hal::Type::s32:
    case hal::Type::s64: return static_cast<double>(hal::from_raw<std::int64_t>(raw));
    default: return static_cast<double>(raw);
  }
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

struct Machine::Parts {
  fs::path folder;
  pid_t owner{getpid()};
  std::string start_errors;
  bool ready{false};
  std::unique_ptr<rtapi::Segment> segment;
  rtapi::LocalScheduler scheduler;
  std::vector<hal::StaticModule> module_table;
  std::unique_ptr<hal::StaticSource> modules;
  std::unique_ptr<Driver> driver;
  std::unique_ptr<hal::Host> host;
  std::unique_ptr<hal::RealtimeHost> realtime;
  Watcher watcher;
  std::unique_ptr<hal::LocalSession> session;
  TextSink sink;
  ini::IniFile ini;
  std::unique_ptr<hal::Commander> halcmd;
  std::unique_ptr<task::Task> task;
  motion::MotionShared* shared{nullptr};
  int programs{0};

  ~Parts() {
    if (task) {
      for (auto* p : task->participants()) scheduler.remove(*p);
      task->shut_down();
      task.reset();
    }
    halcmd.reset();
    if (realtime) scheduler.remove(*realtime);
    scheduler.remove(watcher);
    realtime.reset();
    session.reset();
    host.reset();
    std::error_code ignored;
    if (getpid() == owner) fs::remove_all(folder, ignored);
  }
};

/// What the launcher does with HAL files, in this process; Tcl files cannot start programs here.
bool Machine::run_hal_steps(Parts& p, const std::vector<launcher::HalStep>& steps,
                            const std::string& two_pass) {
  hal::tcl::TclHal words([&p]() -> rtapi::Result<hal::tcl::Attachment> {
    return hal::tcl::Attachment{p.session.get(), nullptr};
  });
  hal::tcl::ScriptRunner scripts(words, &p.ini, &p.sink);
  scripts.set_exit_forbidden(true);
  std::vector<hal::tcl::HalFile> files;
  for (const auto& step : steps)
    if (step.is_file) files.push_back({step.text, step.arguments});
  if (!two_pass.empty() && !scripts.run_two_pass(files, hal::tcl::TwoPassOptions::parse(two_pass)))
    return false;
  for (const auto& step : steps) {
    if (step.is_file && !two_pass.empty()) continue;
    const bool done = step.is_tcl()  ? scripts.run_file({step.text, step.arguments})
                      : step.is_file ? p.halcmd->run_file(step.text)
                                     : p.halcmd->run_line(step.text, "INI", step.at.line);
    if (!done) return false;
  }
  return true;
}

Machine::Machine() : parts_(std::make_unique<Parts>()) {}
Machine::~Machine() = default;

std::unique_ptr<Machine> Machine::start(const MachineOptions& options) {
  static std::atomic<int> count{0};
  auto machine = std::unique_ptr<Machine>(new Machine());
  Parts& p = *machine->parts_;
  const auto complain = [&p](const std::string& text) { p.start_errors += text + "\n"; };

  const fs::path original(options.ini);
  p.folder = fs::temp_directory_path() /
             ("kerf-machine-" + std::to_string(getpid()) + "-" + std::to_string(++count));
  fs::create_directories(p.folder);
  fs::copy(original.parent_path(), p.folder,
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  // What a machine of that folder has left of its offsets is no part of the tree.
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(p.folder))
    if (entry.path().extension() == ".var") fs::remove(entry.path(), ignored);
  std::string text = read_file(original);
  // The sample INI files find the programs by a way from their own folder.
  const std::vector<std::pair<std::string, std::string>> paths{
      {"../../../nc_files", KERF_SOURCE_DIR "/nc_files"}};
  for (const auto& [from, to] : paths)
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  for (const auto& [from, to] : options.replace) {
    const auto at = text.find(from);
    if (at == std::string::npos)
      complain("the INI file has no text '" + from + "' to replace");
    else
      text.replace(at, from.size(), to);
  }
  text += options.append;
  const fs::path ini_path = p.folder / original.filename();
  std::ofstream(ini_path) << text;
  for (const auto& [name, content] : options.files) {
    std::ofstream(p.folder / name) << content;
    if (content.rfind("#!", 0) == 0)
      fs::permissions(p.folder / name, fs::perms::owner_all, fs::perm_options::add);
  }
  for (const auto& file : fs::directory_iterator(p.folder))
    if (const auto kind = file.path().extension(); kind == ".var" || kind == ".bak")
      fs::remove(file.path());

  auto loaded = ini::IniFile::load(ini_path.string());
  for (const auto& d : loaded.diagnostics) complain(d.message());
  if (!loaded.ok) return machine;
  p.ini = std::move(loaded.file);

  const std::string instance =
      options.clients ? "harness-" + std::to_string(getpid()) + "-" + std::to_string(count)
                      : "private";
  p.segment = rtapi::Segment::in_memory(rtapi::Segment::kDefaultBytes, instance);
  const auto components = hal::static_components();
  p.module_table.assign(components.begin(), components.end());
  p.module_table.insert(p.module_table.end(), options.modules.begin(), options.modules.end());
  p.modules = std::make_unique<hal::StaticSource>(p.module_table);
  p.driver = std::make_unique<Driver>(p.scheduler);
  auto host = hal::Host::create(*p.segment, p.scheduler, *p.modules, p.driver.get());
  if (!host.ok()) {
    complain(host.error().message());
    return machine;
  }
  p.host = std::move(*host);
  p.realtime = std::make_unique<hal::RealtimeHost>(*p.host);
  p.session = std::make_unique<hal::LocalSession>(*p.host);
  p.halcmd = std::make_unique<hal::Commander>(*p.session, hal::ini_lookup(p.ini), &p.sink);
  p.task = std::make_unique<task::Task>(p.ini, *p.segment, p.session.get(),
                                        task::TaskOptions{.listen = options.clients});
  if (const auto prepared = p.task->prepare(); !prepared.ok()) {
    complain(prepared.error().message());
    return machine;
  }
  const auto plan =
      launcher::make_plan(p.ini, {.first = {}, .library = {KERF_SOURCE_DIR "/configs/hallib"}});
  for (const auto& d : plan.diagnostics) complain(d.message());
  if (!run_hal_steps(p, plan.modules, "")) return machine;
  auto steps = plan.hal;
  for (const auto& line : options.hal) steps.push_back({false, line, {}});
  if (!run_hal_steps(p, steps, plan.two_pass)) return machine;
  if (const auto connected = p.task->connect(); !connected.ok()) {
    complain(connected.error().message());
    return machine;
  }
  if (!p.task->warnings().empty()) complain(p.task->warnings());
  p.shared =
      *hal::View(*p.segment).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  p.watcher.shared = p.shared;
  if (!p.halcmd->run_line("start", "start", 0)) return machine;
  p.scheduler.add(*p.realtime);
  p.scheduler.add(p.watcher);
  for (auto* participant : p.task->participants()) p.scheduler.add(*participant);
  p.ready = true;
  machine->run_for(0.01);
  if (const auto period = machine->motion().servo_period_ns; period > 0)
    p.watcher.period_ns = period;
  return machine;
}

bool Machine::ready() const { return parts_->ready; }

std::string Machine::errors() const {
  std::string all = parts_->start_errors + parts_->sink.errors_;
  if (parts_->ready) {
    std::uint64_t cursor = 0;
    for (const auto& m : parts_->task->messages(cursor)) {
      all += m.text.view();
      all += '\n';
    }
  }
  return all;
}

rtapi::Segment& Machine::segment() const { return *parts_->segment; }

const std::string& Machine::folder() const {
  static thread_local std::string text;
  text = parts_->folder.string();
  return text;
}

rtapi::Nanos Machine::now() const { return parts_->scheduler.now(); }
void Machine::run_for(double seconds) {
  parts_->scheduler.run_until(now() + rtapi::seconds(seconds));
}
bool Machine::run_until(const std::function<bool()>& done, double limit_s) {
  return parts_->scheduler.run_until(done, now() + rtapi::seconds(limit_s));
}
void Machine::cycle() { parts_->scheduler.run_until(now() + parts_->watcher.period_ns); }

std::uint64_t Machine::send(const std::vector<std::string>& words) {
  return parts_->task->submit(words);
}

std::unique_ptr<task::Client> Machine::connect() {
  auto client = task::Client::connect(*parts_->segment);
  EXPECT_TRUE(client.ok()) << client.error().message();
  return client.ok() ? std::move(*client) : nullptr;
}

task::Reply Machine::outcome(std::uint64_t id) const {
  const auto reply = parts_->task->outcome(id);
  return reply ? *reply : task::Reply{.id = id, .state = task::CommandState::received, .text = ""};
}

task::Reply Machine::command(const std::vector<std::string>& words, double limit_s) {
  const auto id = send(words);
  run_until([&] { return task::is_terminal(outcome(id).state); }, limit_s);
  return outcome(id);
}

bool Machine::does(const std::vector<std::string>& words, double limit_s) {
  const auto reply = command(words, limit_s);
  if (reply.state != task::CommandState::done) {
    std::string line;
    for (const auto& w : words) line += w + " ";
    std::fprintf(stderr, "machine: %s-> %s %s\n", line.c_str(), task::to_string(reply.state),
                 reply.text.c_str());
  }
  return reply.state == task::CommandState::done;
}

bool Machine::power_on() { return does({"state", "estop-reset"}) && does({"state", "on"}); }
bool Machine::power_on_and_home() { return power_on() && does({"home", "-1"}); }
bool Machine::mdi(const std::string& line, double limit_s) { return does({"mdi", line}, limit_s); }

std::string Machine::write_program(const std::string& text, const std::string& name) {
  const fs::path path = parts_->folder / name;
  std::ofstream(path) << text;
  return path.string();
}

std::uint64_t Machine::start_program(const std::string& path) {
  if (!does({"mode", "auto"}) || !does({"open", path})) return 0;
  return send({"run"});
}

task::Reply Machine::run_program(const std::string& path, double limit_s) {
  if (auto opened = command({"mode", "auto"}); opened.state != task::CommandState::done)
    return opened;
  if (auto opened = command({"open", path}); opened.state != task::CommandState::done)
    return opened;
  return command({"run"}, limit_s);
}

std::string Machine::line_to_shown_place(std::string_view axes) const {
  const task::TaskStatus t = task();
  const rtapi::Pose at = motion().pos_cmd - t.g5x_offset - t.g92_offset - t.tool_offset;
  std::string line = "G90 G0";
  for (const char letter : axes) {
    const auto i = static_cast<std::size_t>(rtapi::axis_index(letter));
    const double unit = t.program_units == 1 && !rtapi::is_rotary(i) ? 25.4 : 1;
    char word[40];
    std::snprintf(word, sizeof word, " %c%.13f", letter, at[i] / unit);
    line += word;
  }
  return line;
}

motion::MotionStatus Machine::motion() const {
  motion::MotionStatus status;
  EXPECT_TRUE(parts_->shared->status.read(status));
  return status;
}

task::TaskStatus Machine::task() const { return parts_->task->status(); }

double Machine::get(const std::string& name) const {
  const auto item = parts_->halcmd->view().find_item(name);
  if (!item) {
    ADD_FAILURE() << "no pin or parameter '" << name << "'";
    return std::nan("");
  }
  return real_value(item->type, item->raw);
}

std::string Machine::pin_kind(const std::string& name) const {
  const auto pin = parts_->halcmd->view().find_pin(name);
  if (!pin) return "";
  return std::string(hal::type_name(pin->type)) + " " + std::string(hal::dir_name(pin->dir));
}

std::string Machine::parameter_kind(const std::string& name) const {
  const auto param = parts_->halcmd->view().find_param(name);
  if (!param) return "";
  return std::string(hal::type_name(param->type)) + " " + std::string(hal::dir_name(param->dir));
}

hal::Session& Machine::session() const { return *parts_->session; }
void Machine::add(rtapi::Participant& participant) { parts_->scheduler.add(participant); }
void Machine::remove(rtapi::Participant& participant) { parts_->scheduler.remove(participant); }
bool Machine::hal(const std::string& line) { return parts_->halcmd->run_line(line, "test", 0); }

void Machine::on_cycle(std::function<void(const motion::MotionStatus&)> f) {
  parts_->watcher.on_cycle = std::move(f);
  parts_->watcher.last_cycle = motion().cycle;
  parts_->scheduler.remove(parts_->watcher);
  parts_->scheduler.add(parts_->watcher);
}

int Machine::branch(const std::function<void()>& body) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return 1;
  if (child == 0) {
    // Only failures of the branch count, and nothing of the test program's end runs here.
    const auto* before = testing::UnitTest::GetInstance()->current_test_info()->result();
    const int old = before->total_part_count();
    body();
    const auto* result = testing::UnitTest::GetInstance()->current_test_info()->result();
    int failed = 0;
    for (int i = old; i < result->total_part_count(); ++i)
      if (result->GetTestPartResult(i).failed()) ++failed;
    std::fflush(nullptr);
    _exit(failed > 250 ? 250 : failed);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace kerf::harness
