// toggle2nist and, with KERF_MOMENTARY, momentary2nist: a button or a switch for a device with on and off inputs.
#include "hal/component.hpp"

namespace kerf::components {
namespace {

#ifdef KERF_MOMENTARY
constexpr bool kMomentary = true;
#else
constexpr bool kMomentary = false;
#endif

class Nist final : public hal::Component<Nist> {
 public:
  static constexpr hal::Info kInfo{
      .name = kMomentary ? "momentary2nist" : "toggle2nist",
      .summary = kMomentary ? "Two-position switch for a device with on and off inputs"
                            : "Push button for a device with on and off inputs",
      .notes =
          kMomentary
              ? "A change of in asks the device to follow, and keeps asking until is-on has done "
                "so."
              : "Each change of in, up or down, asks for the opposite of what is-on says, and "
                "keeps "
                "asking until is-on has changed. A button that springs back needs a toggle before "
                "it: letting it go is a change too."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>(
      "in", kMomentary ? "Switch: true on, false off" : "Button, out of a toggle")};
  hal::In<bool> is_on_{pin<hal::In<bool>>("is-on", "True while the device is on")};
  hal::Out<bool> on_{pin<hal::Out<bool>>("on", "True asks the device to go on")};
  hal::Out<bool> off_{pin<hal::Out<bool>>("off", "True asks the device to go off")};
  bool before_{false};

  void update(const hal::Period&) noexcept {
    const bool in = in_, is_on = is_on_;
    const bool asks = in != before_;
    const bool wanted = kMomentary ? in : !is_on;
    before_ = in;
    if (asks) {
      on_ = wanted && !is_on;
      off_ = !wanted && is_on;
    }
    if (is_on) on_ = false;
    if (!is_on) off_ = false;
  }
  hal::Function update_{function<&Nist::update>("", "Computes the outputs from the inputs")};
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Nist)
