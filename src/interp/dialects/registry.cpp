// The dialects there are.
#include <array>

#include "interp/dialect.hpp"

namespace kerf::interp {

namespace {

struct Row {
  std::string_view name;
  const Dialect& (*dialect)();
};
constexpr Row kDialects[] = {
    {"linuxcnc", linuxcnc_dialect},
};

constexpr auto kNames = [] {
  std::array<std::string_view, std::size(kDialects)> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kDialects[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> dialect_names() { return kNames; }

const Dialect& dialect_of(std::string_view name) {
  for (const Row& row : kDialects) {
    if (row.name == name) return row.dialect();
  }
  return kDialects[0].dialect();
}

}  // namespace kerf::interp
