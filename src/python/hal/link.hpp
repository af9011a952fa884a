// Link: this process's connection to its HAL instance. One for all components of the process.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "hal/client/session.hpp"
#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::python {

class Link {
 public:
  /// The connection to the instance of KERF_INSTANCE, made at need; an error says how to start HAL. A dead one is replaced.
  static rtapi::Result<std::shared_ptr<Link>> get();
  /// The present one, or none.
  static std::shared_ptr<Link> present();
  /// Ends the connection: the realtime host removes the components of this process.
  static void end();
  /// Once: a forked child must not use its parent's connection, nor keep it open.
  static void watch_forks();

  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// One command of Host::command. Waits for the reply without the GIL; callers of other threads wait for their turn.
  rtapi::Result<std::string> ask(const std::vector<std::string>& argv);
  [[nodiscard]] rtapi::Segment& segment() noexcept { return *segment_; }
  [[nodiscard]] hal::View view() const { return hal::View(*segment_); }
  /// False after end(), when the host has died, and in a forked child.
  [[nodiscard]] bool usable() const noexcept { return ended_.get() == 0 && fork_count_ == forks(); }
  /// True in a process that was forked after this connection was made.
  [[nodiscard]] bool is_parents() const noexcept { return fork_count_ != forks(); }
  /// Components that are open. Under the GIL.
  int components{0};

 private:
  Link(std::unique_ptr<rtapi::Segment> segment, std::unique_ptr<hal::SocketSession> session);
  static std::uint64_t forks() noexcept;
  [[nodiscard]] bool host_is_there() const;

  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<hal::SocketSession> session_;
  std::mutex mutex_;  ///< one request at a time
  std::uint64_t fork_count_;
  rtapi::Word<std::uint32_t> ended_{0};
};

}  // namespace kerf::python
