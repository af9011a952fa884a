// Contact: a mechanical contact that bounces. The same edges at the same times give the same bounces: nothing is left to chance.
#pragma once

#include <cstdint>

namespace kerf::components {

class Contact {
 public:
  /// The contact's state one period later. `bounce_s`: how long it is unsteady after each change.
  bool step(bool touched, double dt, double bounce_s) noexcept {
    if (touched != touched_) {
      touched_ = touched;
      left_s_ = bounce_s;
      return touched;  // the first touch is always seen
    }
    if (!(left_s_ > 0.5 * dt)) return touched;
    left_s_ -= dt;
    // xorshift: bounces of uneven length.
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return (state_ >> 16U & 1U) != 0 ? touched : !touched;
  }

 private:
  bool touched_{false};
  double left_s_{0.0};
  std::uint32_t state_{2463534242U};
};

}  // namespace kerf::components
