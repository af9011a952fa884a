// dbounce: filters the bounce out of a switch.
#include "bounce_filter.hpp"
#include "hal/component.hpp"

namespace kerf::components {

class Dbounce final : public hal::Component<Dbounce> {
 public:
  static constexpr hal::Info kInfo{
      .name = "dbounce",
      .summary = "Filters the bounce out of a switch",
      .notes =
          "The input is counted up while true and down while false; out changes when the count has "
          "come to delay or to zero and one more call says the same. With a delay of 0 nothing is "
          "filtered."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input that bounces")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "Input without bounces")};
  hal::In<std::uint32_t> delay_{pin<hal::In<std::uint32_t>>(
      "delay", "Calls for which in must have a new value, and one more, before out takes it", 5)};
  BounceFilter filter_;

  void update(const hal::Period&) noexcept { filter_.update(in_, out_, delay_); }
  hal::Function update_{function<&Dbounce::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Dbounce)
