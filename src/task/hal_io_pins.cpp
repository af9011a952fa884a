#include "task/hal_io_pins.hpp"

namespace kerf::task {

HalIoPins::HalIoPins(hal::Session& session, bool v2) : component_(session, "iocontrol.0") {
  if (v2) v2_.emplace(component_);
  status_ = component_.ready();
}

io::IoInputs HalIoPins::read() {
  io::IoInputs in;
  in.emc_enable_in = emc_enable_in_;
  in.tool_changed = tool_changed_;
  in.tool_prepared = tool_prepared_;
  if (v2_) {
    in.emc_abort_ack = v2_->emc_abort_ack;
    in.start_change_ack = v2_->start_change_ack;
    in.toolchanger_fault = v2_->toolchanger_fault;
    in.toolchanger_clear_fault = v2_->toolchanger_clear_fault;
    in.toolchanger_reason = v2_->toolchanger_reason;
  }
  return in;
}

void HalIoPins::write(const io::IoOutputs& o) {
  coolant_flood_ = o.coolant_flood;
  coolant_mist_ = o.coolant_mist;
  // Numbers before the question that they belong to.
  tool_from_pocket_ = o.tool_from_pocket;
  tool_number_ = o.tool_number;
  tool_prep_index_ = o.tool_prep_index;
  tool_prep_number_ = o.tool_prep_number;
  tool_prep_pocket_ = o.tool_prep_pocket;
  tool_prepare_ = o.tool_prepare;
  tool_change_ = o.tool_change;
  user_enable_out_ = o.user_enable_out;
  user_request_enable_ = o.user_request_enable;
  if (!v2_) return;
  v2_->emc_reason = o.emc_reason;
  v2_->emc_abort = o.emc_abort;
  v2_->start_change = o.start_change;
  v2_->toolchanger_faulted = o.toolchanger_faulted;
  v2_->toolchanger_fault_ack = o.toolchanger_fault_ack;
  v2_->state = o.state;
}

}  // namespace kerf::task
