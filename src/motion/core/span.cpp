#include "motion/core/span.hpp"

#include <algorithm>

namespace kerf::motion {

double wanted_x(const SpeedBounds& speed, const FeedScale& scale) noexcept {
  if (speed.sync) return speed.cap;
  double r = speed.rapid ? scale.rapid : scale.feed;
  if (speed.per_rev >= 0 && !speed.rapid) r *= scale.rps[speed.per_rev] / speed.rps;
  if (!(r > 0)) return 0;
  // A rapid's own speed is what the axes can do, so its override scales that.
  double x = speed.rapid ? std::min(speed.cap, speed.feed_cap) * r * r
                         : std::min(speed.cap, speed.feed_cap * r * r);
  if (speed.slope > 0) {
    const double v = std::max(scale.max_vel, 0.0) / speed.slope;
    x = std::min(x, v * v);
  }
  return x;
}

}  // namespace kerf::motion
