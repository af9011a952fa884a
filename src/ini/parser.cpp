#include "ini/parser.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "ini/escape.hpp"

namespace kerf::ini {

namespace {

constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kInclude = "#INCLUDE";

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_identifier(std::string_view text) {
  for (const char c : text) {
    if (!is_digit(c) && !(c >= 'A' && c <= 'Z') && !(c >= 'a' && c <= 'z') && c != '_')
      return false;
  }
  return true;
}

std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

/// The text before a continuation backslash (blanks may follow it), or nothing if the line ends.
std::optional<std::string_view> continued(std::string_view text) {
  const auto last = text.find_last_not_of(kBlanks);
  if (last == std::string_view::npos || text[last] != '\\') return std::nullopt;
  std::size_t backslashes = 0;
  while (backslashes <= last && text[last - backslashes] == '\\') ++backslashes;
  if (backslashes % 2 == 0) return std::nullopt;  // `\\` at the end is an escaped backslash
  return text.substr(0, last);
}

/// The next line of `text` from `at` without its LF or CR LF; moves `at` behind it.
std::string_view next_line(std::string_view text, std::size_t& at) {
  const auto end = text.find('\n', at);
  std::string_view line = text.substr(at, end == std::string_view::npos ? end : end - at);
  at = end == std::string_view::npos ? text.size() : end + 1;
  if (end != std::string_view::npos && !line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

}  // namespace

int Parser::slurp(const std::string& path, std::string& out) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) return errno;
  char buffer[16384];
  std::size_t got = 0;
  errno = 0;
  while ((got = std::fread(buffer, 1, sizeof buffer, file.get())) > 0) {
    if (got > bytes_left_) return EFBIG;
    bytes_left_ -= got;
    out.append(buffer, got);
  }
  return std::ferror(file.get()) != 0 ? (errno != 0 ? errno : EIO) : 0;
}

void Parser::read_file(const std::string& path) {
  std::string text;
  if (const int code = slurp(path, text); code != 0) {
    out_.diagnostics.push_back({{path, 0},
                                true,
                                "Cannot open ini-file (errno=" + std::to_string(code) + " (" +
                                    std::strerror(code) + "))"});
    return;
  }
  std::error_code ignored;
  stack_.push_back({path, std::filesystem::weakly_canonical(path, ignored).string()});
  read_text(text, path);
  stack_.pop_back();
}

void Parser::read_text(std::string_view text, const std::string& name) {
  const bool own_source = stack_.empty();
  if (own_source) stack_.push_back({name, {}});
  const bool has_mark = text.substr(0, kByteOrderMark.size()) == kByteOrderMark;
  std::size_t at = 0;
  int number = 0;
  while (at < text.size()) {
    const std::string_view first = next_line(text, at);
    const int begin = ++number;
    const std::string_view inner = trim(first);
    if (inner.empty()) continue;
    if (inner[0] == '#' || inner[0] == ';') {
      line(first, begin);  // a backslash does not continue a comment or an #INCLUDE
      continue;
    }
    auto part = continued(first);
    if (!part) {
      line(first, begin);
      continue;
    }
    std::string whole;
    while (part) {
      whole += *part;
      if (at >= text.size()) {
        error(number, "Last line has a continuation");
        break;
      }
      const std::string_view more = next_line(text, at);
      ++number;
      part = continued(more);
      if (!part) whole += more;
    }
    if (!part) line(whole, begin);
  }
  // After LinuxCNC's own words about that line, which do not show what is wrong.
  if (has_mark) warning(1, "The file begins with a UTF-8 byte order mark; save it without one");
  if (own_source) stack_.pop_back();
}

LoadResult Parser::finish() {
  out_.ok = true;
  for (const auto& diagnostic : out_.diagnostics) out_.ok = out_.ok && !diagnostic.is_error;
  return std::move(out_);
}

void Parser::line(std::string_view text, int number) {
  if (text.find('\0') != std::string_view::npos) {
    error(number, "Embedded literal NUL character not supported");
    return;
  }
  if (text.substr(0, kInclude.size()) == kInclude) {
    const std::string_view rest = text.substr(kInclude.size());
    if (rest.empty() || kBlanks.find(rest[0]) != std::string_view::npos) {
      include(trim(rest), number);
      return;
    }
  }
  const std::string_view inner = trim(text);
  if (inner.empty() || inner[0] == '#' || inner[0] == ';') return;
  if (inner[0] == '[') {
    section_header(inner, number);
  } else {
    assignment(inner, number);
  }
}

void Parser::section_header(std::string_view text, int number) {
  section_broken_ = true;
  const auto close = text.find(']');
  if (close == std::string_view::npos) {
    error(number, "Invalid section. Missing ']'");
    return;
  }
  const std::string_view name = trim(text.substr(1, close - 1));
  if (name.empty()) {
    error(number, "Invalid section. No content between '[' and ']'");
    return;
  }
  if (!is_identifier(name)) {
    error(number,
          "Invalid section " + in_quotes(name) + ". Identifier contains invalid character(s)");
    return;
  }
  if (is_digit(name[0])) {
    error(number, "Invalid section " + in_quotes(name) + ". Cannot start with a digit");
    return;
  }
  section_broken_ = false;
  section_ = name;
  const std::string_view tail = trim(text.substr(close + 1));
  if (!tail.empty() && tail[0] != '#' && tail[0] != ';') {
    warning(number, "Section header has trailing content, ignored");
  }
  if (out_.file.has_section(name)) {
    warning(number, "Section " + in_quotes(name) + " already exists. Merging...");
  } else {
    out_.file.sections_.push_back({section_, {stack_.back().name, number}});
  }
}

void Parser::assignment(std::string_view text, int number) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) {
    error(number, "Invalid tag " + in_quotes(text) + ". Expected '=' after tag identifier");
    return;
  }
  const std::string_view key = trim(text.substr(0, equals));
  if (key.empty()) {
    error(number, "Invalid tag. Missing identifier before '='");
    return;
  }
  if (!is_identifier(key)) {
    error(number,
          "Invalid tag name " + in_quotes(key) + ". Identifier contains invalid character(s)");
    return;
  }
  if (is_digit(key[0])) {
    error(number, "Invalid tag " + in_quotes(key) + ". Tag identifiers cannot start with a digit");
    return;
  }
  if (section_.empty() && !section_broken_) {
    error(number, "Tag " + in_quotes(key) + " found without prior section definition");
    return;
  }
  Unescaped value = unescape(trim(text.substr(equals + 1)));
  for (auto& note : value.warnings) warning(number, std::move(note));
  if (!value.error.empty()) {
    error(number, std::move(value.error));
    return;
  }
  if (section_broken_) return;
  out_.file.add({section_, std::string(key), std::move(value.value), {stack_.back().name, number}});
}

void Parser::include(std::string_view name, int number) {
  if (name.empty()) {
    error(number, "Missing filename after #INCLUDE");
    return;
  }
  const std::string path = resolve(name);
  std::error_code ignored;
  const std::string canonical = std::filesystem::weakly_canonical(path, ignored).string();
  for (const auto& source : stack_) {
    if (!canonical.empty() && source.canonical == canonical) {
      error(number, "Include file recursion on loading " + in_quotes(path));
      return;
    }
  }
  if (stack_.size() >= kMaxIncludeDepth) {
    error(number, "Maximum include depth (" + std::to_string(kMaxIncludeDepth) +
                      ") reached on loading " + in_quotes(path));
    return;
  }
  if (++includes_ >= kMaxIncludes) {
    if (includes_ == kMaxIncludes)
      error(number, "More than " + std::to_string(kMaxIncludes) + " files on loading " +
                        in_quotes(path) + "; the others are not read");
    return;
  }
  std::string text;
  if (const int code = slurp(path, text); code != 0) {
    error(number, "Cannot open ini-file " + in_quotes(path) + " (errno=" + std::to_string(code) +
                      " (" + std::strerror(code) + "))");
    return;
  }
  stack_.push_back({path, canonical});
  read_text(text, path);
  stack_.pop_back();
}

std::string Parser::resolve(std::string_view name) const {
  std::string path = expand_tilde(name);
  if (path[0] == '/') return path;
  const std::string& including = stack_.back().name;
  const auto slash = including.rfind('/');
  return slash == std::string::npos ? path : including.substr(0, slash + 1) + path;
}

void Parser::complain(int number, bool is_error, std::string text) {
  out_.diagnostics.push_back({{stack_.back().name, number}, is_error, std::move(text)});
}

LoadResult IniFile::load(const std::string& path) {
  Parser parser(path);
  parser.read_file(path);
  return parser.finish();
}

LoadResult IniFile::parse(std::string_view text, const std::string& name) {
  Parser parser(name);
  parser.read_text(text, name);
  return parser.finish();
}

}  // namespace kerf::ini
