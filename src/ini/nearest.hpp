// The nearest known name, for "did you mean" in INI messages (internal to src/ini, which uses
// nothing else of the project).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kerf::ini {

/// The name in `known` that a person who typed `name` probably meant, or "" if none is near.
/// Case, one swap of neighbours and a few wrong characters count little.
[[nodiscard]] std::string nearest_name(std::string_view name,
                                       const std::vector<std::string>& known);

}  // namespace kerf::ini
