// abs_s64: writes a float only while it is enabled.
#include "hal/component.hpp"

namespace kerf::components {

class AbsS64 final : public hal::Component<AbsS64> {
 public:
  static constexpr hal::Info kInfo{.name = "abs-s64",
                                   .summary = "Writes a float only while it is enabled",
                                   .notes =
                                       "Several of them can share one signal, as drivers on a bus "
                                       "do; see that one at a time is enabled."};
  using Component::Component;

 private:
  hal::In<std::int64_t> in_{pin<hal::In<std::int64_t>>("in", "Value to write")};
  hal::Io<std::int64_t> out_{
      pin<hal::Io<std::int64_t>>("out", "Gets in while enable is true, and is left alone else")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True writes")};

  void update(const hal::Period&) noexcept {
    if (enable_) out_ = in_.get();
  }
  hal::Function update_{function<&AbsS64::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::AbsS64)
