// eoffset_per_angle: external offset that follows an angle.
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class EoffsetPerAngle final : public hal::Component<EoffsetPerAngle> {
 public:
  static constexpr hal::Info kInfo{
      .name = "eoffset-per-angle",
      .summary = "External offset that follows an angle",
      .notes =
          "Makes polygons, waves and squares of a turning part. k is the number of counts of one "
          "unit; kreciprocal is the scale for the axis. When enable-in goes, or the settings of a "
          "function are wrong, the offset is taken back. Behind wrong settings, and when the "
          "machine "
          "has been off, enable-in must become false before it acts again."};
  using Component::Component;

 private:
  hal::In<bool> active_{pin<hal::In<bool>>("active", "From motion.eoffset-active", false)};
  hal::In<bool> is_on_{pin<hal::In<bool>>("is-on", "From halui.machine.is-on", false)};
  hal::In<bool> enable_in_{pin<hal::In<bool>>("enable-in", "True follows the angle", false)};
  hal::In<double> radius_ref_{pin<hal::In<double>>("radius-ref", "Radius of the part", 1)};
  hal::In<double> angle_{pin<hal::In<double>>("angle", "Angle of the part [degrees]", 0)};
  hal::In<double> start_angle_{
      pin<hal::In<double>>("start-angle", "Angle of the middle of a side [degrees]", 0)};
  hal::In<std::int32_t> fnum_{pin<hal::In<std::int32_t>>(
      "fnum", "0 polygon around the circle, 1 polygon within it, 2 wave, 3 square wave", 0)};
  hal::In<double> rfraction_{
      pin<hal::In<double>>("rfraction", "Height of the offset as a fraction of radius-ref", 0.1)};
  hal::In<double> fmult_{
      pin<hal::In<double>>("fmult", "Sides of the polygon, or waves of a revolution", 6)};
  hal::In<std::uint32_t> k_{
      pin<hal::In<std::uint32_t>>("k", "Counts of one unit; 0 is taken for 10000", 10000)};
  hal::Out<bool> is_off_{pin<hal::Out<bool>>("is-off", "The opposite of is-on")};
  hal::Out<bool> enable_out_{pin<hal::Out<bool>>("enable-out", "For axis.L.eoffset-enable")};
  hal::Out<bool> clear_{pin<hal::Out<bool>>("clear", "For axis.L.eoffset-clear")};
  hal::Out<std::int32_t> kcounts_{
      pin<hal::Out<std::int32_t>>("kcounts", "For axis.L.eoffset-counts")};
  hal::Out<double> kreciprocal_{
      pin<hal::Out<double>>("kreciprocal", "1 / k, for axis.L.eoffset-scale")};
  hal::Out<double> eoffset_dbg_{pin<hal::Out<double>>("eoffset-dbg", "The offset")};
  hal::Out<std::uint32_t> state_dbg_{pin<hal::Out<std::uint32_t>>(
      "state-dbg",
      "0 waits for enable-in to be false, 1 waits, 2 follows the angle, 3 waits for the offset to "
      "be taken back, 4 it is")};

  bool compute(double& offset) const noexcept {
    constexpr double kPi = 3.14159265358979323846;
    const double radius = radius_ref_, height = radius * rfraction_, waves = fmult_;
    const double angle_from_start = angle_ - start_angle_;
    if (fnum_ == 2 || fnum_ == 3) {
      const double wave = std::sin((angle_from_start * waves - 90.0) * kPi / 180.0);
      if (fnum_ == 2)
        offset = height * (1.0 + wave) / 2.0;
      else
        offset = wave >= 0.0 ? height : 0.0;
      return true;
    }
    if (!(waves >= 3.0)) return false;
    // From the middle of the nearest side; a corner is half a side away.
    const double side = 360.0 / waves, from_middle = std::remainder(angle_from_start, side);
    double inner = radius * (1.0 + rfraction_);
    if (fnum_ == 1) inner *= std::cos(0.5 * side * kPi / 180.0);
    offset = inner / std::cos(from_middle * kPi / 180.0) - radius;
    return true;
  }
  enum class State : std::uint32_t { disabled, waits, follows, returns, returned };
  State state_{State::disabled};
  bool wrong_{false};

  void show(double offset, double k) noexcept {
    const auto counts =
        static_cast<std::int32_t>(rtapi::limited(offset * k, -2147483648.0, 2147483647.0));
    kcounts_ = counts;
    eoffset_dbg_ = counts / k;
  }
  void update(const hal::Period&) noexcept {
    const bool enable = enable_in_, is_on = is_on_;
    const double k = k_ == 0 ? 10000.0 : static_cast<double>(k_.get());
    is_off_ = !is_on;
    kreciprocal_ = 1.0 / k;
    state_dbg_ = static_cast<std::uint32_t>(state_);
    if (!is_on) {
      enable_out_ = false;
      show(0.0, k);
      state_ = State::disabled;
      return;
    }
    switch (state_) {
      case State::disabled:
        if (!enable) state_ = State::waits;
        break;
      case State::waits:
        if (enable) state_ = State::follows;
        break;
      case State::follows: {
        double offset = 0.0;
        if (!enable)
          clear_ = true;
        else
          enable_out_ = true;
        wrong_ = enable && !compute(offset);
        if (!enable || wrong_) state_ = State::returns;
        show(enable && !wrong_ ? offset : 0.0, k);
        break;
      }
      case State::returns:
        if (!active_) state_ = State::returned;
        break;
      case State::returned:
        clear_ = false;
        enable_out_ = false;
        state_ = wrong_ ? State::disabled : State::waits;
        break;
    }
  }
  hal::Function update_{
      function<&EoffsetPerAngle::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::EoffsetPerAngle)
