// Random programs for the mill of configs/sim/mill: all that they ask for is within its limits.
#pragma once

#include <cstdint>
#include <string>

namespace kerf::soak {

/// Numbers that are the same everywhere for the same seed (splitmix64).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }
  /// 0 to n - 1.
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11U) * 0x1.0p-53;
  }
  bool one_in(int n) { return below(n) == 0; }

 private:
  std::uint64_t state_;
};

struct Program {
  std::string text;
  bool is_sound{true};  ///< it runs to its end when nobody disturbs it
  bool asks{false};     ///< M0, M1: somebody has to resume it
};

/// A whole program, some 5 to 60 blocks.
[[nodiscard]] Program random_program(Dice& dice);
/// One MDI line; not every one is valid.
[[nodiscard]] std::string random_mdi(Dice& dice);

}  // namespace kerf::soak
