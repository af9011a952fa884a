// LostCycles: in how many of the last cycles something was lost. @rt, O(1) a cycle.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace kerf::motion {

class LostCycles {
 public:
  static constexpr std::int32_t kMostCycles = 8192;

  /// Of how many cycles; forgets all of them.
  void begin(std::int32_t window) noexcept {
    window_ = std::clamp(window, 1, kMostCycles);
    std::fill(std::begin(bits_), std::end(bits_), 0);
    at_ = count_ = 0;
  }
  void note(bool lost) noexcept {
    const auto n = static_cast<std::size_t>(at_);
    at_ = at_ + 1 < window_ ? at_ + 1 : 0;
    if (!lost && count_ == 0) return;  // as on most machines for ever
    std::uint64_t& word = bits_[n / 64];
    const std::uint64_t bit = std::uint64_t{1} << n % 64;
    count_ += (lost ? 1 : 0) - ((word & bit) != 0 ? 1 : 0);
    word = lost ? word | bit : word & ~bit;
  }
  [[nodiscard]] std::int32_t count() const noexcept { return count_; }

 private:
  std::int32_t window_{1}, at_{0}, count_{0};
  std::uint64_t bits_[kMostCycles / 64]{};
};

}  // namespace kerf::motion
