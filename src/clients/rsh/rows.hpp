// What the rows of the table share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clients/rsh/session.hpp"
#include "clients/rsh/table.hpp"
#include "clients/rsh/text.hpp"

namespace kerf::rsh {

inline constexpr Argument kOnOff[]{{"on or off", ArgumentType::choice, true, "on,off"}};
inline constexpr Argument kOptionalJoint[]{{"joint", ArgumentType::joint, false}};
inline constexpr Argument kJoint[]{{"joint", ArgumentType::joint}};
inline constexpr Argument kOptionalAxis[]{{"axis", ArgumentType::axis, false}};
inline constexpr Argument kOptionalSpindle[]{{"spindle", ArgumentType::spindle, false}};

inline std::string on_off(bool on) { return on ? "ON" : "OFF"; }

/// The answer for one joint ("0 YES"), or for all of them ("YES YES NO").
template <class F>
std::string per_joint(Session& s, const Values& v, F&& text) {
  const int wanted = v.index(0);
  if (wanted >= 0) return std::to_string(wanted) + " " + text(static_cast<std::size_t>(wanted));
  std::string out;
  for (int j = 0; j < s.stat().joints; ++j)
    out += (j == 0 ? "" : " ") + text(static_cast<std::size_t>(j));
  return out;
}

/// The answer for one axis ("X 1.000000"), or for all nine.
template <class F>
std::string per_axis(const Values& v, F&& value) {
  const int wanted = v.index(0);
  if (wanted >= 0) return v.text[0] + " " + fixed(value(static_cast<std::size_t>(wanted)));
  std::string out;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) out += (a == 0 ? "" : " ") + fixed(value(a));
  return out;
}

/// The answer for one spindle ("0 FORWARD"), or a line for each.
template <class F>
std::string per_spindle(Session& s, const Values& v, F&& text) {
  const int wanted = v.index(0);
  if (wanted >= 0) return std::to_string(wanted) + " " + text(static_cast<std::size_t>(wanted));
  std::string out;
  for (int n = 0; n < s.stat().spindles; ++n)
    out += (n == 0 ? "" : "\n") + std::to_string(n) + " " + text(static_cast<std::size_t>(n));
  return out;
}

/// "MM" and so on, from machine units in one mm; the names of angles from units in one degree.
[[nodiscard]] std::string linear_units_name(double units_per_mm);
[[nodiscard]] std::string angular_units_name(double units_per_degree);
[[nodiscard]] std::string program_units_name(int program_units);

}  // namespace kerf::rsh
