#include "task/interpreter/program_lines.hpp"

#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

namespace kerf::task {
namespace {

struct Body {
  std::string label;
  bool sub{false};
  std::int32_t from{0};
};

/// Without blanks and comments, in small letters, without `/` and line number.
std::string code_of(std::string_view line) {
  std::string out;
  int depth = 0;
  for (const char c : line) {
    if (depth == 0 && c == ';') break;
    if (c == '(') ++depth;
    if (depth == 0 && std::isspace(static_cast<unsigned char>(c)) == 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (c == ')' && depth > 0) --depth;
  }
  std::size_t at = !out.empty() && out[0] == '/' ? 1 : 0;
  if (at < out.size() && out[at] == 'n') {
    std::size_t end = at + 1;
    while (end < out.size() &&
           (std::isdigit(static_cast<unsigned char>(out[end])) != 0 || out[end] == '.'))
      ++end;
    at = end;
  }
  return out.substr(at);
}

/// "o100while[..]" -> "o100" and "while[..]"; false: no O-word.
bool split(const std::string& code, std::string& label, std::string_view& rest) {
  if (code.size() < 2 || code[0] != 'o') return false;
  std::size_t end = 1;
  if (code[1] == '<') {
    end = code.find('>');
    if (end == std::string::npos) return false;
    ++end;
  } else {
    while (end < code.size() && std::isdigit(static_cast<unsigned char>(code[end])) != 0) ++end;
  }
  label = code.substr(0, end);
  rest = std::string_view(code).substr(end);
  return end > 1;
}

class Lines {
 public:
  explicit Lines(std::int32_t wished) : wished_(wished) {}
  /// False: found.
  bool take(std::string_view text) {
    ++line_;
    const std::string code = code_of(text);
    if (code.empty() || code[0] == '%') return true;
    std::string label;
    std::string_view rest;
    const bool flow = split(code, label, rest);
    const auto is = [&](std::string_view word) {
      return flow && rest.substr(0, word.size()) == word;
    };
    // The last line of a body belongs to it: it decides what comes next.
    if (line_ >= wished_) {
      found_.line = line_;
      if (!bodies_.empty())
        found_.inside = std::string(bodies_.back().sub ? "sub " : "loop ") + bodies_.back().label +
                        " (line " + std::to_string(bodies_.back().from) + ")";
      return false;
    }
    const bool ends = is("endsub") || is("endwhile") || is("endrepeat") ||
                      (is("while") && !bodies_.empty() && bodies_.back().label == label);
    if (ends) {
      while (!bodies_.empty() && bodies_.back().label != label) bodies_.pop_back();
      if (!bodies_.empty()) bodies_.pop_back();
    } else if (is("sub") || is("while") || is("do") || is("repeat")) {
      bodies_.push_back({label, is("sub"), line_});
    }
    return true;
  }
  [[nodiscard]] const LinePlace& found() const { return found_; }

 private:
  std::int32_t wished_;
  std::int32_t line_{0};
  std::vector<Body> bodies_;
  LinePlace found_;
};

}  // namespace

LinePlace find_line_in(std::string_view program, std::int32_t line) {
  Lines lines(line);
  while (!program.empty()) {
    const std::size_t end = program.find('\n');
    if (!lines.take(program.substr(0, end))) break;
    if (end == std::string_view::npos) break;
    program.remove_prefix(end + 1);
  }
  return lines.found();
}

rtapi::Result<LinePlace> find_line(const std::string& path, std::int32_t line) {
  std::ifstream in(path);
  if (!in)
    return rtapi::fail(rtapi::Errc::not_found, "cannot read " + path + ": " + std::strerror(errno));
  Lines lines(line);
  std::string text;
  while (std::getline(in, text))
    if (!lines.take(text)) break;
  return lines.found();
}

}  // namespace kerf::task
