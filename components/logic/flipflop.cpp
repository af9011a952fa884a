// flipflop: d flip-flop with set and reset.
#include "hal/component.hpp"

namespace kerf::components {

class Flipflop final : public hal::Component<Flipflop> {
 public:
  static constexpr hal::Info kInfo{.name = "flipflop",
                                   .summary = "D flip-flop with set and reset",
                                   .notes = "set and reset work at once, without the clock."};
  using Component::Component;

 private:
  hal::In<bool> data_{pin<hal::In<bool>>("data", "What a rising edge of clk copies to out")};
  hal::In<bool> clk_{pin<hal::In<bool>>("clk", "Clock")};
  hal::In<bool> set_{pin<hal::In<bool>>("set", "True makes out true")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True makes out false, whatever set says")};
  hal::Io<bool> out_{pin<hal::Io<bool>>("out", "State")};
  hal::Io<bool> out_not_{pin<hal::Io<bool>>("out-not", "Opposite of the state")};
  bool clk_before_{false};

  void update(const hal::Period&) noexcept {
    const bool clk = clk_;
    bool out = out_;
    if (clk && !clk_before_) out = data_;
    clk_before_ = clk;
    if (set_) out = true;
    if (reset_) out = false;
    out_ = out;
    out_not_ = !out;
  }
  hal::Function update_{function<&Flipflop::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Flipflop)
