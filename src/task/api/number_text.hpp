// Lengths and speeds in texts for people.
#pragma once

#include <cstdio>
#include <string>

namespace kerf::task {

/// Four decimals, without the zeros at the end: "12.5", "3", "0".
[[nodiscard]] inline std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", v);
  std::string out(text);
  while (out.back() == '0') out.pop_back();
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

}  // namespace kerf::task
