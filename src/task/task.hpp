// Task: all of milltask as one object, without threads, sockets or signals of its own.
//
//   task::Task task(ini_file, segment, session, {});
//   if (auto status = task.start(); !status.ok()) ...         // complaints of the INI file, missing motion block
//   for (auto* p : task.participants()) scheduler.add(*p);    // or a thread each with join_clock()
//   const auto id = task.submit({"mdi", "G0 X1"});            // tests; programs use task/api/client.hpp
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/client/session.hpp"
#include "ini/ini_file.hpp"
#include "io/io_pins.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"

namespace kerf::task {

struct TaskOptions {
  bool listen{true};    ///< open the socket for clients
  std::int64_t pid{0};  ///< shown in the status
  /// Pins for IoControl; null: the user component iocontrol.0 of the session.
  io::IoPins* pins{nullptr};
  /// A journal also when the INI file names none, written by a thread of its own. Without: only one that is named, written at once.
  bool journal_thread{false};
};

/// Makes the block of task in a segment, for its maker (make_block is no business of two processes at once). Task makes it itself
/// when it is missing.
rtapi::Status make_task_block(rtapi::Segment& segment);

class Task {
 public:
  /// `session` may be null when options.pins is given (then #<_hal[...]> knows nothing). All must outlive the task.
  Task(const ini::IniFile& ini, rtapi::Segment& segment, hal::Session* session,
       TaskOptions options = {});
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  /// Reads the machine's setup and files, and connects to motion. not_found: no motion block (yet): motmod is not loaded. Other
  /// errors are the user's to mend; the text has all complaints, a line each.
  rtapi::Status start();
  /// The two halves of start(): setup, files and the pins of iocontrol.0, which HAL files link; then motion, which HAL files load.
  rtapi::Status prepare();
  /// May be called again while it says not_found.
  rtapi::Status connect();
  /// Warnings of start(), a line each, or "".
  [[nodiscard]] const std::string& warnings() const;

  /// Command, interpreter, io, in the order in which they run at one instant. After start().
  [[nodiscard]] std::vector<rtapi::Participant*> participants();

  /// A command, taken in the command participant's next step.
  std::uint64_t submit(const std::vector<std::string>& words);
  void submit_json(const std::string& json);
  [[nodiscard]] std::optional<Reply> outcome(std::uint64_t id) const;
  [[nodiscard]] TaskStatus status() const;
  [[nodiscard]] TaskShared& shared();
  /// Operator messages behind a cursor.
  [[nodiscard]] std::vector<OperatorMessage> messages(std::uint64_t& cursor) const;

  /// Functions in Python that are in progress are abandoned from now on; from any thread. Before the participants' threads are joined.
  void end_scripts();
  /// Takes the enable away, stops everything, saves what outlives the power. After the participants have run for the last time.
  void shut_down();

 private:
  void open_journal();
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace kerf::task
