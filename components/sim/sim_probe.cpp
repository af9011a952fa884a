// sim_probe: a touch probe, or a tool setter, and the block that it meets.
#include <cmath>

#include "contact.hpp"
#include "hal/component.hpp"

namespace kerf::components {

class SimProbe final : public hal::Component<SimProbe> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-probe",
      .summary = "Simulated touch probe with bounce and delay",
      .notes =
          "Connect x, y and z to where the tip is (joint.N.pos-fb of a machine whose joints are "
          "its "
          "axes) and tripped to motion.probe-input. There is one block, from min-x to max-x and so "
          "on; a tip of radius touches it. tripped follows contact after delay and is unsteady for "
          "bounce after each change, always in the same way. contact is the truth, contacts counts "
          "the touches. Positions are in machine units. Run it after the motion controller."};
  using Component::Component;

 private:
  hal::In<double> x_{pin<hal::In<double>>("x", "Where the tip is")};
  hal::In<double> y_{pin<hal::In<double>>("y", "Where the tip is")};
  hal::In<double> z_{pin<hal::In<double>>("z", "Where the tip is")};
  hal::In<bool> connected_{
      pin<hal::In<bool>>("connected", "False: the plug is out and nothing is seen", true)};
  hal::In<bool> stuck_{pin<hal::In<bool>>("stuck", "True: tripped whatever it touches")};
  hal::Out<bool> tripped_{pin<hal::Out<bool>>("tripped", "What the controller sees")};
  hal::Out<bool> contact_{pin<hal::Out<bool>>("contact", "The tip touches the block")};
  hal::Out<std::uint32_t> contacts_{
      pin<hal::Out<std::uint32_t>>("contacts", "How often it has touched")};
  hal::Param<double> min_x_{param<hal::Param<double>>("min-x", "Block: lower end in X", 0.0)};
  hal::Param<double> max_x_{param<hal::Param<double>>("max-x", "Block: upper end in X", 0.0)};
  hal::Param<double> min_y_{param<hal::Param<double>>("min-y", "Block: lower end in Y", 0.0)};
  hal::Param<double> max_y_{param<hal::Param<double>>("max-y", "Block: upper end in Y", 0.0)};
  hal::Param<double> min_z_{param<hal::Param<double>>("min-z", "Block: lower end in Z", 0.0)};
  hal::Param<double> max_z_{param<hal::Param<double>>("max-z", "Block: upper end in Z", 0.0)};
  hal::Param<double> radius_{param<hal::Param<double>>("radius", "Radius of the tip", 0.0)};
  hal::Param<double> delay_s_{
      param<hal::Param<double>>("delay", "From contact to tripped [s]", 0.0)};
  hal::Param<double> bounce_s_{
      param<hal::Param<double>>("bounce", "Time tripped is unsteady after a change [s]", 0.0)};

  Contact output_;
  bool seen_{false};  // contact, after the delay
  double changing_s_{0.0};

  static double beyond(double at, double low, double high) noexcept {
    return at < low ? low - at : at > high ? at - high : 0.0;
  }

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const double dx = beyond(x_, min_x_, max_x_), dy = beyond(y_, min_y_, max_y_),
                 dz = beyond(z_, min_z_, max_z_);
    // A block without volume is no block.
    const bool block = min_x_ < max_x_ && min_y_ < max_y_ && min_z_ < max_z_;
    const bool touches = block && dx * dx + dy * dy + dz * dz <= radius_ * radius_;
    if (touches && !contact_.last()) contacts_ = contacts_.last() + 1;
    contact_ = touches;
    if (touches == seen_) {
      changing_s_ = 0.0;
    } else {
      if (changing_s_ + 0.5 * dt >= delay_s_) seen_ = touches;
      changing_s_ += dt;
    }
    tripped_ = stuck_ || (output_.step(seen_, dt, bounce_s_) && connected_);
  }
  hal::Function update_{function<&SimProbe::update>("", "Looks whether the tip touches")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimProbe)
