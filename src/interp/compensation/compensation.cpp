#include "interp/compensation/compensation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "interp/core.hpp"

namespace kerf::interp {

namespace {

constexpr double kTwoPi = 6.283185307179586;
/// Moves in the plane shorter than this (mm) have no direction.
constexpr double kNoMove = 1e-9;

/// Lathe tools: direction from the centre of the tip to the controlled point, x and z, in radii. Manual: "Tool Orientation".
constexpr double kTip[10][2] = {{0, 0}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1},
                                {0, 1}, {-1, 0}, {0, -1},  {1, 0},  {0, 0}};

/// Turns that an arc of this sweep starts.
int turns_of(const CompMove& m, double sweep) {
  const int turns = std::max(1, static_cast<int>(std::ceil((sweep - 1e-6) / kTwoPi)));
  return m.turn_sign > 0 ? turns : -turns;
}

}  // namespace

Compensation::State& Compensation::edit() {
  if (!staged_) next_ = state_;
  staged_ = true;
  return next_;
}

void Compensation::place(const State& s, Pose& p, Flat at) {
  p[s.e1] = at.a + s.tip.a;
  p[s.e2] = at.b + s.tip.b;
}

// --- handlers ---

void Compensation::turn_on(bool left_side, double diameter_mm, int orientation) {
  State& s = edit();
  const double side = left_side == (diameter_mm >= 0) ? 1.0 : -1.0;
  const double radius = std::fabs(diameter_mm) / 2;
  const bool xz = core_.state.plane() == Plane::xz;
  s.bends = radius > 0;
  s.leaving = false;
  s.path = CompPath(side, radius);
  s.side = side;
  s.radius_mm = radius;
  s.e1 = xz ? 2 : 0;
  s.e2 = xz ? 0 : 1;
  s.tip = {};
  if (xz) s.tip = {kTip[orientation][1] * radius, kTip[orientation][0] * radius};
}

/// The peer's: one number in program units.
double Compensation::slack() const { return core_.state.units == Units::inch ? 0.001 : 0.0254; }

bool Compensation::end_open() {
  edit().path.set_slack(slack());
  return take(current().path.last(), {}, {});
}

bool Compensation::turn_off() {
  if (!current().bends) return true;
  const bool started = current().path.started();
  if (started && !end_open()) return false;
  State& s = edit();
  s.bends = false;
  s.leaving = started;
  return true;
}

bool Compensation::end_program(bool off) {
  if (current().bends && current().path.started()) {
    if (!end_open()) return false;
    place(current(), core_.state.position, current().path.end());
  } else if (!current().bends && !current().leaving) {
    return true;
  }
  State& s = edit();
  s.path = CompPath(s.side, s.radius_mm);
  s.leaving = false;
  if (off) s.bends = false;
  return true;
}

bool Compensation::take(const CompStep& step, const Pose& corner_end, Flat corner) {
  if (step.problem != nullptr) {
    char help[160];
    const int line = used_ == 0 ? 0 : waiting_.front().source.line;
    if (line > 0 && line != core_.state.line)
      std::snprintf(help, sizeof help,
                    "The tool does not fit between this move, that of line %d and the one before "
                    "it; use a smaller tool or longer moves",
                    line);
    else
      std::snprintf(help, sizeof help, "Make the move longer, or use a smaller tool");
    return core_.fail(0, help, "%s", step.problem);
  }
  release_ = true;
  release_at_ = core_.out.size();
  open_ = step;
  edit();
  if (!step.corner_end) return true;
  Pose end = corner_end;
  place(current(), end, *step.corner_end);
  if (!step.move.is_arc && step.move.traverse) {
    core_.out.call<&Canon::straight_traverse>(end);
    return true;
  }
  Arc arc;
  arc.end = end;
  arc.center[current().e1] = corner.a + current().tip.a;
  arc.center[current().e2] = corner.b + current().tip.b;
  arc.plane = core_.state.plane();
  arc.turns = current().side > 0 ? -1 : 1;
  core_.out.call<&Canon::arc_feed>(arc);
  return true;
}

/// The way around the corner takes the other axes along, but not the one across the plane.
Pose Compensation::corner_pose(const Pose& end) const {
  const std::size_t across = 3 - current().e1 - current().e2;
  Pose p = end;
  p[across] = core_.state.position[across];
  return p;
}

void Compensation::stage_move(const Move& move) {
  has_move_ = true;
  move_ = move;
  split_ = core_.out.size();
}

bool Compensation::straight(const Pose& end, bool traverse) {
  const Flat from = flat(core_.state.position), to = flat(end);
  Move move;
  move.traverse = traverse;
  move.end = end;
  const bool stays = std::hypot(to.a - from.a, to.b - from.b) < kNoMove;
  opens_ = !stays || !current().path.started();
  if (opens_) {
    edit().path.set_slack(slack());
    const CompStep step = current().path.line(from, to, traverse);
    if (!take(step, corner_pose(end), from)) return false;
    edit().path.take(step.move);
  } else {
    edit();
  }
  place(current(), move.end, current().path.end());
  stage_move(move);
  return true;
}

bool Compensation::arc(const Arc& arc) {
  const Flat from = flat(core_.state.position), to = flat(arc.end);
  const Flat center{arc.center[current().e1], arc.center[current().e2]};
  edit().path.set_slack(slack());
  const CompStep step = current().path.arc(from, to, {center, arc.turns}, from - current().tip);
  if (!take(step, corner_pose(arc.end), from)) return false;
  edit().path.take(step.move);
  opens_ = true;
  Move move;
  move.is_arc = true;
  move.arc = arc;
  place(current(), move.arc.end, step.move.end);
  move.arc.center[current().e1] = step.move.center.a + current().tip.a;
  move.arc.center[current().e2] = step.move.center.b + current().tip.b;
  move.arc.turns = turns_of(step.move, step.move.sweep);
  stage_move(move);
  return true;
}

Pose Compensation::tool_position(const Pose& programmed) const {
  Pose p = programmed;
  const State& s = current();
  if (s.bends && s.path.started()) {
    p[s.e1] = s.path.end().a;
    p[s.e2] = s.path.end().b;
  }
  return p;
}

// --- delivery ---

void Compensation::make(const Move& move) {
  if (move.is_arc)
    core_.canon.arc_feed(move.arc);
  else if (move.traverse)
    core_.canon.straight_traverse(move.end);
  else
    core_.canon.straight_feed(move.end);
}

void Compensation::deliver(Waiting& w) {
  w.source.file = w.file;
  w.source.text = w.text;
  core_.shown = &w.modal;
  const auto which = w.overtaken ? CanonBuffer::Which::waiting : CanonBuffer::Which::all;
  bool announced = false;
  w.calls.play(core_.canon, w.source, w.from, w.split, which, announced);
  if (w.has_move) {
    if (!announced) core_.canon.next_block(w.source);
    announced = true;
    make(w.move);
  }
  w.calls.play(core_.canon, w.source, w.split, w.calls.size(), which, announced);
  core_.shown = nullptr;
  if (w.sync != SyncReason::none) sync_ = w.sync;
}

void Compensation::wait(const SourceLine& source) {
  if (used_ == waiting_.size()) waiting_.emplace_back();
  Waiting& w = waiting_[used_++];
  w.source = source;
  w.file.assign(source.file);
  w.text.assign(source.text);
  w.modal = core_.state;
  w.from = has_move_ && opens_ ? split_ : 0;
  w.split = has_move_ ? split_ : core_.out.size();
  w.has_move = has_move_;
  w.move = move_;
  w.overtaken = !(has_move_ && opens_);
  w.sync = core_.sync;
  core_.sync = SyncReason::none;
  w.calls.swap(core_.out);
  core_.out.clear();  // what an earlier block left there
}

void Compensation::finish(const SourceLine& source) {
  sync_ = SyncReason::none;
  bool announced = false;
  const std::size_t overtaken = release_ ? release_at_ : 0;
  core_.out.play(core_.canon, source, 0, overtaken, CanonBuffer::Which::overtaking, announced);
  if (release_) {
    for (std::size_t i = 0; i < used_; ++i) {
      Waiting& w = waiting_[i];
      if (w.has_move) {
        Pose& end = w.move.is_arc ? w.move.arc.end : w.move.end;
        place(state_, end, open_.open_end);  // the plane and tool of that time
        if (w.move.is_arc) {
          CompMove turned;
          turned.turn_sign = w.move.arc.turns > 0 ? 1 : -1;
          w.move.arc.turns = turns_of(turned, open_.open_sweep);
        }
      }
      deliver(w);
    }
    used_ = 0;
  }
  if (release_) announced = false;
  core_.out.play(core_.canon, source, 0, overtaken, CanonBuffer::Which::waiting, announced);
  if (has_move_ && opens_) {
    // The calls before the move, its corner among them, need not wait for its end.
    core_.out.play(core_.canon, source, overtaken, split_, CanonBuffer::Which::all, announced);
    wait(source);
  } else if (has_move_ || used_ > 0) {
    core_.out.play(core_.canon, source, 0, core_.out.size(), CanonBuffer::Which::overtaking,
                   announced);
    if (has_move_ || !core_.out.empty()) wait(source);
  } else {
    core_.out.play(core_.canon, source, overtaken, core_.out.size(), CanonBuffer::Which::all,
                   announced);
    core_.out.clear();
  }
  if (staged_) state_ = next_;
  undo();
  if (core_.sync == SyncReason::none) core_.sync = sync_;
}

void Compensation::drop() {
  undo();
  state_ = State{};
  used_ = 0;
}

void Compensation::start_again() {
  undo();
  used_ = 0;
  state_.leaving = false;
  if (state_.bends) state_.path = CompPath(state_.side, state_.radius_mm);
}

}  // namespace kerf::interp
