// JournalWriter: the thread that writes the journal. The command thread leaves a record and goes on.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "rtapi/base/result.hpp"
#include "task/api/journal.hpp"

namespace kerf::task {

class JournalWriter {
 public:
  struct Options {
    /// A thread of its own; without it post() writes at once, for tests in one thread.
    bool thread{true};
    /// Each record on the disk before the next; a machine on virtual time is none that loses its power.
    bool sync{true};
  };
  JournalWriter(std::string path, Options options);
  /// Writes what was posted last.
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Makes the file, with its folder, if it is not there; goes on behind its newest record.
  rtapi::Status open();
  /// Never waits for the disk: a record that was not written yet gives way to this one. False: the writer has the lock just now; come
  /// again. Number and mark are the writer's.
  bool post(const JournalRecord& record);
  /// A program begins: its file is marked anew.
  void begin_program() { ++program_; }
  /// Waits until what was posted is written. Not for the command thread.
  void flush();
  /// What went wrong, once.
  [[nodiscard]] std::string take_failure();

 private:
  struct Job {
    JournalRecord record;
    std::uint64_t program{0};
  };
  void run();
  void write(Job& job);

  std::string path_;
  Options options_;
  int fd_{-1};
  std::uint64_t number_{0};
  std::uint64_t program_{0};  ///< of the command thread
  std::uint64_t marked_program_{0};
  FileMark mark_;
  bool marked_{false};
  std::mutex mutex_;
  std::condition_variable wake_, idle_;
  std::optional<Job> next_;
  bool busy_{false}, ending_{false};
  std::string failure_;
  bool failed_{false};
  std::thread thread_;
};

}  // namespace kerf::task
