// abs_s64: absolute value and sign of an s64.
#include "hal/component.hpp"

namespace kerf::components {

class AbsS64 final : public hal::Component<AbsS64> {
 public:
  static constexpr hal::Info kInfo{.name = "abs-s64",
                                   .summary = "Absolute value and sign of an s64",
                                   .notes =
                                       "Zero is neither positive nor negative. The lowest number "
                                       "has no positive counterpart and stays as it is."};
  using Component::Component;

 private:
  hal::In<std::int64_t> in_{pin<hal::In<std::int64_t>>("in", "Input value")};
  hal::Out<std::int64_t> out_{pin<hal::Out<std::int64_t>>("out", "The input without its sign")};
  hal::Out<bool> sign_{pin<hal::Out<bool>>("sign", "True while in is negative")};
  hal::Out<bool> is_positive_{pin<hal::Out<bool>>("is-positive", "True while in is above zero")};
  hal::Out<bool> is_negative_{pin<hal::Out<bool>>("is-negative", "True while in is below zero")};

  void update(const hal::Period&) noexcept {
    const std::int64_t in = in_;
    const bool negative = in < 0;
    out_ = static_cast<std::int64_t>(negative ? 0ULL - static_cast<std::uint64_t>(in)
                                              : static_cast<std::uint64_t>(in));
    sign_ = negative;
    is_negative_ = negative;
    is_positive_ = in > 0;
  }
  hal::Function update_{function<&AbsS64::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::AbsS64)
