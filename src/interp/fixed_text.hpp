// A double as text with a fixed number of decimals: exactly what printf writes, in a tenth of its time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace kerf::interp {

/// Longest text that write_fixed() makes: sign, 309 digits, point, decimals.
inline constexpr std::size_t kLongestFixed = 328;

/// Writes the digits of `n`; returns the end.
inline char* write_digits(char* to, std::uint64_t n) noexcept {
  char digits[20];
  char* at = digits + sizeof digits;
  do {
    *--at = static_cast<char>('0' + n % 10);
    n /= 10;
  } while (n != 0);
  const auto length = static_cast<std::size_t>(digits + sizeof digits - at);
  std::memcpy(to, at, length);
  return to + length;
}

/// Writes `value` as printf("%.*f", Decimals, value) does and returns the end; `to` has room for kLongestFixed.
/// The exact binary value is rounded, ties to even; the sign of zero is kept. Large values and what is no number go to printf itself.
template <int Decimals>
char* write_fixed(char* to, double value) noexcept {
  static_assert(Decimals >= 1 && Decimals <= 6);
  constexpr std::uint64_t kScale = [] {
    std::uint64_t s = 1;
    for (int i = 0; i < Decimals; ++i) s *= 10;
    return s;
  }();
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int exponent = static_cast<int>(bits >> 52 & 0x7FF) - 1075;
  // Below 2^40 the scaled value fits 64 bits: 40 + 20. Nothing is shifted left, so the exponent is negative here.
  if (exponent >= 40 - 52) return to + std::snprintf(to, kLongestFixed, "%.*f", Decimals, value);
  if ((bits >> 63) != 0) *to++ = '-';
  std::uint64_t scaled = 0;
  const int shift = -exponent;
  if (shift < 76) {  // smaller values are below half of the last decimal; so are all subnormal ones
    const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
    __extension__ using Wide = unsigned __int128;
    const Wide exact = Wide{mantissa} * kScale;
    scaled = static_cast<std::uint64_t>(exact >> shift);
    const Wide half = Wide{1} << (shift - 1);
    const Wide rest = exact & ((Wide{1} << shift) - 1);
    if (rest > half || (rest == half && (scaled & 1) != 0)) ++scaled;
  }
  const std::uint64_t whole = scaled / kScale;
  auto fraction = static_cast<std::uint32_t>(scaled - whole * kScale);
  if (whole < 10)
    *to++ = static_cast<char>('0' + whole);
  else
    to = write_digits(to, whole);
  *to = '.';
  for (int i = Decimals; i > 0; --i) {
    to[i] = static_cast<char>('0' + fraction % 10);
    fraction /= 10;
  }
  return to + Decimals + 1;
}

}  // namespace kerf::interp
