// From a line of a HAL file to words: comments, substitution, quotes. There are no escapes; a backslash is a character.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::ini {
class IniFile;
}

namespace kerf::hal {

/// Value of [SECTION]KEY, or nullopt. Empty function: no INI file was given.
using IniLookup =
    std::function<std::optional<std::string>(std::string_view section, std::string_view key)>;
/// The file must outlive the look-up.
IniLookup ini_lookup(const ini::IniFile& file);

/// The line without what follows '#' outside quotes.
std::string without_comment(std::string_view line);

/// Replaces $VAR, $(VAR), [SECTION]KEY and [SECTION](KEY), also within words and quotes. A name without parentheses is made of
/// letters, digits, '_', '.' and '-'. Each '$' and '[' must begin one.
rtapi::Result<std::string> substitute(std::string_view text, const IniLookup& ini);

/// Words between blanks; "..." and '...' may hold blanks and stay in the words: quotes are part of what a command is given.
/// An open quote is an error.
rtapi::Result<std::vector<std::string>> split_words(std::string_view text);

/// The word without its quotes, as programs are given it: a"b c"d -> ab cd.
std::string unquoted(std::string_view word);

}  // namespace kerf::hal
