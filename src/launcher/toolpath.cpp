#include "launcher/toolpath.hpp"

#include <cmath>
#include <utility>

namespace kerf::launcher {

namespace {

Point3 minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Distance of p from the line piece a-b, squared.
double distance2(const Point3& p, const Point3& a, const Point3& b) {
  const Point3 along = minus(b, a);
  const Point3 to = minus(p, a);
  const double length2 = dot(along, along);
  double t = length2 > 0 ? dot(to, along) / length2 : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  const Point3 off{to[0] - t * along[0], to[1] - t * along[1], to[2] - t * along[2]};
  return dot(off, off);
}

}  // namespace

std::vector<Point3> simplify(const std::vector<Point3>& points, double tolerance_mm) {
  if (points.size() < 3) return points;
  std::vector<bool> keep(points.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> todo{{0, points.size() - 1}};
  while (!todo.empty()) {
    const auto [first, last] = todo.back();
    todo.pop_back();
    double worst = tolerance_mm * tolerance_mm;
    std::size_t at = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = distance2(points[i], points[first], points[last]);
      if (d > worst) worst = d, at = i;
    }
    if (at == 0) continue;
    keep[at] = true;
    todo.emplace_back(first, at);
    todo.emplace_back(at, last);
  }
  std::vector<Point3> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (keep[i]) out.push_back(points[i]);
  return out;
}

void ToolpathRecorder::add(const motion::JointSample& sample) {
  const Point3 here{sample.position[0], sample.position[1], sample.position[2]};
  if (!started_) {
    started_ = true;
    last_ = here;
    return;
  }
  const Point3 step = minus(here, last_);
  if (dot(step, step) < 1e-18) return;
  using motion::MotionKind;
  const bool rapid = sample.kind != MotionKind::feed && sample.kind != MotionKind::arc &&
                     sample.kind != MotionKind::probing;
  // Programmed feeds are told apart to 0.1 mm/min.
  const double feed = rapid ? 0 : std::round(sample.requested_vel_mm_s * 600) / 10;
  if (pieces_.empty() || pieces_.back().rapid != rapid || pieces_.back().feed_mm_min != feed) {
    finish();
    pieces_.push_back({rapid, feed, {last_}});
  }
  PathPiece& piece = pieces_.back();
  piece.points.push_back(here);
  last_ = here;
  if (piece.points.size() - thinned_ >= kChunk) thin(piece);
}

void ToolpathRecorder::thin(PathPiece& piece) {
  const std::vector<Point3> tail(piece.points.begin() + static_cast<std::ptrdiff_t>(thinned_),
                                 piece.points.end());
  piece.points.resize(thinned_);
  for (const Point3& p : simplify(tail, kToleranceMm)) piece.points.push_back(p);
  // The last point stays open: what follows may lie on the same line.
  thinned_ = piece.points.size() - 1;
}

void ToolpathRecorder::finish() {
  if (!pieces_.empty()) thin(pieces_.back());
  thinned_ = 0;
}

}  // namespace kerf::launcher
