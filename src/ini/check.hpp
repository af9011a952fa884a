// Holds a machine file against the table of keys: unknown keys, keys without effect, wrong values.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ini/ini_file.hpp"
#include "ini/keys.hpp"

namespace kerf::ini {

/// Which INI values HAL files use, so that keys of the user's own are not taken for mistakes.
class HalUse {
 public:
  /// Collects [SECTION]KEY and [SECTION](KEY), as HAL files write it.
  void add_text(std::string_view text);
  /// The same of a Tcl file, where ARRAY(KEY) is a value too, and a name may be put together: any word of it may be a key.
  void add_script(std::string_view text);
  [[nodiscard]] bool uses(std::string_view section, std::string_view key) const;
  [[nodiscard]] bool uses_section(std::string_view section) const;

 private:
  std::set<std::pair<std::string, std::string>, std::less<>> pairs_;
  std::set<std::string, std::less<>> words_;  ///< of scripts
};

/// Everything that is wrong, in file order. Errors: values that Kerf could not use. Warnings: keys that nobody knows
/// (with the nearest name), that are not supported (with the reason), a second line of a key that counts once, and
/// values that a screen or HAL file could not use.
[[nodiscard]] std::vector<Diagnostic> check_keys(const IniFile& file, const HalUse& hal,
                                                 const KeyTable& table = machine_keys());

}  // namespace kerf::ini
