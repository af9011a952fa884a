// Dialect: what differs between controls, as data. Nothing else in the interpreter asks which dialect runs.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "interp/letters.hpp"

namespace kerf::interp {

class Core;
struct Block;

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
};

/// Complaint about a letter that no code of its block uses.
struct LetterRow {
  char letter;
  const char* unused;  ///< null: always allowed (f, s, t, n)
};

struct Dialect {
  std::string_view name;
  std::span<const std::span<const CodeRow>> families;
  std::span<const LetterRow> letters;
  bool o_words;       ///< O-word flow control
  bool block_delete;  ///< leading /
  int last_m_code;    ///< larger: out of range
  int last_g_code;    ///< times ten
};

/// RS274NGC as LinuxCNC speaks it.
[[nodiscard]] const Dialect& linuxcnc_dialect();

/// Places in the order of execution (manual: "G-code Order of Execution").
enum Order : std::int16_t {
  kOrderComment = 10,
  kOrderFeedMode = 20,
  kOrderFeed = 30,
  kOrderSpindleMode = 35,
  kOrderSpeed = 40,
  kOrderTool = 50,
  kOrderIo = 60,
  kOrderToolChange = 70,
  kOrderSpindle = 80,
  kOrderSaveState = 90,
  kOrderCoolant = 100,
  kOrderOverride = 110,
  kOrderUser = 120,
  kOrderDwell = 130,
  kOrderPlane = 140,
  kOrderUnits = 150,
  kOrderCutterComp = 160,
  kOrderToolOffset = 170,
  kOrderCoordSystem = 180,
  kOrderLathe = 185,
  kOrderPath = 190,
  kOrderDistance = 200,
  kOrderRetract = 210,
  kOrderReference = 220,
  kOrderMotion = 230,
  kOrderStop = 240,
};

}  // namespace kerf::interp
