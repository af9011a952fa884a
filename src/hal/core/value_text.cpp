#include "hal/core/value_text.hpp"

#include <strings.h>

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>

namespace kerf::hal {
namespace {

struct TypeRow {
  Type type;
  const char* name;
  const char* label;  ///< in messages about bad values
};
constexpr TypeRow kTypes[] = {{Type::bit, "bit", "bit"},   {Type::floating, "float", "float"},
                              {Type::s32, "s32", "S32"},   {Type::u32, "u32", "U32"},
                              {Type::s64, "s64", "S64"},   {Type::u64, "u64", "U64"},
                              {Type::port, "port", "PORT"}};

struct DirRow {
  Dir dir;
  const char* name;
};
constexpr DirRow kDirs[] = {
    {Dir::in, "IN"}, {Dir::out, "OUT"}, {Dir::io, "I/O"}, {Dir::ro, "RO"}, {Dir::rw, "RW"}};

const char* label(Type type) {
  for (const auto& row : kTypes) {
    if (row.type == type) return row.label;
  }
  return "unknown";
}

rtapi::Failure<rtapi::Error> invalid(Type type, const std::string& text, const char* why = "") {
  return rtapi::fail(
      rtapi::Errc::bad_argument,
      rtapi::format_fixed<480>("value '%.200s' invalid for %s%s", text.c_str(), label(type), why));
}

/// Integers of `bits` width. A negative number is the bit pattern of an unsigned one and the other way round.
rtapi::Result<std::uint64_t> parse_integer(Type type, const std::string& text, bool is_signed,
                                           int bits) {
  if (text.empty() || std::isspace(static_cast<unsigned char>(text[0])) != 0)
    return invalid(type, text);
  char* end = nullptr;
  errno = 0;
  const bool negative = text[0] == '-';
  std::uint64_t raw = 0;
  if (negative) {
    raw = static_cast<std::uint64_t>(std::strtoll(text.c_str(), &end, 0));
  } else {
    raw = std::strtoull(text.c_str(), &end, 0);
  }
  if (end == text.c_str() || *end != '\0') return invalid(type, text);
  if (errno == ERANGE) return invalid(type, text, " (out of range)");
  const bool hex = text.find_first_of("xX") != std::string::npos;
  if (bits == 64) {
    if (is_signed && !negative && !hex && raw > INT64_MAX)
      return invalid(type, text, " (out of range)");
    return raw;
  }
  const auto value = static_cast<std::int64_t>(raw);
  if (value > INT64_C(0xFFFFFFFF) || value < INT32_MIN)
    return invalid(type, text, " (out of range)");
  if (!negative && value < 0) return invalid(type, text, " (out of range)");
  if (is_signed && value > INT32_MAX && !hex) return invalid(type, text, " (out of range)");
  if (is_signed) return to_raw(static_cast<std::int32_t>(static_cast<std::uint32_t>(raw)));
  return to_raw(static_cast<std::uint32_t>(raw));
}

}  // namespace

std::string_view type_name(Type type) noexcept {
  for (const auto& row : kTypes) {
    if (row.type == type) return row.name;
  }
  return "unknown";
}

Type type_from_name(std::string_view name) noexcept {
  for (const auto& row : kTypes) {
    if (name == row.name) return row.type;
  }
  return Type::unspecified;
}

std::string_view dir_name(Dir dir) noexcept {
  for (const auto& row : kDirs) {
    if (row.dir == dir) return row.name;
  }
  return "???";
}

Dir dir_from_name(std::string_view name) noexcept {
  for (const auto& row : kDirs) {
    if (name == row.name) return row.dir;
  }
  return Dir::unspecified;
}

std::string plain_value_text(Type type, std::uint64_t raw) {
  char text[40];
  switch (type) {
    case Type::bit: return raw != 0 ? "TRUE" : "FALSE";
    case Type::floating: std::snprintf(text, sizeof text, "%.7g", from_raw<double>(raw)); break;
    case Type::s32:
    case Type::s64:
      std::snprintf(text, sizeof text, "%" PRId64, from_raw<std::int64_t>(raw));
      break;
    default: std::snprintf(text, sizeof text, "%" PRIu64, raw); break;
  }
  return text;
}

std::string value_text(Type type, std::uint64_t raw) {
  char text[40];
  if (type == Type::u32) {
    std::snprintf(text, sizeof text, "0x%08" PRIX64, raw);
  } else if (type == Type::u64) {
    std::snprintf(text, sizeof text, "0x%016" PRIX64, raw);
  } else {
    return plain_value_text(type, raw);
  }
  return text;
}

rtapi::Result<std::uint64_t> parse_value(Type type, std::string_view view) {
  const std::string text(view);
  switch (type) {
    case Type::bit:
      if (text == "1" || strcasecmp(text.c_str(), "TRUE") == 0) return to_raw(true);
      if (text == "0" || strcasecmp(text.c_str(), "FALSE") == 0) return to_raw(false);
      return invalid(type, text);
    case Type::floating: {
      char* end = nullptr;
      const double value = std::strtod(text.c_str(), &end);
      if (text.empty() || end == text.c_str() || *end != '\0') return invalid(type, text);
      return to_raw(value);
    }
    case Type::s32: return parse_integer(type, text, true, 32);
    case Type::u32:
    case Type::port: return parse_integer(type, text, false, 32);
    case Type::s64: return parse_integer(type, text, true, 64);
    case Type::u64: return parse_integer(type, text, false, 64);
    default: return invalid(type, text);
  }
}

}  // namespace kerf::hal
