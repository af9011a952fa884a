// G73, G74, G81-G89: canned cycles. Manual: "G80-G89 Canned Cycles" and the sections of the codes.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

/// A hole needs no more pecks; more is a typing mistake that would fill the memory.
constexpr double kMostPecks = 20000;
/// LinuxCNC takes a Q or P of exactly this for a missing one, which shows in its messages.
constexpr double kAsMissing = -1.0;

struct PlaneRow {
  std::size_t a1, a2, depth;
  const char* name;        ///< in messages about missing or wrong numbers
  const char* upper_name;  ///< in messages about axes that do not belong
};
constexpr PlaneRow kPlanes[] = {
    {0, 1, 2, "xy", "XY"}, {0, 2, 1, "xz", "XZ"}, {1, 2, 0, "yz", "YZ"},  // G17 G18 G19
    {6, 7, 8, "UV", "UV"}, {6, 8, 7, "UW", "UW"}, {7, 8, 6, "VW", "VW"},  // G17.1 G18.1 G19.1
};
constexpr std::size_t kFirstUvwPlane = 3;

bool is_cycle(int motion) {
  return motion == 730 || motion == 740 || (motion >= 810 && motion <= 890);
}

/// One hole: where and how deep. Depths are numbers of the program (G20: inches), as the pecks count them.
struct Hole {
  Core& c;
  const PlaneRow& plane;
  int code;
  double r, clear, bottom;
  double clearance;  ///< of pecks
  int spindle;

  void place(double level) const { c.state.position[plane.depth] = c.mm(level); }
  void traverse(double level) const {
    place(level);
    c.out.call<&Canon::straight_traverse>(c.state.position);
  }
  void feed(double level) const {
    place(level);
    c.out.call<&Canon::straight_feed>(c.state.position);
  }
  void dwell() const { c.out.call<&Canon::dwell>(c.state.cycle.p); }
  void stop_spindle() const { c.out.call<&Canon::stop_spindle>(spindle); }
  [[nodiscard]] SpindleDirection direction() const {
    return c.state.direction[static_cast<std::size_t>(spindle)];
  }
  void start_spindle(SpindleDirection way) const {
    c.out.call<&Canon::start_spindle>(spindle, way);
  }
};

void drill(const Hole& h) {
  h.feed(h.bottom);
  h.traverse(h.clear);
}

void drill_dwell(const Hole& h) {
  h.feed(h.bottom);
  h.dwell();
  h.traverse(h.clear);
}

void peck_full(const Hole& h) {
  const double q = h.c.state.cycle.q;
  for (double level = h.r - q; level > h.bottom; level -= q) {
    h.feed(level);
    h.traverse(h.r);
    h.traverse(std::min(level + h.clearance, h.r));
  }
  drill(h);
}

void peck_short(const Hole& h) {
  const double q = h.c.state.cycle.q;
  for (double level = h.r - q; level > h.bottom; level -= q) {
    h.feed(level);
    h.traverse(std::min(level + h.clearance, h.r));
  }
  drill(h);
}

/// G74 and G84 with a floating chuck: overrides would break the ratio of feed and speed.
void tap(const Hole& h) {
  ModalState& s = h.c.state;
  const auto n = static_cast<std::size_t>(h.spindle);
  const SpindleDirection way = h.direction();
  h.c.out.call<&Canon::enable_feed_override>(false);
  h.c.out.call<&Canon::enable_speed_override>(h.spindle, false);
  h.feed(h.bottom);
  h.stop_spindle();
  h.start_spindle(way == SpindleDirection::clockwise ? SpindleDirection::counterclockwise
                                                     : SpindleDirection::clockwise);
  h.c.out.call<&Canon::dwell>(std::max(0.0, s.cycle.p));
  h.feed(h.clear);
  h.stop_spindle();
  h.start_spindle(way);
  if (s.feed_override) h.c.out.call<&Canon::enable_feed_override>(true);
  if (s.speed_override[n]) h.c.out.call<&Canon::enable_speed_override>(h.spindle, true);
}

void bore(const Hole& h) {
  h.feed(h.bottom);
  h.feed(h.r);
  h.traverse(h.clear);
}

void bore_stop(const Hole& h) {
  h.feed(h.bottom);
  h.dwell();
  h.stop_spindle();
  h.traverse(h.clear);
  h.start_spindle(h.direction());
}

/// G87: in beside the bore with the tool turned away, up along its back. The manual leaves it open; this is what
/// LinuxCNC does, down to the modes of the orientation.
void back_bore(const Hole& h) {
  Core& c = h.c;
  const CycleState& k = c.state.cycle;
  const std::array<double, 3> ijk{k.i, k.j, k.k};
  Pose& at = c.state.position;
  const double x1 = at[h.plane.a1], x2 = at[h.plane.a2];
  const auto beside = [&](double level) {
    at[h.plane.a1] = x1 + c.mm(ijk[h.plane.a1 % 6]);
    at[h.plane.a2] = x2 + c.mm(ijk[h.plane.a2 % 6]);
    h.traverse(level);
  };
  const auto centre = [&](double level) {
    at[h.plane.a1] = x1;
    at[h.plane.a2] = x2;
    h.traverse(level);
  };
  const auto orient = [&] {
    h.stop_spindle();
    c.out.call<&Canon::orient_spindle>(h.spindle, 0.0,
                                       h.direction() == SpindleDirection::clockwise ? 2 : 3);
  };
  const double up = ijk[h.plane.depth % 6];
  const double back = c.state.distance == DistanceMode::incremental ? h.bottom + up : up;
  beside(h.r);
  orient();
  beside(h.bottom);
  centre(h.bottom);
  h.start_spindle(h.direction());
  h.feed(back);
  h.feed(h.bottom);
  orient();
  beside(h.bottom);
  beside(h.clear);
  centre(h.clear);
  h.start_spindle(h.direction());
}

/// G88: the operator takes the tool out during the stop; the program goes on above the hole.
void bore_manual(const Hole& h) {
  h.feed(h.bottom);
  h.dwell();
  h.stop_spindle();
  h.c.out.call<&Canon::program_stop>();
  h.start_spindle(h.direction());
  h.place(h.clear);
  h.c.ask_sync(SyncReason::program_stop);
}

void bore_dwell(const Hole& h) {
  h.feed(h.bottom);
  h.dwell();
  h.feed(h.clear);
}

/// What must be true of the spindle before the hole.
enum class Spindle : std::uint8_t { any, turning, clockwise, counterclockwise };

struct CycleRow {
  int code;
  void (*make)(const Hole&);
  LetterMask needs;  ///< letters that must be known
  LetterMask takes;  ///< letters besides R, L and those
  Spindle spindle;
  const char* name;  ///< in the message about the spindle
};
constexpr CycleRow kCycles[] = {
    {730, peck_short, letters("q"), letters("d"), Spindle::any, ""},
    {740, tap, 0, letters("p$"), Spindle::counterclockwise, "G74"},
    {810, drill, 0, 0, Spindle::any, ""},
    {820, drill_dwell, letters("p"), 0, Spindle::any, ""},
    {830, peck_full, letters("q"), letters("d"), Spindle::any, ""},
    {840, tap, 0, letters("p$"), Spindle::clockwise, "G84"},
    {850, bore, 0, 0, Spindle::any, ""},
    {860, bore_stop, letters("p"), letters("$"), Spindle::turning, "g86"},
    {870, back_bore, letters("ijk"), 0, Spindle::turning, "g87"},
    {880, bore_manual, letters("p"), 0, Spindle::turning, "g88"},
    {890, bore_dwell, letters("p"), 0, Spindle::any, ""},
};

char upper(char c) { return static_cast<char>(std::toupper(c)); }

/// Takes the block's words into the sticky numbers.
void read_words(Core& c, const Block& b, const CycleRow& row, const PlaneRow& p) {
  CycleState& k = c.state.cycle;
  if (!is_cycle(c.state.motion) || !k.clear_known) k.clear_mm = c.state.position[p.depth];
  k.clear_known = true;
  if (c.state.motion != row.code) {
    k.known = 0;
    k.p = 0;
    k.spindle = 0;
  }
  const auto take = [&](char letter, double& number) {
    if (!b.has(letter)) return;
    number = b[letter];
    k.known |= letters({&letter, 1});
  };
  take('r', k.r);
  take('p', k.p);
  take('q', k.q);
  take('i', k.i);
  take('j', k.j);
  take('k', k.k);
  take('d', k.d);
  if (b.has_axis(p.depth)) {
    k.bottom = b.axis(p.depth);
    if (p.depth == 0 && c.state.lathe_diameter) k.bottom /= 2;
    k.known |= letters("z");
  }
}

bool check_words(Core& c, const Block& b, const CycleRow& row) {
  const CycleState& k = c.state.cycle;
  const int g = row.code / 10;
  const auto missing = [&](char letter) {
    const LetterMask bit = letters({&letter, 1});
    return (row.needs & bit) != 0 && (k.known & bit) == 0;
  };
  for (const char letter : {'i', 'j', 'k'}) {
    if (missing(letter))
      return c.fail(0, "Write I, J and K: where the tool goes beside the bore",
                    "%c word missing with g%d", upper(letter), g);
  }
  if (missing('p') || ((row.needs & letters("p")) != 0 && k.p < 0))
    return c.fail('p', "Write P with the seconds at the bottom, 0 or more",
                  "Dwell time p word missing with g%d", g);
  if ((row.needs & letters("q")) != 0) {
    if (missing('q') || k.q == kAsMissing)
      return c.fail('q', "Write Q with the depth of one peck, greater than 0",
                    "Q word missing with g%d", g);
    if (k.q <= 0) return c.fail('q', "Write Q greater than 0", "Negative or zero q value used");
  }
  if (b.has('d') && k.d < 0)
    return c.fail('d', "D is how far a peck backs off", "Negative d word used");
  return true;
}

bool check_rotary(Core& c, const Block& b) {
  for (const std::size_t axis : {3U, 4U, 5U}) {
    if (!b.has_axis(axis)) continue;
    const char letter = static_cast<char>(std::tolower(rtapi::kAxisLetters[axis]));
    return c.fail(letter, "Turn it before the cycle", "Cannot put %s %c in canned cycle",
                  axis == 3 ? "an" : "a", letter);
  }
  return true;
}

/// Axes of the other family do not move in a cycle.
bool check_axes(Core& c, const Block& b, const PlaneRow& p, bool uvw) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = uvw ? i : 6 + i;
    if (!b.has_axis(axis)) continue;
    const char letter = rtapi::kAxisLetters[axis];
    return c.fail(static_cast<char>(std::tolower(letter)), "Move it before the cycle",
                  "Cannot put %s %c in a canned cycle in the %s plane", axis == 0 ? "an" : "a",
                  letter, p.upper_name);
  }
  return true;
}

bool check_modes(Core& c) {
  if (c.state.feed == 0)
    return c.fail(0, "Write F with a feed, here or before", "Cannot feed with zero feed rate");
  if (c.state.feed_mode == ProgramFeedMode::inverse_time)
    return c.fail(0, "Write G94 before", "Cannot use inverse time feed with canned cycles");
  return true;
}

bool check_spindle(Core& c, const Block& b, const CycleRow& row) {
  if (row.spindle == Spindle::any) return true;
  CycleState& k = c.state.cycle;
  if (b.has('$')) {
    int n = 0;
    if (!c.integer(b, '$', 0, n)) return false;
    if (n < (row.make == tap ? 0 : -1) || n >= c.settings.spindles)
      return c.fail('$', "[TRAJ]SPINDLES says how many spindles there are",
                    "Invalid spindle ($) number in %s cycle",
                    row.make == tap ? "G74/G84" : row.name);
    k.spindle = std::max(n, 0);
  }
  const SpindleDirection way = c.state.direction[static_cast<std::size_t>(k.spindle)];
  if (way == SpindleDirection::stopped)
    return c.fail(0, "Start it with M3 or M4 before", "Spindle not turning in %s", row.name);
  if (row.spindle == Spindle::clockwise && way != SpindleDirection::clockwise)
    return c.fail(0, "Right-hand tapping needs M3", "Spindle turning counterclockwise in %s",
                  row.name);
  if (row.spindle == Spindle::counterclockwise && way != SpindleDirection::counterclockwise)
    return c.fail(0, "Left-hand tapping needs M4", "Spindle turning clockwise in %s", row.name);
  return true;
}

/// All that a cycle block checks before its first hole.
bool check(Core& c, const Block& b, const CycleRow& row, const PlaneRow& p, bool uvw,
           int& repeats) {
  if (!check_rotary(c, b) || !c.integer(b, 'l', 1, repeats)) return false;
  if (repeats < 0) return c.fail('l', "Write L1 or more", "Negative l word used");
  if (!check_modes(c) || !check_axes(c, b, p, uvw)) return false;
  if (repeats == 0) return c.fail('l', "Write L1 or more", "Cannot do zero repeats of cycle");
  read_words(c, b, row, p);
  const CycleState& k = c.state.cycle;
  if ((k.known & letters("r")) == 0)
    return c.fail(0, "Write R with the level where feeding begins",
                  "R clearance plane unspecified in cycle");
  const char depth = rtapi::kAxisLetters[p.depth];
  if ((k.known & letters("z")) == 0)
    return c.fail(0, "Write the depth", "%c value unspecified in %s plane canned cycle", depth,
                  p.name);
  // In G91 the depth counts from R.
  if (c.state.distance == DistanceMode::incremental ? k.bottom > 0 : k.r < k.bottom)
    return c.fail('r', "R lies above the bottom of the hole", "R less than %c in cycle in %s plane",
                  uvw ? depth : static_cast<char>(std::tolower(depth)), p.name);
  return check_words(c, b, row) && check_spindle(c, b, row);
}

double peck_clearance(const Core& c, int code) {
  const CycleState& k = c.state.cycle;
  if ((k.known & letters("d")) != 0) return k.d;
  const double set = code == 730 ? c.settings.g73_clearance_mm : c.settings.g83_clearance_mm;
  if (set > 0) return set / c.state.unit_mm();
  return c.state.units == Units::inch ? 0.050 : 1.0;
}

void announce_exact_path(Core& c, bool on) {
  if (c.state.path == PathMode::exact_path) return;
  if (on) {
    c.out.call<&Canon::set_motion_control_mode>(PathMode::exact_path, 0.0);
    return;
  }
  announce_path_mode(c);
  if (c.state.path == PathMode::exact_stop)
    c.out.call<&Canon::set_naivecam_tolerance>(c.state.naivecam_tolerance_mm);
}

bool cycle(Core& c, const Block& b, int code) {
  const CycleRow& row = *std::find_if(std::begin(kCycles), std::end(kCycles),
                                      [&](const CycleRow& r) { return r.code == code; });
  const auto plane = static_cast<std::size_t>(c.state.plane());
  const PlaneRow& p = kPlanes[plane];
  const bool first = c.repeats.left == 0;
  if (first) {
    int repeats = 1;
    if (!check(c, b, row, p, plane >= kFirstUvwPlane, repeats)) return false;
    c.repeats.left = repeats;
    c.repeats.code = code;
    if (repeats > 1) {
      c.repeats.block = b;
      c.repeats.block.source = nullptr;
    }
  }
  CycleState& k = c.state.cycle;
  const bool incremental = c.state.distance == DistanceMode::incremental;
  const double clear = k.clear_mm / c.state.unit_mm();
  const double r = incremental ? clear + k.r : k.r;
  const double bottom = incremental ? r + k.bottom : k.bottom;
  if ((row.needs & letters("q")) != 0 && (r - bottom) / k.q > kMostPecks)
    return c.fail('q', "Write a larger Q", "Too many pecks in one cycle");
  const bool old_z = c.state.retract == RetractMode::old_z;
  const Hole hole{
      c, p, code, r, old_z ? std::max(clear, r) : r, bottom, peck_clearance(c, code), k.spindle};
  Pose& at = c.state.position;
  // Where the holes go is found before anything moves; the depth word of `end` means nothing here.
  Pose end;
  if (!c.target(b, end)) return false;
  if (first) {
    if (clear < r) hole.traverse(r);
    announce_exact_path(c, true);
  }
  at[p.a1] = end[p.a1] + 0.0;  // X-0 is X0
  at[p.a2] = end[p.a2] + 0.0;
  // At or below R (G99, or an offset that changed) the way to the next hole leads over the clear level.
  const double level = at[p.depth] > c.mm(r) ? at[p.depth] : c.mm(hole.clear);
  at[p.depth] = level;
  c.out.call<&Canon::straight_traverse>(at);
  if (level != c.mm(r)) hole.traverse(r);
  row.make(hole);
  c.state.motion = code;
  if (--c.repeats.left == 0) announce_exact_path(c, false);
  return true;
}

constexpr CodeRow code_row(const CycleRow& r) {
  const auto code = static_cast<std::int16_t>(r.code);
  return {'g',
          code,
          code,
          1,
          kOrderMotion,
          cycle,
          letters("rl") | r.needs | r.takes,
          AxisUse::required};
}
template <std::size_t... I>
constexpr std::array<CodeRow, sizeof...(I)> code_rows(std::index_sequence<I...>) {
  return {code_row(kCycles[I])...};
}
constexpr auto kRows = code_rows(std::make_index_sequence<std::size(kCycles)>());

}  // namespace

std::span<const CodeRow> cycle_codes() { return kRows; }

}  // namespace kerf::interp
