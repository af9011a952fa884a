#include "motion/core/planner/planner.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/planner/ceilings.hpp"

namespace kerf::motion {
namespace {
/// Items in one turn: the caller looks for stops between turns.
constexpr int kItemsPerTurn = 64;
constexpr std::size_t kBodies = std::variant_size_v<PathItems::Variant>;
}  // namespace

Planner::Waits Planner::run(PathRing& in, const ServoView& view,
                            std::uint32_t abort_epoch) noexcept {
  for (int n = 0; n < kItemsPerTurn; ++n) {
    const PathItem* item = in.front();
    if (item == nullptr) return Waits::items;
    const bool old =
        static_cast<std::int32_t>(item->epoch - abort_epoch) < 0 || item->epoch <= view.void_epoch;
    if (old || (refusing_ && item->epoch == refused_epoch_)) {
      in.pop();
      continue;
    }
    if (item->epoch != view.acked_epoch) return Waits::servo;
    switch (take(*item, view)) {
      case Take::done: in.pop(); break;
      case Take::wait_room: return Waits::room;
      case Take::wait_servo: return Waits::servo;
    }
  }
  return Waits::turn;
}

Planner::Take Planner::push(Span& span) noexcept {
  return spans_.push(span) ? Take::done : Take::wait_room;
}

Planner::Take Planner::refuse(const PathItem& item, FaultRecord record) noexcept {
  record.tag = item.tag;
  // A full ring holds older refusals that nobody has seen yet; they say enough.
  (void)faults_.push(record);
  refusing_ = true;
  refused_epoch_ = item.epoch;
  return Take::done;
}

Planner::Take Planner::bad_item(const PathItem& item, double value) noexcept {
  FaultRecord record;
  record.fault = Fault::bad_item;
  record.index = static_cast<std::int32_t>(item.body.index());
  record.value = value;
  return refuse(item, record);
}

bool Planner::may_move(const ServoView& view) noexcept {
  if (!view.takes_moves || spans_.size() == SpanRing::capacity()) return false;
  if (probing_) {
    // Wherever the probe move ends, the place changes.
    if (view.place == place_) return false;
    probing_ = false;
  }
  if (!placed_ || view.place != place_) {
    end_ = view.pose;
    place_ = view.place;
    placed_ = true;
  }
  return true;
}

Planner::Take Planner::take(const PathItem& item, const ServoView& view) noexcept {
  if (item.body.index() >= kBodies) return bad_item(item, -1);
  Span span;
  span.epoch = item.epoch;
  span.seq = item.seq;
  span.tag = item.tag;
  const auto straight = [&](const Pose& end, double speed, MotionKind kind,
                            const ProbeMove* probe) {
    if (!may_move(view))
      return spans_.size() == SpanRing::capacity() ? Take::wait_room : Take::wait_servo;
    Curve curve;
    const bool shaped = make_line(end_, end, axes_of(kinematics_.axis_mask(), config_), curve);
    return take_move(item, span, curve, shaped, speed, kind, probe);
  };
  const auto event = [&](const auto& body) {
    span.body = body;
    return push(span);
  };
  return std::visit(
      Overloaded{
          [&](const LinearMove& m) { return straight(m.end, m.vel_mm_s, m.kind, nullptr); },
          [&](const ProbeMove& m) { return straight(m.end, m.vel_mm_s, MotionKind::probing, &m); },
          [&](const ArcMove& m) {
            if (!may_move(view))
              return spans_.size() == SpanRing::capacity() ? Take::wait_room : Take::wait_servo;
            Curve curve;
            const bool shaped = make_arc(end_, m, curve);
            return take_move(item, span, curve, shaped, m.vel_mm_s, m.kind, nullptr);
          },
          [&](const Dwell& m) {
            return m.seconds >= 0 && std::isfinite(m.seconds) ? event(m)
                                                              : bad_item(item, m.seconds);
          },
          [&](const OutputChange& m) { return output_change(item, m, span); },
          [&](const SpindleChange& m) { return spindle_change(item, m, span); },
          [&](const PathControl& m) { return event(m); },
          [&](const OverrideEnable& m) { return event(m); },
          [&](const ToolOffset& m) { return is_finite(m.offset) ? event(m) : bad_item(item, 0); },
          [&](const Marker& m) { return event(m); },
      },
      item.body);
}

Planner::Take Planner::take_move(const PathItem& item, Span& span, Curve& curve, bool shaped,
                                 double speed, MotionKind kind, const ProbeMove* probe) noexcept {
  const bool traverse = kind == MotionKind::traverse || kind == MotionKind::tool_change;
  const bool speed_ok = std::isfinite(speed) && (traverse ? speed >= 0 : speed > 0);
  if (!shaped || (!speed_ok && curve.shape != Curve::Shape::point)) return bad_item(item, speed);
  FaultRecord record;
  MoveSpan move;
  move.curve = curve;
  move.kind = kind;
  if (curve.shape != Curve::Shape::point) {
    if (!within_soft_limits(curve, kinematics_, config_, record)) return refuse(item, record);
    // Ceilings hold for any override: a curve is planned for the largest one.
    const double most =
        traverse ? (speed > 0 ? speed : 1e99) : speed * std::max(config_.max_feed_override, 1.0);
    Ceilings ceilings;
    if (!ceilings_of(curve, kinematics_, config_, most, ceilings)) {
      record.fault = Fault::no_inverse;
      return refuse(item, record);
    }
    if (!(ceilings.speed > 0) || !(ceilings.acc > 0)) return bad_item(item, ceilings.speed);
    move.speed_ceiling = ceilings.speed;
    move.acc = ceilings.acc;
    move.requested = traverse && speed == 0 ? ceilings.speed : speed;
  }
  if (probe != nullptr) {
    move.probe = true;
    move.probe_until_open = probe->until_open;
    move.probe_fail_is_error = probe->fail_is_error;
  }
  span.body = move;
  const Take result = push(span);
  if (result == Take::done) {
    end_ = curve.end;
    if (probe != nullptr) probing_ = true;
  }
  return result;
}

Planner::Take Planner::output_change(const PathItem& item, const OutputChange& change,
                                     Span& span) noexcept {
  const std::int32_t count = change.analog ? analog_ : digital_;
  if (change.index < 0 || change.index >= count) return bad_item(item, change.index);
  if (!std::isfinite(change.value)) return bad_item(item, change.value);
  span.body = change;
  return push(span);
}

Planner::Take Planner::spindle_change(const PathItem& item, const SpindleChange& change,
                                      Span& span) noexcept {
  if (change.spindle < 0 || change.spindle >= spindles_) return bad_item(item, change.spindle);
  const bool numbers = std::isfinite(change.speed_rpm) && std::isfinite(change.css_factor) &&
                       std::isfinite(change.css_max_rpm) && std::isfinite(change.css_center_x_mm) &&
                       std::isfinite(change.orient_angle_deg);
  // Without a bound the speed at the centre would be without end.
  if (change.css_factor > 0 && change.css_max_rpm <= 0) return bad_item(item, change.css_max_rpm);
  if (!numbers || change.speed_rpm < 0) return bad_item(item, change.speed_rpm);
  span.body = change;
  return push(span);
}

}  // namespace kerf::motion
