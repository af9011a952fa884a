#include "hal/cmd/words.hpp"

#include <cctype>
#include <cstdlib>

#include "ini/ini_file.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;

namespace {

bool is_name_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-';
}
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// A name at text[i]: bare, or in parentheses; i moves behind it.
Result<std::string> take_name(std::string_view text, std::size_t& i) {
  std::string name;
  if (i < text.size() && text[i] == '(') {
    const auto end = text.find(')', i);
    if (end == std::string_view::npos) {
      return fail(Errc::syntax, "Missing close parenthesis.");
    }
    name = text.substr(i + 1, end - i - 1);
    i = end + 1;
  } else {
    const std::size_t begin = i;
    while (i < text.size() && is_name_char(text[i])) ++i;
    name = text.substr(begin, i - begin);
  }
  if (name.empty()) return fail(Errc::syntax, "Empty variable name.");
  return name;
}

}  // namespace

IniLookup ini_lookup(const ini::IniFile& file) {
  return [&file](std::string_view section, std::string_view key) -> std::optional<std::string> {
    const auto* entry = file.find(section, key);
    if (entry == nullptr) return std::nullopt;
    return entry->value;
  };
}

std::string without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      return std::string(line.substr(0, i));
    }
  }
  return std::string(line);
}

Result<std::string> substitute(std::string_view text, const IniLookup& ini) {
  std::string out;
  std::size_t i = 0;
  while (i < text.size()) {
    if (text[i] == '$') {
      ++i;
      KERF_TRY(const std::string name, take_name(text, i));
      const char* value = std::getenv(name.c_str());
      if (value == nullptr)
        return fail(Errc::not_found, "Environment variable '" + name + "' not found.");
      out += value;
    } else if (text[i] == '[') {
      const auto close = text.find(']', i);
      if (close == std::string_view::npos)
        return fail(Errc::syntax, "Missing close square bracket.");
      const std::string section(text.substr(i + 1, close - i - 1));
      i = close + 1;
      KERF_TRY(const std::string name, take_name(text, i));
      const auto value = ini ? ini(section, name) : std::nullopt;
      if (!value) {
        std::string reason = "Ini variable '[";
        reason.append(section).append("]").append(name).append("' not found.");
        if (!ini) reason += " No INI file was given: option -i";
        return fail(Errc::not_found, reason);
      }
      out += *value;
    } else {
      out += text[i++];
    }
  }
  return out;
}

Result<std::vector<std::string>> split_words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = 0;
  for (const char c : text) {
    if (quote == 0 && is_blank(c)) {
      if (in_word) words.push_back(word);
      word.clear();
      in_word = false;
      continue;
    }
    in_word = true;
    word += c;
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    }
  }
  if (quote != 0) return fail(Errc::syntax, "unterminated quoted string");
  if (in_word) words.push_back(word);
  return words;
}

std::string unquoted(std::string_view word) {
  std::string out;
  char quote = 0;
  for (const char c : word) {
    if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = 0;
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace kerf::hal
