// sim_home_switch: a home switch for a simulated joint.
#include "hal/component.hpp"

namespace kerf::components {

class SimHomeSwitch final : public hal::Component<SimHomeSwitch> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-home-switch",
      .summary = "Home switch simulator",
      .notes =
          "A switch that closes at home-pos, seen from the machine's middle: for home-pos of zero "
          "and "
          "above at and beyond it in positive direction, for a negative home-pos at and beyond it "
          "in "
          "negative direction. It opens again after a travel of hysteresis back from home-pos. "
          "index-enable is for joints that home to an index pulse: some time after it was set, it "
          "is "
          "cleared as an encoder would do at the pulse. It has to be false in some call before it "
          "is "
          "waited for again."};
  using Component::Component;

 private:
  hal::In<double> cur_pos_{
      pin<hal::In<double>>("cur-pos", "Position of the joint, normally joint.N.motor-pos-fb")};
  hal::In<double> home_pos_{pin<hal::In<double>>("home-pos", "Where the switch closes", 1.0)};
  hal::In<double> hysteresis_{
      pin<hal::In<double>>("hysteresis", "Travel back from home-pos until the switch opens", 0.1)};
  hal::Out<bool> home_sw_{pin<hal::Out<bool>>("home-sw", "True while the switch is closed")};
  hal::Io<bool> index_enable_{
      pin<hal::Io<bool>>("index-enable", "Cleared index-delay-ms after it was set")};
  hal::In<double> index_delay_ms_{pin<hal::In<double>>(
      "index-delay-ms", "Time from index-enable to the simulated index pulse, above 0 [ms]", 10.0)};
  double left_ms_{0.0};
  bool asked_before_{false};

  void update(const hal::Period& period) noexcept {
    update_switch();
    update_index(period.nominal_ns);
  }

  void update_switch() noexcept {
    // Mirrored, so that the switch closes upwards for either sign.
    const double sign = home_pos_ < 0.0 ? -1.0 : 1.0;
    const double at = sign * cur_pos_, home = sign * home_pos_;
    if (at >= home) home_sw_ = true;
    if (at < home && at <= home - hysteresis_) home_sw_ = false;
  }

  void update_index(std::int64_t period_ns) noexcept {
    const bool asked = index_enable_, rose = asked && !asked_before_;
    asked_before_ = asked;
    if (rose) {
      left_ms_ = index_delay_ms_;
    } else if (asked && left_ms_ > 0.0) {
      left_ms_ -= static_cast<double>(period_ns) * 1e-6;
      if (left_ms_ <= 1e-9) {
        left_ms_ = 0.0;
        index_enable_ = false;
      }
    }
  }
  hal::Function update_{
      function<&SimHomeSwitch::update>("", "Computes home-sw and clears index-enable in time")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimHomeSwitch)
