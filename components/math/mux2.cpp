// mux2: one of two values.
#include "hal/component.hpp"

namespace kerf::components {

class Mux2 final : public hal::Component<Mux2> {
 public:
  static constexpr hal::Info kInfo{.name = "mux2",
                                   .summary = "Selects one of two values",
                                   .notes = "The change from one input to the other is a step."};
  using Component::Component;

 private:
  hal::In<bool> sel_{pin<hal::In<bool>>("sel", "False selects in0, true selects in1")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "The selected input")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Value of out while sel is true")};
  hal::In<double> in0_{pin<hal::In<double>>("in0", "Value of out while sel is false")};

  void update(const hal::Period&) noexcept { out_ = sel_ ? in1_.get() : in0_.get(); }
  hal::Function update_{function<&Mux2::update>("", "Copies the selected input to out")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Mux2)
