// The pins of iocontrol.0 as two plain structs, so that IoControl is tested without HAL.
#pragma once

#include <cstdint>

namespace kerf::io {

struct IoInputs {
  bool emc_enable_in{false};  ///< FALSE: external estop
  bool tool_prepared{false};
  bool tool_changed{false};
};

struct IoOutputs {
  bool user_enable_out{false};      ///< FALSE: internal estop
  bool user_request_enable{false};  ///< TRUE while the operator asks for the end of the estop
  bool coolant_flood{false}, coolant_mist{false};
  bool tool_prepare{false}, tool_change{false};
  std::int32_t tool_from_pocket{0};
  std::int32_t tool_number{0};
  std::int32_t tool_prep_index{0}, tool_prep_number{0}, tool_prep_pocket{0};
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
