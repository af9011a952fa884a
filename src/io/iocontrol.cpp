#include "io/iocontrol.hpp"

namespace kerf::io {

IoControl::IoControl(IoLink& link, rtapi::Cell& to_io, IoPins& pins, ToolStore& tools,
                     bool random_changer)
    : link_(link), to_io_(to_io), pins_(pins), tools_(tools), random_(random_changer) {
  read_spindle();
  pins_.write(out_);
  link_.publish(state_);
}

void IoControl::read_spindle() {
  if (!random_) return;
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
    in.tool_prepared = in.tool_prepared || (started_ && out_.tool_prepare);
    in.tool_changed = in.tool_changed || (started_ && out_.tool_change);
  }
  const IoOutputs before = out_;
  estop_chain(in, wishes, now);
  out_.coolant_flood = wishes.flood;
  out_.coolant_mist = wishes.mist;
  tool_orders(in, wishes);
  if (!(out_ == before)) pins_.write(out_);
  state_.emc_enable_in = in.emc_enable_in;
  state_.user_enable = out_.user_enable_out;
  state_.flood = out_.coolant_flood;
  state_.mist = out_.coolant_mist;
  state_.waiting_prepared = out_.tool_prepare;
  state_.waiting_changed = out_.tool_change;
  link_.publish(state_);
  const bool busy =
      out_.user_request_enable || out_.tool_prepare || out_.tool_change || !(out_ == before);
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

void IoControl::tool_orders(const IoInputs& in, const IoWishes& wishes) {
  if (wishes.abort_epoch != abort_seen_) {
    abort_seen_ = wishes.abort_epoch;
    if (started_) drop_handshake();
  }
  for (;;) {
    const std::optional<ToolOrder> order = link_.next_order();
    if (!order) return;
    if (order->epoch < abort_seen_) {
      link_.finish_order(false, "aborted");
      continue;
    }
    if (!carry_out(*order, in)) return;
    started_ = false;
  }
}

void IoControl::drop_handshake() {
  // The tool that was asked for is not prepared: a changer that was half way must be asked again.
  out_.tool_prepare = false;
  out_.tool_change = false;
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
  }
  return true;
}

bool IoControl::ask_for(int number) {
  const auto table = tools_.table();
  const ToolEntry* tool = table->find(number);
  if (tool == nullptr && (random_ || number != 0)) {
    link_.finish_order(false, "tool " + std::to_string(number) + " is not in the tool table");
    return false;
  }
  const int pocket = number == 0 && !random_ ? 0 : tool->pocket;
  out_.tool_prep_number = number;
  out_.tool_prep_pocket = pocket;
  out_.tool_prep_index = random_ ? pocket : number == 0 ? 0 : table->index_of(number) + 1;
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
  // The answer is looked at in the next cycle, when HAL has seen the question.
  if (!started_) return !ask_for(order.tool);
  if (!in.tool_prepared) return false;
  take_prepared(order.tool);
  link_.finish_order(true, {});
  return true;
}

bool IoControl::change(const ToolOrder& order, const IoInputs& in) {
  if (!started_) {
    const int tool = order.tool >= 0 ? order.tool : state_.prepared_tool;
    const bool nothing = tool < 0 || tool == state_.tool_in_spindle;
    if (!nothing && tool != state_.prepared_tool) return !ask_for(tool);
    if (!nothing) {
      out_.tool_change = true;
      started_ = true;
      return false;
    }
    state_.prepared_tool = state_.prepared_index = -1;
    out_.tool_prep_index = out_.tool_prep_number = out_.tool_prep_pocket = 0;
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
  if (random_) {
    const auto table = tools_.table();
    const ToolEntry* entry = table->find(tool);
    const int from = entry != nullptr ? entry->pocket : 0;
    saved = tools_.move({{state_.tool_in_spindle, from}, {tool, 0}});
  }
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
  if (random_) {
    const auto table = tools_.table();
    const ToolEntry* entry = table->find(tool);
    if (entry != nullptr) (void)tools_.move({{state_.tool_in_spindle, entry->pocket}, {tool, 0}});
  }
  if (tool == 0) out_.tool_from_pocket = 0;
  state_.tool_in_spindle = tool;
  out_.tool_number = tool;
  link_.publish(state_);
}

}  // namespace kerf::io
