// The pins of iocontrol.0 in HAL.
#pragma once

#include <optional>

#include "hal/client/user_component.hpp"
#include "io/io_pins.hpp"

namespace kerf::task {

class HalIoPins final : public io::IoPins {
 public:
  /// Makes the component and its pins; status() tells how that went. `session` must outlive it.
  /// `v2`: the pins of iov2 too.
  HalIoPins(hal::Session& session, bool v2);
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
  struct V2 {
    explicit V2(hal::UserComponent& c)
        : emc_abort_ack(c.pin<In<bool>>("emc-abort-ack")),
          start_change_ack(c.pin<In<bool>>("start-change-ack")),
          toolchanger_fault(c.pin<In<bool>>("toolchanger-fault")),
          toolchanger_clear_fault(c.pin<In<bool>>("toolchanger-clear-fault")),
          toolchanger_reason(c.pin<In<std::int32_t>>("toolchanger-reason")),
          emc_abort(c.pin<Out<bool>>("emc-abort")),
          start_change(c.pin<Out<bool>>("start-change")),
          toolchanger_fault_ack(c.pin<Out<bool>>("toolchanger-fault-ack")),
          toolchanger_faulted(c.pin<Out<bool>>("toolchanger-faulted")),
          emc_reason(c.pin<Out<std::int32_t>>("emc-reason")),
          state(c.pin<Out<std::int32_t>>("state")) {}
    In<bool> emc_abort_ack, start_change_ack, toolchanger_fault, toolchanger_clear_fault;
    In<std::int32_t> toolchanger_reason;
    Out<bool> emc_abort, start_change, toolchanger_fault_ack, toolchanger_faulted;
    Out<std::int32_t> emc_reason, state;
  };
  std::optional<V2> v2_;
  rtapi::Status status_;
};

}  // namespace kerf::task
