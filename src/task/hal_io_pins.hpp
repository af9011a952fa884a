// The pins of iocontrol.0 in HAL.
#pragma once

#include "hal/client/user_component.hpp"
#include "io/io_pins.hpp"

namespace kerf::task {

class HalIoPins final : public io::IoPins {
 public:
  /// Makes the component and its pins; status() tells how that went. `session` must outlive it.
  explicit HalIoPins(hal::Session& session);
  [[nodiscard]] const rtapi::Status& status() const { return status_; }
  io::IoInputs read() override;
  void write(const io::IoOutputs& outputs) override;

 private:
  template <class T>
  using In = hal::LinkIn<T>;
  template <class T>
  using Out = hal::LinkOut<T>;
  hal::UserComponent component_;
  In<bool> emc_enable_in_{component_.pin<In<bool>>("emc-enable-in")};
  In<bool> tool_changed_{component_.pin<In<bool>>("tool-changed")};
  In<bool> tool_prepared_{component_.pin<In<bool>>("tool-prepared")};
  Out<bool> coolant_flood_{component_.pin<Out<bool>>("coolant-flood")};
  Out<bool> coolant_mist_{component_.pin<Out<bool>>("coolant-mist")};
  Out<bool> tool_change_{component_.pin<Out<bool>>("tool-change")};
  Out<bool> tool_prepare_{component_.pin<Out<bool>>("tool-prepare")};
  Out<bool> user_enable_out_{component_.pin<Out<bool>>("user-enable-out")};
  Out<bool> user_request_enable_{component_.pin<Out<bool>>("user-request-enable")};
  Out<std::int32_t> tool_from_pocket_{component_.pin<Out<std::int32_t>>("tool-from-pocket")};
  Out<std::int32_t> tool_number_{component_.pin<Out<std::int32_t>>("tool-number")};
  Out<std::int32_t> tool_prep_index_{component_.pin<Out<std::int32_t>>("tool-prep-index")};
  Out<std::int32_t> tool_prep_number_{component_.pin<Out<std::int32_t>>("tool-prep-number")};
  Out<std::int32_t> tool_prep_pocket_{component_.pin<Out<std::int32_t>>("tool-prep-pocket")};
  // Lubrication is gone since LinuxCNC 2.10; HAL files from before connect its pins.
  Out<bool> lube_{component_.pin<Out<bool>>("lube")};
  In<bool> lube_level_{component_.pin<In<bool>>("lube_level")};
  rtapi::Status status_;
};

}  // namespace kerf::task
