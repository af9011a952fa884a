// Items that follow a spindle: threads, taps, feed per revolution.
//
// All moves of a thread get the same sigma a revolution, whatever their pitches: so sigma is the spindle's angle, its reference one
// straight line, and a change of pitch or direction nothing but a corner like any other.
#include <algorithm>
#include <cmath>

#include "motion/core/planner/ceilings.hpp"
#include "motion/core/planner/planner.hpp"

namespace kerf::motion {
namespace {
/// A thread whose spindle stands has this speed for what wants one (shown feeds, division into stretches).
constexpr double kLeastRps = 0.1;
constexpr double kRounding = 1 + 1e-6;
}  // namespace

/// What the spindle has been told; constant surface speed says nothing.
double Planner::commanded_rps(std::int32_t spindle) const noexcept {
  const auto n = static_cast<std::size_t>(spindle);
  const SpindleConfig& c = config_.spindle[n];
  if (css_[n]) return 0;
  return std::min(speed_rpm_[n], std::max(c.max_forward_rpm, std::abs(c.max_reverse_rpm))) / 60;
}

Planner::Take Planner::take_sync(const PathItem& item, const SyncMove& move,
                                 const ServoView& view) noexcept {
  if (!may_move(view)) return Take::wait_servo;
  if (move.spindle < 0 || move.spindle >= spindles_) return bad_item(item, move.spindle);
  if (!(move.per_rev_mm > 0) || !std::isfinite(move.per_rev_mm))
    return bad_item(item, move.per_rev_mm);
  Curve curve;
  const bool shaped = make_line(end_, move.end, axes_of(kinematics_.axis_mask(), config_), curve);
  if (thread_spindle_ != move.spindle) {
    stop_here();
    thread_spindle_ = move.spindle;
    thread_per_rev_ = move.per_rev_mm;
    thread_first_ = true;
  }
  spindle_changed_ = after_traverse_ = false;
  const double rps = std::max(commanded_rps(move.spindle), kLeastRps);
  const Take taken =
      take_move(item, curve, shaped, {move.per_rev_mm * rps, MotionKind::feed, nullptr, &move});
  if (taken == Take::done && curve.shape != Curve::Shape::point) thread_first_ = false;
  return taken;
}

bool Planner::join_thread(const SyncMove& sync, path::Piece& piece, Meta& meta,
                          FaultRecord& fault) noexcept {
  const double way =
      path::norm3(piece.b, static_cast<std::size_t>(piece.feed.metric)) * piece.length;  // mm
  const double length = way / sync.per_rev_mm * thread_per_rev_, scale = length / piece.length;
  piece.b *= 1 / scale;
  piece.length = length;
  piece.feed.sync = true;
  if (meta.even_acc > 0) {
    meta.even_acc *= scale;
    meta.even_jerk *= scale;
    meta.cap *= scale * scale;
  }
  meta.sync.per_rev = thread_per_rev_;
  meta.sync.acc = meta.even_acc > 0 ? meta.even_acc : path::straight_acc(piece, limits_);
  if (meta.even_acc > 0)
    meta.sync.jerk = meta.even_jerk;
  else if (limits_.jerks)
    meta.sync.jerk = path::straight_box(piece, limits_).jerk;
  meta.sync.mm = way / length;
  meta.sync.spindle = sync.spindle;
  meta.sync.first = thread_first_;
  const double cap = meta.cap > 0 ? meta.cap : path::axis_cap(piece, 0, length, limits_);
  const double needed = thread_per_rev_ * commanded_rps(sync.spindle), most = std::sqrt(cap);
  meta.sync.speed = most;
  if (needed <= most * kRounding) return true;
  fault.fault = Fault::sync_too_fast;
  fault.index = sync.spindle;
  fault.value = needed * meta.sync.mm;
  fault.limit = most * meta.sync.mm;
  return false;
}

void Planner::bound_sync(PathSpan& body, const Meta& meta, double begin) noexcept {
  if (meta.sync.per_rev <= 0) return;
  body.sync = meta.sync;
  if (thread_end_move_ <= move_) {
    std::size_t m = move_ + 1;
    while (m < sending_ && meta_[m].sync.per_rev > 0 && !meta_[m].sync.first) ++m;
    thread_end_move_ = m;
    thread_end_ = meta_[m - 1].sigma_end;
  }
  body.sync.to_end = thread_end_ - begin;
}

Planner::Take Planner::take_tap(const PathItem& item, const TapMove& tap,
                                const ServoView& view) noexcept {
  if (!may_move(view)) return Take::wait_servo;
  if (tap.spindle < 0 || tap.spindle >= spindles_) return bad_item(item, tap.spindle);
  if (!(tap.per_rev_mm > 0) || !std::isfinite(tap.per_rev_mm))
    return bad_item(item, tap.per_rev_mm);
  if (!(tap.return_factor > 0) || !std::isfinite(tap.return_factor))
    return bad_item(item, tap.return_factor);
  Curve curve;
  if (!make_line(end_, tap.end, axes_of(kinematics_.axis_mask(), config_), curve))
    return bad_item(item, 0);
  if (curve.shape == Curve::Shape::point) return event(item, Marker{});
  Meta meta;
  FaultRecord fault;
  const double rps = commanded_rps(tap.spindle), v = tap.per_rev_mm * rps;
  const double fastest = v * std::max(tap.return_factor, 1.0);
  JointVector joint = joint_;
  const bool within = limits_of(item, curve, std::max(fastest, 1e-3), false, meta, joint, fault);
  if (!kinematics_.complete()) return Take::wait_answers;
  if (!within) return refuse(item, fault);
  stop_here();
  const path::Vec from = path::to_vec(curve.start), to = path::to_vec(curve.end);
  TapSpan span;
  span.begin = curve.start;
  span.depth = curve.length;
  span.direction = (to - from) * (1 / curve.length);
  const path::Piece piece = path::straight_piece(from, span.direction, span.depth, path::Feed{});
  span.speed = std::sqrt(plain_ ? path::axis_cap(piece, 0, span.depth, limits_) : meta.cap);
  span.acc = plain_ ? path::straight_acc(piece, limits_) : meta.even_acc;
  const double jerk = plain_ ? path::straight_box(piece, limits_).jerk : meta.even_jerk;
  span.jerk = limits_.jerks && jerk < path::kNoLimit ? jerk : 0.0;
  span.per_rev = tap.per_rev_mm;
  span.return_factor = tap.return_factor;
  span.spindle = tap.spindle;
  span.low = -path::kNoLimit;
  span.high = path::kNoLimit;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const double d = span.direction[i];
    if (d == 0) continue;
    span.low = std::max(span.low, ((d > 0 ? low_ : high_)[i] - from[i]) / d);
    span.high = std::min(span.high, ((d > 0 ? high_ : low_)[i] - from[i]) / d);
  }
  span.low = std::min(span.low, 0.0);
  span.high = std::max(span.high, span.depth);
  if (!(span.speed > 0) || !(span.acc > 0)) return bad_item(item, 0);
  if (fastest > span.speed * kRounding) {
    fault.fault = Fault::sync_too_fast;
    fault.index = tap.spindle;
    fault.value = fastest;
    fault.limit = span.speed;
    return refuse(item, fault);
  }
  spindle_changed_ = after_traverse_ = false;
  return event(item, span);
}

Planner::Take Planner::feed_per_rev(const PathItem& item, const FeedPerRev& mode) noexcept {
  if (mode.spindle >= spindles_) return bad_item(item, mode.spindle);
  if (mode.spindle >= 0 && !(mode.rps > 0 && std::isfinite(mode.rps)))
    return bad_item(item, mode.rps);
  per_rev_ = mode;
  return event(item, Marker{});
}

}  // namespace kerf::motion
