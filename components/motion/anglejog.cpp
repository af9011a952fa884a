// anglejog: jogs two axes along a line at an angle.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Anglejog final : public hal::Component<Anglejog> {
 public:
  static constexpr hal::Info kInfo{
      .name = "anglejog",
      .summary = "Jogs two axes along a line at an angle",
      .notes =
          "scale-in, angle-degrees-in and iscale-factor are read while enable-in is false; what is "
          "no iscale-factor is left alone once it has run. The counts for the two axes are "
          "iscale-factor times as fine as those of the wheel, and "
          "current-scale-out is their scale."};
  using Component::Component;

 private:
  hal::In<bool> enable_in_{pin<hal::In<bool>>("enable-in", "True lets the wheel move the axes")};
  hal::In<std::int32_t> counts_in_{pin<hal::In<std::int32_t>>("counts-in", "Counts of the wheel")};
  hal::In<double> angle_degrees_in_{
      pin<hal::In<double>>("angle-degrees-in", "Angle of the line from the first axis [degrees]")};
  hal::In<std::int32_t> iscale_factor_{pin<hal::In<std::int32_t>>(
      "iscale-factor", "Fine counts of one count of the wheel, 10 to 100000", 10000)};
  hal::In<double> scale_in_{pin<hal::In<double>>("scale-in", "Length of one count of the wheel")};
  hal::In<double> max_vel_{
      pin<hal::In<double>>("max-vel", "Highest speed along the line [units per second]")};
  hal::In<double> max_accel_{
      pin<hal::In<double>>("max-accel", "Acceleration along the line [units per second^2]")};
  hal::In<double> accel_fraction_in_{
      pin<hal::In<double>>("accel-fraction-in", "Fraction of the axes' acceleration to use", 1)};
  hal::Out<bool> enable_out_{pin<hal::Out<bool>>("enable-out", "For jog-enable of both axes")};
  hal::Out<double> current_scale_{
      pin<hal::Out<double>>("current-scale", "Length of one count of the wheel in use")};
  hal::Out<double> current_scale_out_{
      pin<hal::Out<double>>("current-scale-out", "For jog-scale of both axes")};
  hal::Out<std::int32_t> coscounts_{
      pin<hal::Out<std::int32_t>>("coscounts", "For jog-counts of the first axis")};
  hal::Out<std::int32_t> sincounts_{
      pin<hal::Out<std::int32_t>>("sincounts", "For jog-counts of the second axis")};
  hal::Out<double> cos_accel_fraction_{
      pin<hal::Out<double>>("cos-accel-fraction", "For jog-accel-fraction of the first axis")};
  hal::Out<double> sin_accel_fraction_{
      pin<hal::Out<double>>("sin-accel-fraction", "For jog-accel-fraction of the second axis")};
  hal::Out<bool> active_{pin<hal::Out<bool>>("active", "True while it moves")};
  hal::Out<double> current_angle_degrees_{
      pin<hal::Out<double>>("current-angle-degrees", "Angle in use [degrees]")};
  hal::Out<double> current_mag_{pin<hal::Out<double>>("current-mag", "Way along the line")};
  hal::Out<double> current_vel_{
      pin<hal::Out<double>>("current-vel", "Speed along the line [units per second]")};

  static std::int32_t whole(double counts) noexcept {
    return static_cast<std::int32_t>(rtapi::limited(counts, -2147483648.0, 2147483647.0));
  }
  double scale_{0.0}, cosine_{1.0}, sine_{0.0}, target_{0.0}, way_{0.0}, speed_{0.0},
      counts_before_{0.0};
  static constexpr std::int32_t kLeastFine = 10, kMostFine = 100000;
  std::int32_t fine_{10000};
  bool enabled_before_{false}, awaits_{false}, first_{true};

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const bool enable = enable_in_;
    const std::int32_t counts = counts_in_;
    if (!enable || first_) {
      scale_ = scale_in_;
      const std::int32_t fine = iscale_factor_;
      if ((fine >= kLeastFine && fine <= kMostFine) || (first_ && fine != 0)) fine_ = fine;
      first_ = false;
      current_scale_ = scale_;
      current_scale_out_ = scale_ / fine_;
      if (speed_ == 0.0) target_ = way_;
      const double radians = angle_degrees_in_ * (3.14159265358979323846 / 180.0);
      cosine_ = std::cos(radians);
      sine_ = std::sin(radians);
      current_angle_degrees_ = angle_degrees_in_.get();
    } else if (enable && enabled_before_) {
      target_ += (static_cast<double>(counts) - counts_before_) * scale_;
    }
    // Enabled, it stands still until the first count, as LinuxCNC's does.
    if (enable && !enabled_before_) {
      awaits_ = true;
      // From whole counts for the axes on.
      const double fine_scale = scale_ / fine_;
      target_ = scale_ != 0.0 ? std::trunc(way_ / fine_scale) * fine_scale : way_;
    } else if (counts != counts_before_) {
      awaits_ = false;
    }
    counts_before_ = counts;
    enable_out_ = enable;
    const double accel = std::fabs(max_accel_), step = accel * dt, missing = target_ - way_;
    double wanted = 0.0;
    if (enable && std::fabs(missing) > step * dt * 0.001)
      wanted =
          std::copysign(std::sqrt(2.0 * accel * std::fabs(missing) + step * step) - step, missing);
    wanted = rtapi::limited(wanted, -std::fabs(max_vel_), std::fabs(max_vel_));
    if (!awaits_) {
      speed_ = rtapi::limited(wanted, speed_ - step, speed_ + step);
      way_ += speed_ * dt;
      cos_accel_fraction_ = cosine_ * accel_fraction_in_;
      sin_accel_fraction_ = sine_ * accel_fraction_in_;
      current_vel_ = speed_;
    }
    active_ = !awaits_ && (wanted != 0.0 || speed_ != 0.0);
    enabled_before_ = enable;
    current_mag_ = way_;
    if (scale_ != 0.0 && !awaits_) {
      const double fine_scale = scale_ / fine_;
      coscounts_ = whole(way_ * cosine_ / fine_scale);
      sincounts_ = whole(way_ * sine_ / fine_scale);
    }
  }
  hal::Function update_{function<&Anglejog::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Anglejog)
