// offset: adds an offset on the way out and takes it off on the way back.
#include "hal/component.hpp"

namespace kerf::components {

class Offset final : public hal::Component<Offset> {
 public:
  static constexpr hal::Info kInfo{
      .name = "offset",
      .summary = "Adds an offset on the way out and takes it off on the way back",
      .notes = "Between a controller and a drive it moves the zero of one joint."};
  using Component::Component;

 private:
  hal::In<double> offset_{pin<hal::In<double>>("offset", "The offset")};
  hal::In<double> in_{pin<hal::In<double>>("in", "Value without offset")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "in + offset")};
  hal::In<double> fb_in_{pin<hal::In<double>>("fb-in", "Feedback with offset")};
  hal::Out<double> fb_out_{pin<hal::Out<double>>("fb-out", "fb-in - offset")};

  void update_output(const hal::Period&) noexcept { out_ = in_ + offset_; }
  hal::Function update_output_{function<&Offset::update_output>("update-output", "Computes out")};

  void update_feedback(const hal::Period&) noexcept { fb_out_ = fb_in_ - offset_; }
  hal::Function update_feedback_{
      function<&Offset::update_feedback>("update-feedback", "Computes fb-out")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Offset)
