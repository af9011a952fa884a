// sphereprobe: simulates a probe on a hemisphere.
#include "hal/component.hpp"

namespace kerf::components {

class Sphereprobe final : public hal::Component<Sphereprobe> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sphereprobe",
      .summary = "Simulates a probe on a hemisphere",
      .notes =
          "Connect the raw counts of the encoders to px, py and pz. Around the hemisphere there is "
          "a table at the height of its middle."};
  using Component::Component;

 private:
  hal::In<std::int32_t> px_{
      pin<hal::In<std::int32_t>>("px", "Position of the probe along x [counts]")};
  hal::In<std::int32_t> py_{
      pin<hal::In<std::int32_t>>("py", "Position of the probe along y [counts]")};
  hal::In<std::int32_t> pz_{
      pin<hal::In<std::int32_t>>("pz", "Position of the probe along z [counts]")};
  hal::In<std::int32_t> cx_{
      pin<hal::In<std::int32_t>>("cx", "Middle of the sphere along x [counts]")};
  hal::In<std::int32_t> cy_{
      pin<hal::In<std::int32_t>>("cy", "Middle of the sphere along y [counts]")};
  hal::In<std::int32_t> cz_{
      pin<hal::In<std::int32_t>>("cz", "Middle of the sphere along z [counts]")};
  hal::In<std::int32_t> r_{pin<hal::In<std::int32_t>>("r", "Radius of the hemisphere [counts]")};
  hal::Out<bool> probe_out_{
      pin<hal::Out<bool>>("probe-out", "True while the probe touches the hemisphere")};

  void update(const hal::Period&) noexcept {
    const double cx = cx_, cy = cy_, cz = cz_, r = r_;
    const double x = px_ - cx, y = py_ - cy, z = pz_ - cz;
    const double around = x * x + y * y;
    probe_out_ = around + z * z <= r * r || (z < 0.0 && around > r * r);
  }
  hal::Function update_{function<&Sphereprobe::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Sphereprobe)
