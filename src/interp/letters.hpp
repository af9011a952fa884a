// Letters of a block as small numbers.
#pragma once

#include <cstdint>
#include <string_view>

namespace kerf::interp {

/// a-z are 0-25; $ @ ^ follow.
inline constexpr int kLetters = 29;
inline constexpr std::string_view kLetterNames = "abcdefghijklmnopqrstuvwxyz$@^";

/// Index of a lower-case letter or one of $ @ ^, -1 for anything else.
constexpr int letter_index(char c) noexcept {
  if (c >= 'a' && c <= 'z') return c - 'a';
  if (c == '$') return 26;
  if (c == '@') return 27;
  if (c == '^') return 28;
  return -1;
}

/// Set of letters.
using LetterMask = std::uint32_t;
constexpr LetterMask letters(std::string_view names) noexcept {
  LetterMask mask = 0;
  for (const char c : names) mask |= LetterMask{1} << letter_index(c);
  return mask;
}
inline constexpr LetterMask kAxisMask = letters("xyzabcuvw@^");
/// Axis index (XYZABCUVW order) to letter index.
inline constexpr int kAxisLetter[9] = {23, 24, 25, 0, 1, 2, 20, 21, 22};

}  // namespace kerf::interp
