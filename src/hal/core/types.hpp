// The types, directions and limits of HAL, with the values that the published C API gives them.
#pragma once

#include <cstdint>
#include <string_view>

#include "rtapi/base/fixed_string.hpp"

namespace kerf::hal {

enum class Type : std::int32_t {
  unspecified = -1,
  bit = 1,
  floating = 2,
  s32 = 3,
  u32 = 4,
  port = 5,
  s64 = 6,
  u64 = 7
};
enum class Dir : std::int32_t { unspecified = -1, in = 16, out = 32, io = 48, ro = 64, rw = 192 };

inline constexpr std::size_t kNameLength = 55;
using Name = rtapi::FixedString<kNameLength>;

/// Every value is one 8-byte slot; the type never changes. bit: 0 or 1; s32 and u32 are kept as 32 bits, sign- or
/// zero-extended, so that any reader of the slot sees the value.
union Value {
  std::uint64_t raw;
  double f;
  std::int64_t s;
  std::uint64_t u;
};

template <class T>
struct TypeOf;
template <>
struct TypeOf<bool> {
  static constexpr Type kType = Type::bit;
};
template <>
struct TypeOf<double> {
  static constexpr Type kType = Type::floating;
};
template <>
struct TypeOf<std::int32_t> {
  static constexpr Type kType = Type::s32;
};
template <>
struct TypeOf<std::uint32_t> {
  static constexpr Type kType = Type::u32;
};
template <>
struct TypeOf<std::int64_t> {
  static constexpr Type kType = Type::s64;
};
template <>
struct TypeOf<std::uint64_t> {
  static constexpr Type kType = Type::u64;
};

template <class T>
constexpr std::uint64_t to_raw(T v) noexcept {
  Value slot{0};
  if constexpr (sizeof(T) == 1)
    slot.u = v ? 1 : 0;
  else if constexpr (TypeOf<T>::kType == Type::floating)
    slot.f = v;
  else if constexpr (TypeOf<T>::kType == Type::u32 || TypeOf<T>::kType == Type::u64)
    slot.u = v;
  else
    slot.s = v;
  return slot.raw;
}
template <class T>
constexpr T from_raw(std::uint64_t raw) noexcept {
  Value slot{raw};
  if constexpr (TypeOf<T>::kType == Type::bit)
    return slot.u != 0;
  else if constexpr (TypeOf<T>::kType == Type::floating)
    return slot.f;
  else if constexpr (TypeOf<T>::kType == Type::u32 || TypeOf<T>::kType == Type::u64)
    return static_cast<T>(slot.u);
  else
    return static_cast<T>(slot.s);
}

}  // namespace kerf::hal
