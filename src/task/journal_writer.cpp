#include "task/journal_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace kerf::task {

JournalWriter::JournalWriter(std::string path, Options options)
    : path_(std::move(path)), options_(options) {}

rtapi::Status JournalWriter::open() {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
  // A file of another kind under this name keeps what it has.
  auto last = read_journal(path_);
  if (!last.ok() && std::filesystem::exists(path_, ignored) &&
      std::filesystem::file_size(path_, ignored) > kJournalSlots * kJournalSlotBytes)
    return rtapi::fail(rtapi::Errc::bad_argument,
                       path_ + " is no journal; give another name in [KERF]JOURNAL");
  if (last.ok()) number_ = last->number;
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0)
    return rtapi::fail(rtapi::Errc::system,
                       "cannot write the journal " + path_ + ": " + std::strerror(errno));
  if (options_.thread) thread_ = std::thread([this] { run(); });
  return {};
}

JournalWriter::~JournalWriter() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  if (fd_ >= 0) ::close(fd_);
}

bool JournalWriter::post(const JournalRecord& record) {
  if (fd_ < 0) return true;
  if (!thread_.joinable()) {
    Job job{record, program_};
    write(job);
    return true;
  }
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return false;
  next_ = Job{record, program_};
  wake_.notify_one();
  return true;
}

void JournalWriter::flush() {
  if (!thread_.joinable()) return;
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [this] { return !next_ && !busy_; });
}

std::string JournalWriter::take_failure() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  return lock ? std::exchange(failure_, {}) : std::string();
}

void JournalWriter::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return next_ || ending_; });
    if (!next_) return;
    Job job = std::move(*next_);
    next_.reset();
    busy_ = true;
    lock.unlock();
    write(job);
    lock.lock();
    busy_ = false;
    idle_.notify_all();
  }
}

void JournalWriter::write(Job& job) {
  if (job.program != marked_program_) {
    auto mark = mark_file(job.record.program);
    marked_ = mark.ok();
    if (marked_) mark_ = *mark;
    marked_program_ = job.program;
  }
  job.record.mark = mark_;
  job.record.marked = marked_;
  job.record.number = ++number_;
  const std::string slot = format_slot(job.record);
  if (slot.empty()) return;
  const auto at = static_cast<off_t>(number_ % kJournalSlots * kJournalSlotBytes);
  const ssize_t n = ::pwrite(fd_, slot.data(), slot.size(), at);
  const bool good =
      n == static_cast<ssize_t>(slot.size()) && (!options_.sync || ::fdatasync(fd_) == 0);
  if (good || failed_) return;
  failed_ = true;
  const std::lock_guard lock(mutex_);
  failure_ = "the journal " + path_ + " cannot be written: " + std::strerror(errno);
}

}  // namespace kerf::task
