#include "clients/rsh/text.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace kerf::rsh {

namespace {
constexpr const char* kBlanks = " \t\v\f";
constexpr std::size_t kShown = 80;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; }
}  // namespace

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = upper(c);
  return out;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string_view take_word(std::string_view& rest) {
  rest = trimmed(rest);
  const auto end = std::min(rest.find_first_of(kBlanks), rest.size());
  const std::string_view word = rest.substr(0, end);
  rest = trimmed(rest.substr(end));
  return word;
}

std::optional<double> to_number(std::string_view word) {
  // strtod also takes hexadecimal numbers, infinities and NaN, which nobody means here.
  if (word.empty() || word.find_first_not_of("0123456789+-.eE") != std::string_view::npos)
    return std::nullopt;
  const std::string text(word);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long> to_integer(std::string_view word) {
  const std::string text(word);
  const bool hexadecimal = text.rfind("0x", 0) == 0 || text.rfind("0X", 0) == 0;
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, hexadecimal ? 16 : 10);
  constexpr long kMost = 0xffffffffL;
  if (end == text.c_str() || *end != '\0' || value > kMost || value < -kMost) return std::nullopt;
  return value;
}

std::string shown(std::string_view text) {
  std::string out(text.substr(0, kShown));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  if (text.size() > kShown) out += "...";
  return out;
}

std::string fixed(double value) {
  char text[400];
  // -0 is a zero to people.
  std::snprintf(text, sizeof text, "%f", std::fabs(value) < 0.5e-6 ? 0.0 : value);
  return text;
}

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace kerf::rsh
