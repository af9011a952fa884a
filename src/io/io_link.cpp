#include "io/io_link.hpp"

namespace kerf::io {

void IoLink::set_estop(bool estop) {
  {
    const std::lock_guard lock(mutex_);
    wishes_.estop = estop;
  }
  to_io_.notify();
}

void IoLink::request_reset() {
  {
    const std::lock_guard lock(mutex_);
    wishes_.estop = false;
    ++wishes_.reset_requests;
  }
  to_io_.notify();
}

void IoLink::confirm() {
  {
    const std::lock_guard lock(mutex_);
    ++wishes_.confirmations;
  }
  to_io_.notify();
}

void IoLink::abort(std::uint32_t epoch, std::int32_t reason) {
  {
    const std::lock_guard lock(mutex_);
    wishes_.abort_epoch = epoch;
    wishes_.abort_reason = reason;
    wishes_.flood = false;
    wishes_.mist = false;
  }
  to_io_.notify();
}

void IoLink::set_coolant(std::uint32_t epoch, std::optional<bool> flood, std::optional<bool> mist) {
  {
    const std::lock_guard lock(mutex_);
    if (epoch < wishes_.abort_epoch) return;
    if (flood) wishes_.flood = *flood;
    if (mist) wishes_.mist = *mist;
  }
  to_io_.notify();
}

std::uint64_t IoLink::order(ToolOrder::Kind kind, int tool, std::uint32_t epoch) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    if (epoch < wishes_.abort_epoch || last_order_ - state_.finished_order >= kOrders) return 0;
    number = ++last_order_;
    orders_[number % kOrders] = {number, epoch, kind, tool};
  }
  to_io_.notify();
  return number;
}

IoState IoLink::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

IoWishes IoLink::wishes() const {
  const std::lock_guard lock(mutex_);
  return wishes_;
}

std::optional<ToolOrder> IoLink::next_order() const {
  const std::lock_guard lock(mutex_);
  if (state_.finished_order == last_order_) return std::nullopt;
  return orders_[(state_.finished_order + 1) % kOrders];
}

void IoLink::finish_order(bool well, std::string_view failure) {
  {
    const std::lock_guard lock(mutex_);
    if (state_.finished_order == last_order_) return;
    ++state_.finished_order;
    state_.finished_well = well;
    state_.failure = rtapi::FixedString<200>(failure);
  }
  to_interpreter_.notify();
  to_command_.notify();
}

void IoLink::publish(const IoState& state) {
  {
    const std::lock_guard lock(mutex_);
    IoState next = state;
    next.finished_order = state_.finished_order;
    next.finished_well = state_.finished_well;
    next.failure = state_.failure;
    if (next == state_) return;
    state_ = next;
  }
  to_interpreter_.notify();
  to_command_.notify();
}

}  // namespace kerf::io
