// Predefined: the read-only named parameters `#<_...>` that tell the state of the interpreter.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace kerf::interp {

class Core;

/// Manual: "Predefined Named Parameters". Rows are data: name and how to compute it.
class Predefined {
 public:
  using Getter = double (*)(const Core&);
  /// Getter of the name (lower case, with its leading _), or null.
  [[nodiscard]] static Getter find(std::string_view name);
  /// Adds all names, for "did you mean".
  static void add_names(std::vector<std::string_view>& names);
  /// As find(), remembered by name id.
  [[nodiscard]] Getter by_id(std::uint32_t id, std::string_view name);

 private:
  std::vector<std::optional<Getter>> known_;
};

}  // namespace kerf::interp
