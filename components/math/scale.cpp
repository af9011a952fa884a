// scale: gain and offset.
#include "hal/component.hpp"

namespace kerf::components {

class Scale final : public hal::Component<Scale> {
 public:
  static constexpr hal::Info kInfo{
      .name = "scale",
      .summary = "Applies a gain and an offset",
      .notes = "gain starts at zero: out is only the offset until gain is set."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::In<double> gain_{pin<hal::In<double>>("gain", "Factor of in")};
  hal::In<double> offset_{pin<hal::In<double>>("offset", "Added to the product")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "in * gain + offset")};

  void update(const hal::Period&) noexcept { out_ = in_ * gain_ + offset_; }
  hal::Function update_{function<&Scale::update>("", "Computes out from in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Scale)
