// Parser: text of one line -> ParsedBlock. Knows the grammar, computes nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "interp/block.hpp"
#include "interp/dialect.hpp"
#include "interp/parameters.hpp"

namespace kerf::interp {

class Parser {
 public:
  Parser(const Dialect& dialect, ParameterTable& names, LabelTable& labels)
      : dialect_(dialect), names_(names), labels_(labels) {}

  /// False: error() and error_at() say why and where. What `out` shows stays until the next call.
  [[nodiscard]] bool parse(std::string_view line, ParsedBlock& out);
  /// O-word label and keyword of a line, for skipping: false when the line has none (or cannot be read).
  [[nodiscard]] bool peek_flow(std::string_view line, ParsedBlock& out);

  /// N number of a line, -1 without: for a jump to it.
  [[nodiscard]] std::int64_t peek_sequence(std::string_view line) const;

  [[nodiscard]] const char* error() const { return error_; }
  /// Column in the line as written, from 1.
  [[nodiscard]] int column_of(std::string_view line, std::size_t normalised) const;
  [[nodiscard]] std::size_t error_at() const { return at_; }

 private:
  /// Lines of letters and numbers only, which are nearly all. False: look closer.
  [[nodiscard]] bool plain(std::string_view line, ParsedBlock& out);
  void show(ParsedBlock& out) const;
  static void trailing_comment(std::string_view line, std::size_t semicolon, ParsedBlock& out);
  [[nodiscard]] bool normalise(std::string_view line);
  [[nodiscard]] bool items();
  [[nodiscard]] bool word(int letter);
  [[nodiscard]] bool statement(std::string_view word);
  [[nodiscard]] bool end_of_statement(const StatementRow& row);
  [[nodiscard]] bool words_to(std::string_view stop);
  [[nodiscard]] std::uint32_t quoted();
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
  [[nodiscard]] bool parameter_name(std::uint32_t& id);
  [[nodiscard]] int operator_at(Op& op, std::size_t& length) const;
  [[nodiscard]] bool fail(const char* format, ...) __attribute__((format(printf, 2, 3)));
  /// Appends an operation; one on numbers alone is done at once.
  void push(Op op, std::size_t at, double number = 0, std::uint32_t id = 0);
  [[nodiscard]] Expr since(std::size_t first) const {
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(ops_.size() - first)};
  }
  [[nodiscard]] char peek() const { return pos_ < size_ ? buffer_[pos_] : '\0'; }
  [[nodiscard]] bool starts(std::string_view word) const {
    return std::string_view(buffer_).substr(pos_, word.size()) == word;
  }

  const Dialect& dialect_;
  ParameterTable& names_;
  LabelTable& labels_;
  ParsedBlock* out_{nullptr};
  std::vector<ParsedWord> words_;
  std::vector<Assignment> assignments_;
  std::vector<ExprOp> ops_;
  std::vector<Expr> arguments_;
  std::size_t size_{0}, pos_{0}, at_{0};
  std::size_t semicolon_{std::string_view::npos};  ///< in the line as written
  int depth_{0};
  char error_[200]{};
  std::string buffer_;  ///< the line without blanks, in small letters; at least size_ + 1 long
};

/// What kind of comment `text` (between the parentheses) is; `rest` becomes the part after the comma.
[[nodiscard]] std::string_view probe_file(std::string_view text);  ///< of (PROBEOPEN file)
[[nodiscard]] CommentKind classify_comment(std::string_view text, std::string_view& rest);

}  // namespace kerf::interp
