// ParsedBlock: one line after reading, before its numbers are computed. Cached for loops; evaluated each time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "interp/letters.hpp"
#include "interp/names.hpp"

namespace kerf::interp {

/// Codes within this of an integer are that integer; EQ compares by it (manual: "Equality").
inline constexpr double kTolerance = 0.0001;

/// One operation of a postfix program.
enum class Op : std::uint8_t {
  number,
  parameter,     ///< number computed
  parameter_at,  ///< number known: ExprOp::id
  named,
  exists_named,
  exists_numbered,
  external,        ///< a function of the dialect: ExprOp::id
  first_function,  // what follows can be computed at once when its operands are constant
  negate = first_function,
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
  std::uint32_t at{0};  ///< place in the normalised line, for messages
  std::uint32_t id{0};  ///< name of Op::named and Op::exists_named, number of Op::parameter_at
  double value{0};      ///< of Op::number
};

/// A run of ParsedBlock::ops.
struct Expr {
  std::uint32_t first{0}, count{0};
};

struct ParsedWord {
  std::uint8_t letter{0};
  bool constant{true};
  std::int16_t code{-1};  ///< of a constant G or M word: G times ten, M; -1: none
  std::uint32_t at{0};
  double value{0};  ///< when constant
  Expr expr;        ///< when not
};

struct Assignment {
  bool named{false};
  std::uint32_t at{0};
  std::uint32_t id{0};    ///< name, or number when known
  std::uint32_t text{0};  ///< the quoted text that is set: its name + 1; 0 none
  Expr index;             ///< number when computed
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
  go_to,           ///< to the line with an N number
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
  probe_open,   ///< the text is the whole comment
  probe_close,  ///< likewise
  abort,
  script  ///< (py, ...)
};

/// Place of a line in a file.
struct Place {
  std::uint64_t offset{0};
  std::int32_t line{0};  ///< lines before this place
};

struct ParsedBlock;

/// What a cached block remembers of where it led to.
struct Jump {
  Place to;                       ///< line behind the one that a search reached
  bool known{false};              ///< `to` is: no search any more
  ParsedBlock* block{nullptr};    ///< the block that was jumped to last
  ParsedBlock* landing{nullptr};  ///< the block that a search reached, when it computes something
  std::uint32_t leaves{0};        ///< loops and IF blocks in progress that the jump leaves
};

/// Plain and trivially copyable: what the spans and texts show belongs to the parser (until its next line) or to a BlockCache.
struct ParsedBlock {
  std::span<const ParsedWord> words;
  std::span<const Assignment> assignments;
  std::span<const ExprOp> ops;
  std::span<const Expr> arguments;  ///< of the O-word
  std::string_view comment_text;
  std::string_view text;     ///< the line as written
  Label label{Label::none};  ///< none when computed by label_expr
  Expr label_expr;
  Flow flow{Flow::none};
  CommentKind comment{CommentKind::none};
  bool skip{false};         ///< begins with /
  bool percent{false};      ///< a line that begins with %
  bool statement{false};    ///< `flow` was written without an O-word
  bool nested{false};       ///< a statement whose parts belong together by their nesting
  bool conditional{false};  ///< the words and settings happen when arguments[0] is not 0 ...
  std::uint32_t else_words{0}, else_assignments{0};  ///< ... those from here on when it is
  std::uint32_t quoted{0};  ///< a quoted text among the words: its name + 1; 0 none
  bool cached{false};       ///< lives in a BlockCache
  std::int32_t sequence{-1};

  std::uint32_t program{0};
  Place place;  ///< of this line
  Place after;  ///< of the next one

  // Only in a cache: what was found out while running.
  ParsedBlock* next{nullptr};  ///< the block at `after`, when known
  bool label_known{false};     ///< the label was found to be used rightly here
  Jump jump;
  Jump otherwise;  ///< of an elseif whose condition is false
};

}  // namespace kerf::interp
