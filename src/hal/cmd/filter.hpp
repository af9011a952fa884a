// What show, list and status are asked for: kinds of objects, and the patterns of their names.
#pragma once

#include <fnmatch.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// Which names are wanted: any that begins with or matches one of the patterns; -tTYPE first restricts the type.
struct Filter {
  Type type{Type::unspecified};
  std::span<const std::string> patterns;
  bool exact{false};

  static rtapi::Result<Filter> make(std::span<const std::string> words) {
    Filter f{Type::unspecified, words, false};
    if (words.empty() || words[0].rfind("-t", 0) != 0) return f;
    f.type = type_from_name(std::string_view(words[0]).substr(2));
    if (f.type == Type::unspecified) {
      return rtapi::fail(rtapi::Errc::bad_argument, "Unknown type '" + words[0].substr(2) + "'");
    }
    f.patterns = words.subspan(1);
    return f;
  }
  /// The same, for names that are equal to one of the patterns.
  [[nodiscard]] Filter exactly() const { return {type, patterns, true}; }
  [[nodiscard]] bool takes(const std::string& name, Type t = Type::unspecified) const {
    if (type != Type::unspecified && t != type) return false;
    if (patterns.empty()) return true;
    for (const auto& p : patterns) {
      if (exact ? name == p : name.rfind(p, 0) == 0 || fnmatch(p.c_str(), name.c_str(), 0) == 0)
        return true;
    }
    return false;
  }
};

/// The kinds that `show ITEM` tells; "" and "all" are every one but pinexact.
struct ShownKinds {
  bool comp{false};
  bool alias{false};
  bool pin{false};
  bool pinexact{false};
  bool sig{false};
  bool param{false};
  bool funct{false};
  bool thread{false};

  static rtapi::Result<ShownKinds> of(std::string_view item);
};

/// The parts of `status ITEM`.
struct ShownStatus {
  bool all{false};
  bool lock{false};
  bool memory{false};

  static rtapi::Result<ShownStatus> of(std::string_view item);
};

/// The names that `list ITEM` gives.
rtapi::Result<std::vector<std::string>> listed_names(const View& view, std::string_view item,
                                                     std::span<const std::string> patterns);

}  // namespace kerf::hal
