// The arc of a plasma torch, for plasmac: its voltage, whether it burns, and how far the torch shall move for it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace kerf::components {

/// Input to volts, with the filter. @rt.
class ArcVoltage {
 public:
  double follow(double volts, double corner_hz, double dt) noexcept {
    if (corner_hz > 0.0 && begun_)
      volts_ += (volts - volts_) * (1.0 - std::exp(-2.0 * std::numbers::pi * corner_hz * dt));
    else
      volts_ = volts;
    begun_ = true;
    return std::round(volts_ * 1000.0) * 0.001;
  }

 private:
  double volts_{0.0};
  bool begun_{false};
};

/// Mode 0: a good arc is one whose voltage lies in the range, and whose last readings all lie near the present one. Without height
/// control it is lost with the first reading out of the range, else with as many as make a good arc. @rt.
class ArcDetector {
 public:
  /// More readings than these are not looked at.
  static constexpr std::int32_t kMostReadings = 1000;

  void reset() noexcept { readings_.fill(0.0); }
  void off() noexcept { ok_ = false; }
  bool follow(double volts, double low, double high, double most_change, std::int32_t counts,
              bool height_control) noexcept {
    last_ = (last_ + 1) % kMostReadings;
    readings_[static_cast<std::size_t>(last_)] = volts;
    const auto outside = [&](double v) { return v <= low || v >= high; };
    if (outside(volts)) {
      ok_ = ok_ && height_control && !all_of_last(counts, outside);
    } else if (!ok_) {
      ok_ = all_of_last(counts, [&](double v) { return std::fabs(v - volts) <= most_change; });
    }
    return ok_;
  }

 private:
  [[nodiscard]] double reading(std::int32_t cycles_ago) const noexcept {
    return readings_[static_cast<std::size_t>((last_ + kMostReadings - cycles_ago) %
                                              kMostReadings)];
  }
  template <class Test>
  [[nodiscard]] bool all_of_last(std::int32_t counts, Test is) const noexcept {
    std::int32_t i = 0;
    while (i < std::min(counts, kMostReadings) && is(reading(i))) ++i;
    return i >= std::min(counts, kMostReadings);
  }

  std::array<double, kMostReadings> readings_{};
  std::int32_t last_{0};
  bool ok_{false};
};

/// Readings in a row that are near each other. @rt.
class SteadyVoltage {
 public:
  void reset() noexcept { count_ = 0; }
  bool follow(double volts, double most_change, std::int32_t counts) noexcept {
    if (std::fabs(volts - last_) > most_change)
      count_ = 0;
    else if (count_ < counts)
      ++count_;
    last_ = volts;
    return count_ >= counts;
  }

 private:
  double last_{0.0};
  std::int32_t count_{0};
};

/// A steep change of the voltage tells that the torch runs over a void. @rt.
class VoidDetector {
 public:
  void reset() noexcept { *this = VoidDetector{}; }
  bool follow(double volts, double dt, std::int32_t slope, std::int32_t on,
              std::int32_t off) noexcept {
    const bool steep = has_last_ && (volts - last_) / dt > slope;
    last_ = volts;
    has_last_ = true;
    steep_ = steep ? steep_ + 1 : 0;
    calm_ = steep ? 0 : calm_ + 1;
    if (steep_ > on) locked_ = true;
    if (calm_ >= off) locked_ = false;
    return locked_;
  }

 private:
  double last_{0.0};
  std::int32_t steep_{0}, calm_{0};
  bool has_last_{false}, locked_{false};
};

/// Counts of the offset of z for an error of the voltage. @rt.
class HeightPid {
 public:
  void reset() noexcept { last_error_ = 0.0; }
  double follow(double error, double p, double i, double d, double dt) noexcept {
    const double change = (error - last_error_) / dt;
    last_error_ = error;
    return p * error + i * error * dt + d * change;
  }

 private:
  double last_error_{0.0};
};

}  // namespace kerf::components
