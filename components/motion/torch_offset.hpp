// What thc and thcud share: the offset of a torch's z.
#pragma once

#include <algorithm>

namespace kerf::components {

/// True while the torch moves within `tolerance` percent of the requested speed.
[[nodiscard]] inline bool at_cutting_speed(double current, double requested,
                                           double tolerance) noexcept {
  return current > 0.0 && current >= requested * (1.0 - tolerance / 100.0);
}

class TorchOffset {
 public:
  [[nodiscard]] double value() const noexcept { return value_; }
  void add(double change) noexcept { value_ += change; }
  /// Once a call, with the commanded z.
  void follow(double z) noexcept {
    climbed_ = z - before_;
    before_ = z;
  }
  /// In a call with the torch on.
  void burns() noexcept { burnt_ = true; }
  /// Takes the offset back no faster than z moves up, from the second call with the torch off on. True while there is
  /// something to take.
  bool take_back() noexcept {
    if (burnt_) {
      burnt_ = false;
      return false;
    }
    if (value_ == 0.0 || climbed_ <= 0.0) return false;
    value_ = value_ > 0.0 ? std::max(0.0, value_ - climbed_) : std::min(0.0, value_ + climbed_);
    return true;
  }

 private:
  double value_{0.0}, before_{0.0}, climbed_{0.0};
  bool burnt_{false};
};

}  // namespace kerf::components
