#include "hal/tcl/connection.hpp"

#include <unistd.h>

#include <string>

#include "rtapi/clock/join_clock.hpp"

namespace kerf::hal::tcl {

rtapi::Result<Attachment> Connection::attach() {
  close();
  KERF_TRY(segment_, rtapi::Segment::attach(rtapi::default_instance()));
  KERF_TRY(session_, SocketSession::connect(*segment_));
  if (bounded_) {
    KERF_TRY(clock_, rtapi::join_clock(*segment_, rtapi::Role::user_component, "haltcl"));
    session_->use_clock(clock_.get());
  } else {
    clock_ = rtapi::make_real_clock();
  }
  self_ = std::make_unique<UserComponent>(*session_, "halcmd" + std::to_string(::getpid()));
  KERF_CHECK(self_->ready());
  return Attachment{session_.get(), clock_.get()};
}

void Connection::close() {
  self_.reset();
  session_.reset();
  clock_.reset();
  segment_.reset();
}

rtapi::WaitClock* Connection::fresh_clock() {
  if (clock_ != nullptr && clock_->stopped() && !bounded_) clock_ = rtapi::make_real_clock();
  return clock_.get();
}

void Connection::stop_waiting() noexcept {
  if (clock_ != nullptr) clock_->stop();
}

}  // namespace kerf::hal::tcl
