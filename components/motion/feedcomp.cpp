// feedcomp: scales a value with the feed.
#include "hal/component.hpp"

namespace kerf::components {

class Feedcomp final : public hal::Component<Feedcomp> {
 public:
  static constexpr hal::Info kInfo{
      .name = "feedcomp",
      .summary = "Scales a value with the feed",
      .notes = "For a laser or a plasma torch whose power must follow the speed of the cut."};
  using Component::Component;

 private:
  hal::Out<double> out_{
      pin<hal::Out<double>>("out", "in * vel / feed, or in while enable is false")};
  hal::In<double> in_{pin<hal::In<double>>("in", "Value at full feed")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True scales")};
  hal::In<double> vel_{pin<hal::In<double>>("vel", "Speed now")};
  hal::Param<double> feed_{param<hal::Param<double>>("feed", "Speed at which out is in", 0.0)};

  void update(const hal::Period&) noexcept { out_ = enable_ ? in_ * (vel_ / feed_) : in_.get(); }
  hal::Function update_{function<&Feedcomp::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Feedcomp)
