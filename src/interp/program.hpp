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

/// Labels of O-words remembered per file, to find one that is used twice; further ones are not checked.
inline constexpr std::size_t kMostLabels = 50000;

/// Where a sub's first line stands.
struct FileAndPlace {
  std::uint32_t program{0};
  Place place;
  bool numbered{false};  ///< O100 ... M99, called by M98
};

/// What a label stands for in its sub (or in the main program).
struct LabelUse {
  Flow kind{Flow::none};  ///< the word that begins the block: if, while, do, repeat
  std::int32_t line{0};
  std::uint64_t offset{0};
};

struct Program {
  std::string path;
  std::unique_ptr<LineSource> source;
  std::unordered_map<std::uint64_t, std::unique_ptr<ParsedBlock>> cache;  ///< by offset
  std::unordered_map<std::string, LabelUse> labels;                       ///< by sub and label
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
  bool numbered{false};                       ///< called by M98: #1-#30 are the caller's
  std::int64_t times{1};                      ///< M98 L: runs to do, this one included
  Place start;                                ///< of the sub's first line
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
  bool numbered{false};          ///< the call is M98 ...
  std::int64_t times{1};         ///< ... with this L
  std::size_t argument_count{0};
  bool to_sub{false};   ///< looks for a definition to call, with `arguments`
  Place return_place;   ///< where the caller goes on after the sub
  bool wrapped{false};  ///< the search has begun again at the top of the file
  std::array<double, kSubArguments> arguments{};

  /// A call of an O-sub without arguments; the caller sets the rest.
  void begin_call() noexcept {
    numbered = false;
    times = 1;
    argument_count = 0;
    arguments.fill(0);
  }
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
