// toggle2nist: push button for a device with on and off inputs.
#include "hal/component.hpp"

namespace kerf::components {

class Toggle2nist final : public hal::Component<Toggle2nist> {
 public:
  static constexpr hal::Info kInfo{.name = "toggle2nist",
                                   .summary = "Push button for a device with on and off inputs",
                                   .notes =
                                       "Each press asks for the opposite of what is-on says, and "
                                       "keeps asking until is-on has changed."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Push button")};
  hal::In<bool> is_on_{pin<hal::In<bool>>("is-on", "True while the device is on")};
  hal::Out<bool> on_{pin<hal::Out<bool>>("on", "True asks the device to go on")};
  hal::Out<bool> off_{pin<hal::Out<bool>>("off", "True asks the device to go off")};
  bool before_{false};

  void update(const hal::Period&) noexcept {
    const bool in = in_, is_on = is_on_;
    if (in && !before_) {
      on_ = !is_on;
      off_ = is_on;
    }
    before_ = in;
    if (is_on) on_ = false;
    if (!is_on) off_ = false;
  }
  hal::Function update_{function<&Toggle2nist::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Toggle2nist)
