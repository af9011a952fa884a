// Places for tests of curves.
#pragma once

#include "motion/core/path/vec.hpp"

namespace kerf::motion::path {

inline Vec xyz(double x, double y, double z = 0) { return {{x, y, z}}; }

inline Vec everywhere(double value) {
  Vec v;
  v.at.fill(value);
  return v;
}

}  // namespace kerf::motion::path
