// HAL values as text, in the forms that halcmd reads and prints.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/core/types.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// "bit", "float", "s32", "u32", "s64", "u64", "port"; "unknown".
std::string_view type_name(Type type) noexcept;
/// Type::unspecified for an unknown name.
Type type_from_name(std::string_view name) noexcept;
/// "IN", "OUT", "I/O", "RO", "RW".
std::string_view dir_name(Dir dir) noexcept;
Dir dir_from_name(std::string_view name) noexcept;

/// As `show` prints: TRUE/FALSE, %.7g, decimal, u32 0x%08X, u64 0x%016X.
std::string value_text(Type type, std::uint64_t raw);
/// As `getp`, `gets` and `-s` print: unsigned in decimal.
std::string plain_value_text(Type type, std::uint64_t raw);

/// Reads a value as setp and sets do: bit 0, 1, TRUE, FALSE in any case; integers decimal, 0x and 0 octal; floats as strtod.
/// A port: the size of its queue. Bit patterns are allowed (u32 from -1, s32 from 0xFFFFFFFF), anything that does not fit 32 or 64 bits is an error.
rtapi::Result<std::uint64_t> parse_value(Type type, std::string_view text);

}  // namespace kerf::hal
