// The filter of dbounce and debounce.
#pragma once

#include <cstdint>

#include "hal/component.hpp"

namespace kerf::components {

/// Counts up while the input is true and down while it is false.
class BounceFilter {
 public:
  /// The output changes when the count has come to `delay`, or to zero, and one more call says the same.
  void update(const hal::In<bool>& in, hal::Out<bool>& out, std::int64_t delay) noexcept {
    if (in) {
      if (count_ < delay)
        ++count_;
      else
        out = true;
    } else {
      if (count_ > 0)
        --count_;
      else
        out = false;
    }
  }

 private:
  std::int64_t count_{0};
};

}  // namespace kerf::components
