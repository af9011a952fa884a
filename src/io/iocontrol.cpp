#include "io/iocontrol.hpp"

#include <utility>

namespace kerf::io {

namespace {

/// emc-reason of an M6 that a fault of the changer has ended.
constexpr std::int32_t kAbortedByChanger = 101;

/// iocontrol.0.state
enum State : std::int32_t { kIdle = 0, kPreparing, kStarting, kChanging, kAborting, kFaulted };

/// Do the pins ask the same in both?
bool same_questions(const IoOutputs& a, const IoOutputs& b) {
  return a.tool_prepare == b.tool_prepare && a.tool_change == b.tool_change &&
         a.start_change == b.start_change && a.emc_abort == b.emc_abort;
}

}  // namespace

IoControl::IoControl(IoLink& link, rtapi::Cell& to_io, IoPins& pins, ToolStore& tools,
                     IoOptions options)
    : link_(link), to_io_(to_io), pins_(pins), tools_(tools), options_(std::move(options)) {
  read_spindle();
  pins_.write(out_);
  link_.publish(state_);
}

void IoControl::read_spindle() {
  if (!options_.random_changer) return;
  // On random changers pocket 0 is the spindle, and the table knows what is in it.
  const auto table = tools_.table();
  const ToolEntry* tool = table->find_pocket(0);
  state_.tool_in_spindle = tool != nullptr ? tool->number : -1;
  out_.tool_number = state_.tool_in_spindle;
}

void IoControl::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(to_io_);
  IoInputs in = pins_.read();
  const IoWishes wishes = link_.wishes();
  if (wishes.confirmations != confirmations_seen_) {
    confirmations_seen_ = wishes.confirmations;
    // Only of a question that has been asked.
    confirmed_ = started_ && (out_.tool_prepare || out_.tool_change);
  }
  in.tool_prepared = in.tool_prepared || (confirmed_ && out_.tool_prepare);
  in.tool_changed = in.tool_changed || (confirmed_ && out_.tool_change);
  const IoOutputs before = out_;
  estop_chain(in, wishes, now);
  out_.coolant_flood = wishes.flood;
  out_.coolant_mist = wishes.mist;
  if (options_.v2) watch_changer(in);
  tool_orders(in, wishes, now);
  if (!same_questions(out_, before)) {
    settled_ = now + 2 * options_.servo_period;
    confirmed_ = false;
  }
  out_.state = out_.emc_abort      ? kAborting
               : out_.start_change ? kStarting
               : out_.tool_change  ? kChanging
               : out_.tool_prepare ? kPreparing
               : faulted_          ? kFaulted
                                   : kIdle;
  if (!(out_ == before)) pins_.write(out_);
  state_.emc_enable_in = in.emc_enable_in;
  state_.user_enable = out_.user_enable_out;
  state_.flood = out_.coolant_flood;
  state_.mist = out_.coolant_mist;
  state_.waiting_prepared = out_.tool_prepare;
  state_.waiting_changed = out_.tool_change;
  state_.waiting_start_change = out_.start_change;
  state_.waiting_abort_ack = out_.emc_abort;
  link_.publish(state_);
  const bool busy = out_.user_request_enable || out_.tool_prepare || out_.tool_change ||
                    out_.start_change || out_.emc_abort || out_.toolchanger_fault_ack ||
                    now < settled_ || !(out_ == before);
  // On the grid of its period, so that looks at pins fall on the same instants whatever woke it.
  const rtapi::Nanos period = busy ? kBusyPeriod : kIdlePeriod;
  next.wake_at((now / period + 1) * period);
}

void IoControl::estop_chain(const IoInputs& in, const IoWishes& wishes, rtapi::Nanos now) {
  out_.user_enable_out = !wishes.estop;
  if (wishes.estop) out_.user_request_enable = false;
  if (wishes.reset_requests != resets_seen_) {
    resets_seen_ = wishes.reset_requests;
    out_.user_request_enable = !wishes.estop;
    request_end_ = now + kRequestTime;
  } else if (out_.user_request_enable && (in.emc_enable_in || now >= request_end_)) {
    out_.user_request_enable = false;
  }
}

void IoControl::tool_orders(const IoInputs& in, const IoWishes& wishes, rtapi::Nanos now) {
  const IoOutputs before = out_;
  if (wishes.abort_epoch != abort_seen_) {
    abort_seen_ = wishes.abort_epoch;
    if (started_) drop_handshake();
    if (options_.v2) signal_abort(wishes.abort_reason);
  }
  const auto stands = [&] { return now < settled_ || !same_questions(out_, before); };
  if (out_.emc_abort && !stands() && in.emc_abort_ack) {
    out_.emc_abort = false;
    out_.emc_reason = 0;
  }
  for (;;) {
    const std::optional<ToolOrder> order = link_.next_order();
    if (!order) return;
    if (order->epoch < abort_seen_) {
      link_.finish_order(false, "aborted");
      continue;
    }
    if (out_.emc_abort || stands() || !carry_out(*order, in)) return;
    started_ = false;
  }
}

void IoControl::drop_handshake() {
  // The tool that was asked for is not prepared: a changer that was half way must be asked again.
  out_.tool_prepare = false;
  out_.tool_change = false;
  out_.start_change = false;
  state_.prepared_tool = -1;
  state_.prepared_index = -1;
  out_.tool_prep_index = out_.tool_prep_number = out_.tool_prep_pocket = 0;
  started_ = false;
}

bool IoControl::carry_out(const ToolOrder& order, const IoInputs& in) {
  switch (order.kind) {
    case ToolOrder::Kind::prepare: return prepare(order, in);
    case ToolOrder::Kind::change: return change(order, in);
    case ToolOrder::Kind::set_number:
      set_number(order.tool);
      link_.finish_order(true, {});
      return true;
    case ToolOrder::Kind::start: return start_change(in);
  }
  return true;
}

void IoControl::signal_abort(std::int32_t reason) {
  out_.emc_reason = reason;
  out_.emc_abort = true;
}

void IoControl::watch_changer(const IoInputs& in) {
  if (in.toolchanger_fault && !out_.toolchanger_fault_ack) {
    reason_ = in.toolchanger_reason;
    faulted_ = out_.toolchanger_faulted = out_.toolchanger_fault_ack = true;
  }
  if (in.toolchanger_fault) return;
  out_.toolchanger_fault_ack = false;
  if (in.toolchanger_clear_fault) faulted_ = out_.toolchanger_faulted = false;
}

bool IoControl::start_change(const IoInputs& in) {
  if (!options_.v2 || !options_.start_change) {
    link_.finish_order(true, {});
    return true;
  }
  if (!started_) {
    out_.start_change = started_ = true;
    return false;
  }
  if (!in.start_change_ack && !faulted_) return false;
  out_.start_change = false;
  link_.finish_order(true, {});
  return true;
}

void IoControl::fail_change() {
  drop_handshake();
  state_.changer_fault = true;
  state_.changer_reason = reason_;
  link_.publish(state_);  // before the end of the order
  signal_abort(kAbortedByChanger);
  if (reason_ > 0) {
    link_.finish_order(true, {});
    return;
  }
  std::string text = reason_ == 0 ? "the tool changer reports a fault" : options_.fault_text;
  if (const auto at = text.find("%d"); at != std::string::npos && reason_ != 0)
    text.replace(at, 2, std::to_string(reason_));
  link_.finish_order(
      false, text + "; see to it, then set iocontrol.0.toolchanger-clear-fault to forget it");
}

bool IoControl::ask_for(int number) {
  const auto table = tools_.table();
  const ToolEntry* tool = table->find(number);
  if (tool == nullptr && (options_.random_changer || number != 0)) {
    link_.finish_order(false, "tool " + std::to_string(number) + " is not in the tool table");
    return false;
  }
  const int pocket = number == 0 && !options_.random_changer ? 0 : tool->pocket;
  out_.tool_prep_number = number;
  out_.tool_prep_pocket = pocket;
  out_.tool_prep_index = options_.random_changer ? pocket
                         : number == 0           ? 0
                                                 : table->index_of(number) + 1;
  out_.tool_prepare = true;
  started_ = true;
  return true;
}

void IoControl::take_prepared(int tool) {
  out_.tool_prepare = false;
  state_.prepared_tool = tool;
  state_.prepared_index = out_.tool_prep_index;
}

bool IoControl::prepare(const ToolOrder& order, const IoInputs& in) {
  // A changer with a fault is not asked; M6 tells.
  if (faulted_) {
    drop_handshake();
    link_.finish_order(true, {});
    return true;
  }
  if (!started_) return !ask_for(order.tool);
  if (!in.tool_prepared) return false;
  take_prepared(order.tool);
  link_.finish_order(true, {});
  return true;
}

bool IoControl::change(const ToolOrder& order, const IoInputs& in) {
  if (faulted_) {
    fail_change();
    return true;
  }
  if (!started_) state_.changer_fault = false;
  if (!started_) {
    const int tool = order.tool >= 0 ? order.tool : state_.prepared_tool;
    const bool nothing = tool < 0 || tool == state_.tool_in_spindle;
    if (!nothing && tool != state_.prepared_tool) return !ask_for(tool);
    if (!nothing) {
      out_.tool_change = true;
      started_ = true;
      return false;
    }
    link_.finish_order(true, {});
    return true;
  }
  if (out_.tool_prepare) {
    if (!in.tool_prepared) return false;
    take_prepared(order.tool);
    out_.tool_change = true;
    return false;
  }
  if (!in.tool_changed) return false;
  out_.tool_change = false;
  out_.tool_from_pocket = out_.tool_prep_pocket;
  state_.pocket_in_spindle = out_.tool_prep_pocket;
  put_into_spindle(state_.prepared_tool);
  return true;
}

void IoControl::put_into_spindle(int tool) {
  rtapi::Status saved;
  const int before = state_.tool_in_spindle;
  int from = 0;
  if (options_.random_changer) {
    const auto table = tools_.table();
    const ToolEntry* entry = table->find(tool);
    if (entry != nullptr) from = entry->pocket;
    saved = tools_.move({{before, from}, {tool, 0}});
  }
  if (const auto told = tools_.in_spindle(tool, before, from); saved.ok()) saved = told;
  state_.tool_in_spindle = tool;
  state_.prepared_tool = state_.prepared_index = -1;
  out_.tool_number = tool;
  out_.tool_prep_index = out_.tool_prep_number = out_.tool_prep_pocket = 0;
  link_.publish(state_);  // whoever sees the order ended sees the new tool
  link_.finish_order(saved.ok(), saved.ok()
                                     ? std::string()
                                     : "the tool was changed, but " + saved.error().message());
}

void IoControl::set_number(int tool) {
  int from = 0;
  if (options_.random_changer) {
    const auto table = tools_.table();
    const ToolEntry* entry = table->find(tool);
    if (entry != nullptr) {
      from = entry->pocket;
      (void)tools_.move({{state_.tool_in_spindle, from}, {tool, 0}});
    }
  }
  (void)tools_.in_spindle(tool, state_.tool_in_spindle, from);
  if (tool == 0) out_.tool_from_pocket = 0;
  state_.tool_in_spindle = tool;
  out_.tool_number = tool;
  link_.publish(state_);
}

}  // namespace kerf::io
