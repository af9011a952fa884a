// Backslash escapes and the UTF-8 rule of INI values (internal to src/ini).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kerf::ini {

/// What resolving a value's escapes gives: the text, warnings, and at most one error.
struct Unescaped {
  std::string value;
  std::vector<std::string> warnings;
  std::string error;
};

/// Resolves \a \b \f \n \r \t \v \\, \[0-2]oo (octal), \xHH, \uHHHH (surrogate pairs) and \UHHHHHHHH.
/// An unknown escape stays as written, with a warning. NUL and invalid UTF-8 are errors.
[[nodiscard]] Unescaped unescape(std::string_view raw);

/// True if `text` is well-formed UTF-8 (no overlong forms, no surrogates, at most U+10FFFF).
[[nodiscard]] bool is_valid_utf8(std::string_view text);

}  // namespace kerf::ini
