// safety_latch: an error that lasts is latched.
#include <algorithm>

#include "hal/component.hpp"

namespace kerf::components {

class SafetyLatch final : public hal::Component<SafetyLatch> {
 public:
  static constexpr hal::Info kInfo{
      .name = "safety-latch",
      .summary = "Latches an error that lasts or comes too often",
      .notes =
          "A damage, from 0 to 100 percent, grows by harm percent a second while error-in is true "
          "and heals by heal percent a second while it is false. From threshold percent on "
          "error-out is true. With latching it stays so until a rising edge of reset with error-in "
          "false, which heals all; without, until the damage is gone. A threshold of 0 takes the "
          "first call with an error."};
  using Component::Component;

 private:
  hal::In<bool> error_in_{pin<hal::In<bool>>("error-in", "True while there is an error")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "A rising edge takes the latch back")};
  hal::Out<bool> error_out_{pin<hal::Out<bool>>("error-out", "True once the error has lasted")};
  hal::Param<std::uint32_t> threshold_{
      param<hal::Param<std::uint32_t>>("threshold", "Damage that sets error-out [percent]", 100)};
  hal::Param<std::uint32_t> harm_{
      param<hal::Param<std::uint32_t>>("harm", "Damage by an error [percent per second]", 500)};
  hal::Param<std::uint32_t> heal_{
      param<hal::Param<std::uint32_t>>("heal", "Healing without error [percent per second]", 250)};
  hal::Param<bool> latching_{
      param<hal::Param<bool>>("latching", "True: error-out stays until reset", true)};
  double damage_{0.0};
  bool reset_before_{true};

  void update(const hal::Period& period) noexcept {
    const bool error = error_in_, reset = reset_;
    const double rate = error ? static_cast<double>(harm_) : -static_cast<double>(heal_);
    damage_ += rate * period.seconds();
    damage_ = damage_ < 0.0 ? 0.0 : damage_ > 100.0 ? 100.0 : damage_;
    const double threshold = std::min<std::uint32_t>(threshold_, 100);
    // The last digits of the sum are those of its many parts.
    if (error && damage_ + 1e-6 >= threshold) error_out_ = true;
    if (!latching_ && damage_ == 0.0 && !error) error_out_ = false;
    if (reset && !reset_before_ && !error) {
      damage_ = 0.0;
      error_out_ = false;
    }
    reset_before_ = reset;
  }
  hal::Function update_{function<&SafetyLatch::update>("", "Looks at the error")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SafetyLatch)
