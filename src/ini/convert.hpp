// Text to number, truth value and unit, by the rules of the newest LinuxCNC INI reader.
//
// Numbers: leading blanks and a sign are fine; integers also as 0x1F, 0b101, 0o17 (017 is 17);
// what follows the number is handed back, so that the caller decides whether it is worth a warning.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace kerf::ini {

/// A converted number. `valid` false: no number there, or too large for the type.
template <class T>
struct Number {
  T value{};
  bool valid{false};
  bool negated{false};    ///< a leading minus (of interest for unsigned: the value has wrapped)
  std::string_view rest;  ///< what follows the number, blanks included

  /// Characters are stuck to the number ("12abc", "1.5" read as an integer).
  [[nodiscard]] bool has_trailing() const {
    return !rest.empty() && rest[0] != ' ' && rest[0] != '\t';
  }
};

[[nodiscard]] Number<std::int64_t> to_int(std::string_view text);

/// "-3" is valid and wraps to 2^64 - 3, with `negated` set.
[[nodiscard]] Number<std::uint64_t> to_uint(std::string_view text);

/// Decimal or hexadecimal (0x1F, 0x1.8p3) real; "nan" and "inf" are not numbers. No locale.
[[nodiscard]] Number<double> to_real(std::string_view text);

/// TRUE YES ON 1 / FALSE NO OFF 0 in any case; nothing else may be there.
[[nodiscard]] std::optional<bool> to_bool(std::string_view text);

/// Millimetres per linear unit: "mm" or "metric" 1, "cm" 10, "inch", "in" or "imperial" 25.4; any
/// case. ([TRAJ]LINEAR_UNITS; LinuxCNC itself reports the reciprocal, units per mm.)
[[nodiscard]] std::optional<double> mm_per_unit(std::string_view name);

/// Degrees per angular unit: "deg" or "degree" 1, "rad" or "radian", "grad" or "gon"; any case.
[[nodiscard]] std::optional<double> deg_per_unit(std::string_view name);

/// Equal but for the case of ASCII letters.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

}  // namespace kerf::ini
