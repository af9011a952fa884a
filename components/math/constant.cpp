// constant: a pin with a set value.
#include "hal/component.hpp"

namespace kerf::components {

class Constant final : public hal::Component<Constant> {
 public:
  static constexpr hal::Info kInfo{
      .name = "constant",
      .summary = "Gives a pin the value of a parameter",
      .notes = "Gives a signal a writer where `sets` on the signal is not enough."};
  using Component::Component;

 private:
  hal::Out<double> out_{pin<hal::Out<double>>("out", "The value")};
  hal::Param<double> value_{param<hal::Param<double>>("value", "Value that out gets")};

  void update(const hal::Period&) noexcept { out_ = value_.get(); }
  hal::Function update_{function<&Constant::update>("", "Copies value to out")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Constant)
