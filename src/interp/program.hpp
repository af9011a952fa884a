// Program: one open file with its cache of parsed lines; Flows: sub calls and loops in progress.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "interp/block.hpp"
#include "interp/modal.hpp"
#include "interp/parameters.hpp"
#include "interp/source.hpp"

namespace kerf::interp {

/// Sub calls inside sub calls (manual: O-codes; the peer allows 10).
inline constexpr std::size_t kMostLevels = 10;
/// Parsed lines kept per file; what exceeds it is read again each time.
inline constexpr std::size_t kMostCached = 200000;

struct RemapCall;

struct FileAndPlace {
  std::uint32_t program{0};
  Place place;
};

struct Program {
  std::string path;
  std::unique_ptr<LineSource> source;
  std::unordered_map<std::uint64_t, std::unique_ptr<ParsedBlock>> cache;  ///< by offset
};

struct Loop {
  std::string label;
  Flow kind{Flow::while_loop};  ///< while_, do_, repeat
  Place start;                  ///< line of the O-word
  Place body;                   ///< line after it
  std::int64_t left{0};         ///< repeats to do, this one included
};

/// A sub call, or the main program.
struct Frame {
  std::uint32_t program{0};
  Place place;                                ///< of the next line
  ParsedBlock* upcoming{nullptr};             ///< cached block at `place`, when known
  std::string sub;                            ///< label; "" for the main program
  std::array<double, kSubArguments> saved{};  ///< #1-#30 of the caller
  std::vector<Loop> loops;
  std::optional<ModalState> saved_state;  ///< M70, M73
  int saved_tool{0};                      ///< in the spindle then
  bool restore_on_return{false};          ///< M73
  std::shared_ptr<RemapCall> remap;       ///< this is the body of a remapped code
};

/// A search for an O-word line further down.
struct Skip {
  bool active{false};
  std::string label;
  FlowMask stop_at{0};
  Place from;
  ParsedBlock* origin{nullptr};  ///< cached block to remember the result in
  bool to_sub{false};            ///< looks for a definition to call, with `arguments`
  Place return_place;            ///< where the caller goes on after the sub
  bool wrapped{false};           ///< the search has begun again at the top of the file
  std::array<double, kSubArguments> arguments{};
};

struct Flows {
  std::vector<Program> programs;                       ///< [0] is MDI
  std::vector<Frame> frames;                           ///< [0] is the main program, or MDI
  std::unordered_map<std::string, FileAndPlace> subs;  ///< definitions seen, by label
  Skip skip;
  bool started{
      false};  ///< something other than blank lines was seen: no % can open the file any more
  std::shared_ptr<RemapCall> resume;  ///< a block whose remapped code is done: its rest comes next
  std::vector<Frame> parked;          ///< the main program while an MDI line runs
  std::shared_ptr<RemapCall> parked_resume;
  bool mdi{false};
  ParsedBlock* last_cached{nullptr};  ///< to link a line to the one before it
  std::uint32_t last_cached_program{0};
};

}  // namespace kerf::interp
