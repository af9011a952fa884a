// Pieces of path become spans, and the pass from the end says how fast each may be left.
#include <algorithm>
#include <cmath>

#include "motion/core/ahead.hpp"
#include "motion/core/planner/planner.hpp"

namespace kerf::motion {
namespace {

/// What rounding may have added up to at the end of a path (mm, degrees).
constexpr double kSamePoint = 1e-6;
/// Moves and events that end or stand so near to the end of a stretch are there (sigma, s at the feed): no law can be found over slivers.
constexpr double kSliver = 3e-4, kSliverTime = 5e-4;
/// A stretch that takes longer is divided where moves end, so that the shown line is right.
constexpr double kLineLag = 0.01;  // s
constexpr double kRounding = 1.0 - 1e-7;
constexpr int kGroupsTogether = 3;
/// What is near, for feeds: so many of the longest stops, and so long (s).
constexpr double kNearStops = 3, kNearTime = 0.1;

/// Stretches of a straight along which joints bend: at least, and on the way on which it gets its speed.
constexpr int kLeastPerStraight = 8, kPerRamp = 4;
constexpr double kShortestStep = 1e-4;

/// Whether joints go along so straight that their curls are nothing, at x.
bool evenly(const path::JointCurve& curve, double x) noexcept {
  const path::JointBends bends = path::bends_of(curve, curve.from, curve.from + curve.length);
  for (std::size_t i = 0; i < bends.count; ++i)
    if (bends.row[i].e * x > path::kJointBend * bends.row[i].acc) return false;
  return true;
}

/// The largest |u| by the rates of the joints alone, at most `acc`.
double even_acc(const path::JointCurve& curve, double acc) noexcept {
  const path::JointBends bends = path::bends_of(curve, curve.from, curve.from + curve.length);
  for (std::size_t i = 0; i < bends.count; ++i)
    if (bends.row[i].p > 0) acc = std::min(acc, bends.row[i].acc / bends.row[i].p);
  return acc;
}

double sliver_of(const path::Piece& piece) noexcept {
  return std::clamp(kSliverTime * piece.feed.speed, kOnePlace, kSliver);
}

}  // namespace

/// False: no room in the ring, or answers about joints are awaited.
bool Planner::send() noexcept {
  bool all = true;
  awaits_answers_ = false;
  if (slots_.gate.pass([&] { return spans_.size(); }) + kRoomWorthSending > kSpans) return false;
  while (true) {
    if (!send_events(sigma_)) {
      all = false;
      break;
    }
    if (piece_ >= pieces_.size()) break;
    if (slots_.gate.pass([&] { return spans_.size(); }) >= kSpans) {
      all = false;
      break;
    }
    const path::Piece& piece = pieces_[piece_];
    const bool whole = meta_[std::min(move_, sending_ - 1)].even_acc > 0;
    const double from = sigma_ - piece_sigma_;
    double to = piece.length;
    bool last = true;
    if (mixed_ && !whole) {
      if (!mixed_end(piece, from, to)) {
        all = false;
        break;
      }
      last = to >= piece.length;
    } else {
      const int n = whole ? 1 : path::divisions(piece);
      last = static_cast<int>(stretch_) + 1 == n;
      if (!last) to = piece.length * static_cast<double>(stretch_ + 1) / n;
    }
    // An event divides it; so does the end of a move where the shown line would lag too far behind.
    bool divided = false;
    const double near = sliver_of(piece);
    const auto divide = [&](double at) {
      if (at >= piece_sigma_ + to - near || at <= sigma_ + near) return;
      to = at - piece_sigma_;
      divided = true;
    };
    if (events_sent_ < events_sending_ && events_[events_sent_].after > 0)
      divide(meta_[events_[events_sent_].after - 1].sigma_end);
    if (piece.straight() || to - from > kLineLag * piece.feed.speed) {
      std::size_t m = move_;
      while (m + 1 < sending_ && meta_[m].sigma_end <= sigma_ + near) ++m;
      divide(meta_[m].sigma_end);
    }
    if (to - from > 0 && !send_stretch(piece, from, to)) {
      all = false;
      break;
    }
    sigma_ = piece_sigma_ + to;
    if (divided) continue;
    ++stretch_;
    if (!last) continue;
    piece_sigma_ += piece.length;
    sigma_ = piece_sigma_;
    stretch_ = 0;
    curved_ = false;
    ++piece_;
  }
  if (next_number_ != first_new_) plan(Plan::more);
  if (all) finish_sending();
  return all;
}

bool Planner::send_events(double sigma) noexcept {
  while (events_sent_ < events_sending_) {
    const Event& e = events_[events_sent_];
    const bool at_end = piece_ >= pieces_.size();
    if (!at_end && e.after > 0) {
      // What needs a standing machine waits for the very end.
      const double near = moves_[e.after - 1].stop_at_end ? kOnePlace : sliver_of(pieces_[piece_]);
      if (meta_[e.after - 1].sigma_end > sigma + near) return true;
    }
    if (!slots_.gate.pass([&] { return spans_.push(e.span); })) return false;
    ++events_sent_;
  }
  return true;
}

bool Planner::send_stretch(const path::Piece& piece, double from, double to) noexcept {
  const double begin = piece_sigma_ + from, end = piece_sigma_ + to, middle = (begin + end) / 2;
  while (move_ + 1 < sending_ && meta_[move_].sigma_end <= middle) ++move_;
  const Meta& meta = meta_[move_];
  Span span;
  span.epoch = epoch_;
  PathSpan body;
  body.piece = piece;
  body.from = from;
  body.length = to - from;
  const path::Vec slope = piece.first(from);
  body.heading = std::atan2(slope[1], slope[0]);
  body.kind = meta.kind;
  body.number = next_number_;
  body.probe = meta.probe;
  body.probe_until_open = meta.probe_until_open;
  body.probe_fail_is_error = meta.probe_fail_is_error;
  Sent sent;
  std::size_t done = blocks_done_;
  if (!send_blocks(begin, end, done, span, body, sent)) return false;
  const bool at_piece_end = to >= piece.length;
  body.stop_at_end = piece.stop_at_end && at_piece_end;
  // A corner that stands for several programmed ones (coarse.hpp) may be as far along as one of them, and beside it.
  body.at_end_exactly =
      body.stop_at_end && sent.block_end &&
      path::max_abs(path::to_vec(body.end) - piece.point(piece.length)) <= kSamePoint;

  // It is done when it is locked.
  if (meta.kind == MotionKind::index_rotary) {
    body.done_seq = 0;
    sent.block_end = false;
  }

  sent.begins = begins_;
  sent.length = body.length;
  sent.stop_at_end = body.stop_at_end;
  SpeedBounds& speed = body.speed;
  speed.rapid = piece.feed.rapid;
  speed.sync = piece.feed.sync;
  speed.per_rev = piece.feed.per_rev;
  speed.rps = piece.feed.rps;
  bound_sync(body, meta, begin);
  speed.feed_cap = path::feed_cap(piece, from, to);
  double axis_cap = 0;
  if (meta.even_acc > 0) {
    speed.cap = meta.cap;
    body.even_acc = meta.even_acc;
    body.even_jerk = meta.even_jerk;
  } else if (mixed_ && !limits_.jerks) {
    bound_mixed(body, from, to);
    if (!(body.even_acc > 0)) rows_of(body, limits_, sent.rows);
  } else {
    speed.cap = axis_cap = path::axis_cap(piece, from, to, limits_);
    if (limits_.jerks) {
      path::Box box = boxes_[piece_];
      if (mixed_ && !foretold_) {
        box = creep_.box;
        speed.cap = creep_.cap;
        axis_cap = 0;
      } else if (mixed_) {
        speed.cap = axis_cap = path::velocity_cap(curve_, from, to, axis_cap);
        speed.cap = std::min(speed.cap, path::box_cap(path::bends_of(curve_, from, to), box));
      }
      body.even_acc = box.acc;
      body.even_jerk = box.jerk;
      speed.cap = std::min(speed.cap, path::box_cap(piece, from, to, box, limits_));
    } else if (piece.straight())
      body.even_acc = path::straight_acc(piece, limits_);
    else
      rows_of(body, limits_, sent.rows);
  }
  if (piece.feed.metric != 3 && piece.feed.metric >= 0)
    speed.slope = path::slope_of(piece, from, to);
  body.requested = piece.feed.speed < path::kNoLimit
                       ? piece.feed.speed
                       : std::sqrt(speed.cap) * path::slope_of(piece, from, to);
  body.by_law = laws_.on() && axis_cap > 0 && body.even_jerk > 0 && !meta.probe && !speed.sync &&
                meta.kind != MotionKind::index_rotary;
  if (laws_.on()) {
    LawMaker::Stretch stretch{piece,          from,           body.length, speed,
                              body.even_acc,  body.even_jerk, body.by_law, body.stop_at_end,
                              sent.block_end, sent.blocks};
    stretch.speed.cap = axis_cap;  // not that of the box
    laws_.add(next_number_, stretch, mixed_ && body.by_law ? &curve_ : nullptr);
  }
  sent.speed = speed;
  sent.even_acc = body.even_acc;
  sent.even_jerk = body.even_jerk;
  sent.place = spans_.pushed();
  sent.group = next_number_;
  if (next_number_ > 0 && sent.even_jerk > 0 && !begins_) {
    const Sent& before = sent_[(next_number_ - 1) % kSpans];
    if (!before.stop_at_end && before.even_acc == sent.even_acc &&
        before.even_jerk == sent.even_jerk)
      sent.group = before.group;
  }
  span.body = body;
  // Until the pass from the end has been made it ends in a stop.
  PlanSlots::Ahead& ahead = slots_.ahead[next_number_ % kSpans];
  ahead.length.set(body.length);
  ahead.acc.set(body.even_acc);
  ahead.jerk.set(body.even_jerk);
  ahead.cap.set(speed.cap);
  ahead.feed_cap.set(speed.sync ? path::kNoLimit : speed.feed_cap);
  ahead.slope.set(speed.slope);
  ahead.rps.set(speed.rps);
  ahead.rapid.set(speed.rapid ? 1 : 0);
  ahead.per_rev.set(speed.per_rev);
  slots_.hard[next_number_ % kSpans].set(0);
  slots_.soft[next_number_ % kSpans].set(0);
  if (!slots_.gate.pass([&] { return spans_.push(span); })) return false;
  if (sent_.size() < kSpans)
    sent_.push_back(sent);
  else
    sent_[next_number_ % kSpans] = sent;
  ++next_number_;
  next_block_ = sent.last_block;
  blocks_done_ = done;
  begins_ = false;
  return true;
}

/// How joints move along the stretch that begins at `from`. False: that is not known yet.
bool Planner::next_curve(const path::Piece& piece, double from, double& to) noexcept {
  if (!asks_) {
    foretold_ = joint_bounds_.curve_of(piece, from, to, curve_);
    creep_ = joint_bounds_.creep();
    return true;
  }
  const auto passed = [&](const JointBounds::Told& told) {
    return told.piece < piece_ || (told.piece == piece_ && told.to <= from + kOnePlace);
  };
  while (true) {
    while (next_told_ < told_.size() && passed(told_[next_told_])) ++next_told_;
    if (next_told_ < told_.size()) break;
    told_.clear();
    next_told_ = 0;
    if (asked_.piece != piece_ || std::abs(asked_.from - from) > kOnePlace) asked_ = {piece_, from};
    if (!joint_bounds_.tell(pieces_, asked_, told_)) return false;
  }
  const JointBounds::Told& told = told_[next_told_];
  foretold_ = told.foretold;
  curve_ = told.curve;
  creep_ = told.creep;
  to = told.to;
  return true;
}

/// Where a stretch ends that begins at `from`, where kinematics mix axes. False: answers are awaited.
bool Planner::mixed_end(const path::Piece& piece, double from, double& to) noexcept {
  const bool within =
      curved_ && from >= curve_.from && from < curve_.from + curve_.length - kOnePlace;
  to = piece.length;
  if (!within) {
    if (!next_curve(piece, from, to)) {
      awaits_answers_ = true;
      return false;
    }
    if (!foretold_) curve_.from = from, curve_.length = to - from;
    curved_ = true;
  }
  const double end = curve_.from + curve_.length;
  // What rounding leaves is no stretch.
  to = piece.length - end <= kOnePlace ? piece.length : end;
  if (limits_.jerks || !foretold_) return true;
  const double cap = path::velocity_cap(curve_, from, to, path::axis_cap(piece, from, to, limits_));
  if (piece.straight() && evenly(curve_, cap)) return true;
  // Limited in acceleration x is linear on a stretch: there are as many as let it bend.
  double step = std::min(path::even_step(curve_, path::even_x(curve_, cap)),
                         piece.length / path::divisions(piece));
  if (piece.straight()) {
    const double most = std::max(config_.max_feed_override, 1.0);
    const double wanted = std::min(cap, path::feed_cap(piece, from, to) * most * most);
    const double ramp = wanted / (2 * even_acc(curve_, path::straight_acc(piece, limits_)));
    step = std::min({step, piece.length / kLeastPerStraight, ramp / kPerRamp});
  }
  const double parts = std::ceil((to - from) / std::max(step, kShortestStep) - 1e-9);
  if (parts > 1) to = from + (to - from) / parts;
  return true;
}

/// The same, limited in acceleration: what bounds the stretch.
void Planner::bound_mixed(PathSpan& body, double from, double to) noexcept {
  if (!foretold_) {
    body.speed.cap = creep_.cap;
    body.even_acc = creep_.box.acc;
    return;
  }
  const path::Piece& piece = body.piece;
  body.speed.cap = path::velocity_cap(curve_, from, to, path::axis_cap(piece, from, to, limits_));
  if (piece.straight() && evenly(curve_, body.speed.cap)) {
    body.even_acc = even_acc(curve_, path::straight_acc(piece, limits_));
    return;
  }
  path::JointCurve& kept = curves_[next_number_ % kCurves];
  kept = curve_;
  body.joints = &kept;
}

/// What ends and begins within [begin, end] of what is sent; `done` blocks have ended before it, and at its end. False: no room.
bool Planner::send_blocks(double begin, double end, std::size_t& done, Span& span, PathSpan& body,
                          Sent& sent) noexcept {
  // Blocks that are as good as nothing end with the one before.
  while (done + 1 < blocks_sending_ && blocks_[done].sigma_end <= begin + kOnePlace) ++done;
  const std::size_t first = std::min(done, blocks_sending_ - 1);
  std::size_t last = first;
  while (last + 1 < blocks_sending_ && blocks_[last].sigma_end < end - kOnePlace) ++last;
  const Block& own = blocks_[first];
  span.seq = own.seq;
  span.tag = own.tag;
  body.end = blocks_[last].end;
  body.to_move_end = std::max(0.0, blocks_[last].sigma_end - end);
  sent.blocks = last > first;
  sent.last_block = next_block_;
  if (sent.blocks) {
    const std::size_t count = last - first + 1;
    if (!room_for_blocks(count)) return false;
    body.first_block = next_block_;
    body.blocks = static_cast<std::uint32_t>(count);
    for (std::size_t n = first; n <= last; ++n) {
      BlockStart& start = slots_.block[sent.last_block++ % PlanSlots::kBlocks];
      start.left = n > first ? end - blocks_[n - 1].sigma_end : body.length;
      start.done_seq = n > first ? blocks_[n - 1].seq : 0;
      start.seq = blocks_[n].seq;
      start.tag = blocks_[n].tag;
    }
    body.done_seq = blocks_[last - 1].seq;
  }
  for (done = last; done < blocks_sending_ && blocks_[done].sigma_end <= end + kOnePlace; ++done) {
    body.done_seq = blocks_[done].seq;
    sent.block_end = true;
  }
  return true;
}

/// In PlanSlots::block, beside what the spans use that the servo has not popped.
bool Planner::room_for_blocks(std::size_t count) noexcept {
  const std::uint64_t popped = slots_.gate.pass([&] { return spans_.popped(); });
  while (oldest_span_ < next_number_ && sent_[oldest_span_ % kSpans].place < popped)
    oldest_block_ = sent_[oldest_span_++ % kSpans].last_block;
  return next_block_ + count <= oldest_block_ + PlanSlots::kBlocks;
}

/// With the first `gone` moves, and what was sent of the one behind them.
void Planner::drop_blocks(std::size_t gone) noexcept {
  std::size_t blocks = 0;
  for (std::size_t i = 0; i < gone; ++i) blocks += meta_[i].blocks;
  if (halved_) {
    Meta& part = meta_[gone];
    const std::size_t ended = blocks_done_ > blocks ? blocks_done_ - blocks : 0;
    part.blocks -= static_cast<std::uint32_t>(ended);
    blocks += ended;
    for (std::uint32_t n = 0; n < part.blocks; ++n)
      blocks_[blocks + n].way -= moves_[gone].piece.length;  // half of it was sent
  }
  blocks_.drop_front(blocks);
}

void Planner::finish_sending() noexcept {
  const std::size_t gone = halved_ ? sending_ - 1 : sending_;
  drop_blocks(gone);
  moves_.drop_front(gone);
  meta_.drop_front(gone);
  events_.drop_front(events_sending_);
  for (Event& e : events_) e.after -= static_cast<std::uint32_t>(gone);
  due_ =
      std::any_of(moves_.begin(), moves_.end(), [](const path::Move& m) { return m.stop_at_end; });
  sending_ = events_sending_ = events_sent_ = 0;
  pieces_.clear();
  if (moves_.empty() && events_.empty()) slots_.gate.pass([&] { slots_.pending.publish(0); });
}

/// In single step the path stands at the end of span n: a block ends there, or within the next span, which is entered at rest then (Executor::cut_).
bool Planner::steps_end_behind(std::uint64_t n) const noexcept {
  const Sent& next = sent_[(n + 1) % kSpans];
  return sent_[n % kSpans].block_end || (n + 1 < next_number_ && !next.begins && next.blocks);
}

/// Behind the way that the servo drives within the next moments: no stop that begins within the next cycles gets there.
std::uint64_t Planner::near_end() noexcept {
  const double enough_s = kNearStops * stop_s_ + kNearTime;
  // Of the first one hardly anything may be left.
  std::uint64_t n = std::min(first_ahead() + 1, next_number_);
  for (double s = 0; n < next_number_ && s < enough_s; ++n) {
    const Sent& span = sent_[n % kSpans];
    s += span.length / std::sqrt(span.speed.cap);
  }
  return n;
}

/// Backwards to the first span that the servo has not begun.
void Planner::plan(Plan what) noexcept {
  const bool all = what == Plan::all, feed = what == Plan::feed || what == Plan::near_feed;
  // What the servo drives on to meanwhile is written in vain; nobody reads it.
  const std::uint64_t popped = slots_.gate.pass([&] { return spans_.popped(); });
  // As if it were wanted to stand behind what is near.
  const std::uint64_t end = what == Plan::near_feed ? near_end() : next_number_;
  if (what != Plan::more) far_feed_old_ = end < next_number_;
  double hard = 0, soft = 0;
  int unchanged = 0;  // ends of groups in a row
  for (std::uint64_t n = end; n-- > 0 && next_number_ - n <= kSpans;) {
    const Sent& s = sent_[n % kSpans];
    if (s.place < popped) break;
    if (s.even_jerk > 0) {
      hard = soft = 0;
      if (feed) {
        // Feeds bear on nothing here.
        if (s.begins) break;
        continue;
      }
      // Within a group nothing changes.
      if (!all && n + 1 < first_new_ && sent_[(n + 1) % kSpans].group <= n) {
        n = s.group;
        if (next_number_ - n > kSpans || sent_[n % kSpans].begins) break;
        continue;
      }
      // More groups than are ever looked at together are as they were.
      if (!plan_ramps(n, unchanged) && !all && unchanged > kGroupsTogether) break;
      if (s.begins) break;
      continue;
    }
    rtapi::Word<double>&hard_slot = slots_.hard[n % kSpans], &soft_slot = slots_.soft[n % kSpans];
    const double cap = s.speed.cap, wanted = wanted_x(s.speed, scale_);
    const double hard_end = feed ? hard_slot.get() : s.stop_at_end ? 0.0 : std::min(hard, cap);
    const bool stands = s.stop_at_end || (single_step_ && !s.speed.sync && steps_end_behind(n));
    const double soft_end = stands ? 0.0 : std::min({soft, wanted, hard_end});
    if (what == Plan::more && n < first_new_ && hard_slot.get() == hard_end &&
        soft_slot.get() == soft_end)
      break;
    slots_.gate.pass([&] {
      soft_slot.set(soft_end);
      // Release, last span first: see PlanSlots.
      hard_slot.publish(hard_end);
    });
    const double gain = 2.0 * s.length * s.even_acc * kRounding;
    const auto start = [&](double x_end) {
      return s.even_acc > 0 ? x_end + gain : path::largest_x0(s.rows.all(), x_end);
    };
    if (!feed) hard = std::min(cap, start(hard_end));
    soft = std::min(wanted, start(soft_end));
    if (s.begins) break;
  }
  first_new_ = next_number_;
}

/// Span n, with jerk limits: only where the limits along the path change there is a speed to find (ahead.hpp). Counts the ends of groups that stayed
/// as they were; true: this one is none, or changed.
bool Planner::plan_ramps(std::uint64_t n, int& unchanged) noexcept {
  const Sent& s = sent_[n % kSpans];
  const Sent& next = sent_[(n + 1) % kSpans];
  const bool ends = s.stop_at_end || n + 1 == next_number_ || next.begins || !(next.even_jerk > 0);
  const bool group_end = ends || next.even_acc != s.even_acc || next.even_jerk != s.even_jerk;
  double hard = 0;
  if (!ends) {
    hard = std::min(s.speed.cap, next.speed.cap);
    if (group_end) {
      const double v = highest_level_speed(slots_, n + 1);
      hard = std::min(hard, v * v);
    }
  }
  rtapi::Word<double>& slot = slots_.hard[n % kSpans];
  double soft = path::kNoLimit;
  if (single_step_ && !s.speed.sync && steps_end_behind(n)) {
    soft = 0;
  } else if (single_step_ && group_end && !ends) {
    const double v = highest_level_speed(slots_, n + 1, true);
    soft = v * v;
  }
  const bool same = group_end && n < first_new_ && slot.get() == hard;
  if (group_end) unchanged = same ? unchanged + 1 : 0;
  slots_.gate.pass([&] {
    slots_.soft[n % kSpans].set(soft);
    // Release, last span first: see PlanSlots.
    slot.publish(hard);
  });
  return !same;
}

}  // namespace kerf::motion
