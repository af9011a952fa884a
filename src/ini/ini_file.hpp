// The one INI reader: every program of Kerf reads machine files through this class.
//
// The format is that of the newest LinuxCNC reader: `[SECTION]`, `KEY = value`, `#` and `;` comment
// lines (a comment after a value is part of the value), a backslash at the line end continues the
// line, `\n \t \x41 \u00e9 ...` escapes, repeated keys, `#INCLUDE file` from column 1. Names are
// case-sensitive. A file with any error does not load, but every error in it is reported at once.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace kerf::ini {

/// A place in a user's file. `line` counts from 1; 0: the file as a whole.
struct Position {
  std::string file;
  int line{0};

  /// "FILE:LINE", "FILE", or "" when no file is known.
  [[nodiscard]] std::string text() const;
};

/// One error or warning about an INI file.
struct Diagnostic {
  Position at;
  bool is_error{true};
  std::string text;

  /// "FILE:LINE: error: TEXT" or "FILE:LINE: warning: TEXT", as far as the place is known.
  [[nodiscard]] std::string message() const;
};

/// One `KEY = value` line. `value` is trimmed and its escapes are resolved.
struct Entry {
  std::string section;
  std::string key;
  std::string value;
  Position at;  ///< where the line begins, in the file that has it (not the including one)
};

struct LoadResult;

/// The content of an INI file with all its includes. Immutable once loaded; copies are deep.
class IniFile {
 public:
  /// Reads `path` and what it includes. Never throws on bad input: see LoadResult.
  [[nodiscard]] static LoadResult load(const std::string& path);

  /// Reads INI text. `name` stands for the file in messages; includes are relative to its folder.
  [[nodiscard]] static LoadResult parse(std::string_view text, const std::string& name);

  /// The `num`-th (from 1) value of `key`, or null. An empty `section` means any section, in file
  /// order; an empty `key` means any key. The pointer lives as long as this object stays in place.
  [[nodiscard]] const Entry* find(std::string_view section, std::string_view key,
                                  std::size_t num = 1) const;

  /// All values of `key`, in file order; empty names as in find().
  [[nodiscard]] std::vector<const Entry*> find_all(std::string_view section,
                                                   std::string_view key) const;

  /// Section names in the order of their first header.
  [[nodiscard]] std::vector<std::string> sections() const;

  /// Every entry of `section` (all sections if empty) in file order, repeated keys repeatedly.
  [[nodiscard]] std::vector<const Entry*> variables(std::string_view section) const {
    return find_all(section, {});
  }

  [[nodiscard]] bool has_section(std::string_view section) const;

  /// Where `section`'s first header stands; the file itself (line 0) when there is none.
  [[nodiscard]] Position section_position(std::string_view section) const;

  /// The name the file was loaded by.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  friend class Parser;
  struct Section {
    std::string name;
    Position at;
  };

  [[nodiscard]] const std::vector<std::size_t>* indices(std::string_view section,
                                                        std::string_view key) const;
  void add(Entry entry);

  std::string name_;
  std::vector<Section> sections_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> all_;
  // "SECTION\nKEY", "SECTION\n" and "\nKEY" -> entries, so that look-ups never walk the file.
  std::unordered_map<std::string, std::vector<std::size_t>> index_;
};

/// What loading gives. With `ok` false the file must not be used; `file` then holds what could be
/// read, for messages only.
struct LoadResult {
  IniFile file;
  std::vector<Diagnostic> diagnostics;
  bool ok{false};
};

/// Replaces a leading "~/" by $HOME; anything else stays.
[[nodiscard]] std::string expand_tilde(std::string_view path);

}  // namespace kerf::ini
