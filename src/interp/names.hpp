// NameTable: texts as small numbers, so that running a program compares numbers and never texts.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>

namespace kerf::interp {

/// Ids count from 0 and stay. Looking up a known name allocates nothing.
class NameTable {
 public:
  /// Memory for the texts of one table: some hundred thousand names. A program of any size must not fill the computer's.
  static constexpr std::size_t kMostBytes = std::size_t{16} * 1024 * 1024;

  NameTable() = default;
  ~NameTable() = default;
  /// The keys of `ids_` look into `texts_`: a copy has to look into its own. What is moved keeps its place.
  NameTable(const NameTable& other) { *this = other; }
  NameTable& operator=(const NameTable& other) {
    if (this == &other) return *this;
    ids_.clear();
    texts_ = other.texts_;
    bytes_ = other.bytes_;
    ids_.reserve(texts_.size());
    std::uint32_t id = 0;
    for (const std::string& text : texts_) ids_.emplace(text, id++);
    return *this;
  }
  NameTable(NameTable&&) noexcept = default;
  NameTable& operator=(NameTable&&) noexcept = default;

  /// False: `name` is a new one, and the table is full.
  [[nodiscard]] bool has_room(std::string_view name) const {
    return bytes_ + name.size() <= kMostBytes || ids_.contains(name);
  }
  [[nodiscard]] std::uint32_t intern(std::string_view name) {
    if (const auto hit = ids_.find(name); hit != ids_.end()) return hit->second;
    const auto id = static_cast<std::uint32_t>(texts_.size());
    constexpr std::size_t kEntry = 100;  // of the text's object and the map; an estimate
    bytes_ += name.size() + kEntry;
    ids_.emplace(texts_.emplace_back(name), id);  // a deque does not move what it holds
    return id;
  }
  [[nodiscard]] const std::string& text(std::uint32_t id) const { return texts_[id]; }
  [[nodiscard]] std::size_t size() const noexcept { return texts_.size(); }

 private:
  std::deque<std::string> texts_;
  std::unordered_map<std::string_view, std::uint32_t> ids_;
  std::size_t bytes_{0};
};

/// Label of an O-word. Numbers below 2^31 are themselves, so a program that computes its labels fills no table.
enum class Label : std::uint32_t {
  none = 0xFFFFFFFF,
  nested = 0xFFFFFFFE  ///< of statements that belong together by their nesting
};

class LabelTable {
 public:
  /// Of digits without leading zeros.
  [[nodiscard]] Label number(std::string_view digits) {
    if (digits.size() > 9) return named_label(digits);
    std::uint32_t n = 0;
    for (const char c : digits) n = n * 10 + static_cast<std::uint32_t>(c - '0');
    return Label{n};
  }
  [[nodiscard]] Label number(long n) {
    return n >= 0 && n <= 999999999 ? Label{static_cast<std::uint32_t>(n)}
                                    : named_label(std::to_string(n));
  }
  [[nodiscard]] bool has_room(std::string_view text) const { return names_.has_room(text); }
  /// Of <name>; `text` has the brackets.
  [[nodiscard]] Label named(std::string_view text) { return named_label(text); }
  /// "100" or "<name>"; of no label "".
  [[nodiscard]] std::string text(Label label) const {
    if (label == Label::none || label == Label::nested) return {};
    const auto n = static_cast<std::uint32_t>(label);
    return (n & kNamed) == 0 ? std::to_string(n) : names_.text(n & ~kNamed);
  }

 private:
  static constexpr std::uint32_t kNamed = 0x80000000;
  [[nodiscard]] Label named_label(std::string_view text) {
    return Label{names_.intern(text) | kNamed};
  }
  NameTable names_;
};

}  // namespace kerf::interp
