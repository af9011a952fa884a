// knob2float: makes a value of the counts of a knob.
#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Knob2float final : public hal::Component<Knob2float> {
 public:
  static constexpr hal::Info kInfo{.name = "knob2float",
                                   .summary = "Makes a value of the counts of a knob",
                                   .notes = "Counts that come while enable is false are not used."};
  using Component::Component;

 private:
  hal::In<std::int32_t> counts_{pin<hal::In<std::int32_t>>("counts", "Counts of the knob")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True: the knob changes out")};
  hal::In<double> scale_{pin<hal::In<double>>("scale", "Change of out for a count")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Value")};
  hal::Param<double> max_out_{param<hal::Param<double>>("max-out", "Highest value of out", 1.0)};
  hal::Param<double> min_out_{param<hal::Param<double>>("min-out", "Lowest value of out", 0.0)};
  std::int32_t before_{0};

  void update(const hal::Period&) noexcept {
    const std::int32_t counts = counts_;
    const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) -
                                                 static_cast<std::uint32_t>(before_));
    before_ = counts;
    if (enable_)
      out_ = rtapi::limited(out_.last() + scale_ * moved, min_out_.get(), max_out_.get());
  }
  hal::Function update_{function<&Knob2float::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Knob2float)
