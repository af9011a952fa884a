// blend: mixes two values.
#include "hal/component.hpp"

namespace kerf::components {

class Blend final : public hal::Component<Blend> {
 public:
  static constexpr hal::Info kInfo{
      .name = "blend", .summary = "Mixes two values", .notes = "select is the share of in1."};
  using Component::Component;

 private:
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Value at select 1")};
  hal::In<double> in2_{pin<hal::In<double>>("in2", "Value at select 0")};
  hal::In<double> select_{pin<hal::In<double>>("select", "Share of in1")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "in1 * select + in2 * (1 - select)")};
  hal::Param<bool> open_{param<hal::Param<bool>>(
      "open", "True: select may leave the range from 0 to 1; false: it is bounded", false)};

  void update(const hal::Period&) noexcept {
    double select = select_;
    if (!open_) {
      if (select > 1.0) select = 1.0;
      if (select < 0.0) select = 0.0;
    }
    out_ = in1_ * select + in2_ * (1.0 - select);
  }
  hal::Function update_{function<&Blend::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Blend)
