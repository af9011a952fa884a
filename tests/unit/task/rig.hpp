// A task with a motion that pretends: takes every item, needs a set time for it, obeys the intent cell as the real one does.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ini/ini_file.hpp"
#include "io/io_pins.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/task.hpp"

namespace kerf::task::testing {

using rtapi::kMillisecond;
using rtapi::Nanos;

class FakeMotion final : public rtapi::Participant {
 public:
  explicit FakeMotion(motion::MotionShared& shared) : shared_(shared) {
    status.servo_period_ns = kMillisecond;
    status.acked_epoch = shared.intent.abort_epoch.get();
    shared_.status.write(status);
  }
  const char* name() const noexcept override { return "fake-motion"; }
  rtapi::Role role() const noexcept override { return rtapi::Role::realtime_host; }

  void step(Nanos now, rtapi::WaitSpec& next) override {
    if (now >= next_cycle_ && now >= sleeps_until) {
      if (std::exchange(writes_, false)) toggle_write();
      cycle(now);
      next_cycle_ = now + kMillisecond;
      if (now >= stalls_from) {
        stalls_from = rtapi::kForever;
        sleeps_until = now + 5 * kMillisecond;
        writes_ = true;
        toggle_write();
      }
    }
    next.wake_at(std::max(next_cycle_, sleeps_until));
  }

  /// Items in the order of execution.
  template <class T>
  std::vector<T> executed() const {
    std::vector<T> out;
    for (const auto& item : done)
      if (const T* body = std::get_if<T>(&item.body)) out.push_back(*body);
    return out;
  }
  void raise(motion::Fault fault, int index = -1) {
    motion::FaultRecord record;
    record.number = ++status.faults;
    record.fault = fault;
    record.index = index;
    record.tag = status.current;
    shared_.faults.slot[record.number % motion::FaultLog::kSlots].write(record);
    shared_.faults.newest.publish(record.number);
    shared_.status_cell.notify();
  }

  motion::MotionStatus status;
  motion::Intent intent;
  std::vector<motion::PathItem> done;
  Nanos move_time{10 * kMillisecond};
  int ack_cycles{5};  ///< from a raised epoch to the acknowledgement
  int take_cycles{
      0};  ///< so many cycles pass before wishes are seen, as if task were kept from writing them
  bool may_enable{true};
  Nanos sleeps_until{0};  ///< no cycle before
  /// Behind the next cycle from then on nothing runs for some, as if the thread had been stopped in the middle of its next write.
  Nanos stalls_from{rtapi::kForever};
  bool homes{true};
  bool orients{true};
  std::uint64_t beats_seen{0};
  std::uint64_t stale{0};  ///< items of old epochs that were met and dropped
  std::uint64_t spindle_stops{0};
  std::uint64_t peak_queue{0};

 private:
  /// The count of a SeqCell is odd while a write is going on.
  void toggle_write() {
    const std::uint64_t step = writes_ ? 1 : ~std::uint64_t{0};
    reinterpret_cast<std::atomic<std::uint64_t>*>(&shared_.status)->fetch_add(step);
  }

  void cycle(Nanos now) {
    ++status.cycle;
    status.time_ns = now;
    const auto before = std::make_tuple(status.executed_seq, status.acked_epoch, status.enabled,
                                        status.mode, status.path_empty, status.all_homed);
    motion::Intent next;
    if (shared_.intent.values.read(next) && next.serial != intent.serial &&
        ++take_count_ > take_cycles) {
      take(next);
      take_count_ = 0;
    }
    beats_seen = shared_.intent.heartbeat.get();
    status.enabled = may_enable && shared_.intent.enable.get() != 0;
    const std::uint32_t epoch = shared_.intent.abort_epoch.observe();
    if (epoch != status.acked_epoch) {
      if (++ack_count_ >= ack_cycles) {
        busy_until_ = 0;
        status.acked_epoch = epoch;
        ack_count_ = 0;
      }
    } else {
      work(now);
    }
    peak_queue = std::max(peak_queue, shared_.path.size());
    status.path_empty = shared_.path.empty();
    status.held = shared_.intent.hold.get() != 0 || step_done_;
    status.place = status.pos_cmd;
    shared_.status.write(status);
    if (before != std::make_tuple(status.executed_seq, status.acked_epoch, status.enabled,
                                  status.mode, status.path_empty, status.all_homed))
      shared_.status_cell.notify();
  }

  void take(const motion::Intent& next) {
    if (next.home_seq != intent.home_seq && homes) {
      status.all_homed = true;
      for (auto& j : status.joint) j.homed = true;
    }
    if (next.unhome_seq != intent.unhome_seq) {
      status.all_homed = false;
      for (auto& j : status.joint) j.homed = false;
    }
    if (next.spindle_stop_seq[0] != intent.spindle_stop_seq[0]) ++spindle_stops;
    status.mode = next.mode;
    status.intent_taken = next.serial;
    status.jogging = false;
    for (const auto& j : next.joint_jog)
      status.jogging = status.jogging || j.kind == motion::JogIntent::Kind::continuous;
    intent = next;
  }

  void work(Nanos now) {
    if (shared_.intent.hold.get() != 0 || !intent.single_step) {
      step_id_ = 0;
      step_done_ = false;
    }
    if (!status.enabled || shared_.intent.hold.get() != 0) return;
    for (int n = 0; n < 64; ++n) {
      const motion::PathItem* item = shared_.path.front();
      if (item == nullptr) return;
      if (item->epoch != status.acked_epoch) {
        ++stale;
        shared_.path.pop();
        continue;
      }
      if (intent.single_step && step_id_ == 0) step_id_ = item->tag.id;
      step_done_ = intent.single_step && item->tag.id != step_id_;
      if (step_done_) return;
      if (status.current_seq != item->seq) {
        status.current_seq = item->seq;
        status.current = item->tag;
        busy_until_ = now + duration(*item);
      }
      if (now < busy_until_) return;
      finish(*item);
      done.push_back(*item);
      status.executed_seq = item->seq;
      shared_.path.pop();
    }
  }
  Nanos duration(const motion::PathItem& item) const {
    if (const auto* d = std::get_if<motion::Dwell>(&item.body)) return rtapi::seconds(d->seconds);
    const bool move = std::holds_alternative<motion::LinearMove>(item.body) ||
                      std::holds_alternative<motion::ArcMove>(item.body);
    return move ? move_time : 0;
  }
  void finish(const motion::PathItem& item) {
    if (const auto* m = std::get_if<motion::LinearMove>(&item.body)) status.pos_cmd = m->end;
    if (const auto* m = std::get_if<motion::ArcMove>(&item.body)) status.pos_cmd = m->end;
    if (const auto* s = std::get_if<motion::SpindleChange>(&item.body))
      if (s->action == motion::SpindleChange::Action::orient)
        status.spindle[s->spindle].orient_state = orients ? 2 : 1;
  }

  motion::MotionShared& shared_;
  Nanos next_cycle_{0};
  Nanos busy_until_{0};
  std::uint64_t step_id_{0};
  bool step_done_{false};
  int ack_count_{0}, take_count_{0};
  bool writes_{false};  ///< is stopped in the middle of it
};

/// Pins with the usual loops: estop chain, tool prepare and change answer at once.
class FakePins final : public io::IoPins {
 public:
  io::IoInputs read() override {
    io::IoInputs in;
    in.emc_enable_in = out.user_enable_out && external_ok;
    in.tool_prepared = out.tool_prepare && prepares;
    in.tool_changed = out.tool_change && changes;
    return in;
  }
  void write(const io::IoOutputs& outputs) override { out = outputs; }
  io::IoOutputs out;
  bool external_ok{true}, prepares{true}, changes{true};
};

/// A folder that is gone at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = std::filesystem::temp_directory_path().string() + "/kerf-task-XXXXXX";
    path = ::mkdtemp(name.data());
  }
  ~TempFolder() { std::filesystem::remove_all(path); }
  std::string write(const std::string& name, const std::string& text,
                    bool executable = false) const {
    std::string file = path + "/" + name;
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    std::ofstream(file) << text;
    if (executable) ::chmod(file.c_str(), 0755);
    return file;
  }
  std::string read(const std::string& name) const {
    std::ifstream in(path + "/" + name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string path;
};

inline constexpr const char* kMillIni = R"([EMC]
MACHINE = test
[DISPLAY]
PROGRAM_PREFIX = nc
MAX_FEED_OVERRIDE = 1.5
[RS274NGC]
PARAMETER_FILE = test.var
USER_M_PATH = mcodes
SUBROUTINE_PATH = subs
[KINS]
KINEMATICS = trivkins
JOINTS = 3
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 50
[EMCIO]
TOOL_TABLE = tool.tbl
[AXIS_X]
MAX_VELOCITY = 50
MAX_ACCELERATION = 500
[AXIS_Y]
MAX_VELOCITY = 50
MAX_ACCELERATION = 500
[AXIS_Z]
MAX_VELOCITY = 30
MAX_ACCELERATION = 500
[JOINT_0]
MAX_VELOCITY = 50
MAX_ACCELERATION = 500
[JOINT_1]
MAX_VELOCITY = 50
MAX_ACCELERATION = 500
[JOINT_2]
MAX_VELOCITY = 30
MAX_ACCELERATION = 500
)";

class Rig {
 public:
  explicit Rig(const std::string& ini_text = kMillIni) {
    folder.write("tool.tbl", "T1 P1 Z10 D6 ;mill\nT2 P2 Z20 D3\n");
    folder.write("nc/.keep", "");
    const std::string ini_path = folder.write("test.ini", ini_text);
    loaded = ini::IniFile::load(ini_path);
    segment = rtapi::Segment::in_memory();
    shared = *segment->make<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
    fake = std::make_unique<FakeMotion>(*shared);
    start();
  }
  ~Rig() { stop(); }
  void start() {
    TaskOptions options;
    options.listen = false;
    options.pins = &pins;
    task = std::make_unique<Task>(loaded.file, *segment, nullptr, options);
    started = task->start();
    EXPECT_TRUE(started.ok()) << started.error().message();
    scheduler = std::make_unique<rtapi::LocalScheduler>();
    scheduler->set_hold_limit_ms(20000);
    scheduler->add(*fake);
    if (started.ok())
      for (auto* p : task->participants()) scheduler->add(*p);
  }
  void stop() {
    if (!task) return;
    for (auto* p : task->participants()) scheduler->remove(*p);
    task->shut_down();
    task.reset();
  }

  void run_for(double s) { scheduler->run_until(scheduler->now() + rtapi::seconds(s)); }
  bool run_until(const std::function<bool()>& done, double s = 60) {
    return scheduler->run_until(done, scheduler->now() + rtapi::seconds(s));
  }
  std::uint64_t send(const std::vector<std::string>& words) { return task->submit(words); }
  Reply outcome(std::uint64_t id) const {
    return task->outcome(id).value_or(Reply{id, CommandState::received, {}});
  }
  bool finished(std::uint64_t id) const { return is_terminal(outcome(id).state); }
  Reply wait(std::uint64_t id, double s = 60) {
    run_until([&] { return finished(id); }, s);
    return outcome(id);
  }
  Reply command(const std::vector<std::string>& words, double s = 60) {
    return wait(send(words), s);
  }
  bool does(const std::vector<std::string>& words) {
    const Reply r = command(words);
    EXPECT_EQ(to_string(r.state), std::string("done")) << words[0] << ": " << r.text;
    return r.state == CommandState::done;
  }
  void power_on() { does({"state", "estop-reset"}), does({"state", "on"}); }
  void ready() { power_on(), does({"home"}); }
  Reply run_text(const std::string& text, double s = 60) {
    const std::string file = folder.write("nc/test.ngc", text);
    does({"open", file});
    return command({"run"}, s);
  }
  std::uint64_t start_text(const std::string& text) {
    const std::string file = folder.write("nc/test.ngc", text);
    does({"open", file});
    return send({"run"});
  }
  std::string messages() {
    std::string out;
    for (const auto& m : task->messages(cursor)) out += std::string(m.text.view()) + "\n";
    return out;
  }
  TaskStatus status() const { return task->status(); }
  double seconds() const { return static_cast<double>(scheduler->now()) * 1e-9; }

  TempFolder folder;
  ini::LoadResult loaded;
  std::unique_ptr<rtapi::Segment> segment;
  motion::MotionShared* shared{nullptr};
  std::unique_ptr<FakeMotion> fake;
  FakePins pins;
  std::unique_ptr<Task> task;
  rtapi::Status started;
  std::unique_ptr<rtapi::LocalScheduler> scheduler;
  std::uint64_t cursor{0};
};

}  // namespace kerf::task::testing
