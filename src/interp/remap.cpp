#include "interp/remap.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

#include "interp/dialect.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::interp {

namespace {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; }

constexpr std::array<std::string_view, 7> kOptions = {"modalgroup", "argspec", "prolog", "epilog",
                                                      "ngc",        "python",  "py"};

bool has_builtin(char letter, int code) {
  for (const auto& family : linuxcnc_dialect().families) {
    for (const CodeRow& r : family) {
      if (r.letter == letter && code >= r.code && code <= r.last) return true;
    }
  }
  return false;
}

/// Built-in codes that may get another body.
bool may_replace(char letter, int code) {
  if (letter != 'm') return false;
  return code == 0 || code == 1 || code == 6 || code == 60 || code == 61 ||
         (code >= 62 && code <= 68);
}

/// "M400" into letter and code; false: no such code.
bool read_code(std::string_view text, Remap& r) {
  if (text.empty()) return false;
  r.letter = lower(text[0]);
  r.name = std::string(text);
  r.name[0] = upper(text[0]);
  if (text.size() == 1) return r.letter == 't' || r.letter == 's' || r.letter == 'f';
  if (r.letter != 'g' && r.letter != 'm') return false;
  const std::string number(text.substr(1));
  char* end = nullptr;
  const double v = std::strtod(number.c_str(), &end);
  if (*end != '\0' || number[0] == '-' || number[0] == '+') return false;
  const double scaled = r.letter == 'g' ? v * 10 : v;
  if (!(scaled >= 0 && scaled <= 999) || std::fabs(scaled - std::nearbyint(scaled)) > 1e-4)
    return false;
  r.code = static_cast<std::int16_t>(std::nearbyint(scaled));
  return true;
}

std::string read_argspec(std::string_view spec, Remap& r) {
  for (const char c : spec) {
    switch (c) {
      case '@': r.positional = true; continue;
      case '^': r.spindle = true; continue;
      case '>': r.feed = true; continue;
      case 'n':
      case 'N': r.line_number = true; continue;
      default: break;
    }
    const char l = lower(c);
    if (l < 'a' || l > 'z' || l == 'g' || l == 'm' || l == 'o')
      return std::string("argspec: illegal word '") + c + "'";
    r.words += c;
  }
  return {};
}

std::string read_group(std::string_view text, Remap& r) {
  const std::string value(text);
  char* end = nullptr;
  const long n = std::strtol(value.c_str(), &end, 10);
  const bool number = !value.empty() && *end == '\0';
  if (r.letter == 'g') {
    if (!number || n != 1)
      return "error: code '" + r.name + "' : invalid modalgroup=<int> given (only 1 for G-codes)";
  } else if (!number || n < 4 || n > 10) {
    return "error: code '" + r.name + "' : invalid modalgroup=<int> given (currently valid: 4..10)";
  }
  r.group = static_cast<std::int8_t>(n);
  return {};
}

std::string read_option(std::string_view name, std::string_view value, Remap& r) {
  if (name == "modalgroup")
    return r.letter == 'g' || r.letter == 'm' ? read_group(value, r) : std::string();
  if (name == "argspec") return read_argspec(value, r);
  if (name == "prolog") r.prolog = value;
  if (name == "epilog") r.epilog = value;
  if (name == "ngc") r.ngc = value;
  if (name == "python" || name == "py") r.python = value;
  return {};
}

std::string_view next_word(std::string_view& rest) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!rest.empty() && blank(rest.front())) rest.remove_prefix(1);
  std::size_t n = 0;
  while (n < rest.size() && !blank(rest[n])) ++n;
  const std::string_view word = rest.substr(0, n);
  rest.remove_prefix(n);
  return word;
}

}  // namespace

RemapParse parse_remap(std::string_view text) {
  RemapParse out;
  Remap r;
  r.text = std::string(text);
  std::string_view rest = text;
  const std::string_view code = next_word(rest);
  if (!read_code(code, r)) {
    out.error = code.empty()
                    ? "the code is missing: expected such as M400 ngc=name"
                    : "'" + std::string(code) +
                          "' is no code that can be remapped: expected T, S, F, a free G-code "
                          "(G0.1 to G99.9) or M-code (M200 to M999)";
    return out;
  }
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    bool known = equals != std::string_view::npos;
    if (known) {
      known = false;
      for (const std::string_view option : kOptions) known = known || option == name;
    }
    if (!known) {
      std::vector<std::string_view> names(kOptions.begin(), kOptions.end());
      const std::string near = rtapi::nearest_name(name, names);
      out.warnings.push_back("unrecognized option '" + std::string(word) + "'" +
                             (near.empty() ? "" : "; did you mean " + near + "=?"));
      continue;
    }
    out.error = read_option(name, word.substr(equals + 1), r);
    if (!out.error.empty()) return out;
  }
  if (!r.ngc.empty() && !r.python.empty()) {
    out.error = "can't remap to an ngc file and a Python function";
    return out;
  }
  if (r.ngc.empty() && r.python.empty()) {
    out.error = "code '" + r.name +
                "' - no remap function given, use either 'python=<function>' or 'ngc=<basename>'";
    return out;
  }
  if (r.group == 0) r.group = static_cast<std::int8_t>(r.letter == 'g' ? 1 : 10);
  const bool code_word = r.letter == 'g' || r.letter == 'm';
  const bool user_program = r.letter == 'm' && r.code >= 100 && r.code <= 199;
  if (code_word && has_builtin(r.letter, r.code) && !may_replace(r.letter, r.code)) {
    out.warnings.push_back(r.name + (user_program ? " runs a user's program" : " is built in") +
                           " and stays so: T, S, F, M0, M1, M6, M60, M61 and M62 to M68 can be "
                           "remapped, and codes that are free");
    return out;
  }
  out.remap = std::move(r);
  return out;
}

}  // namespace kerf::interp
