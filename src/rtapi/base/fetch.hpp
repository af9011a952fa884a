// Memory that is far from the caches and will be needed soon.
#pragma once

#include <cstddef>

namespace kerf::rtapi {

inline constexpr std::size_t kCacheLine = 64;

/// @rt. Begins to fetch the lines of `bytes` bytes; nobody waits, and no address is wrong.
inline void fetch(const void* memory, std::size_t bytes) noexcept {
  const auto* const at = static_cast<const std::byte*>(memory);
  for (std::size_t i = 0; i < bytes; i += kCacheLine) __builtin_prefetch(at + i);
  __builtin_prefetch(at + bytes - 1);
}
/// The same for who is going to write there.
inline void fetch_to_write(const void* memory, std::size_t bytes) noexcept {
  const auto* const at = static_cast<const std::byte*>(memory);
  for (std::size_t i = 0; i < bytes; i += kCacheLine) __builtin_prefetch(at + i, 1);
  __builtin_prefetch(at + bytes - 1, 1);
}

}  // namespace kerf::rtapi
