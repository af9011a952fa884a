// match8: compares two bytes bit by bit.
#include "hal/component.hpp"

namespace kerf::components {

class Match8 final : public hal::Component<Match8> {
 public:
  static constexpr hal::Info kInfo{.name = "match8",
                                   .summary = "Compares two bytes bit by bit",
                                   .notes = "Chain several through in and out for wider numbers."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Cascade: false makes out false", true)};
  hal::PinArray<hal::In<bool>, 8> a_{pins<hal::In<bool>, 8>("a#", 8, "Bit of the first byte")};
  hal::PinArray<hal::In<bool>, 8> b_{pins<hal::In<bool>, 8>("b#", 8, "Bit of the second byte")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while in is true and all bits agree")};

  void update(const hal::Period&) noexcept {
    bool same = in_;
    for (std::size_t i = 0; i < a_.size(); ++i) same = same && a_[i] == b_[i];
    out_ = same;
  }
  hal::Function update_{function<&Match8::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Match8)
