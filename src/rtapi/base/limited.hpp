// A number kept within bounds that users may have set to anything.
#pragma once

namespace kerf::rtapi {

/// @rt. std::clamp without its precondition: the bounds come from pins, and a lower one above the upper one must not be undefined
/// behaviour in a realtime thread. Then the upper one wins. What is not a number stays so.
[[nodiscard]] constexpr double limited(double value, double low, double high) noexcept {
  if (value < low) value = low;
  return value > high ? high : value;
}

}  // namespace kerf::rtapi
