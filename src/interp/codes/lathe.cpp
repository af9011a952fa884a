// G70, G71-G71.2, G72-G72.2: lathe cycles on a profile in a sub. Manual: "G70 Lathe finishing cycle",
// "G71 G72 Lathe roughing cycles".
//
// The sub is interpreted with its expressions, loops and calls, but of its blocks only the moves count (G0-G3 with X Z U W,
// I K R, and the corners A and C). So every check of the profile comes before the first canonical call of the cycle.
#include <cmath>
#include <optional>

#include "interp/codes/families.hpp"
#include "interp/lathe/passes.hpp"
#include "interp/lathe/reading.hpp"

namespace kerf::interp {

namespace {

using lathe::Move;
using lathe::Path;
using lathe::Point;

/// A profile has no more moves; more are a loop without an end.
constexpr std::size_t kMostProfileMoves = 10000;
constexpr int kMostFinishingPasses = 1000;

constexpr bool facing(int code) { return code >= 720; }
constexpr bool finishing(int code) { return code == 700; }

/// Turns (s, h) of a path that runs forward, above the part, into Z and X (and back). Facing swaps the axes.
struct Orientation {
  bool swap{false};
  double s{1}, h{1};

  [[nodiscard]] Point from_zx(Point p) const {
    return swap ? Point{p.h * s, p.s * h} : Point{p.s * s, p.h * h};
  }
  [[nodiscard]] Point to_zx(Point p) const {
    return swap ? Point{p.h * h, p.s * s} : Point{p.s * s, p.h * h};
  }
  [[nodiscard]] bool mirrors() const { return swap != (s * h < 0); }
  [[nodiscard]] Path from_zx(const Path& moves) const {
    Path out = moves;
    for (Move& m : out) {
      m.from = from_zx(m.from);
      m.to = from_zx(m.to);
      m.center = from_zx(m.center);
      if (mirrors()) m.ccw = !m.ccw;
    }
    return out;
  }
};

/// Makes moves of the machine of the cycle's: canonical calls, or steps for cutter compensation.
class CycleTool final : public lathe::Tool {
 public:
  CycleTool(Core& c, const Orientation& o, std::vector<ProfileReading::Step>* steps)
      : c_(c), o_(o), steps_(steps), at_(c.state.position) {}
  void rapid(Point to) override { straight(to, true); }
  void feed(Point to) override { straight(to, false); }
  void arc(const Move& m) override {
    const Point center = o_.to_zx(m.center);
    Arc a;
    a.end = place(m.to);
    a.center = {no_dust(center.h), 0, no_dust(center.s)};
    a.plane = Plane::xz;
    a.turns = m.ccw != o_.mirrors() ? 1 : -1;
    if (steps_ != nullptr)
      steps_->push_back({true, false, a});
    else
      c_.out.call<&Canon::arc_feed>(a);
  }

 private:
  void straight(Point to, bool traverse) {
    const Pose before = at_, end = place(to);
    if (steps_ != nullptr) {
      Arc a;
      a.end = end;
      if (end != before) steps_->push_back({false, traverse, a});  // no length, no side of it
    } else if (traverse) {
      c_.out.call<&Canon::straight_traverse>(end);
    } else {
      c_.out.call<&Canon::straight_feed>(end);
    }
  }
  const Pose& place(Point p) {
    const Point zx = o_.to_zx(p);
    at_.z = no_dust(zx.s);
    at_.x = no_dust(zx.h);
    if (steps_ == nullptr) c_.state.position = at_;
    return at_;
  }
  /// Sums that should be 0 but are not quite would be shown as -0.
  static double no_dust(double v) { return std::fabs(v) < lathe::kNothing ? 0.0 : v; }

  Core& c_;
  const Orientation& o_;
  std::vector<ProfileReading::Step>* steps_;
  Pose at_;
};

/// Direction of the profile along its axis, and the side on which the cycle begins.
Orientation orientation(const Path& moves, Point start, bool swap) {
  Orientation o;
  o.swap = swap;
  const Point first = o.from_zx(moves.front().from), last = o.from_zx(moves.back().to);
  const Point from = o.from_zx(start);
  if (last.s < first.s) o.s = -1;
  const double above =
      std::fabs(from.h - first.h) > lathe::kNothing ? from.h - first.h : from.h - last.h;
  if (above < 0) o.h = -1;
  return o;
}

bool not_monotonic(Core& c, const char* axis) {
  return c.fail(0, axis, "G7X error: Not monotonic");
}

double length_of(const Move& m) { return std::hypot(m.to.s - m.from.s, m.to.h - m.from.h); }

/// The profile without the way to it, corners rounded; Z and X.
bool rounded_profile(Core& c, const ProfileReading& p, Path& profile) {
  if (p.moves.size() < 2)
    return c.fail('q', "The sub needs at least two moves: to the profile, and along it",
                  "G7X error: The profile has no moves");
  auto rounded = lathe::round_corners(p.moves);
  if (!rounded)
    return not_monotonic(c, "A fillet or chamfer (A, C) is too large for the moves beside it");
  profile = std::move(*rounded);
  // round_corners() leaves out a way of no length: the cycle begins at the profile.
  const Move& way = p.moves.front();
  const bool left_out = length_of(way) < lathe::kNothing;
  if (!left_out && !profile.empty()) profile.erase(profile.begin());
  // Corners may take the whole of a move.
  std::erase_if(profile, [](const Move& m) { return length_of(m) < lathe::kNothing; });
  if (profile.empty())
    return c.fail('q', "All moves of the sub end at the same point",
                  "G7X error: The profile has no moves");
  return true;
}

/// From `start` the tool gets to the beginning of the way without going through the part.
bool reaches(const Path& way, Point start) {
  const double begin = way.front().from.s;
  return start.s <= begin || lathe::clear_of(way, {begin, start.h}, start);
}

/// What the tool follows at this distance. Error: it cannot, or cannot get to its beginning.
bool way_beside(Core& c, const Path& path, double distance, Point start, Path& way) {
  way = lathe::allowance(path, distance);
  if (way.empty())
    return c.fail('d', "Write a smaller D", "G7X error: The profile is too narrow for D");
  if (reaches(way, start)) return true;
  return c.fail(0, "Begin further away, beside the beginning of the profile",
                "G7X error: The cycle begins inside the part");
}

bool finish(Core& c, ProfileReading& p, const Path& profile) {
  const Point start{p.start.z, p.start.x};
  // Along Z as G71, or along X as G72 where Z turns back or the cycle begins in front of the face.
  std::optional<Orientation> chosen;
  for (const bool across : {false, true}) {
    const Orientation o = orientation(profile, start, across);
    const Path path = o.from_zx(profile);
    if (!lathe::runs_forward(path)) continue;
    const bool reached = reaches(path, o.from_zx(start));
    if (reached || !chosen) chosen = o;
    if (reached) break;
  }
  if (!chosen) return not_monotonic(c, "Z or X of the profile must not turn back on the way");
  const Orientation o = *chosen;
  const Path path = o.from_zx(profile);
  const Block& b = p.block;
  const double from = c.mm(b.get('d', 0)), to = c.mm(b.get('e', 0));
  const double passes = std::nearbyint(b.get('p', 1));
  const Point begin = o.from_zx(start);
  CycleTool tool(c, o, c.compensation.bends() ? &p.steps : nullptr);
  Path way;
  tool.rapid(begin);
  for (double pass = passes; pass >= 1; --pass) {
    if (!way_beside(c, path, (pass - 1) * (from - to) / passes + to, begin, way)) return false;
    // Down to the profile from beside its beginning, never slanting over it.
    tool.rapid({std::min(begin.s, way.front().from.s), begin.h});
    tool.rapid(way.front().from);
    lathe::follow(way, tool);
    const Point end = way.back().to;
    if (pass < 2) break;
    if (!lathe::clear_of(way, end, begin)) {
      const double top = std::max(begin.h, lathe::highest(way));
      tool.rapid({end.s, top});
      if (top > begin.h) tool.rapid({std::min(begin.s, way.front().from.s), top});
    }
    if (begin.s > way.front().from.s) tool.rapid(begin);
  }
  return true;
}

bool rough(Core& c, const ProfileReading& p, const Path& profile) {
  const Block& b = p.block;
  const Point start{p.start.z, p.start.x};
  const Orientation o = orientation(profile, start, facing(p.code));
  const Path path = o.from_zx(profile);
  if (!lathe::runs_forward(path))
    return not_monotonic(c, facing(p.code) ? "X of the profile must not turn back on the way"
                                           : "Z of the profile must not turn back on the way");
  lathe::Roughing cycle;
  cycle.start = o.from_zx(start);
  cycle.cut = c.mm(b.get('i', 1));
  cycle.retract = c.mm(b.get('r', 0.5));
  cycle.pockets = p.code % 10 == 0   ? lathe::Pockets::all
                  : p.code % 10 == 1 ? lathe::Pockets::none
                                     : lathe::Pockets::only;
  Path way;
  if (!way_beside(c, path, c.mm(b.get('d', 0)), cycle.start, way)) return false;
  CycleTool tool(c, o, nullptr);
  tool.rapid(cycle.start);
  if (!lathe::rough(way, cycle, tool))
    return c.fail('i', "Write a larger I", "G7X error: More than %d moves", lathe::kMostMoves);
  return true;
}

bool check_cycle(Core& c, const Block& b, int code, int& sub) {
  const int g = code / 10, tenth = code % 10;
  if (!b.has('q'))
    return c.fail(0, "Write Q with the number of the sub that has the profile",
                  "G7x.x  requires a Q word");
  if (c.state.plane_code != 180)
    return c.fail(0, "Write G18 before", "G%d.%d can only be used in XZ plane (G18)", g, tenth);
  if (c.state.cutter_comp != 400 && !finishing(code))
    return c.fail(0, "Write G40 before", "G%d.%d cannot be used with cutter compensation enabled",
                  g, tenth);
  if (!c.integer(b, 'q', 0, sub)) return false;
  if (sub < 0) return c.fail('q', "", "Bad format unsigned integer");
  if (b.get('i', 1) <= 0)
    return c.fail('i', "I is the depth of one cut", "G7X error: I must be greater than zero.");
  for (const char word : {'d', 'e', 'r'}) {
    if (b.get(word, 0) < 0)
      return c.fail(word, "", "G7X error: %c must not be negative.", static_cast<char>(word - 32));
  }
  int passes = 1;
  if (!c.integer(b, 'p', 1, passes)) return false;
  if (passes < 1 || passes > kMostFinishingPasses)
    return c.fail('p', "P is the number of passes", "G7X error: P must be between 1 and %d.",
                  kMostFinishingPasses);
  if (b.code_of('m', 4) >= 0)
    return c.fail(0, "Write the M code on a line of its own",
                  "G%d.%d cannot be used with M0, M1, M2, M30 or M60", g, tenth);
  if (c.state.feed_mode == ProgramFeedMode::inverse_time)
    return c.fail(0, "Write G94 before", "F word missing with inverse time g1 move");
  return check_feed(c, b, "g1", "Cannot do g1 with zero feed rate");
}

bool cycle(Core& c, const Block& b, int code) { return c.begin_profile(b, code); }

constexpr CodeRow kRows[] = {
    {'g', 700, 700, 1, kOrderMotion, cycle, letters("qdep"), AxisUse::optional},
    {'g', 710, 712, 1, kOrderMotion, cycle, letters("qdir"), AxisUse::optional},
    {'g', 720, 722, 1, kOrderMotion, cycle, letters("qdir"), AxisUse::optional},
};

}  // namespace

std::span<const CodeRow> lathe_codes() { return kRows; }

bool Core::begin_profile(const Block& b, int code) {
  if (flows.profile != nullptr)
    return fail(0, "", "G7X error: a cycle cannot begin inside a profile");
  int sub = 0;
  if (current == nullptr || !check_cycle(*this, b, code, sub)) return false;
  auto p = std::make_shared<ProfileReading>();
  if (!target(b, p->start)) return false;
  p->code = code;
  p->block = b;
  p->block.source = nullptr;
  p->source.file_id = block_program_;
  p->source.line = current->place.line + 1;
  p->source.sequence = current->sequence;
  p->source.call_level = block_level_;
  p->source.main_line = main_line_;
  p->file = flows.programs[block_program_].path;
  p->text = current->text;
  p->level = flows.frames.size();
  p->at = {p->start.z, p->start.x};
  p->motion = state.motion <= 30 ? state.motion : 10;
  flows.skip.begin_call();
  if (!find_and_enter(*current, flows.labels.number(sub))) return false;
  flows.profile = std::move(p);
  return true;
}

Pose Core::shown_position() const {
  if (flows.profile == nullptr || !flows.profile->steps.empty()) return tool_position();
  Pose at = state.position;
  at.z = flows.profile->at.s;
  at.x = flows.profile->at.h;
  return at;
}

Outcome Core::profile_step() {
  if (!flows.profile->steps.empty()) return next_compensated();
  if (flows.frames.size() <= flows.profile->level) return run_profile();
  ParsedBlock* b = nullptr;
  const LineRead r = read_block(b);
  Outcome o = Outcome::error;
  if (r == LineRead::line) {
    if (b->skip && block_delete) return Outcome::ok;
    begin_block();
    current = b;
    if (b->conditional) b = chosen_part(*b);
    if (b == nullptr) {
      undo_block();
    } else if (b->flow != Flow::none) {
      o = run_flow(*b);
    } else if (read_words(*b, block_) && assign(*b) && store(*b) && profile_move(block_)) {
      o = Outcome::ok;
    } else {
      undo_block();
    }
  } else if (r != LineRead::bad) {
    o = read_problem(r);
  }
  if (o == Outcome::error && flows.profile != nullptr) {
    while (flows.frames.size() > flows.profile->level) leave_sub(false, 0);
    flows.profile.reset();
  }
  return o;
}

bool Core::profile_move(const Block& b) {
  ProfileReading& p = *flows.profile;
  const int code = b.code_of('g', 1);
  if (code >= 0 && code != 0 && code != 10 && code != 20 && code != 30) return true;
  if (code >= 0) p.motion = code;
  if (!b.has('x') && !b.has('z') && !b.has('u') && !b.has('w')) return true;
  for (const auto& [absolute, step] : {std::pair{'x', 'u'}, std::pair{'z', 'w'}}) {
    if (b.has(absolute) && b.has(step))
      return fail(step, "Use either", "G7x error: Cannot use %c and %c in the same block",
                  static_cast<char>(step - 32), static_cast<char>(absolute - 32));
  }
  if (b.has('a') && b.has('c'))
    return fail('c', "A is a fillet, C a chamfer: use either",
                "G7X error: Both A and C parameters on a corner");
  if (p.moves.size() == kMostProfileMoves)
    return fail(0, "Look for a loop without an end", "G7X error: More than %d moves in the profile",
                static_cast<int>(kMostProfileMoves));
  const bool incremental = state.distance == DistanceMode::incremental;
  const double across = state.lathe_diameter ? 0.5 : 1.0;
  Move m;
  m.from = m.to = p.at;
  if (b.has('x')) m.to.h = mm(b['x']) * across + (incremental ? p.at.h : 0);
  if (b.has('u')) m.to.h += mm(b['u']) * across;
  if (b.has('z')) m.to.s = mm(b['z']) + (incremental ? p.at.s : 0);
  if (b.has('w')) m.to.s += mm(b['w']);
  m.chamfer = b.has('c');
  m.corner = std::fabs(mm(b.get(m.chamfer ? 'c' : 'a', 0)));
  m.arc = p.motion >= 20 && !p.moves.empty();  // the first move leads to the profile
  if (m.arc) {
    if (!b.has('i') && !b.has('k') && !b.has('r'))
      return fail(0, "Write the centre (I, K) or the radius (R)",
                  "G7X error: either I or K must be present for arc");
    m.ccw = p.motion == 30;
    if (!arc_center_xz(*this, b, {m.from.s, m.from.h}, {m.to.s, m.to.h}, m.ccw, m.center.s,
                       m.center.h))
      return false;
  }
  p.at = m.to;
  p.moves.push_back(m);
  return true;
}

// The sub is read: the cycle itself, as a block of its line.
Outcome Core::run_profile() {
  const std::shared_ptr<ProfileReading> p = std::exchange(flows.profile, nullptr);
  begin_block();
  current = nullptr;
  state.line = p->source.line;
  Path profile;
  const bool good = rounded_profile(*this, *p, profile) &&
                    (finishing(p->code) ? finish(*this, *p, profile) : rough(*this, *p, profile));
  if (good && !p->steps.empty()) {
    flows.profile = p;
    return next_compensated();
  }
  if (good && compensation.leaving()) compensation.left();
  return finish_cycle(*p, good);
}

// One move of G70 under cutter compensation.
Outcome Core::next_compensated() {
  const std::shared_ptr<ProfileReading> p = flows.profile;
  begin_block();
  current = nullptr;
  state.line = p->source.line;
  const ProfileReading::Step& step = p->steps[p->next++];
  const bool good =
      step.is_arc ? compensation.arc(step.arc) : compensation.straight(step.arc.end, step.traverse);
  if (good) state.position = step.arc.end;
  if (!good || p->next == p->steps.size()) flows.profile.reset();
  return finish_cycle(*p, good);
}

Outcome Core::finish_cycle(const ProfileReading& p, bool good) {
  if (!good) {
    undo_block();
    error.file = p.file;
    error.source = p.text;
    error.line = p.source.line;
    return Outcome::error;
  }
  state.motion = 10;
  SourceLine source = p.source;
  source.file = p.file;
  source.text = p.text;
  if (compensation.busy())
    compensation.finish(source);
  else
    out.deliver(canon, source);
  return block_done();
}

}  // namespace kerf::interp
