// edge: pulses at the edges of a bit.
#include <algorithm>

#include "hal/component.hpp"

namespace kerf::components {

class Edge final : public hal::Component<Edge> {
 public:
  static constexpr hal::Info kInfo{
      .name = "edge",
      .summary = "Edge detector",
      .notes =
          "An edge of the chosen kind starts a pulse at out of out-width-ns, rounded up to whole "
          "periods of the thread and at least one. Another edge during the pulse starts its time "
          "anew. Mind in-edge: true, its default, chooses the falling edge."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input whose edges count")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True during the pulse")};
  hal::Out<bool> out_invert_{pin<hal::Out<bool>>("out-invert", "The opposite of out")};
  hal::Param<bool> both_{param<hal::Param<bool>>("both", "True: both edges count", false)};
  hal::Param<bool> in_edge_{param<hal::Param<bool>>(
      "in-edge", "Without both, the edge that counts: true falling, false rising", true)};
  hal::Param<std::int32_t> width_ns_{
      param<hal::Param<std::int32_t>>("out-width-ns", "Length of the pulse [ns]", 0)};
  hal::RoParam<std::int32_t> left_ns_{
      param<hal::RoParam<std::int32_t>>("time-left-ns", "Rest of the running pulse [ns]")};
  hal::RoParam<bool> last_in_{param<hal::RoParam<bool>>("last-in", "in at the last call")};

  void update(const hal::Period& period) noexcept {
    // What is there at the first call is no edge.
    const bool now = in_, before = first_ ? now : last_in_.last();
    first_ = false;
    const bool counts = now != before && (both_ || now != in_edge_.get());
    std::int64_t left_ns = left_ns_.last();
    left_ns = counts ? std::max(width_ns_.get(), 0)
                     : std::max<std::int64_t>(left_ns - period.nominal_ns, 0);
    left_ns_ = static_cast<std::int32_t>(left_ns);
    out_ = counts || left_ns > 0;
    out_invert_ = !out_.last();
    last_in_ = now;
  }
  bool first_{true};
  hal::Function update_{function<&Edge::update>("", "Makes pulses from edges")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Edge)
