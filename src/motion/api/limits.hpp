// How many of each a machine may have.
#pragma once

#include <cstddef>

namespace kerf::motion {

inline constexpr std::size_t kMaxJoints = 16;
inline constexpr std::size_t kMaxSpindles = 8;
inline constexpr std::size_t kMaxDigital = 64;
inline constexpr std::size_t kMaxAnalog = 64;

}  // namespace kerf::motion
