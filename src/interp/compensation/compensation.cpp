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

/// Blocks that may wait for the end of one move: some 30 MB. A program of any length runs in bounded memory.
constexpr std::size_t kMostWaiting = 10000;

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
  s.moves = 0;
  if (xz) s.tip = {kTip[orientation][1] * radius, kTip[orientation][0] * radius};
}

/// The peer's: one number in program units.
double Compensation::slack() const { return core_.state.units == Units::inch ? 0.001 : 0.0254; }

bool Compensation::end_open() {
  edit().path.set_slack(slack());
  release_all_ = true;
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
  s.moves = 0;
  s.leaving = false;
  if (off) s.bends = false;
  return true;
}

bool Compensation::take(const CompStep& step, const Pose& corner_end, Flat corner) {
  if (step.problem != nullptr) return too_narrow(step.problem);
  if (!release_all_ && core_.settings.compensation_look_ahead > 0 && current().path.started() &&
      !close(step))
    return false;
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

bool Compensation::too_narrow(const char* problem) {
  char help[160];
  const auto open =
      std::find_if(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return !w.closed; });
  const int line = open == waiting_.end() ? 0 : open->source.line;
  if (line > 0 && line != core_.state.line)
    std::snprintf(help, sizeof help,
                  "The tool does not fit between this move, that of line %d and the one before it; "
                  "use a smaller tool or longer moves",
                  line);
  else
    std::snprintf(help, sizeof help, "Make the move longer, or use a smaller tool");
  return core_.fail(0, help, "%s", problem);
}

/// The way around the corner takes the other axes along, but not the one across the plane.
Pose Compensation::corner_pose(const Pose& end) const {
  const std::size_t across = 3 - current().e1 - current().e2;
  Pose p = end;
  p[across] = core_.state.position[across];
  return p;
}

// --- look-ahead ---

bool Compensation::close(const CompStep& step) {
  // The way in and what leads from it to the contour are in the air; so is the last move, which never gets here.
  if (current().moves <= 2) return true;
  GuardedMove m = current().open;
  m.tool.end = step.open_end;
  m.tool.sweep = m.tool.sweep < 0 ? -step.open_sweep : step.open_sweep;
  closing_ = m;
  const double radius = current().radius_mm;
  const auto gouge = look_ahead_.gouge(m, radius);
  if (!gouge) return true;
  const double unit = core_.state.unit_mm();
  const char* const name = core_.state.units == Units::inch ? "inch" : "mm";
  char help[200];
  std::snprintf(help, sizeof help,
                "Its centre comes within %.4g %s of that contour, its radius is %.4g %s; use a "
                "smaller tool, or make the place wider",
                gouge->distance / unit, name, radius / unit, name);
  return core_.fail(0, help, "The tool gouges the contour of line %d on its way along line %d",
                    gouge->wall_line, gouge->tool_line);
}

void Compensation::guard(const CompStep& step, Flat from, Flat to, Flat corner, double across_end) {
  if (core_.settings.compensation_look_ahead <= 0) return;
  State& s = edit();
  s.moves = std::min(s.moves + 1, 3);
  const CompMove& m = step.move;
  const double across = core_.state.position[3 - s.e1 - s.e2];
  GuardedMove& g = s.open;
  g.programmed = {from, to, m.is_arc, m.center, m.turn_sign * m.programmed_sweep};
  g.tool = {m.start, m.end, m.is_arc, m.center, m.turn_sign * m.sweep};
  g.corner.reset();
  if (step.corner_end) {
    const Flat begin = step.open_end - corner, end = *step.corner_end - corner;
    double turn = std::atan2(begin.a * end.b - begin.b * end.a, begin.a * end.a + begin.b * end.b);
    if (turn * s.side > 0) turn -= s.side * kTwoPi;
    g.corner = FlatPiece{step.open_end, *step.corner_end, m.is_arc || !m.traverse, corner, turn};
  }
  g.line = core_.state.line;
  g.wall = m.is_arc || !m.traverse;
  g.low = std::min(across, across_end);
  g.high = std::max(across, across_end);
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
    guard(step, from, to, from, end[3 - current().e1 - current().e2]);
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
  guard(step, from, to, from, arc.end[3 - current().e1 - current().e2]);
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
  w.source.label = label_;
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

void Compensation::wait(const SourceLine& source, std::size_t from, bool overtaken) {
  if (spare_.empty()) spare_.emplace_back();
  waiting_.splice(waiting_.end(), spare_, spare_.begin());
  Waiting& w = waiting_.back();
  w.source = source;
  w.file.assign(source.file);
  w.text.assign(source.text);
  w.modal = core_.state;
  w.from = from;
  w.split = has_move_ ? split_ : core_.out.size();
  w.has_move = has_move_;
  w.move = move_;
  w.overtaken = overtaken;
  w.opens = has_move_ && opens_;
  w.closed = false;
  w.sync = core_.sync;
  core_.sync = SyncReason::none;
  w.calls.swap(core_.out);
  core_.out.clear();  // what an earlier block left there
}

/// The open move ends where it is known now, and so do moves across the plane behind it.
void Compensation::settle() {
  for (auto w = waiting_.rbegin(); w != waiting_.rend() && !w->closed; ++w) {
    w->closed = true;
    if (w->opens) ++closed_;
    if (!w->has_move) continue;
    Pose& end = w->move.is_arc ? w->move.arc.end : w->move.end;
    place(state_, end, open_.open_end);  // the plane and tool of that time
    if (w->move.is_arc) {
      CompMove turned;
      turned.turn_sign = w->move.arc.turns > 0 ? 1 : -1;
      w->move.arc.turns = turns_of(turned, open_.open_sweep);
    }
  }
}

void Compensation::release() {
  const auto depth =
      release_all_ ? 0U
                   : static_cast<std::size_t>(std::max(0, core_.settings.compensation_look_ahead));
  const auto stops = [](const Waiting& w) { return w.sync != SyncReason::none; };
  auto barrier = std::find_if(waiting_.rbegin(), waiting_.rend(), stops).base();
  bool held = barrier != waiting_.begin();
  while (!waiting_.empty()) {
    const auto w = waiting_.begin();
    if (w == barrier) held = false;
    if (!held && w->opens && closed_ <= depth) return;
    if (w->opens) --closed_;
    deliver(*w);
    spare_.splice(spare_.end(), waiting_, w);
  }
}

bool Compensation::has_room() const {
  if (release_ || waiting_.size() < kMostWaiting || (core_.out.empty() && !has_move_)) return true;
  return core_.fail(
      0, "Turn the compensation off with G40 where the tool does not move in the plane for long",
      "%zu blocks wait for the next move in the plane of the cutter compensation", waiting_.size());
}

void Compensation::finish(const SourceLine& source) {
  sync_ = SyncReason::none;
  label_ = source.label;
  const bool in_order = core_.settings.compensation_look_ahead > 0;
  bool announced = false;
  const std::size_t before = release_ ? release_at_ : 0;
  if (!in_order)
    core_.out.play(core_.canon, source, 0, before, CanonBuffer::Which::overtaking, announced);
  if (release_) {
    settle();
    release();
    announced = false;
  }
  if (in_order && waits()) {
    if (has_move_ || !core_.out.empty()) wait(source, 0, false);
  } else {
    const auto rest = in_order ? CanonBuffer::Which::all : CanonBuffer::Which::waiting;
    core_.out.play(core_.canon, source, 0, before, rest, announced);
    const std::size_t size = core_.out.size();
    if (has_move_ && opens_) {
      // The calls before the move, its corner among them, need not wait for its end.
      core_.out.play(core_.canon, source, before, split_, CanonBuffer::Which::all, announced);
      wait(source, split_, false);
    } else if (has_move_ || waits()) {
      core_.out.play(core_.canon, source, 0, size, CanonBuffer::Which::overtaking, announced);
      if (has_move_ || !core_.out.empty()) wait(source, 0, true);
    } else {
      core_.out.play(core_.canon, source, before, size, CanonBuffer::Which::all, announced);
      core_.out.clear();
    }
  }
  if (closing_)
    look_ahead_.take(*closing_, static_cast<std::size_t>(core_.settings.compensation_look_ahead));
  if (release_all_) look_ahead_.clear();
  if (staged_) state_ = next_;
  undo();
  if (core_.sync == SyncReason::none) core_.sync = sync_;
}

void Compensation::forget() {
  spare_.splice(spare_.end(), waiting_);
  closed_ = 0;
  look_ahead_.clear();
}

void Compensation::drop() {
  undo();
  state_ = State{};
  forget();
}

void Compensation::start_again() {
  undo();
  forget();
  state_.leaving = false;
  state_.moves = 0;
  if (state_.bends) state_.path = CompPath(state_.side, state_.radius_mm);
}

}  // namespace kerf::interp
