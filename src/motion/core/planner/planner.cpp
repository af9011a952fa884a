// Items: what of the queue becomes which part of the path.
#include "motion/core/planner/planner.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/path/history.hpp"
#include "motion/core/planner/ceilings.hpp"

namespace kerf::motion {
namespace {

/// Items in one turn: the caller looks for stops between turns.
constexpr int kItemsPerTurn = 64;
constexpr std::size_t kBodies = std::variant_size_v<PathItems::Variant>;
constexpr std::size_t kMoves = 1024;  ///< pending at most
constexpr std::size_t kTold =
    2048;  ///< stretches kept until they are sent, of kinematics that answer later
constexpr std::size_t kEvents = 1024;                           ///< between them
constexpr std::size_t kPendingBlocks = PlanSlots::kBlocks / 2;  ///< that they are made of
/// An arc with its blend, or five knots a corner and what feeds divide, of at most two lines for each move (coarse.hpp).
constexpr std::size_t kPieces = (path::kJunctionPieces + 4) * kMoves + 64;
/// G64 without P keeps this; see docs/planner.md.
constexpr double kFreeTolerance = 0.1;

path::Piece piece_of(const Curve& curve, double feed, bool rapid,
                     const path::Vec& max_vel) noexcept {
  const path::Vec from = path::to_vec(curve.start), to = path::to_vec(curve.end);
  if (curve.shape == Curve::Shape::cubic) {
    path::Feed f;
    f.speed = feed;
    path::Piece p = path::straight_piece(from, path::to_vec(curve.first), curve.length, f);
    p.c = path::to_vec(curve.second);
    p.d = path::to_vec(curve.third);
    return p;
  }
  if (curve.shape != Curve::Shape::arc) return path::line_move(from, to, feed, rapid, max_vel);
  path::Piece p;
  p.shape = path::Piece::Shape::arc;
  p.a = from;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) p.b[i] = (to[i] - from[i]) / curve.angle;
  for (std::size_t i = 0; i < 3; ++i) {
    p.a[i] = curve.base[i];
    p.b[i] = curve.axial * curve.normal[i];
    p.c[i] = curve.radial[i];
    p.d[i] = curve.side[i];
  }
  p.radius = curve.radius;
  p.growth = curve.growth;
  path::scale_arc(p, curve.angle, curve.length, feed, rapid, max_vel);
  return p;
}

/// Every axis that moves has an acceleration (and a jerk, where that is limited) to do so.
bool can_accelerate(const path::Piece& p, const path::AxisLimits& limits) noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const bool moves = p.b[i] != 0 || p.c[i] != 0 || p.d[i] != 0;
    if (moves && !(limits.acc[i] > 0 && limits.jerk[i] > 0)) return false;
  }
  return limits.path_acc > 0;
}

/// Ceilings of a whole move count along its length: sigma is not stretched for slow axes then.
void unstretch(const Curve& curve, path::Piece& piece) noexcept {
  if (curve.shape == Curve::Shape::arc)
    piece.rate = curve.angle / curve.length;
  else if (curve.shape == Curve::Shape::line)
    piece.b *= piece.length / curve.length;
  piece.length = curve.length;
}

}  // namespace

bool Planner::create(path::Memory& memory) noexcept {
  static_assert(kCurves >= kSpans + 2 * path::PathHistory::kGeneration);
  // What joints need beside axes with jerk limits.
  bool joints = kinematics_.kinds() > 1;
  for (std::int32_t j = 0; j < kinematics_.joints(); ++j)
    joints = joints || kinematics_.axis_of_joint(j) < 0;
  const bool later = joints && !kinematics_.answers_at_once();
  return moves_.create(memory, kMoves) && meta_.create(memory, kMoves) &&
         blocks_.create(memory, kPendingBlocks) && events_.create(memory, kEvents) &&
         pieces_.create(memory, kPieces) && boxes_.create(memory, kPieces) &&
         sent_.create(memory, kSpans) && program_path_.create(memory, kMoves) &&
         (!joints || (bends_.create(memory, kPieces) && curves_.create(memory, kCurves) &&
                      unreached_.create(memory, kPieces))) &&
         (!later || told_.create(memory, kTold)) && laws_.create(memory, joints);
}

void Planner::configure(const MachineConfig& config) noexcept {
  config_ = config;
  const PathLimits limits = path_limits_of(kinematics_, config);
  limits_ = limits.axes;
  stop_s_ = stop_seconds();
  plain_ = limits.plain;
  mixed_ = !plain_;
  if (mixed_) joint_bounds_.configure(config, limits_);
  mixed_ = mixed_ && curves_.size() + curves_.room() > 0 && joint_bounds_.few_enough();
  asks_ = mixed_ && !kinematics_.answers_at_once();
  felt_ = false;
  curves_.assign(kCurves, path::JointCurve{});
  laws_.configure(limits_, config.time_laws && (plain_ || mixed_) && limits_.jerks, stop_s_);
  guide_ = mixed_ ? guide() : limits_;
  path::PathSettings settings;
  low_ = settings.low = limits.low;
  high_ = settings.high = limits.high;
  settings.limits = guide_;
  settings.by_law = laws_.on();
  settings.relaxes = !mixed_;
  program_path_.configure(settings);
}

/// Where kinematics mix axes these may have limits far beyond what joints can do, or none of jerk; then the path is made as if each axis were the
/// best joint of its kind. What it may be driven at follows from the joints themselves.
path::AxisLimits Planner::guide() const noexcept {
  path::AxisLimits out = limits_;
  for (const bool turns : {false, true}) {
    JointConfig best;
    best.max_vel = best.max_acc = best.max_jerk = 0;
    for (std::int32_t j = 0; j < joints_of(kinematics_.joints(), config_); ++j) {
      const JointConfig& c = config_.joint[j];
      if (kinematics_.axis_of_joint(j) >= 0 || c.rotary != turns) continue;
      best.max_vel = std::max(best.max_vel, c.max_vel);
      best.max_acc = std::max(best.max_acc, c.max_acc);
      best.max_jerk = std::max(best.max_jerk, c.max_jerk);
    }
    for (std::size_t i = 0; i < path::kAxes; ++i) {
      if ((i >= 3 && i < 6) != turns || !(best.max_vel > 0)) continue;
      out.vel[i] = std::min(out.vel[i], best.max_vel);
      out.acc[i] = std::min(out.acc[i], best.max_acc);
      if (best.max_jerk > 0) out.jerk[i] = std::min(out.jerk[i], best.max_jerk);
    }
  }
  return out;
}

Planner::Waits Planner::run(PathRing& in, const ServoView& view, std::uint32_t abort_epoch,
                            std::int64_t now_ns, std::uint64_t passes) noexcept {
  if (tap_ != nullptr) tap_->turn(now_ns, passes, abort_epoch, view.cycle);
  const Waits waits = take_items(in, view, abort_epoch, now_ns);
  if (waits == Waits::turn) return waits;
  if (laws_.on()) run_laws(view, now_ns);
  // Release: behind what is planned for it.
  if (single_step_) slots_.gate.pass([&] { slots_.steps.publish(1); });
  return waits;
}

/// The first span that the servo has not driven to its end.
std::uint64_t Planner::first_ahead() noexcept {
  // With a full ring the next span takes the slot of the one that was driven last.
  const std::uint64_t popped = slots_.gate.pass([&] { return spans_.popped(); });
  while (first_ahead_ < next_number_ &&
         (next_number_ - first_ahead_ > kSpans || sent_[first_ahead_ % kSpans].place < popped))
    ++first_ahead_;
  return first_ahead_;
}

void Planner::run_laws(const ServoView& view, std::int64_t now_ns) noexcept {
  laws_.run(view, scale_, single_step_, first_ahead(), next_number_,
            static_cast<double>(now_ns) * 1e-9);
}

Planner::Waits Planner::take_items(PathRing& in, const ServoView& view, std::uint32_t abort_epoch,
                                   std::int64_t now_ns) noexcept {
  if (view.acked_epoch != epoch_ || (placed_ && view.place != place_ && !probing_)) {
    if (view.acked_epoch != epoch_) per_rev_ = FeedPerRev{};
    forget();
    epoch_ = view.acked_epoch;
  }
  if (!(view.scale == scale_) || view.single_step != single_step_) {
    const bool feed_only = view.single_step == single_step_ && first_new_ == next_number_;
    scale_ = view.scale;
    single_step_ = view.single_step;
    if (!single_step_) slots_.gate.pass([&] { slots_.steps.publish(0); });
    feed_changed_ns_ = now_ns;
    plan(feed_only ? Plan::near_feed : Plan::all);
  } else if (far_feed_old_ && now_ns >= feed_changed_ns_ + kSoon) {
    plan(Plan::feed);
  }
  shift_ = view.shift;
  for (int n = 0; n < kItemsPerTurn; ++n) {
    if (committing_ != Committing::nothing) {
      if (!go_on_committing()) return Waits::servo;
      continue;
    }
    if (sending_ > 0 || events_sending_ > 0) {
      if (!send()) return awaits_answers_ ? Waits::servo : Waits::room;
      continue;
    }
    const PathItem* item = in.front();
    commit_if_due(item != nullptr, now_ns);
    if (sending_ > 0 || events_sending_ > 0) continue;
    if (item == nullptr) return moves_.empty() ? Waits::items : Waits::time;
    const bool old =
        static_cast<std::int32_t>(item->epoch - abort_epoch) < 0 || item->epoch <= view.void_epoch;
    if (old || (refusing_ && item->epoch == refused_epoch_)) {
      in.pop();
      continue;
    }
    if (item->epoch != view.acked_epoch) return Waits::servo;
    const Modal before = tap_ != nullptr ? modal() : Modal{};
    const bool idle = slots_.pending.get() == 0;
    switch (take(*item, view)) {
      case Take::done:
        if (tap_ != nullptr) tap_->taken(*item, before, idle);
        last_item_ns_ = now_ns;
        slots_.gate.pass([&] { slots_.pending.publish(1); });
        in.pop();
        break;
      case Take::wait_room: return Waits::room;
      case Take::wait_answers: return Waits::servo;
      case Take::wait_servo:
        // What is pending must not wait for what cannot come yet.
        if (moves_.empty()) return Waits::servo;
        stop_here();
        break;
    }
  }
  return Waits::turn;
}

Planner::Modal Planner::modal() const noexcept {
  Modal m;
  m.mode = mode_;
  std::copy(std::begin(speed_rpm_), std::end(speed_rpm_), std::begin(m.speed_rpm));
  std::copy(std::begin(css_), std::end(css_), std::begin(m.css));
  m.per_rev = per_rev_;
  m.merge_mm = merge_mm_, m.thread_per_rev = thread_per_rev_;
  m.law_lead_s = laws_.lead_s();
  m.thread_spindle = thread_spindle_, m.thread_first = thread_first_;
  m.epoch = epoch_, m.refused_epoch = refused_epoch_;
  m.refusing = refusing_, m.after_traverse = after_traverse_, m.spindle_changed = spindle_changed_;
  return m;
}

void Planner::set_modal(const Modal& m) noexcept {
  mode_ = m.mode;
  std::copy(std::begin(m.speed_rpm), std::end(m.speed_rpm), std::begin(speed_rpm_));
  std::copy(std::begin(m.css), std::end(m.css), std::begin(css_));
  per_rev_ = m.per_rev;
  merge_mm_ = m.merge_mm, thread_per_rev_ = m.thread_per_rev;
  laws_.set_lead(m.law_lead_s);
  thread_spindle_ = m.thread_spindle, thread_first_ = m.thread_first;
  epoch_ = m.epoch, refused_epoch_ = m.refused_epoch;
  refusing_ = m.refusing, after_traverse_ = m.after_traverse, spindle_changed_ = m.spindle_changed;
}

/// Nothing of what was taken will be driven, but for what the servo has.
void Planner::forget() noexcept {
  moves_.clear();
  meta_.clear();
  blocks_.clear();
  events_.clear();
  merge_.end();
  pieces_.clear();
  sending_ = events_sending_ = events_sent_ = 0;
  committing_ = Committing::nothing;
  asked_ = {};
  laws_.forget();
  slots_.gate.pass([&] { slots_.pending.publish(0); });
  due_ = false;
  pending_since_ns_ = 0;
  handed_over_ = halved_ = false;
  program_path_.forget();
  begins_ = true;
  spindle_changed_ = false;
  after_traverse_ = false;
  placed_ = false;
  probing_ = false;
  thread_spindle_ = -1;
}

void Planner::stop_here() noexcept {
  if (moves_.empty()) return;
  moves_.back().stop_at_end = true;
  due_ = true;
}

Planner::Take Planner::refuse(const PathItem& item, FaultRecord record) noexcept {
  record.tag = item.tag;
  // A full ring holds older refusals that nobody has seen yet; they say enough.
  slots_.gate.pass([&] { (void)faults_.push(record); });
  refusing_ = true;
  refused_epoch_ = item.epoch;
  stop_here();
  return Take::done;
}

Planner::Take Planner::bad_item(const PathItem& item, double value) noexcept {
  FaultRecord record;
  record.fault = Fault::bad_item;
  record.index = static_cast<std::int32_t>(item.body.index());
  record.value = value;
  return refuse(item, record);
}

bool Planner::indexer_of(const Curve& curve, MotionKind kind, std::int32_t& joint,
                         FaultRecord& fault) const noexcept {
  joint = -1;
  std::int32_t turns = -1;
  int others = 0;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const double way = std::abs(curve.end[i] - curve.start[i]);
    if (config_.axis[i].locking_joint >= 0 && way > kLockedSlack)
      turns = static_cast<std::int32_t>(i);
    else if (way > 0 && config_.axis[i].locking_joint < 0)
      ++others;
  }
  if (turns < 0) return true;
  const std::int32_t of_axis = config_.axis[turns].locking_joint;
  IndexerRefusal why{};
  if (kind != MotionKind::index_rotary || others > 0)
    why = IndexerRefusal::not_alone;
  else if (of_axis >= static_cast<std::int32_t>(kMaxJoints) ||
           (unlock_pins_ >> static_cast<std::uint32_t>(of_axis) & 1U) == 0)
    why = IndexerRefusal::no_pins;
  joint = of_axis;
  if (why == IndexerRefusal{}) return true;
  fault.fault = Fault::indexer_refused;
  fault.index = turns;
  fault.value = static_cast<double>(why);
  fault.limit = of_axis;
  return false;
}

bool Planner::may_move(const ServoView& view) noexcept {
  if (!view.takes_moves) return false;
  if (probing_) {
    // Wherever the probe move ends, the place changes.
    if (view.place == place_) return false;
    probing_ = false;
    placed_ = false;
  }
  if (!placed_) {
    end_ = view.pose;
    std::copy(std::begin(view.skew), std::end(view.skew), skew_);
    place_ = view.place;
    placed_ = true;
    begins_ = true;
    joint_ = view.joint;
    joint_bounds_.begin(joint_);
    felt_ = false;
  }
  return true;
}

path::PathMode Planner::mode_of(const PathControl& control) const noexcept {
  using Corners = path::PathMode::Corners;
  path::PathMode out;
  switch (control.mode) {
    case PathControl::Mode::exact_path: out.corners = Corners::exact_path; break;
    case PathControl::Mode::exact_stop: out.corners = Corners::exact_stop; break;
    default: out.corners = Corners::blend;
  }
  if (out.corners == Corners::exact_path) {
    out.tolerance = {path::kExact, path::kExact};
    return out;
  }
  const double p = control.tolerance_mm > 0 ? control.tolerance_mm : kFreeTolerance;
  out.tolerance = {p, config_.rotary_tolerance_deg > 0 ? config_.rotary_tolerance_deg : p};
  return out;
}

/// Whether the machine has to stand before the item acts.
bool Planner::stands_for(const PathItem& item) const noexcept {
  if (const auto* change = std::get_if<OutputChange>(&item.body)) return !change->synchronised;
  if (const auto* dwell = std::get_if<Dwell>(&item.body)) return dwell->seconds > 0;
  const auto* spindle = std::get_if<SpindleChange>(&item.body);
  return spindle != nullptr && spindle->action == SpindleChange::Action::orient;
}

Planner::Take Planner::event(const PathItem& item, const Span::Body& body) noexcept {
  if (events_.full()) {
    // All of them stand between the last few moves.
    stop_here();
    due_ = true;
    return Take::wait_room;
  }
  if (stands_for(item)) stop_here();
  Event e;
  e.span.epoch = item.epoch;
  e.span.seq = item.seq;
  e.span.tag = item.tag;
  e.span.body = body;
  e.after = static_cast<std::uint32_t>(moves_.size());
  events_.push_back(e);
  return Take::done;
}

Planner::Take Planner::take(const PathItem& item, const ServoView& view) noexcept {
  if (item.body.index() >= kBodies) return bad_item(item, -1);
  const auto straight = [&](const Pose& end, double speed, MotionKind kind,
                            const ProbeMove* probe) {
    if (!may_move(view)) return Take::wait_servo;
    Curve curve;
    const bool shaped = make_line(end_, end, axes_of(kinematics_.axis_mask(), config_), curve);
    return take_move(item, curve, shaped, {speed, kind, probe});
  };
  if (ends_thread(item.body) && thread_spindle_ >= 0) {
    stop_here();
    thread_spindle_ = -1;
  }
  return std::visit(
      Overloaded{
          [&](const LinearMove& m) { return straight(m.end, m.vel_mm_s, m.kind, nullptr); },
          [&](const ProbeMove& m) { return straight(m.end, m.vel_mm_s, MotionKind::probing, &m); },
          [&](const ArcMove& m) {
            if (!may_move(view)) return Take::wait_servo;
            Curve curve;
            const bool shaped = make_arc(end_, m, curve);
            return take_move(item, curve, shaped, {m.vel_mm_s, m.kind});
          },
          [&](const CubicMove& m) {
            if (!may_move(view)) return Take::wait_servo;
            Curve curve;
            const bool shaped = make_cubic(end_, m, curve);
            return take_move(item, curve, shaped, {m.vel_mm_s});
          },
          [&](const Dwell& m) {
            return m.seconds >= 0 && std::isfinite(m.seconds) ? event(item, m)
                                                              : bad_item(item, m.seconds);
          },
          [&](const OutputChange& m) { return output_change(item, m); },
          [&](const SpindleChange& m) { return spindle_change(item, m); },
          [&](const PathControl& m) {
            mode_ = mode_of(m);
            // A line in parts is the line, whatever Q is.
            merge_mm_ = mode_.blends() ? std::min(std::max(m.naive_cam_tolerance_mm, 0.0),
                                                  Merge::kShareOfTolerance * mode_.tolerance.mm)
                                       : 0.0;
            if (mode_.corners != path::PathMode::Corners::exact_stop)
              merge_mm_ = std::max(merge_mm_, Merge::kSameLine);
            return event(item, m);
          },
          [&](const OverrideEnable& m) { return event(item, m); },
          [&](const ToolOffset& m) {
            return is_finite(m.offset) ? event(item, m) : bad_item(item, 0);
          },
          [&](const Marker& m) { return event(item, m); },
          [&](const SyncMove& m) { return take_sync(item, m, view); },
          [&](const TapMove& m) { return take_tap(item, m, view); },
          [&](const FeedPerRev& m) { return feed_per_rev(item, m); },
      },
      item.body);
}

bool Planner::limits_of(const PathItem& item, const Curve& curve, double speed, bool traverse,
                        Meta& meta, JointVector& joint, FaultRecord& fault) noexcept {
  if (!within_soft_limits(curve, kinematics_, config_, skew_, shift_, joint, fault)) return false;
  if (plain_) return true;
  // Ceilings hold for any override: a curve is planned for the largest one.
  const double most = traverse ? (speed > 0 ? speed : path::kNoLimit)
                               : speed * std::max(config_.max_feed_override, 1.0);
  Ceilings ceilings;
  if (!ceilings_of(curve, kinematics_, config_, joint_, most, ceilings)) {
    fault.fault = Fault::no_inverse;
    return false;
  }
  if (!(ceilings.speed > 0) || !(ceilings.acc > 0)) {
    fault.fault = Fault::bad_item;
    fault.index = static_cast<std::int32_t>(item.body.index());
    fault.value = ceilings.speed;
    return false;
  }
  // Ceilings count along the length; sigma of a spiral runs evenly in its angle, so it is slower or faster by the radius.
  double even = 1;
  if (curve.shape == Curve::Shape::arc && curve.growth != 0) {
    const double last = curve.radius + curve.growth * curve.angle;
    even = std::min(curve.radius, last) / std::max(curve.radius, last);
  }
  meta.even_acc = ceilings.acc * even;
  if (ceilings.jerk > 0) {
    // q'' and q''' of a spiral in sigma have more terms.
    meta.even_acc *= even;
    meta.even_jerk = ceilings.jerk * even * even * even;
  }
  meta.cap = ceilings.speed * ceilings.speed * even * even;
  if (!(meta.cap > 0)) {
    fault.fault = Fault::bad_item;
    fault.index = static_cast<std::int32_t>(item.body.index());
    return false;
  }
  return true;
}

Planner::Take Planner::take_move(const PathItem& item, const Curve& curve, bool shaped,
                                 const Order& order) noexcept {
  if (moves_.full() || blocks_.full()) {
    due_ = true;
    return Take::wait_room;
  }
  const auto& [speed, kind, probe, sync] = order;
  const bool traverse = kind == MotionKind::traverse || kind == MotionKind::tool_change ||
                        kind == MotionKind::index_rotary;
  const bool speed_ok = std::isfinite(speed) && (traverse ? speed >= 0 : speed > 0);
  const bool point = curve.shape == Curve::Shape::point;
  if (!shaped || (!speed_ok && !point)) return bad_item(item, speed);
  Meta meta;
  meta.kind = kind;
  if (probe != nullptr) {
    stop_here();
    meta.probe = true;
    meta.probe_until_open = probe->until_open;
    meta.probe_fail_is_error = probe->fail_is_error;
  }
  if (point) {
    PathSpan span;
    span.point = true;
    span.end = curve.end;
    span.done_seq = item.seq;
    span.kind = kind;
    span.probe = meta.probe;
    span.probe_until_open = meta.probe_until_open;
    span.probe_fail_is_error = meta.probe_fail_is_error;
    const Take result = event(item, span);
    if (result == Take::done && probe != nullptr) probing_ = true;
    return result;
  }
  FaultRecord fault;
  std::int32_t indexer = -1;
  if (!indexer_of(curve, kind, indexer, fault)) return refuse(item, fault);
  if (indexer >= 0 && events_.size() + 2 > kEvents) {
    stop_here();
    due_ = true;
    return Take::wait_room;
  }
  if (asks_ && !felt_) {
    rough_ = !joint_bounds_.smooth_at(path::to_vec(end_));
    if (!kinematics_.complete()) return Take::wait_answers;
    felt_ = true;
  }
  // What cannot be looked at in stretches is judged as a whole, and stands alone. What follows a spindle is judged so too, for what it has to be refused for.
  const bool alone = !plain_ && (!mixed_ || (asks_ && rough_));
  const bool as_a_whole = alone || (mixed_ && sync != nullptr);
  JointVector joint = joint_;
  const bool within =
      as_a_whole ? limits_of(item, curve, speed, traverse, meta, joint, fault)
                 : within_soft_limits(curve, kinematics_, config_, skew_, shift_, joint, fault);
  if (!kinematics_.complete()) return Take::wait_answers;
  if (!within) return refuse(item, fault);
  // The first feed move after a change of a spindle waits for it at rest; at constant surface speed also the first after a rapid.
  const bool css = std::any_of(std::begin(css_), std::end(css_), [](bool on) { return on; });
  if (!traverse && (spindle_changed_ || (after_traverse_ && css))) stop_here();
  if (!traverse) spindle_changed_ = false;
  path::Move move;
  move.piece =
      piece_of(curve, traverse && speed == 0 ? path::kNoLimit : speed, traverse, guide_.vel);
  if (as_a_whole) unstretch(curve, move.piece);
  if (sync != nullptr && !join_thread(*sync, move.piece, meta, fault)) return refuse(item, fault);
  // It was judged, and is driven in stretches like any other path.
  if (!alone) meta.even_acc = meta.even_jerk = meta.cap = 0;
  if (per_rev_.spindle >= 0 && !traverse && probe == nullptr && sync == nullptr) {
    move.piece.feed.per_rev = static_cast<std::int8_t>(per_rev_.spindle);
    move.piece.feed.rps = per_rev_.rps;
  }
  move.mode = mode_;
  meta.tolerance_mm = mode_.tolerance.mm;
  move.stop_at_end = probe != nullptr || alone || indexer >= 0;
  if (!(path::axis_cap(move.piece, 0, move.piece.length, limits_) > 0) ||
      !can_accelerate(move.piece, limits_))
    return bad_item(item, 0);
  if (alone || indexer >= 0) stop_here();
  if (indexer >= 0) (void)event(item, IndexerSpan{indexer, true});
  if (config_.path_check) note(move, item.seq);
  const bool may_merge = kind == MotionKind::feed && sync == nullptr && !alone &&
                         curve.shape == Curve::Shape::line && merge_mm_ > 0 && !single_step_ &&
                         !asks_;  // the longer line would be another question
  end_ = curve.end;
  joint_ = joint;
  if (item.apart != 0) merge_.end();
  const Block block{item.seq, item.tag, curve.end, move.piece.length, 0};
  if (may_merge && merge_line(block, move.piece, meta)) {
    after_traverse_ = false;
    return Take::done;
  }
  moves_.push_back(move);
  meta_.push_back(meta);
  blocks_.push_back(block);
  share_tolerance();
  if (may_merge)
    merge_.begin(path::to_vec(curve.start), path::to_vec(curve.end));
  else
    merge_.end();
  if (indexer >= 0) (void)event(item, IndexerSpan{indexer, false});
  if (move.stop_at_end) due_ = true;
  after_traverse_ = traverse;
  if (probe != nullptr) probing_ = true;
  return Take::done;
}

/// For PathOracle. On an exact path the corner at the start is that of the move before.
void Planner::note(const path::Move& move, std::uint64_t seq) noexcept {
  const path::Tolerance here = move.mode.blends() ? move.mode.tolerance : path::Tolerance{};
  const ProgrammedMove noted{move.piece, move.mode.blends() ? here : noted_tolerance_};
  noted_tolerance_ = here;
  slots_.gate.pass([&] { slots_.programmed.add(noted, seq); });
}

/// Where kinematics mix axes joints may go beyond their soft limits on the way between two places that are within.
bool Planner::joins_within_limits(const Pose& end) const noexcept {
  if (merge_.count() == 0) return false;
  Curve whole;
  JointVector joint = joint_;
  FaultRecord unused;
  return make_line(path::to_pose(merge_.start()), end, axes_of(kinematics_.axis_mask(), config_),
                   whole) &&
         within_soft_limits(whole, kinematics_, config_, skew_, shift_, joint, unused);
}

bool Planner::merge_line(const Block& block, const path::Piece& line, const Meta& meta) noexcept {
  // What stands between two moves keeps its place: outputs switch where they were programmed.
  const bool between = !events_.empty() && events_.back().after == moves_.size();
  if (moves_.empty() || between || moves_.back().stop_at_end ||
      !(moves_.back().piece.feed == line.feed))
    return false;
  const path::Vec end = path::to_vec(block.end);
  if (!plain_ && !joins_within_limits(block.end)) return false;
  if (!merge_.add(end, merge_mm_)) return false;
  const double speed = line.feed.speed;
  path::Piece& piece = moves_.back().piece;
  piece = path::line_move(merge_.start(), end, speed, false, guide_.vel);
  piece.feed = line.feed;
  meta_.back() = meta;
  meta_.back().merged_off_mm = merge_.off_mm();
  meta_.back().blocks = static_cast<std::uint32_t>(merge_.count());
  blocks_.push_back(block);
  Block* of = blocks_.end() - merge_.count();
  for (std::size_t n = 0; n < merge_.count(); ++n) of[n].way = piece.length * merge_.share(n);
  share_tolerance();
  return true;
}

/// A blend gets what merging has left of the tolerance on both of its sides; of two tolerances the smaller, else points of short moves behind the
/// corner could be off by that of the move before it.
void Planner::share_tolerance() noexcept {
  const std::size_t n = moves_.size();
  const double off = meta_[n - 1].merged_off_mm;
  moves_[n - 1].mode.tolerance.mm = std::max(meta_[n - 1].tolerance_mm - off, 0.0);
  if (n < 2) return;
  const Meta &before = meta_[n - 2], &here = meta_[n - 1];
  path::PathMode& corner = moves_[n - 2].mode;
  double p = before.tolerance_mm;
  if (corner.blends() && moves_[n - 1].mode.blends()) {
    p = std::min(p, here.tolerance_mm);
    corner.tolerance.deg = std::min(corner.tolerance.deg, moves_[n - 1].mode.tolerance.deg);
  }
  corner.tolerance.mm = std::max(p - std::max(before.merged_off_mm, off), 0.0);
}

Planner::Take Planner::output_change(const PathItem& item, const OutputChange& change) noexcept {
  const std::int32_t count = change.analog ? analog_ : digital_;
  if (change.index < 0 || change.index >= count) return bad_item(item, change.index);
  if (!std::isfinite(change.value)) return bad_item(item, change.value);
  return event(item, change);
}

Planner::Take Planner::spindle_change(const PathItem& item, const SpindleChange& change) noexcept {
  if (change.spindle < 0 || change.spindle >= spindles_) return bad_item(item, change.spindle);
  const bool numbers = std::isfinite(change.speed_rpm) && std::isfinite(change.css_factor) &&
                       std::isfinite(change.css_max_rpm) && std::isfinite(change.css_center_x_mm) &&
                       std::isfinite(change.orient_angle_deg);
  // Without a bound the speed at the centre would be without end.
  if (change.css_factor > 0 && change.css_max_rpm <= 0) return bad_item(item, change.css_max_rpm);
  if (!numbers || change.speed_rpm < 0) return bad_item(item, change.speed_rpm);
  const Take result = event(item, change);
  if (result == Take::done) {
    // S as it was changes nothing.
    const auto n = static_cast<std::size_t>(change.spindle);
    using Action = SpindleChange::Action;
    const bool css = change.css_factor > 0;
    if (change.action != Action::set_speed || change.speed_rpm != speed_rpm_[n] || css != css_[n])
      spindle_changed_ = true;
    speed_rpm_[n] = change.speed_rpm;
    css_[n] = css;
  }
  return result;
}

}  // namespace kerf::motion
