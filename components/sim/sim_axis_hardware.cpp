// sim_axis_hardware: home and limit switches of simulated axes.
#include <array>

#include "hal/component.hpp"

namespace kerf::components {

class SimAxisHardware final : public hal::Component<SimAxisHardware> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-axis-hardware",
      .summary = "Home and limit switches of simulated axes",
      .notes =
          "For each of X, X2, Y, Y2, Z, A, U and V: a home switch around homesw-pos and limit "
          "switches between a lower and an upper position, from the position of the joint. "
          "maxsw-homesw-out, minsw-homesw-out and bothsw-homesw-out of A stay false, as in "
          "LinuxCNC: take homesw-out and the limit switches of A."};

  explicit SimAxisHardware(hal::Builder& b) noexcept : Component(b) {
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      Axis& a = axes_[i];
      const auto name = [&](const char* suffix) {
        hal::Name whole(kAxes[i]);
        whole.append(suffix);
        return b.full_name(whole);
      };
      a.pos.declare(b, name("current-pos"), "Position of the joint, from joint.N.motor-pos-fb");
      a.home_pos.declare(b, name("homesw-pos"), "Middle of the home switch", 1.0);
      a.max_upper.declare(b, name("maxsw-upper"), "Upper end of the max limit switch");
      a.max_lower.declare(b, name("maxsw-lower"), "Lower end of the max limit switch");
      a.min_upper.declare(b, name("minsw-upper"), "Upper end of the min limit switch");
      a.min_lower.declare(b, name("minsw-lower"), "Lower end of the min limit switch");
      a.home_hyst.declare(b, name("homesw-hyst"),
                          "Width of the home switch: half of it on each side", 0.025);
      a.homing.declare(b, name("homing"), "True while the joint homes");
      a.home.declare(b, name("homesw-out"), "Home switch");
      a.max.declare(b, name("maxsw-out"), "Max limit switch");
      a.min.declare(b, name("minsw-out"), "Min limit switch");
      a.both.declare(b, name("bothsw-out"), "Either limit switch, while no joint homes");
      a.max_home.declare(b, name("maxsw-homesw-out"), "Max limit or home switch");
      a.min_home.declare(b, name("minsw-homesw-out"), "Min limit or home switch");
      a.both_home.declare(b, name("bothsw-homesw-out"),
                          "The home switch or, while no joint homes, either limit switch");
    }
  }

 private:
  static constexpr std::array<const char*, 8> kAxes{"X", "X2", "Y", "Y2", "Z", "A", "U", "V"};
  static constexpr std::size_t kOfA = 5;
  struct Axis {
    hal::In<double> pos, home_pos, max_upper, max_lower, min_upper, min_lower, home_hyst;
    hal::In<bool> homing;
    hal::Out<bool> home, max, min, both, max_home, min_home, both_home;
  };

  std::array<Axis, kAxes.size()> axes_{};
  hal::Out<bool> homesw_all_{
      pin<hal::Out<bool>>("homesw-all", "True while a joint homes and any home switch is closed")};
  hal::Out<bool> limitsw_all_{pin<hal::Out<bool>>(
      "limitsw-all", "True while no joint homes and any limit switch is closed")};
  hal::Out<bool> limitsw_homesw_all_{pin<hal::Out<bool>>(
      "limitsw-homesw-all", "The one of homesw-all and limitsw-all that counts now")};
  hal::In<double> limit_offset_{
      pin<hal::In<double>>("limit-offset",
                           "Moves the inner ends of the limit switches outwards: added to "
                           "maxsw-lower, taken off minsw-upper",
                           0.01)};

  void update(const hal::Period&) noexcept {
    bool any_home = false, any_limit = false, any_homing = false;
    for (const Axis& a : axes_) any_homing = any_homing || a.homing;
    const double offset = limit_offset_;
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      Axis& a = axes_[i];
      const double at = a.pos, half = 0.5 * a.home_hyst;
      const bool home = at >= a.home_pos - half && at <= a.home_pos + half;
      const bool max = at > a.max_lower + offset && at < a.max_upper;
      const bool min = at > a.min_lower && at < a.min_upper - offset;
      a.home = home;
      a.max = max;
      a.min = min;
      a.both = !any_homing && (max || min);
      if (i != kOfA) {
        a.max_home = max || home;
        a.min_home = min || home;
        a.both_home = home || (!any_homing && (max || min));
      }
      any_home = any_home || home;
      any_limit = any_limit || max || min;
    }
    // Switches that share an input: while a joint homes it is a home switch, else a limit switch.
    homesw_all_ = any_homing && any_home;
    limitsw_all_ = !any_homing && any_limit;
    limitsw_homesw_all_ = any_homing ? any_home : any_limit;
  }
  hal::Function update_{
      function<&SimAxisHardware::update>("update", "Computes all switches from the positions")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimAxisHardware)
