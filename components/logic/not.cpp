// not: inverts a bit.
#include "hal/component.hpp"

namespace kerf::components {

class Not final : public hal::Component<Not> {
 public:
  static constexpr hal::Info kInfo{.name = "not",
                                   .summary = "Inverter",
                                   .notes = "out is true while in is false, and the reverse."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "The opposite of in")};

  void update(const hal::Period&) noexcept { out_ = !in_.get(); }
  hal::Function update_{function<&Not::update>("", "Computes out from in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Not)
