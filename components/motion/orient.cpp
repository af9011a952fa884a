// orient: target position for turning a spindle to an angle.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Orient final : public hal::Component<Orient> {
 public:
  static constexpr hal::Info kInfo{.name = "orient",
                                   .summary = "Target position for turning a spindle to an angle",
                                   .notes =
                                       "At a rising edge of enable the target is computed from the "
                                       "spindle's position; a position loop then follows command. "
                                       "A spindle that swings through the angle is not oriented "
                                       "yet: is-oriented comes after 100 calls within tolerance."};
  using Component::Component;

 private:
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "A rising edge computes command")};
  hal::In<std::int32_t> mode_{pin<hal::In<std::int32_t>>(
      "mode", "0 the short way, 1 clockwise (upwards), 2 counterclockwise")};
  hal::In<double> position_{
      pin<hal::In<double>>("position", "Position of the spindle [revolutions]")};
  hal::In<double> angle_{pin<hal::In<double>>("angle", "Angle to turn to [degrees]")};
  hal::Out<double> command_{pin<hal::Out<double>>("command", "Target position [revolutions]")};
  hal::Out<double> poserr_{pin<hal::Out<double>>("poserr", "Position minus target [degrees]")};
  hal::Out<bool> is_oriented_{pin<hal::Out<bool>>(
      "is-oriented",
      "True after 100 calls with the error below tolerance; stays so until enable is false")};
  hal::In<double> tolerance_{
      pin<hal::In<double>>("tolerance", "Largest error that counts as oriented [degrees]", 0.5)};
  static constexpr int kCalls = 100;
  int calls_within_{0};
  bool before_{false};

  void update(const hal::Period&) noexcept {
    const bool enable = enable_;
    const double position = position_;
    if (enable && !before_) {
      // However many turns the angle has, the way is less than one, or half of one: half a turn goes upwards.
      const double target = std::floor(position) + angle_ / 360.0;
      const double way = target - position;
      const double turns = mode_ == 1   ? std::floor(way)
                           : mode_ == 2 ? std::ceil(way)
                                        : std::ceil(way - 0.5);
      command_ = target - turns;
    }
    before_ = enable;
    if (enable) {
      const double error = (position - command_.last()) * 360.0;
      poserr_ = error;
      if (std::fabs(error) < tolerance_) {
        is_oriented_ = is_oriented_.last() || calls_within_ >= kCalls;
        if (calls_within_ < kCalls) ++calls_within_;
      }
    } else {
      is_oriented_ = false;
      calls_within_ = 0;
    }
  }
  hal::Function update_{function<&Orient::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Orient)
