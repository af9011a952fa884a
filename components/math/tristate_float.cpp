// tristate_float: writes a float only while it is enabled.
#include "hal/component.hpp"

namespace kerf::components {

class TristateFloat final : public hal::Component<TristateFloat> {
 public:
  static constexpr hal::Info kInfo{.name = "tristate-float",
                                   .summary = "Writes a float only while it is enabled",
                                   .notes =
                                       "Several of them can share one signal, as drivers on a bus "
                                       "do; see that one at a time is enabled."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Value to write")};
  hal::Io<double> out_{
      pin<hal::Io<double>>("out", "Gets in while enable is true, and is left alone else")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True writes")};

  void update(const hal::Period&) noexcept {
    if (enable_) out_ = in_.get();
  }
  hal::Function update_{
      function<&TristateFloat::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::TristateFloat)
