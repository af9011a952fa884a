// Connection: a Tcl program's session with the instance's realtime host.
#pragma once

#include <memory>

#include "hal/client/session.hpp"
#include "hal/client/user_component.hpp"
#include "hal/tcl/tcl_hal.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal::tcl {

class Connection {
 public:
  /// `bounded`: a script of a known end, which holds virtual time while it runs. A person or a screen must not.
  explicit Connection(bool bounded) : bounded_(bounded) {}
  ~Connection() { close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Connects to KERF_INSTANCE, and shows itself in `show comp` as halcmdPID. dead or not_found while nothing runs.
  rtapi::Result<Attachment> attach();
  void close();
  /// The clock to wait on, another one after stop_waiting(); nullptr while not connected. For interactive programs.
  rtapi::WaitClock* fresh_clock();
  /// Ends what a command waits for. Async-signal-safe.
  void stop_waiting() noexcept;

 private:
  bool bounded_;
  std::unique_ptr<rtapi::Segment> segment_;
  std::unique_ptr<rtapi::WaitClock> clock_;
  std::unique_ptr<SocketSession> session_;
  std::unique_ptr<UserComponent> self_;
};

}  // namespace kerf::hal::tcl
