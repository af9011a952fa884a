// G73, G81, G82, G83, G85, G89: canned cycles. Manual: "Canned Cycles".
#include <algorithm>
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

/// A hole needs no more pecks; more is a typing mistake that would fill the memory.
constexpr double kMostPecks = 20000;

struct PlaneRow {
  std::size_t a1, a2, depth;
  const char* name;
};
constexpr PlaneRow kPlanes[] = {{0, 1, 2, "xy"}, {0, 2, 1, "xz"}, {1, 2, 0, "yz"}};

bool is_cycle(int motion) { return motion == 730 || (motion >= 810 && motion <= 890); }

/// One hole: where, and how deep, all in mm of program coordinates along the depth axis.
struct Hole {
  Core& c;
  std::size_t depth;
  double r, clear, bottom, dwell, peck, clearance;

  void traverse(double level) const {
    c.state.position[depth] = level;
    c.out.call<&Canon::straight_traverse>(c.state.position);
  }
  void feed(double level) const {
    c.state.position[depth] = level;
    c.out.call<&Canon::straight_feed>(c.state.position);
  }
};

void drill(const Hole& h) {
  h.feed(h.bottom);
  h.traverse(h.clear);
}

void drill_dwell(const Hole& h) {
  h.feed(h.bottom);
  h.c.out.call<&Canon::dwell>(h.dwell);
  h.traverse(h.clear);
}

void peck_full(const Hole& h) {
  for (double level = h.r - h.peck; level > h.bottom; level -= h.peck) {
    h.feed(level);
    h.traverse(h.r);
    h.traverse(std::min(level + h.clearance, h.r));
  }
  h.feed(h.bottom);
  h.traverse(h.clear);
}

void peck_short(const Hole& h) {
  for (double level = h.r - h.peck; level > h.bottom; level -= h.peck) {
    h.feed(level);
    h.traverse(std::min(level + h.clearance, h.r));
  }
  h.feed(h.bottom);
  h.traverse(h.clear);
}

void bore(const Hole& h) {
  h.feed(h.bottom);
  h.feed(h.r);
  h.traverse(h.clear);
}

void bore_dwell(const Hole& h) {
  h.feed(h.bottom);
  h.c.out.call<&Canon::dwell>(h.dwell);
  h.feed(h.clear);
}

struct CycleRow {
  int code;
  void (*make)(const Hole&);
  bool p, q;
};
constexpr CycleRow kCycles[] = {
    {730, peck_short, false, true}, {810, drill, false, false}, {820, drill_dwell, true, false},
    {830, peck_full, false, true},  {850, bore, false, false},  {890, bore_dwell, true, false},
};

/// Takes the block's words into the sticky values and checks them.
bool read_words(Core& c, const Block& b, const CycleRow& row, const PlaneRow& p) {
  CycleState& k = c.state.cycle;
  if (!is_cycle(c.state.motion)) k.clear = c.state.position[p.depth];
  if (c.state.motion != row.code) k.r_known = k.bottom_known = k.p_known = k.q_known = false;
  if (b.has('r')) k.r = c.mm(b['r']), k.r_known = true;
  if (b.has_axis(p.depth)) k.bottom = c.mm(b.axis(p.depth)), k.bottom_known = true;
  if (b.has('p')) k.p = b['p'], k.p_known = true;
  if (b.has('q')) k.q = c.mm(b['q']), k.q_known = true;
  const int g = row.code / 10;
  if (!k.r_known)
    return c.fail(0, "Write R with the level where feeding begins",
                  "R clearance plane unspecified in cycle");
  if (!k.bottom_known)
    return c.fail(0, "Write the depth", "%c value unspecified in %s plane canned cycle",
                  rtapi::kAxisLetters[p.depth], p.name);
  if (row.p && !k.p_known)
    return c.fail(0, "Write P with the seconds at the bottom", "Dwell time p word missing with g%d",
                  g);
  if (row.p && k.p < 0) return c.fail('p', "", "Dwell time p word missing with g%d", g);
  if (row.q && !k.q_known)
    return c.fail(0, "Write Q with the depth of one peck", "Q word missing with g%d", g);
  if (row.q && k.q <= 0)
    return c.fail('q', "Write Q greater than 0", "Negative or zero q value used");
  return true;
}

bool check_modes(Core& c, const Block& b) {
  if (c.state.feed == 0)
    return c.fail(0, "Write F with a feed, here or before", "Cannot feed with zero feed rate");
  if (c.state.feed_mode == ProgramFeedMode::inverse_time)
    return c.fail(0, "Write G94 before", "Cannot use inverse time feed with canned cycles");
  if (c.state.cutter_comp != 400)
    return c.fail(0, "Write G40 before", "Cannot use canned cycles with cutter compensation on");
  for (const std::size_t rotary : {3U, 4U, 5U, 6U, 7U, 8U}) {
    if (b.has_axis(rotary))
      return c.fail(0, "Move it before the cycle", "Cannot put %s in canned cycle",
                    rotary == 3   ? "an a"
                    : rotary == 4 ? "a b"
                    : rotary == 5 ? "a c"
                    : rotary == 6 ? "a u"
                    : rotary == 7 ? "a v"
                                  : "a w");
  }
  return true;
}

bool cycle(Core& c, const Block& b, int code) {
  const CycleRow* row = nullptr;
  for (const CycleRow& r : kCycles) {
    if (r.code == code) row = &r;
  }
  if (row == nullptr) return c.fail(0, "", "Unknown g code used");
  const PlaneRow& p = kPlanes[static_cast<std::size_t>(c.state.plane())];
  const bool first = c.repeats.left == 0;
  int repeats = 1;
  if (first) {
    if (!check_modes(c, b) || !c.integer(b, 'l', 1, repeats)) return false;
    if (repeats == 0) return c.fail('l', "Write L1 or more", "Cannot do zero repeats of cycle");
    if (repeats < 0) return c.fail('l', "Write L1 or more", "Negative l word used");
    if (!read_words(c, b, *row, p)) return false;
    c.repeats.left = repeats;
    c.repeats.code = code;
    if (repeats > 1) {
      c.repeats.block = b;
      c.repeats.block.source = nullptr;
    }
  }
  CycleState& k = c.state.cycle;
  const bool incremental = c.state.distance == DistanceMode::incremental;
  const double r = incremental ? k.clear + k.r : k.r;
  const double bottom = incremental ? r + k.bottom : k.bottom;
  if (r < bottom)
    return c.fail('r', "R lies above the bottom of the hole", "R less than %c in cycle in %s plane",
                  static_cast<char>(rtapi::kAxisLetters[p.depth] + 32), p.name);
  if (row->q && (r - bottom) / k.q > kMostPecks)
    return c.fail('q', "Write a larger Q", "Too many pecks in one cycle");
  const bool old_z = c.state.retract == RetractMode::old_z;
  const bool inch = c.state.units == Units::inch;
  const double set = code == 730 ? c.settings.g73_clearance_mm : c.settings.g83_clearance_mm;
  const Hole hole{c,      p.depth, r,   old_z ? std::max(k.clear, r) : r,
                  bottom, k.p,     k.q, set > 0 ? set : inch ? 0.050 * 25.4 : 1.0};
  Pose& at = c.state.position;
  if (first) {
    if (at[p.depth] < r) hole.traverse(r);
    if (c.state.path != PathMode::exact_path)
      c.out.call<&Canon::set_motion_control_mode>(PathMode::exact_path, 0.0);
  }
  for (const std::size_t axis : {p.a1, p.a2}) {
    if (b.has_axis(axis)) at[axis] = (incremental ? at[axis] : 0.0) + c.mm(b.axis(axis));
  }
  const double level = std::max(at[p.depth], hole.clear);
  hole.traverse(level);
  if (level != r) hole.traverse(r);
  row->make(hole);
  c.state.motion = code;
  if (--c.repeats.left == 0 && c.state.path != PathMode::exact_path) {
    announce_path_mode(c);
    if (c.state.path == PathMode::exact_stop)
      c.out.call<&Canon::set_naivecam_tolerance>(c.state.naivecam_tolerance_mm);
  }
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 730, 730, 1, kOrderMotion, cycle, letters("rlq"), AxisUse::required},
    {'g', 810, 810, 1, kOrderMotion, cycle, letters("rl"), AxisUse::required},
    {'g', 820, 820, 1, kOrderMotion, cycle, letters("rlp"), AxisUse::required},
    {'g', 830, 830, 1, kOrderMotion, cycle, letters("rlq"), AxisUse::required},
    {'g', 850, 850, 1, kOrderMotion, cycle, letters("rl"), AxisUse::required},
    {'g', 890, 890, 1, kOrderMotion, cycle, letters("rlp"), AxisUse::required},
};

}  // namespace

std::span<const CodeRow> cycle_codes() { return kRows; }

}  // namespace kerf::interp
