#include "ini/convert.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <system_error>
#include <utility>

namespace kerf::ini {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

struct Magnitude {
  std::uint64_t value{0};
  bool valid{false};
  bool negative{false};
  std::string_view rest;
};

std::string_view skip_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n\v\f\r");
  return first == std::string_view::npos ? std::string_view{} : text.substr(first);
}

/// Takes one sign off the front; true for a minus.
bool take_sign(std::string_view& text) {
  if (text.empty() || (text[0] != '-' && text[0] != '+')) return false;
  const bool minus = text[0] == '-';
  text.remove_prefix(1);
  return minus;
}

int base_of_prefix(std::string_view text) {
  if (text.size() < 3 || text[0] != '0') return 10;
  const int base = lower(text[1]) == 'x'   ? 16
                   : lower(text[1]) == 'o' ? 8
                   : lower(text[1]) == 'b' ? 2
                                           : 10;
  if (base == 10) return 10;
  // "0x" without a digit of its base is the number 0 followed by a letter.
  std::uint64_t probe = 0;
  const char* const digit = text.data() + 2;
  return std::from_chars(digit, digit + 1, probe, base).ec == std::errc{} ? base : 10;
}

Magnitude to_magnitude(std::string_view text) {
  Magnitude out;
  text = skip_blanks(text);
  out.negative = take_sign(text);
  const int base = base_of_prefix(text);
  if (base != 10) text.remove_prefix(2);
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), out.value, base);
  out.valid = code == std::errc{};
  out.rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return out;
}

std::optional<double> look_up(std::string_view name,
                              std::initializer_list<std::pair<std::string_view, double>> table) {
  for (const auto& [known, value] : table) {
    if (equal_ignoring_case(name, known)) return value;
  }
  return std::nullopt;
}

}  // namespace

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

Number<std::int64_t> to_int(std::string_view text) {
  const Magnitude m = to_magnitude(text);
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  Number<std::int64_t> out;
  out.rest = m.rest;
  out.negated = m.negative;
  out.valid = m.valid && m.value <= kMax + (m.negative ? 1U : 0U);
  if (out.valid) out.value = static_cast<std::int64_t>(m.negative ? 0U - m.value : m.value);
  return out;
}

Number<std::uint64_t> to_uint(std::string_view text) {
  const Magnitude m = to_magnitude(text);
  return {m.negative ? 0U - m.value : m.value, m.valid, m.negative, m.rest};
}

Number<double> to_real(std::string_view text) {
  Number<double> out;
  text = skip_blanks(text);
  out.negated = take_sign(text);
  // Refuses "nan", "inf" and a second sign, which from_chars would take.
  if (text.empty() || !((text[0] >= '0' && text[0] <= '9') || text[0] == '.')) return out;
  auto format = std::chars_format::general;
  if (base_of_prefix(text) == 16) {
    format = std::chars_format::hex;
    text.remove_prefix(2);
  }
  const auto [end, code] =
      std::from_chars(text.data(), text.data() + text.size(), out.value, format);
  const auto length = static_cast<std::size_t>(end - text.data());
  out.rest = text.substr(length);
  // from_chars says "out of range" for 1e400 and 1e-400 alike; too small is just zero.
  const bool tiny = code == std::errc::result_out_of_range &&
                    text.substr(0, length).find('-') != std::string_view::npos;
  out.valid = code == std::errc{} || tiny;
  if (tiny) out.value = 0.0;
  if (out.negated) out.value = -out.value;
  return out;
}

std::optional<bool> to_bool(std::string_view text) {
  for (const auto* word : {"true", "yes", "on", "1"}) {
    if (equal_ignoring_case(text, word)) return true;
  }
  for (const auto* word : {"false", "no", "off", "0"}) {
    if (equal_ignoring_case(text, word)) return false;
  }
  return std::nullopt;
}

std::optional<double> mm_per_unit(std::string_view name) {
  // Old files say how many units are a millimetre.
  if (const auto per_mm = to_real(name); per_mm.valid && !per_mm.has_trailing() && per_mm.value > 0)
    return 1.0 / per_mm.value;
  return look_up(name, {{"mm", 1.0},
                        {"metric", 1.0},
                        {"cm", 10.0},
                        {"inch", 25.4},
                        {"in", 25.4},
                        {"imperial", 25.4}});
}

std::optional<double> deg_per_unit(std::string_view name) {
  if (const auto per_deg = to_real(name);
      per_deg.valid && !per_deg.has_trailing() && per_deg.value > 0)
    return 1.0 / per_deg.value;
  return look_up(name, {{"deg", 1.0},
                        {"degree", 1.0},
                        {"rad", 180.0 / std::numbers::pi},
                        {"radian", 180.0 / std::numbers::pi},
                        {"grad", 0.9},
                        {"gon", 0.9}});
}

}  // namespace kerf::ini
