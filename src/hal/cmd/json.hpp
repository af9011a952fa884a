// What `halcmd --json` prints. docs/hal-json.md says what each key means; keys are only ever added.
//
// One JSON value a command, ended by a newline. Numbers are numbers in their full width (s64 and u64 are exact), bits are true
// or false; a float that JSON has no number for is the string "nan", "inf" or "-inf".
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// The items and patterns of show_text().
rtapi::Result<std::string> show_json(const View& view, std::string_view item,
                                     std::span<const std::string> patterns);
rtapi::Result<std::string> list_json(const View& view, std::string_view item,
                                     std::span<const std::string> patterns);
rtapi::Result<std::string> status_json(const View& view, std::string_view item);
/// Of getp and gets.
std::string value_json(const std::string& name, Type type, std::uint64_t raw);
/// Of ptype and stype.
std::string type_json(const std::string& name, Type type);
/// A failed command; goes to stderr.
std::string error_json(const std::string& file, int line, const std::string& message);

}  // namespace kerf::hal
