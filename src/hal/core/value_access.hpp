// Reading and writing a HAL value in memory, in the width of its type: C code reads and writes only so many bytes.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "hal/core/types.hpp"

namespace kerf::hal {

static_assert(std::endian::native == std::endian::little,
              "the narrow values stand in the first bytes of their slots");

/// Bytes that a value of the type has: 1, 4 or 8.
constexpr std::size_t value_bytes(Type type) noexcept {
  switch (type) {
    case Type::bit: return 1;
    case Type::s32:
    case Type::u32:
    case Type::port: return 4;
    default: return 8;
  }
}

/// Relaxed, as all values of HAL: each stands alone.
inline std::uint64_t load_value(Type type, const void* at) noexcept {
  const auto load = [at]<class T>(T) {
    return reinterpret_cast<const std::atomic<T>*>(at)->load(std::memory_order_relaxed);
  };
  switch (value_bytes(type)) {
    case 1: return load(std::uint8_t{}) != 0 ? 1 : 0;
    case 4:
      return type == Type::s32 ? to_raw(static_cast<std::int32_t>(load(std::uint32_t{})))
                               : load(std::uint32_t{});
    default: return load(std::uint64_t{});
  }
}

/// Writes as many bytes as the C type has. A whole slot is better written whole: store_slot().
inline void store_value(Type type, void* at, std::uint64_t raw) noexcept {
  const auto store = [at]<class T>(T v) {
    reinterpret_cast<std::atomic<T>*>(at)->store(v, std::memory_order_relaxed);
  };
  switch (value_bytes(type)) {
    case 1: store(static_cast<std::uint8_t>(raw != 0)); break;
    case 4: store(static_cast<std::uint32_t>(raw)); break;
    default: store(raw); break;
  }
}

/// A slot made of plain memory, for handles of items that stand in no segment.
inline std::atomic<std::uint64_t>& slot_of(std::uint64_t& word) noexcept {
  return reinterpret_cast<std::atomic<std::uint64_t>&>(word);
}

/// Writes all 8 bytes of a slot.
inline void store_slot(void* at, std::uint64_t raw) noexcept {
  reinterpret_cast<std::atomic<std::uint64_t>*>(at)->store(raw, std::memory_order_relaxed);
}

}  // namespace kerf::hal
