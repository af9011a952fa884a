// maj3: majority of three bits.
#include "hal/component.hpp"

namespace kerf::components {

class Maj3 final : public hal::Component<Maj3> {
 public:
  static constexpr hal::Info kInfo{
      .name = "maj3", .summary = "Majority of three bits", .notes = "Two of three inputs decide."};
  using Component::Component;

 private:
  hal::In<bool> in1_{pin<hal::In<bool>>("in1", "First vote")};
  hal::In<bool> in2_{pin<hal::In<bool>>("in2", "Second vote")};
  hal::In<bool> in3_{pin<hal::In<bool>>("in3", "Third vote")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "What at least two inputs say")};
  hal::Param<bool> invert_{
      param<hal::Param<bool>>("invert", "True: out is the opposite of the majority", false)};

  void update(const hal::Period&) noexcept {
    const int votes = int{in1_} + int{in2_} + int{in3_};
    out_ = (votes >= 2) != invert_;
  }
  hal::Function update_{function<&Maj3::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Maj3)
