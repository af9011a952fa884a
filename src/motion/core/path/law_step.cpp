#include "motion/core/path/law_step.hpp"

#include <cmath>

namespace kerf::motion::path {
namespace {

/// |w| t^2 below which the series of LawStep::Kind::spline is used.
constexpr double kSeries = 1e-4;

}  // namespace

LawState at(const LawStep& step, double t) noexcept {
  LawState out;
  if (step.kind != LawStep::Kind::spline) {
    const bool start = step.kind == LawStep::Kind::start;
    const double r = start ? t / step.seconds : 1 - t / step.seconds;
    out.s = start ? step.length * r * r * r : step.length * (1 - r * r * r);
    out.speed = 3 * step.length * r * r / step.seconds;
    out.acc = (start ? 6 : -6) * step.length * r / (step.seconds * step.seconds);
    return out;
  }
  const double v = std::sqrt(step.x), z = step.w * t * t;
  if (std::abs(z) < kSeries) {
    out.s = v * t * (1 + z / 6 * (1 + z / 20)) + 0.5 * step.u * t * t * (1 + z / 12 * (1 + z / 30));
    out.speed = v * (1 + z / 2 * (1 + z / 12)) + step.u * t * (1 + z / 6 * (1 + z / 20));
  } else if (step.w > 0) {
    const double k = std::sqrt(step.w), sinh = std::sinh(k * t), half = std::sinh(0.5 * k * t);
    out.s = v / k * sinh + 2 * step.u / step.w * half * half;
    out.speed = v * (1 + 2 * half * half) + step.u / k * sinh;
  } else {
    const double k = std::sqrt(-step.w), sin = std::sin(k * t), half = std::sin(0.5 * k * t);
    out.s = v / k * sin - 2 * step.u / step.w * half * half;
    out.speed = v * (1 - 2 * half * half) + step.u / k * sin;
  }
  out.acc = step.w * out.s + step.u;
  return out;
}

LawPoint at_place(const LawStep& step, double s) noexcept {
  if (step.kind == LawStep::Kind::spline)
    return {step.x + s * (2 * step.u + step.w * s), step.u + step.w * s};
  // Next to rest x is a power 4/3 of the way from there.
  const bool start = step.kind == LawStep::Kind::start;
  const double way = start ? s : step.length - s, top = 3 * step.length / step.seconds;
  if (!(way > 0)) return {};
  const double r = std::cbrt(way / step.length), x = top * top * r * r * r * r;
  return {x, (start ? 2 : -2) * x / (3 * way)};
}

}  // namespace kerf::motion::path
