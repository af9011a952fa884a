// Program: one open file with its cache of parsed lines; Flows: sub calls and loops in progress.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "interp/block.hpp"
#include "interp/modal.hpp"
#include "interp/parameters.hpp"
#include "interp/source.hpp"

namespace kerf::interp {

/// Memory for parsed lines, all files together; what exceeds it is read and parsed again each time.
inline constexpr std::size_t kMostCachedBytes = std::size_t{20} * 1024 * 1024;

/// The parsed lines of one file that may run again, by their offset.
class BlockCache {
 public:
  [[nodiscard]] ParsedBlock* find(std::uint64_t offset) const {
    const auto hit = blocks_.find(offset);
    return hit == blocks_.end() ? nullptr : hit->second;
  }
  /// A lasting copy of `b` with all that it shows. One that is there already is returned as it is.
  ParsedBlock* keep(const ParsedBlock& b);
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  void clear();

 private:
  template <class T>
  std::span<const T> copy(std::span<const T> from);

  std::pmr::monotonic_buffer_resource memory_;
  std::unordered_map<std::uint64_t, ParsedBlock*> blocks_;
  std::size_t bytes_{0};
};

struct RemapCall;
struct ProfileReading;

/// Labels of O-words remembered per file, to find one that is used twice; further ones are not checked.
inline constexpr std::size_t kMostLabels = 50000;

/// Subs of a program.
inline constexpr std::size_t kMostSubs = 100000;

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
/// A label and the sub that it stands in.
[[nodiscard]] constexpr std::uint64_t label_key(Label sub, Label label) noexcept {
  return std::uint64_t{static_cast<std::uint32_t>(sub)} << 32 | static_cast<std::uint32_t>(label);
}

struct Program {
  std::string path;
  std::unique_ptr<LineSource> source;
  std::unique_ptr<BlockCache> cache;                   ///< null until a line is kept
  std::unordered_map<std::uint64_t, LabelUse> labels;  ///< by label_key()
  LineStream* stream{nullptr};                         ///< `source`, when it is one
  bool goes_back{false};                               ///< a GOTO led back, so its lines run again
};

/// A sub that was seen.
struct Sub {
  FileAndPlace where;
  ParsedBlock* body{nullptr};  ///< its first block, when known
};

/// A loop, or an IF block of a statement without an O-word.
struct Loop {
  Label label{Label::none};
  Flow kind{Flow::while_loop};  ///< while_, do_, repeat, if_
  Place start;                  ///< line of the O-word
  Place body;                   ///< line after it
  std::int64_t left{0};         ///< repeats to do, this one included
};

/// What a frame of a script does: its function works as prolog, body or epilog, or lines that it asked for are executed.
enum class ScriptPhase : std::uint8_t { none, prolog, body, epilog, execute };

/// A sub call, or the main program.
struct Frame {
  std::uint32_t program{0};
  Place place;                     ///< of the next line
  ParsedBlock* upcoming{nullptr};  ///< cached block at `place`, when known
  ParsedBlock** link{nullptr};     ///< where to remember the block at `place` once it is known
  Label sub{Label::none};          ///< none for the main program
  std::size_t first_loop{0};       ///< of this frame in Flows::loops
  bool numbered{false};            ///< called by M98: #1-#30 are the caller's
  std::int64_t times{1};           ///< M98 L: runs to do, this one included
  Place start;                     ///< of the sub's first line
  std::array<double, kSubArguments> saved{};  ///< #1-#30 of the caller
  std::unique_ptr<ModalState> saved_state;    ///< M70, M73
  int saved_tool{0};                          ///< in the spindle then
  bool restore_on_return{false};              ///< M73
  std::shared_ptr<RemapCall> remap;  ///< this is the body of a remapped code, or a function
  ScriptPhase phase{ScriptPhase::none};
  bool started{false};  ///< the function of the phase

  [[nodiscard]] bool is_sub() const noexcept { return sub != Label::none; }
  void go_to(const Place& where) {
    place = where;
    upcoming = nullptr;
    link = nullptr;
  }
  /// As a jump of the block `from`, which remembers in `jump` the block there.
  void go_to(const Place& where, const ParsedBlock& from, Jump& jump) {
    place = where;
    const bool hit = jump.block != nullptr && jump.block->place.offset == where.offset;
    upcoming = hit ? jump.block : nullptr;
    link = !hit && from.cached ? &jump.block : nullptr;
  }
  void go_behind(ParsedBlock& b) {
    place = b.after;
    upcoming = b.next;
    link = b.cached && b.next == nullptr ? &b.next : nullptr;
  }
};

/// A search for an O-word line. The frame stays where it is until the line is found.
struct Skip {
  bool active{false};
  Label label{Label::none};
  FlowMask stop_at{0};
  Place from;
  std::uint32_t program{0};
  Place place;                    ///< of the line to look at next
  Jump* origin{nullptr};          ///< of a cached block: where to remember the result
  ParsedBlock* landing{nullptr};  ///< found before: nothing to search
  bool numbered{false};           ///< the call is M98 ...
  std::int64_t times{1};          ///< ... with this L
  std::size_t argument_count{0};
  bool to_sub{false};    ///< looks for a definition to call, with `arguments`
  bool sub_file{false};  ///< in a file that was opened for it
  bool wrapped{false};   ///< the search has begun again at the top of the file
  int depth{0};          ///< nested statements that the search is inside of
  std::size_t open{0};   ///< of a GOTO: Flows::loops that the place looked at is still inside of
  std::array<double, kSubArguments> arguments{};

  /// A statement that belongs to another one, inside of what is searched.
  [[nodiscard]] bool passes(const ParsedBlock& b) noexcept {
    if (!b.nested) return true;
    if (b.flow == Flow::if_block || b.flow == Flow::while_loop) return ++depth, true;
    if (depth == 0) return false;
    if (b.flow == Flow::endif || b.flow == Flow::endwhile) --depth;
    return true;
  }
  /// A call of an O-sub without arguments; the caller sets the rest.
  void begin_call() noexcept {
    numbered = false;
    times = 1;
    argument_count = 0;
    arguments.fill(0);
  }
};

struct Flows {
  std::vector<Program> programs;        ///< [0] is MDI
  std::vector<Frame> frames;            ///< [0] is the main program, or MDI
  std::vector<Loop> loops;              ///< in progress, of all frames, the parked ones too
  std::unordered_map<Label, Sub> subs;  ///< definitions seen
  LabelTable labels;
  Skip skip;
  bool started{
      false};  ///< something other than blank lines was seen: no % can open the file any more
  std::shared_ptr<RemapCall> resume;  ///< a block whose remapped code is done: its rest comes next
  std::vector<Frame> parked;          ///< the main program while an MDI line runs
  std::shared_ptr<RemapCall> parked_resume;
  std::shared_ptr<ProfileReading> profile;  ///< a lathe cycle that reads its sub
  std::shared_ptr<ProfileReading> parked_profile;
  bool mdi{false};
};

}  // namespace kerf::interp
