// LawStep: an interval of a time law, evaluated in closed form. Pure arithmetic.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf::motion::path {

/// One interval of a law, in closed form: O(1) to evaluate in the servo cycle.
struct LawStep {
  enum class Kind : std::int32_t {
    spline, /**< d2s/dt2 = w s + u with s from the interval's start: exponentials or sines of sqrt|w| t */
    start, /**< from rest: s = length (t / seconds)^3 */
    stop   /**< to rest:   s = length (1 - (1 - t / seconds)^3) */
  };
  double length{0};   ///< sigma
  double x{0}, u{0};  ///< at its start
  double w{0};        ///< du/dsigma, constant (spline)
  double seconds{0};
  std::uint64_t span{0};  ///< as given to add()
  double left{0};         ///< sigma from the end of this interval to the end of its span
  Kind kind{Kind::spline};
  std::int32_t reserved{0};
};

/// Place and speed within an interval `t` seconds after its start.
struct LawState {
  double s{0};      ///< sigma from the interval's start
  double speed{0};  ///< dsigma/dt
  double acc{0};    ///< d2sigma/dt2
};
[[nodiscard]] LawState at(const LawStep& step, double t) noexcept;
/// x and u at a place.
struct LawPoint {
  double x{0}, u{0};
};
/// `s` (sigma) from the interval's start.
[[nodiscard]] LawPoint at_place(const LawStep& step, double s) noexcept;

/// A law from some place of it on: its intervals from that of the place, and how far (sigma) into the first of them that is.
struct LawAlong {
  const LawStep* step{nullptr};
  std::size_t count{0};
  double from{0};
};

}  // namespace kerf::motion::path
