#include "motion/core/path/reach.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion::path {
namespace {

/// Plans aim this much below the limits, so that rounding never crosses them; and the pass from the end a little lower than the pass from
/// the start, so that a row that is full in the one has room in the other (rows nearly parallel to an axis magnify rounding).
constexpr double kBackward = 1.0 - 1e-7;
constexpr double kForward = 1.0 - 1e-8;
/// Within a stretch that was entered well a row may seem passed by the error of an arc's rows; with p near 0 that would turn into nonsense for x1.
constexpr double kUnderWay = 1.0 + 1e-5;
constexpr double kFlat = 1e-9;

/// Both bounds of x0 for a given x1, as lines in x1: upper = least of (1 - b x1)/a, lower = largest of (-1 - b x1)/a.
struct Bound {
  double value{0}, slope{0};
};

Bound upper_of_x0(std::span<const Row> rows, double x1) noexcept {
  Bound out{kNoLimit, 0};
  for (const Row& r : rows) {
    if (r.a == 0) continue;
    const double value = ((r.a > 0 ? kBackward : -kBackward) - r.b * x1) / r.a;
    if (value < out.value) out = {value, -r.b / r.a};
  }
  return out;
}

Bound lower_of_x0(std::span<const Row> rows, double x1) noexcept {
  Bound out{0, 0};
  for (const Row& r : rows) {
    if (r.a == 0) continue;
    const double value = ((r.a > 0 ? -kBackward : kBackward) - r.b * x1) / r.a;
    if (value > out.value) out = {value, -r.b / r.a};
  }
  return out;
}

}  // namespace

// upper - lower is concave in x1 and at least 0 at 0, upper is concave: both searches follow lines from the right and end after as
// many steps as there are different lines.
double largest_x0(std::span<const Row> rows, double most) noexcept {
  double right = most;
  for (const Row& r : rows)
    if (r.a == 0 && r.b != 0) right = std::min(right, kBackward / std::abs(r.b));
  for (int n = 0; n < 64; ++n) {
    const Bound up = upper_of_x0(rows, right), low = lower_of_x0(rows, right);
    const double gap = up.value - low.value;
    if (gap >= 0) break;
    const double slope = up.slope - low.slope;  // below 0: the gap closes towards the right
    if (slope >= 0) {
      right = 0;
      break;
    }
    right = std::max(0.0, right - gap / slope);
    if (n == 63) right *= 1 - 1e-3;
  }
  Bound at_right = upper_of_x0(rows, right);
  if (at_right.slope >= 0 || right == 0) return at_right.value;
  double left = 0;
  Bound at_left = upper_of_x0(rows, 0);
  if (at_left.slope <= 0) return at_left.value;
  for (int n = 0; n < 64; ++n) {
    // Where the rising line of the left meets the falling line of the right.
    const double at = left + ((at_right.value - at_right.slope * (right - left)) - at_left.value) /
                                 (at_left.slope - at_right.slope);
    const Bound here = upper_of_x0(rows, at);
    const double top = at_left.value + at_left.slope * (at - left);
    if (here.value >= top * (1 - 1e-12)) return here.value;
    if (here.slope > 0) {
      left = at;
      at_left = here;
    } else if (here.slope < 0) {
      right = at;
      at_right = here;
    } else {
      return here.value;
    }
  }
  return std::max(at_left.value, at_right.value);
}

Range range_of_x1(std::span<const Row> rows, double x0, bool under_way) noexcept {
  const double full = under_way ? kUnderWay : kForward;
  double low = -kNoLimit, high = kNoLimit;
  for (const Row& r : rows) {
    // A row that hardly depends on x1 would only magnify the rounding of x0.
    if (std::abs(r.b) <= kFlat * std::abs(r.a)) continue;
    const double p = (full - r.a * x0) / r.b, q = (-full - r.a * x0) / r.b;
    low = std::max(low, std::min(p, q));
    high = std::min(high, std::max(p, q));
  }
  return {low, high};
}

}  // namespace kerf::motion::path
