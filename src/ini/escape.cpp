#include "ini/escape.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>

namespace kerf::ini {

namespace {

constexpr std::uint32_t kMaxCodePoint = 0x10FFFF;

bool is_high_surrogate(std::uint32_t c) { return c >= 0xD800 && c <= 0xDBFF; }
bool is_low_surrogate(std::uint32_t c) { return c >= 0xDC00 && c <= 0xDFFF; }

std::optional<std::uint32_t> hex_value(std::string_view digits) {
  std::uint32_t value = 0;
  for (const char c : digits) {
    std::uint32_t d = 0;
    if (c >= '0' && c <= '9') {
      d = static_cast<std::uint32_t>(c - '0');
    } else if (c >= 'a' && c <= 'f') {
      d = static_cast<std::uint32_t>(c - 'a') + 10;
    } else if (c >= 'A' && c <= 'F') {
      d = static_cast<std::uint32_t>(c - 'A') + 10;
    } else {
      return std::nullopt;
    }
    value = value * 16 + d;
  }
  return value;
}

void append_utf8(std::string& out, std::uint32_t c) {
  const auto put = [&out](std::uint32_t byte) {
    out += static_cast<char>(static_cast<unsigned char>(byte));
  };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | (c >> 6));
    put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | (c >> 12));
    put(0x80 | ((c >> 6) & 0x3F));
    put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | (c >> 18));
    put(0x80 | ((c >> 12) & 0x3F));
    put(0x80 | ((c >> 6) & 0x3F));
    put(0x80 | (c & 0x3F));
  }
}

/// Walks one raw value; every escape method stands on the character after its letter.
class Unescaper {
 public:
  explicit Unescaper(std::string_view raw) : raw_(raw) {}

  Unescaped run() {
    while (at_ < raw_.size() && out_.error.empty()) {
      const char c = raw_[at_++];
      if (c != '\\' || at_ >= raw_.size()) {
        out_.value += c;
      } else {
        escape(raw_[at_++]);
      }
    }
    if (out_.error.empty() && !is_valid_utf8(out_.value)) {
      out_.error = "Value contains invalid UTF-8 sequence";
    }
    return std::move(out_);
  }

 private:
  void escape(char letter) {
    switch (letter) {
      case 'a': out_.value += '\a'; return;
      case 'b': out_.value += '\b'; return;
      case 'f': out_.value += '\f'; return;
      case 'n': out_.value += '\n'; return;
      case 'r': out_.value += '\r'; return;
      case 't': out_.value += '\t'; return;
      case 'v': out_.value += '\v'; return;
      case '\\': out_.value += '\\'; return;
      case '0':
      case '1':
      case '2': octal(letter); return;
      case 'x': byte(); return;
      case 'u': utf16(); return;
      case 'U': utf32(); return;
      default:
        out_.value += '\\';
        out_.value += letter;
        out_.warnings.push_back(std::string("Improper escape of '") + letter + "', ignored");
    }
  }

  void octal(char first) {
    auto value = static_cast<std::uint32_t>(first - '0');
    for (int i = 0; i < 2 && at_ < raw_.size() && raw_[at_] >= '0' && raw_[at_] <= '7'; ++i) {
      value = value * 8 + static_cast<std::uint32_t>(raw_[at_++] - '0');
    }
    if (value == 0) {
      out_.error = "Embedded octal NUL character not supported";
    } else {
      out_.value += static_cast<char>(static_cast<unsigned char>(value));
    }
  }

  void byte() {
    const auto value = hex(2, "hex escape", "hex escape", "Invalid hex '");
    if (!value) return;
    if (*value == 0) {
      out_.error = "Embedded hex NUL character not supported";
    } else {
      out_.value += static_cast<char>(static_cast<unsigned char>(*value));
    }
  }

  void utf16() {
    const auto first = hex(4, "UTF-16 escape", "UTF-16 escape", "Invalid hex value '");
    if (!first) return;
    std::uint32_t code = *first;
    if (code == 0) {
      out_.error = "Embedded UTF-16 NUL character not supported";
      return;
    }
    if (is_low_surrogate(code)) {
      out_.error = "Missing high surrogate in UTF-16";
      return;
    }
    if (is_high_surrogate(code)) {
      const std::string_view next = raw_.substr(at_, 6);
      const auto low = next.size() == 6 && next[0] == '\\' && next[1] == 'u'
                           ? hex_value(next.substr(2))
                           : std::nullopt;
      if (!low || !is_low_surrogate(*low)) {
        out_.error = "Missing low surrogate in UTF-16";
        return;
      }
      at_ += 6;
      code = 0x10000 + ((code - 0xD800) << 10) + (*low - 0xDC00);
    }
    append_utf8(out_.value, code);
  }

  void utf32() {
    const auto code = hex(8, "UTF-32 escape", "UTF-32 escape", "Invalid hex value '");
    if (!code) return;
    if (*code == 0) {
      out_.error = "Embedded UTF-32 NUL character not supported";
    } else if (*code > kMaxCodePoint || is_high_surrogate(*code) || is_low_surrogate(*code)) {
      char text[64];
      std::snprintf(text, sizeof text, "Invalid code point U%08X in UTF-32 escape", *code);
      out_.error = text;
    } else {
      append_utf8(out_.value, *code);
    }
  }

  std::optional<std::uint32_t> hex(std::size_t count, const char* improper, const char* in,
                                   const char* invalid) {
    const std::string_view digits = raw_.substr(at_, count);
    if (digits.size() < count) {
      out_.error = std::string("Improper ") + improper;
      return std::nullopt;
    }
    const auto value = hex_value(digits);
    if (!value) {
      out_.error = invalid + std::string(digits) + "' in " + in;
      return std::nullopt;
    }
    at_ += count;
    return value;
  }

  std::string_view raw_;
  std::size_t at_{0};
  Unescaped out_;
};

}  // namespace

bool is_valid_utf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    int more = 0;
    std::uint32_t code = 0;
    std::uint32_t least = 0;
    if ((lead & 0xE0) == 0xC0) {
      more = 1, code = lead & 0x1FU, least = 0x80;
    } else if ((lead & 0xF0) == 0xE0) {
      more = 2, code = lead & 0x0FU, least = 0x800;
    } else if ((lead & 0xF8) == 0xF0) {
      more = 3, code = lead & 0x07U, least = 0x10000;
    } else {
      return false;
    }
    for (; more > 0; --more) {
      if (i >= text.size()) return false;
      const auto next = static_cast<unsigned char>(text[i++]);
      if ((next & 0xC0) != 0x80) return false;
      code = (code << 6) | (next & 0x3FU);
    }
    if (code < least || code > kMaxCodePoint || (code >= 0xD800 && code <= 0xDFFF)) return false;
  }
  return true;
}

Unescaped unescape(std::string_view raw) { return Unescaper(raw).run(); }

}  // namespace kerf::ini
