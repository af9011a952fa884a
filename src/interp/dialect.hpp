// Dialect: what differs between controls, as data. Nothing else in the interpreter asks which dialect runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "interp/block.hpp"
#include "interp/letters.hpp"

namespace kerf::interp {

class Core;
struct Block;
struct Remap;

/// Executes one code of a block. False: core.fail() was called, nothing of the block happens.
using CodeHandler = bool (*)(Core& core, const Block& block, int code);

/// How a code uses the axis words of its block.
enum class AxisUse : std::uint8_t { none, optional, required };

/// One G- or M-code.
struct CodeRow {
  char letter;         ///< 'g' or 'm'
  std::int16_t code;   ///< G: times ten; M: the number
  std::int16_t last;   ///< same as code, or the end of a range
  std::int8_t group;   ///< modal group as in the manual's tables; two of one group are an error
  std::int16_t order;  ///< place in the order of execution (manual: "Order of Execution")
  CodeHandler run;     ///< null: only changes how another code of the block works (G53)
  LetterMask words;    ///< letters it may use besides axes
  AxisUse axes;
  const Remap* remap{nullptr};  ///< [RS274NGC]REMAP gave it another body
};

/// Complaint about a letter that no code of its block uses.
struct LetterRow {
  char letter;
  const char* unused;  ///< null: always allowed (f, s, t, n)
};

/// What joins the parts of a statement, or what it refers to.
enum class Joins : std::uint8_t {
  number,   ///< `WHILE [..] DO2` ... `END2`; numbers may be used again
  nesting,  ///< `IF [..]` ... `ELSE` ... `ENDIF`, `WHILE [..]` ... `ENDWHILE`
  line,     ///< `IF [..] GOTO 100`: the line that begins with N100; the number may be computed
  rest,     ///< `IF [..] THEN #1=2 ELSE #1=3`: the rest of the line
};

/// A statement without an O-word at the beginning of a line: its first word, whether a condition follows, and what stands behind
/// that. Of rows with one word the first that fits counts, so the one with nothing behind the condition comes last; a word
/// that begins with another one comes before that (ENDIF before END).
struct StatementRow {
  std::string_view word;
  Flow flow;
  bool condition;
  std::string_view behind;
  Joins joins{Joins::number};
  std::string_view otherwise{};  ///< of Joins::rest: what the line does when the condition is 0
};

/// A function beside those of the language, `PRM[110]`: false when core.fail() was called.
struct ExternalFunction {
  std::string_view name;
  bool (*run)(Core& core, double& value);
};

struct Dialect {
  std::string_view name;
  std::span<const std::span<const CodeRow>> families;
  std::span<const LetterRow> letters;
  bool o_words;       ///< O-word flow control
  bool block_delete;  ///< leading /
  int last_m_code;    ///< larger: out of range
  int last_g_code;    ///< times ten
  int call_levels;    ///< subs inside subs
  std::size_t
      longest_line;  ///< characters, blanks and comments too; what bounds the memory for one line
  std::span<const StatementRow> statements{};
  std::span<const ExternalFunction> functions{};
  bool bare_names{false};                      ///< `_value` is #<_value>
  bool quotes{false};                          ///< "texts" can be written
  int first_text{1}, last_text{0};             ///< numbers of parameters that hold texts
  std::span<const std::int16_t> text_codes{};  ///< M-codes that take a quoted text
};

/// RS274NGC as LinuxCNC speaks it.
[[nodiscard]] const Dialect& linuxcnc_dialect();

/// Names that [RS274NGC]DIALECT may have; the first is the default.
[[nodiscard]] std::span<const std::string_view> dialect_names();
/// The dialect of one of these names; of any other the default.
[[nodiscard]] const Dialect& dialect_of(std::string_view name);

// Places in the order of execution (manual: "G-code Order of Execution").
inline constexpr std::int16_t kOrderComment = 10;
inline constexpr std::int16_t kOrderSpindleMode = 15;
inline constexpr std::int16_t kOrderFeedMode = 20;
inline constexpr std::int16_t kOrderFeed = 30;
inline constexpr std::int16_t kOrderSpeed = 40;
inline constexpr std::int16_t kOrderTool = 50;
inline constexpr std::int16_t kOrderIo = 60;
inline constexpr std::int16_t kOrderToolChange = 70;
inline constexpr std::int16_t kOrderSpindle = 80;
inline constexpr std::int16_t kOrderSaveState = 90;
inline constexpr std::int16_t kOrderCoolant = 100;
inline constexpr std::int16_t kOrderOverride = 110;
inline constexpr std::int16_t kOrderUser = 120;
inline constexpr std::int16_t kOrderDwell = 130;
inline constexpr std::int16_t kOrderPlane = 140;
inline constexpr std::int16_t kOrderUnits = 150;
inline constexpr std::int16_t kOrderLathe = 155;
inline constexpr std::int16_t kOrderCutterComp = 160;
inline constexpr std::int16_t kOrderToolOffset = 170;
inline constexpr std::int16_t kOrderCoordSystem = 180;
inline constexpr std::int16_t kOrderPath = 190;
inline constexpr std::int16_t kOrderDistance = 200;
inline constexpr std::int16_t kOrderArcDistance = 205;
inline constexpr std::int16_t kOrderRetract = 210;
inline constexpr std::int16_t kOrderReference = 220;
inline constexpr std::int16_t kOrderMotion = 230;
inline constexpr std::int16_t kOrderStop = 240;

}  // namespace kerf::interp
