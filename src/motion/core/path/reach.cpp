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

/// A bound of x0 for a given x1, and how it changes with x1.
struct Bound {
  double value{0}, slope{0};
};

/// The rows as bounds of x0, lines in x1: -height + slope x1 <= x0 <= height + slope x1.
class Lines {
 public:
  explicit Lines(std::span<const Row> rows) noexcept {
    for (const Row& r : rows) {
      if (r.a == 0) continue;
      const double over = 1.0 / r.a;
      height_[count_] = kBackward * std::abs(over);
      slope_[count_] = -r.b * over;
      ++count_;
    }
  }
  /// The least of the upper ones.
  [[nodiscard]] Bound upper(double x1) const noexcept {
    Bound out{kNoLimit, 0};
    for (std::size_t i = 0; i < count_; ++i) {
      const double value = height_[i] + slope_[i] * x1;
      if (value < out.value) out = {value, slope_[i]};
    }
    return out;
  }
  /// The largest of the lower ones and 0.
  [[nodiscard]] Bound lower(double x1) const noexcept {
    Bound out{0, 0};
    for (std::size_t i = 0; i < count_; ++i) {
      const double value = slope_[i] * x1 - height_[i];
      if (value > out.value) out = {value, slope_[i]};
    }
    return out;
  }

 private:
  // Only the first ones are ever written or read.
  double height_[kMaxRows];
  double slope_[kMaxRows];
  std::size_t count_{0};
};

}  // namespace

// upper - lower is concave in x1 and at least 0 at 0, upper is concave: both searches follow lines from the right and end after as
// many steps as there are different lines.
double largest_x0(std::span<const Row> rows, double most) noexcept {
  double right = most;
  for (const Row& r : rows)
    if (r.a == 0 && r.b != 0) right = std::min(right, kBackward / std::abs(r.b));
  const Lines lines(rows);
  Bound at_right;
  for (int n = 0; n < 64; ++n) {
    at_right = lines.upper(right);
    const Bound low = lines.lower(right);
    const double gap = at_right.value - low.value;
    if (gap >= 0) break;
    const double slope = at_right.slope - low.slope;  // below 0: the gap closes towards the right
    if (slope >= 0) {
      right = 0;
      at_right = lines.upper(right);
      break;
    }
    right = std::max(0.0, right - gap / slope);
    if (n == 63) {
      right *= 1 - 1e-3;
      at_right = lines.upper(right);
    }
  }
  if (at_right.slope >= 0 || right == 0) return at_right.value;
  double left = 0;
  Bound at_left = lines.upper(0);
  if (at_left.slope <= 0) return at_left.value;
  for (int n = 0; n < 64; ++n) {
    // Where the rising line of the left meets the falling line of the right.
    const double at = left + ((at_right.value - at_right.slope * (right - left)) - at_left.value) /
                                 (at_left.slope - at_right.slope);
    const Bound here = lines.upper(at);
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
    const double over = 1.0 / r.b, middle = -r.a * x0 * over, half = full * std::abs(over);
    low = std::max(low, middle - half);
    high = std::min(high, middle + half);
  }
  return {low, high};
}

}  // namespace kerf::motion::path
