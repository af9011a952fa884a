// The rows of linuxcnctop: each attribute of the machine's status by the name that LinuxCNC's Python module gives it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/common/stat.hpp"

namespace kerf::clients::top {

/// The names, sorted.
[[nodiscard]] std::vector<std::string_view> names();

/// One value as text for people: numbers of states by their names, positions by their letters.
[[nodiscard]] std::string text(const Stat& stat, std::string_view name);

/// An object of the named attributes (all, when there are no names), with numbers as in Python; one line.
[[nodiscard]] std::string json(const Stat& stat, std::span<const std::string> names);

}  // namespace kerf::clients::top
