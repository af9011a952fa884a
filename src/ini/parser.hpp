// Turns INI text into an IniFile (internal to src/ini).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ini/ini_file.hpp"

namespace kerf::ini {

/// How many files may be open inside each other, the first one included.
inline constexpr int kMaxIncludeDepth = 16;
/// How many files one load may read, and how much of all: a few files that include each other twice a level would else be
/// read for hours.
inline constexpr int kMaxIncludes = 1000;
inline constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

/// One load. Goes on after an error, so that the user sees every fault of the file at once.
class Parser {
 public:
  explicit Parser(const std::string& name) { out_.file.name_ = name; }

  void read_file(const std::string& path);
  void read_text(std::string_view text, const std::string& name);
  [[nodiscard]] LoadResult finish();

 private:
  struct Source {
    std::string name;       ///< as shown in messages
    std::string canonical;  ///< to recognise recursion; empty for text
  };

  void line(std::string_view text, int number);
  void section_header(std::string_view text, int number);
  void assignment(std::string_view text, int number);
  void include(std::string_view name, int number);
  /// All bytes of a file, or an errno: EFBIG when too much has been read in all.
  [[nodiscard]] int slurp(const std::string& path, std::string& out);
  [[nodiscard]] std::string resolve(std::string_view name) const;
  void error(int number, std::string text) { complain(number, true, std::move(text)); }
  void warning(int number, std::string text) { complain(number, false, std::move(text)); }
  void complain(int number, bool is_error, std::string text);

  LoadResult out_;
  std::vector<Source> stack_;
  int includes_{0};
  std::size_t bytes_left_{kMaxBytes};
  std::string section_;
  // After a broken header the section is unknown: its keys are checked but neither kept nor
  // blamed for the missing section, so that one fault gives one message.
  bool section_broken_{false};
};

}  // namespace kerf::ini
