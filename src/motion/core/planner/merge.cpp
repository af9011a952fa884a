#include "motion/core/planner/merge.hpp"

#include <algorithm>

namespace kerf::motion {
namespace {

using path::dot;
using path::Vec;

/// Only XYZ and UVW: angles have another measure.
bool turns(const Vec& way) noexcept { return way[3] != 0 || way[4] != 0 || way[5] != 0; }

}  // namespace

void Merge::begin(const Vec& from, const Vec& to) noexcept {
  point_[0] = from;
  point_[1] = to;
  count_ = turns(to - from) ? 0 : 1;
  off_mm_ = 0;
}

bool Merge::add(const Vec& to, double within_mm) noexcept {
  if (count_ == 0 || count_ == kMost || !(within_mm > 0)) return false;
  const Vec way = to - point_[0];
  const double length2 = dot(way, way);
  if (turns(way) || !(length2 > 0)) return false;
  // With places along the line that only grow, each point of it has a programmed one beside it that is no farther than the farthest vertex.
  double last = 0, off = 0, shares[kMost];
  for (std::size_t k = 1; k <= count_; ++k) {
    const Vec from_start = point_[k] - point_[0];
    const double share = dot(from_start, way) / length2;
    if (share <= last || share >= 1) return false;
    last = shares[k - 1] = share;
    const Vec beside = from_start - way * share;
    off = std::max({off, path::norm3(beside, 0), path::norm3(beside, 6)});
    if (off > within_mm) return false;
  }
  std::copy(shares, shares + count_, share_);
  point_[++count_] = to;
  off_mm_ = off;
  return true;
}

}  // namespace kerf::motion
