// The pins of iocontrol.0 as two plain structs, so that IoControl is tested without HAL.
#pragma once

#include <cstdint>

namespace kerf::io {

struct IoInputs {
  bool emc_enable_in{false};  ///< FALSE: external estop
  bool tool_prepared{false};
  bool tool_changed{false};
  // iov2
  bool emc_abort_ack{false}, start_change_ack{false};
  bool toolchanger_fault{false}, toolchanger_clear_fault{false};
  std::int32_t toolchanger_reason{0};
};

struct IoOutputs {
  bool user_enable_out{false};      ///< FALSE: internal estop
  bool user_request_enable{false};  ///< TRUE while the operator asks for the end of the estop
  bool coolant_flood{false}, coolant_mist{false};
  bool tool_prepare{false}, tool_change{false};
  std::int32_t tool_from_pocket{0};
  std::int32_t tool_number{0};
  std::int32_t tool_prep_index{0}, tool_prep_number{0}, tool_prep_pocket{0};
  // iov2
  bool emc_abort{false}, start_change{false};
  bool toolchanger_fault_ack{false}, toolchanger_faulted{false};
  std::int32_t emc_reason{0}, state{0};
  friend bool operator==(const IoOutputs&, const IoOutputs&) = default;
};

/// Where IoControl reads and writes its pins.
class IoPins {
 public:
  virtual ~IoPins() = default;
  virtual IoInputs read() = 0;
  virtual void write(const IoOutputs& outputs) = 0;
};

}  // namespace kerf::io
