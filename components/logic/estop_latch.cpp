// estop_latch: latch for an emergency-stop chain.
#include "hal/component.hpp"

namespace kerf::components {

class EstopLatch final : public hal::Component<EstopLatch> {
 public:
  static constexpr hal::Info kInfo{
      .name = "estop-latch",
      .summary = "Latch for an emergency-stop chain",
      .notes =
          "It starts faulted. A rising edge of reset makes it good when fault-in is false and "
          "ok-in is true; either of them makes it faulted again."};
  using Component::Component;

 private:
  hal::In<bool> ok_in_{pin<hal::In<bool>>("ok-in", "False is a fault", true)};
  hal::In<bool> fault_in_{pin<hal::In<bool>>("fault-in", "True is a fault", false)};
  hal::In<bool> reset_{
      pin<hal::In<bool>>("reset", "A rising edge ends the fault when its cause is gone")};
  hal::Out<bool> ok_out_{pin<hal::Out<bool>>("ok-out", "True while there is no fault", false)};
  hal::Out<bool> fault_out_{pin<hal::Out<bool>>("fault-out", "True while there is a fault", true)};
  hal::Out<bool> watchdog_{
      pin<hal::Out<bool>>("watchdog", "Changes at each call while there is no fault")};
  bool ok_{false}, reset_before_{false};

  void update(const hal::Period&) noexcept {
    const bool reset = reset_;
    const bool well = ok_in_ && !fault_in_;
    ok_ = well && (ok_ || (reset && !reset_before_));
    reset_before_ = reset;
    ok_out_ = ok_;
    fault_out_ = !ok_;
    if (ok_) watchdog_ = !watchdog_.last();
  }
  hal::Function update_{function<&EstopLatch::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::EstopLatch)
