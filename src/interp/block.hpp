// ParsedBlock: one line after reading, before its numbers are computed. Cached for loops; evaluated each time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "interp/letters.hpp"

namespace kerf::interp {

/// One operation of a postfix program.
enum class Op : std::uint8_t {
  number,
  parameter,
  named,
  exists_named,
  exists_numbered,
  negate,
  abs,
  acos,
  asin,
  atan,
  cos,
  exp,
  fix,
  fup,
  ln,
  round,
  sin,
  sqrt,
  tan,
  power,
  times,
  divide,
  modulo,
  plus,
  minus,
  eq,
  ne,
  gt,
  ge,
  lt,
  le,
  op_and,
  op_or,
  op_xor,
};

struct ExprOp {
  Op op{Op::number};
  std::uint16_t at{0};  ///< place in the normalised line, for messages
  std::uint32_t id{0};  ///< name of Op::named and Op::exists_named
  double value{0};      ///< of Op::number
};

/// A run of ParsedBlock::ops.
struct Expr {
  std::uint32_t first{0}, count{0};
};

struct ParsedWord {
  std::uint8_t letter{0};
  bool constant{true};
  std::uint16_t at{0};
  double value{0};  ///< when constant
  Expr expr;        ///< when not
};

struct Assignment {
  bool named{false};
  std::uint16_t at{0};
  std::uint32_t id{0};  ///< name
  Expr index;           ///< number
  Expr value;
};

enum class Flow : std::uint8_t {
  none,
  sub,
  endsub,
  call,
  ret,
  if_block,
  elseif,
  else_block,
  endif,
  while_loop,
  endwhile,
  do_loop,
  repeat_loop,
  endrepeat,
  break_loop,
  continue_loop,
  program_number,  ///< O with a number and nothing else: a numbered program begins
  call_number,     ///< M98
  return_number,   ///< M99
};
using FlowMask = std::uint32_t;
constexpr FlowMask flow_bit(Flow f) noexcept { return FlowMask{1} << static_cast<unsigned>(f); }

/// What a comment does.
enum class CommentKind : std::uint8_t {
  none,
  plain,
  msg,
  debug,
  print,
  log,
  log_open,
  log_append,
  log_close,
  abort
};

/// Place of a line in a file.
struct Place {
  std::uint64_t offset{0};
  std::int32_t line{0};  ///< lines before this place
};

struct ParsedBlock {
  std::vector<ParsedWord> words;
  std::vector<Assignment> assignments;
  std::vector<ExprOp> ops;
  std::vector<Expr> arguments;  ///< of the O-word
  std::string label;            ///< "100", "<name>"; "" when computed by label_expr
  Expr label_expr;
  Flow flow{Flow::none};
  CommentKind comment{CommentKind::none};
  bool skip{false};     ///< begins with /
  bool percent{false};  ///< a line that begins with %
  std::int32_t sequence{-1};
  std::string comment_text;
  std::string text;  ///< the line as written
  std::string_view source() const { return text; }

  Place place;  ///< of this line
  Place after;  ///< of the next one
  Place jump;   ///< line behind the one that a skip from here reached
  bool jump_known{false};
  bool label_known{false};     ///< the label was found to be used rightly here
  ParsedBlock* next{nullptr};  ///< the cached block at `after`

  void clear() {
    words.clear();
    assignments.clear();
    ops.clear();
    arguments.clear();
    label.clear();
    label_expr = {};
    flow = Flow::none;
    comment = CommentKind::none;
    skip = percent = jump_known = label_known = false;
    sequence = -1;
    next = nullptr;
  }
};

}  // namespace kerf::interp
