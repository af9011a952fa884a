// Words of a line, without regard to case.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kerf::rsh {

[[nodiscard]] std::string lower(std::string_view text);
[[nodiscard]] std::string upper(std::string_view text);
/// Takes the first word off the text; "" when there is none.
std::string_view take_word(std::string_view& rest);
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// The whole word as a finite number.
[[nodiscard]] std::optional<double> to_number(std::string_view word);
[[nodiscard]] std::optional<long> to_integer(std::string_view word);
/// For messages: what does not print is shown as '?', and long texts are cut.
[[nodiscard]] std::string shown(std::string_view text);
/// "%f"
[[nodiscard]] std::string fixed(double value);
/// A number as task reads it, exact.
[[nodiscard]] std::string exact(double value);

}  // namespace kerf::rsh
