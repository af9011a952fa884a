// ParameterTable: numbered and named parameters, and ParameterFile: the .var file that keeps some of them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "interp/names.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::interp {

using rtapi::Pose;

inline constexpr int kParameterCount = 5603;  ///< numbers 1 to 5602
inline constexpr int kSubArguments = 30;      ///< #1-#30 are local to a sub

// Numbers with a meaning (manual: "Numbered Parameters").
inline constexpr int kProbe = 5061;  ///< 5061-5069 result of G38.x
inline constexpr int kProbeSuccess = 5070;
inline constexpr int kG28Home = 5161;
inline constexpr int kG30Home = 5181;
inline constexpr int kG92Applied = 5210;
inline constexpr int kG92Offset = 5211;
inline constexpr int kCoordSystem = 5220;
inline constexpr int kG5xOffset = 5221;  ///< + 20 * (system - 1); + 9 is R
inline constexpr int kInputValue = 5399;
inline constexpr int kToolNumber = 5400;  ///< -5413, read from the tool in the spindle
inline constexpr int kToolLast = 5413;
inline constexpr int kPosition = 5420;  ///< -5428, read from the interpreter's position
inline constexpr int kPositionLast = 5428;
inline constexpr int kDebugEnable = 5599;
inline constexpr int kChangerFault = 5600;
inline constexpr int kChangerReason = 5601;

/// A number, or a text (dialects with string parameters). The number of a text is 0.
struct Value {
  double number{0};
  std::shared_ptr<const std::string> text;
};

/// Names are given in lower case without blanks. Changes between begin() and commit() can be taken back: a block in
/// error leaves no trace.
class ParameterTable {
 public:
  ParameterTable();

  // --- numbered ---
  /// index 1 .. kParameterCount-1; others read 0 and ignore writes.
  [[nodiscard]] double get(int index) const noexcept {
    input_read_ = input_read_ || index == kInputValue;
    return index > 0 && index < kParameterCount ? numbers_[static_cast<std::size_t>(index)] : 0.0;
  }
  /// Whether #5399, the result of M66, was read since the last call.
  [[nodiscard]] bool take_input_read() noexcept { return std::exchange(input_read_, false); }
  void set(int index, double value);
  /// A text (dialects with such numbers); the number reads 0 then.
  void set_text(int index, std::shared_ptr<const std::string> text);
  [[nodiscard]] std::shared_ptr<const std::string> text(int index) const {
    const auto hit = number_texts_.find(index);
    return hit == number_texts_.end() ? nullptr : hit->second;
  }
  /// #1-#30 become `fresh`; what they were. Not taken back by rollback(): earlier changes of the block are settled by it.
  std::array<double, kSubArguments> exchange_arguments(
      const std::array<double, kSubArguments>& fresh);
  /// Nine numbers from `first` on as a pose in mm (and back), `unit_mm` being mm per stored unit.
  [[nodiscard]] Pose pose(int first, double unit_mm) const noexcept;
  void set_pose(int first, const Pose& pose, double unit_mm);
  /// True for what the program may not assign (5400-5413, 5420-5428).
  [[nodiscard]] static bool read_only(int index) noexcept {
    return (index >= kToolNumber && index <= kToolLast) ||
           (index >= kPosition && index <= kPositionLast);
  }
  /// True for what the parameter file keeps by the manual; other numbers are kept when the file has them.
  [[nodiscard]] static bool persistent(int index) noexcept;

  // --- named ---
  /// Id of a name, the same for the life of the table.
  [[nodiscard]] std::uint32_t intern(std::string_view name);
  /// False: the name is a new one, and there are too many already.
  [[nodiscard]] bool has_room(std::string_view name) const { return texts_.has_room(name); }
  [[nodiscard]] const std::string& name(std::uint32_t id) const { return texts_.text(id); }
  [[nodiscard]] bool is_global(std::uint32_t id) const { return names_[id].global; }
  /// Null when there is none in the current scope.
  [[nodiscard]] const Value* find(std::uint32_t id) const {
    const Name& n = names_[id];
    if (n.global) return n.set ? &n.value : nullptr;
    if (n.local < scopes_.back()) return nullptr;  // of a caller, or none
    const Local& local = locals_[static_cast<std::size_t>(n.local)];
    return local.set ? &local.value : nullptr;
  }
  void set_named(std::uint32_t id, Value value);
  /// Names that have a value here, for "did you mean".
  [[nodiscard]] std::vector<std::string_view> visible_names() const;
  /// Scopes of local names: one per sub call. The outermost stays.
  void push_scope();
  void pop_scope();

  // --- taking back ---
  void begin() noexcept { undo_numbers_.clear(), undo_named_.clear(), undo_texts_.clear(); }
  void rollback();

 private:
  friend class ParameterFile;
  /// Locals of all scopes lie on one stack; a name knows its newest one, so that a look-up costs the same however many there are.
  static constexpr std::int64_t kNoLocal = -1;
  struct Name {
    bool global{false};
    bool set{false};
    std::int64_t local{kNoLocal};  ///< in locals_
    Value value;                   ///< of globals
  };
  struct Local {
    std::uint32_t id;
    bool set;
    std::int64_t hidden;  ///< Name::local before this one
    Value value;
  };
  struct NamedUndo {
    std::uint32_t id;
    bool set;
    Value value;
  };
  struct Slot {
    bool* set;
    Value* value;
  };
  Slot slot(std::uint32_t id);
  void change_text(int index, std::shared_ptr<const std::string> text);

  std::vector<double> numbers_;
  mutable bool input_read_{false};
  std::vector<std::int32_t> extra_persistent_;  ///< user numbers that the file had
  NameTable texts_;
  std::vector<Name> names_;
  std::vector<Local> locals_;
  std::vector<std::int64_t> scopes_{0};  ///< where each begins in locals_
  std::unordered_map<int, std::shared_ptr<const std::string>> number_texts_;
  std::vector<std::pair<int, std::shared_ptr<const std::string>>> undo_texts_;
  std::vector<std::pair<std::int32_t, double>> undo_numbers_;
  std::vector<NamedUndo> undo_named_;
};

/// The peer's format: lines "number<tab>value"; lines without exactly two numbers are skipped; numbers ascend.
class ParameterFile {
 public:
  explicit ParameterFile(std::string path) : path_(std::move(path)) {}
  /// Numbers that the file does not name stay as they are. Errors: not_found, syntax (out of order, out of range).
  [[nodiscard]] rtapi::Status load(ParameterTable& table) const;
  /// Whole or not at all: PATH.new is written and synced, PATH is kept as PATH.bak, then replaced. Where PATH says the same already
  /// nothing is written: most programs change no parameter that lasts, and a slow disk would hold up the end of each.
  [[nodiscard]] rtapi::Status save(const ParameterTable& table) const;
  /// The text that save() writes.
  [[nodiscard]] static std::string text(const ParameterTable& table);

 private:
  [[nodiscard]] bool holds(const std::string& content) const;
  std::string path_;
};

}  // namespace kerf::interp
