#include "motion/core/span.hpp"

#include <algorithm>

namespace kerf::motion {

namespace {
/// Of x. A feed below 1e-6 mm/s is none (an adaptive feed that passes 0 may be anything): no time law is found from so little, and a machine that
/// crept at it would have to come to rest again before it can do anything else.
constexpr double kNoFeed = 1e-12;
}  // namespace

double wanted_x(const SpeedBounds& speed, const FeedScale& scale) noexcept {
  if (speed.sync) return speed.cap;
  double r = speed.rapid ? scale.rapid : scale.feed;
  if (speed.per_rev >= 0 && !speed.rapid) r *= scale.rps[speed.per_rev] / speed.rps;
  if (!(r > 0)) return 0;
  // A rapid's own speed is what the axes can do, so its override scales that.
  double x = speed.rapid ? std::min(speed.cap, speed.feed_cap) * r * r : speed.feed_cap * r * r;
  if (speed.slope > 0) {
    const double v = std::max(scale.max_vel, 0.0) / speed.slope;
    x = std::min(x, v * v);
  }
  return x < kNoFeed ? 0 : std::min(x, speed.cap);
}

void rows_of(const PathSpan& span, double s0, double s1, const path::AxisLimits& limits,
             path::Rows& out, double joint_share) noexcept {
  path::rows_of(span.piece, s0, s1, limits, out);
  if (span.joints == nullptr) return;
  const bool turned = span.turned_at > 0;
  if (turned)
    path::joint_rows(*span.joints, span.turned_at - s1, span.turned_at - s0, true, joint_share,
                     out);
  else
    path::joint_rows(*span.joints, s0, s1, false, joint_share, out);
  const double along = span.piece.straight() ? path::norm3(span.piece.b, 0) : 0.0;
  if (along > 0 && limits.path_acc < path::kNoLimit) {
    const double p = along / (2 * (s1 - s0) * limits.path_acc);
    out.at[out.count++] = {-p, p};
  }
}

void rows_of(const PathSpan& span, const path::AxisLimits& limits, path::Rows& out) noexcept {
  rows_of(span, span.from, span.from + span.length, limits, out, path::kWholeShare);
}

}  // namespace kerf::motion
