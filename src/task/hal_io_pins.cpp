#include "task/hal_io_pins.hpp"

namespace kerf::task {

HalIoPins::HalIoPins(hal::Session& session) : component_(session, "iocontrol.0") {
  status_ = component_.ready();
}

io::IoInputs HalIoPins::read() {
  io::IoInputs in;
  in.emc_enable_in = emc_enable_in_;
  in.tool_changed = tool_changed_;
  in.tool_prepared = tool_prepared_;
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
}

}  // namespace kerf::task
