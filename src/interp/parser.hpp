// Parser: text of one line -> ParsedBlock. Knows the grammar, computes nothing.
#pragma once

#include <string_view>

#include "interp/block.hpp"
#include "interp/dialect.hpp"
#include "interp/parameters.hpp"

namespace kerf::interp {

/// Longest line; blanks and comments count.
inline constexpr std::size_t kLongestLine = 8192;

class Parser {
 public:
  Parser(const Dialect& dialect, ParameterTable& names) : dialect_(dialect), names_(names) {}

  /// False: error() and error_at() say why and where.
  [[nodiscard]] bool parse(std::string_view line, ParsedBlock& out);
  /// O-word label and keyword of a line, for skipping: false when the line has none (or cannot be read).
  [[nodiscard]] bool peek_flow(std::string_view line, ParsedBlock& out);

  [[nodiscard]] const char* error() const { return error_; }
  /// Column in the line as written, from 1.
  [[nodiscard]] int column_of(std::string_view line, std::size_t normalised) const;
  [[nodiscard]] std::size_t error_at() const { return at_; }

 private:
  [[nodiscard]] bool normalise(std::string_view line);
  [[nodiscard]] bool items();
  [[nodiscard]] bool word(int letter);
  [[nodiscard]] bool assignment();
  [[nodiscard]] bool comment();
  [[nodiscard]] bool flow();
  [[nodiscard]] bool flow_arguments();
  [[nodiscard]] bool sequence();
  [[nodiscard]] bool value();
  [[nodiscard]] bool number(double sign);
  [[nodiscard]] bool expression();
  [[nodiscard]] bool binary(int level);
  [[nodiscard]] bool parameter();
  [[nodiscard]] bool function();
  [[nodiscard]] bool name(std::string_view& out);
  [[nodiscard]] int operator_at(Op& op, std::size_t& length) const;
  [[nodiscard]] bool fail(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void push(Op op, double number = 0, std::uint32_t id = 0);
  [[nodiscard]] char peek() const { return pos_ < size_ ? buffer_[pos_] : '\0'; }
  [[nodiscard]] bool starts(std::string_view word) const {
    return std::string_view(buffer_ + pos_, size_ - pos_).substr(0, word.size()) == word;
  }

  const Dialect& dialect_;
  ParameterTable& names_;
  ParsedBlock* out_{nullptr};
  std::size_t size_{0}, pos_{0}, at_{0};
  int depth_{0};
  char error_[200]{};
  char buffer_[kLongestLine + 2]{};
};

/// What kind of comment `text` (between the parentheses) is; `rest` becomes the part after the comma.
[[nodiscard]] CommentKind classify_comment(std::string_view text, std::string_view& rest);

}  // namespace kerf::interp
