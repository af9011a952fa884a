// G33, G33.1, G76: moves that follow the spindle. Manual: "G33 Spindle Synchronized Motion", "G33.1 Rigid Tapping",
// "G76 Threading Cycle".
#include <algorithm>
#include <cmath>
#include <limits>

#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

/// More passes are a typing mistake (a tiny J, a large R) that would fill the memory.
constexpr double kMostPasses = 10000;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// Highest speed of the spindle on the way between two X, by what the program has said so far.
double highest_rpm(const Core& c, int spindle, double x1, double x2) {
  const auto n = static_cast<std::size_t>(spindle);
  const double machine = c.settings.spindle_max_rpm[n];
  const double most = machine > 0 ? machine : std::numeric_limits<double>::infinity();
  if (!c.state.css[n]) return std::min(c.state.speed_rpm[n], most);
  const double surface_mm_min = c.state.speed_rpm[n] * surface_speed_mm(c);
  const double radius = x1 * x2 <= 0 ? 0.0 : std::min(std::fabs(x1), std::fabs(x2));
  const double wanted = radius > 0 ? surface_mm_min / (2 * 180 * kDegree * radius)
                                   : std::numeric_limits<double>::infinity();
  return std::min({wanted, c.state.css_max_rpm[n], most});
}

/// Refuses a move whose pitch and speed ask more of an axis than it can do: it would cut another pitch.
bool check_axis_speed(Core& c, int spindle, const Pose& from, const Pose& to, double mm_per_rev,
                      double factor, const char* code) {
  const Pose d = c.state.frame.to_machine(to) - c.state.frame.to_machine(from);
  double linear = 0, angular = 0;
  feed_length(from, to, linear, angular);
  const double length = std::max(linear, angular);
  if (length <= 0) return true;
  const double rpm = highest_rpm(c, spindle, from.x, to.x) * factor;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const double most = c.settings.axis_max_per_s[i];
    if (most <= 0 || d[i] == 0) continue;
    const double needed = rpm / 60 * std::fabs(mm_per_rev) * std::fabs(d[i]) / length;
    if (needed <= most * (1 + 1e-9)) continue;
    if (rpm > 1e9) {
      return c.fail(0, "Write D with G96, or G97 with the speed of the thread",
                    "%s in G96 at X0 asks for a spindle without a speed limit", code);
    }
    const double unit = rtapi::is_rotary(i) ? 1.0 : c.state.unit_mm();
    return c.fail(0, "Write a lower S (with G96 a lower D), or a smaller pitch",
                  "%s needs %.4f per minute of axis %c at %.1f rpm, more than its limit %.4f", code,
                  needed * 60 / unit, rtapi::kAxisLetters[i], rpm, most * 60 / unit);
  }
  return true;
}

bool turning(const Core& c, int spindle) {
  const auto n = static_cast<std::size_t>(spindle);
  return c.state.direction[n] != SpindleDirection::stopped && c.state.speed_rpm[n] > 0;
}

bool synchronised(Core& c, const Block& b, int code) {
  const bool tap = code == 331;
  const char* name = tap ? "G33.1" : "G33";
  if (b.has('f'))
    return c.fail('f', "K is the feed: the way in one revolution", "F word used with a g33/g33.1");
  if (!b.has('k'))
    return c.fail(0, "Write K with the way in one revolution", "K word missing with g33/g33.1");
  if (b['k'] == 0)
    return c.fail('k', "K is the way in one revolution", "K word must not be 0 with g33/g33.1");
  int spindle = 0;
  if (!one_spindle(c, b,
                   tap ? "Invalid spindle ($) number in G33.1 move"
                       : "Invalid spindle ($) number in G33 move",
                   spindle))
    return false;
  if (!turning(c, spindle))
    return c.fail(0, "Write S and M3 or M4 before", "Spindle not turning in %s", name);
  if (tap && b.has('i') && b['i'] <= 0)
    return c.fail('i', "I multiplies the speed of the way back; 1 is the same speed",
                  "I word must be greater than 0 with g33.1");
  if (tap && (b.mask & letters("abcuvw")) != 0)
    return c.fail(0, "G33.1 moves X, Y and Z", "Cannot move rotary axes or UVW with g33.1");
  Pose end;
  if (!c.target(b, end)) return false;
  const double pitch = c.mm(b['k']);
  const double back = tap ? b.get('i', 1) : 1.0;
  if (!check_axis_speed(c, spindle, c.state.position, end, pitch, std::max(1.0, back), name))
    return false;
  c.out.call<&Canon::start_speed_feed_sync>(spindle, pitch, false);
  if (tap) {
    // The tool comes back to where it started; rotary axes and UVW do not take part.
    c.out.call<&Canon::rigid_tap>(end, back);
  } else {
    c.out.call<&Canon::straight_feed>(end);
    c.state.position = end;
  }
  c.out.call<&Canon::stop_speed_feed_sync>();
  c.state.motion = code;
  return true;
}

/// One G76, in mm. `out` is +1 for internal threads (I > 0), -1 for external ones; `along` is the direction of Z.
struct Thread {
  double start_x, start_z, end_z;  ///< drive line and ends
  double pitch, crest, first_cut, depth, degression, tan_angle, taper;
  double out, along;
  bool entry_taper, exit_taper;
  int spring_passes, spindle;

  [[nodiscard]] double cut(double pass) const { return first_cut * std::pow(pass, 1 / degression); }
  [[nodiscard]] double taper_pitch() const {
    return pitch * std::hypot(taper, depth) / taper;  // the pitch counts along Z
  }
};

struct Pass {
  Core& c;
  const Thread& t;
  double cut;

  void to(bool feed, double x, double z) const {
    c.state.position.x = x;
    c.state.position.z = z;
    if (feed)
      c.out.call<&Canon::straight_feed>(c.state.position);
    else
      c.out.call<&Canon::straight_traverse>(c.state.position);
  }
  void sync(double pitch) const {
    c.out.call<&Canon::start_speed_feed_sync>(t.spindle, pitch, false);
  }
  void run() const;
};

void Pass::run() const {
  const double rest = t.depth - cut;
  const double clear = t.start_x - t.out * rest;
  const double bottom = t.start_x + t.out * (t.crest + cut);
  const double crest = bottom - t.out * t.depth;
  // Each pass begins and ends further along by its depth: the compound slide.
  const double from = t.start_z + t.along * cut * t.tan_angle;
  const double to_z = t.end_z - t.along * rest * t.tan_angle;
  to(false, clear, from);
  if (!t.entry_taper) to(false, bottom, from);
  c.out.call<&Canon::enable_feed_override>(false);
  if (t.entry_taper) {
    sync(t.taper_pitch());
    to(true, crest, from);
    to(true, bottom, from + t.along * t.taper);
  }
  sync(t.pitch);
  if (t.exit_taper) {
    to(true, bottom, to_z - t.along * t.taper);
    sync(t.taper_pitch());
    to(true, crest, to_z);
  } else {
    to(true, bottom, to_z);
  }
  c.out.call<&Canon::stop_speed_feed_sync>();
  to(false, clear, to_z);
  // M49 and M50 P0 of the program stay in force.
  if (c.state.feed_override) c.out.call<&Canon::enable_feed_override>(true);
}

bool thread_words(Core& c, const Block& b, int& ends, int& springs) {
  if (b.has('a') || b.has('b') || b.has('c'))
    return c.fail(0, "Move it before the cycle", "Cannot move rotary axes with G76");
  if (c.state.plane_code != 180)
    return c.fail(0, "Write G18 before", "G76 can only be used in XZ plane (G18)");
  if (!b.has('p'))
    return c.fail(0, "Write P with the pitch of the thread", "P word missing with G76");
  if (!b.has('i') || !b.has('j') || !b.has('k'))
    return c.fail(0, "Write I (thread peak), J (first cut) and K (full depth)",
                  "I J or K words missing with G76");
  for (const char axis : {'x', 'y', 'u', 'v', 'w'}) {
    if (b.has(axis))
      return c.fail(axis, "G76 takes Z only; move there before", "Cannot use %c word with G76",
                    static_cast<char>(axis - 32));
  }
  if (!b.has('z'))
    return c.fail(0, "Write Z with the end of the thread", "Z word missing with G76");
  if (b['i'] == 0)
    return c.fail('i', "Negative for an external thread, positive for an internal one",
                  "In G76, I must not be 0");
  if (b['j'] <= 0)
    return c.fail('j', "J is the depth of the first cut", "In G76, J must be greater than 0");
  if (b['k'] <= b['j'])
    return c.fail('k', "K is the full depth of the thread", "In G76, K must be greater than J");
  if (b['p'] <= 0)
    return c.fail('p', "P is the way in one revolution", "In G76, P must be greater than 0");
  if (b.get('r', 1) < 1)
    return c.fail('r', "R1 keeps the depth of cut, R2 its area",
                  "In G76, R must not be less than 1");
  if (!c.integer(b, 'h', 0, springs)) return false;
  if (springs < 0) return c.fail('h', "H0 is no spring pass", "In G76, H must not be negative");
  if (!c.integer(b, 'l', 0, ends)) return false;
  if (ends < 0)
    return c.fail('l', "L0 no taper, L1 entry, L2 exit, L3 both", "Negative l word used");
  if (ends > 3)
    return c.fail('l', "L0 no taper, L1 entry, L2 exit, L3 both", "In G76, L must be 0, 1, 2 or 3");
  if (ends != 0 && b.get('e', 0) <= 0)
    return c.fail('e', "E is the length of the taper along Z",
                  "In G76, E must be greater than 0 with L");
  if (std::fabs(b.get('q', 0)) >= 89)
    return c.fail('q', "29 to 30 degrees are usual",
                  "In G76, Q must be between -89 and 89 degrees");
  return true;
}

bool check_thread_speed(Core& c, const Thread& t) {
  Pose from = c.state.position, to = from;
  from.x = to.x = t.start_x + t.out * (t.crest + t.depth);
  to.z = t.end_z;
  if (!check_axis_speed(c, t.spindle, from, to, t.pitch, 1, "G76")) return false;
  if (!t.entry_taper && !t.exit_taper) return true;
  to.x = from.x - t.out * t.depth;
  to.z = from.z + t.along * t.taper;
  return check_axis_speed(c, t.spindle, from, to, t.taper_pitch(), 1, "G76");
}

bool thread(Core& c, const Block& b, int code) {
  Thread t{};
  int ends = 0;
  if (!thread_words(c, b, ends, t.spring_passes)) return false;
  if (!one_spindle(c, b, "Invalid D-number in G76 cycle", t.spindle)) return false;
  if (!turning(c, t.spindle))
    return c.fail(0, "Write S and M3 or M4 before", "Chosen spindle (%d) not turning in G76",
                  t.spindle);
  Pose end;
  if (!c.target(b, end)) return false;
  const double across = c.state.lathe_diameter ? 0.5 : 1.0;
  t.start_x = c.state.position.x;
  t.start_z = c.state.position.z;
  t.end_z = end.z;
  t.pitch = c.mm(b['p']);
  t.crest = std::fabs(c.mm(b['i'])) * across;
  t.first_cut = c.mm(b['j']) * across;
  t.depth = c.mm(b['k']) * across;
  t.degression = b.get('r', 1);
  t.tan_angle = std::tan(b.get('q', 0) * kDegree);
  t.taper = c.mm(b.get('e', 0));
  t.out = b['i'] > 0 ? 1 : -1;
  t.along = t.end_z > t.start_z ? 1 : -1;
  t.entry_taper = (ends & 1) != 0;
  t.exit_taper = (ends & 2) != 0;
  if (t.taper > std::fabs(t.end_z - t.start_z) / 2 + 1e-9)
    return c.fail('e', "Write a shorter taper, or a longer thread",
                  "In G76, E must not be greater than half the drive line length");
  if (std::pow(t.depth / t.first_cut, t.degression) + t.spring_passes > kMostPasses)
    return c.fail('j', "Write a larger J, or a smaller R or H", "Too many passes in one G76");
  if (!check_thread_speed(c, t)) return false;
  for (double n = 1; t.cut(n) < t.depth - 1e-9; ++n) Pass{c, t, t.cut(n)}.run();
  for (int i = 0; i <= t.spring_passes; ++i) Pass{c, t, t.depth}.run();
  Pass{c, t, t.depth}.to(false, t.start_x, t.end_z);
  c.state.motion = code;
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 330, 330, 1, kOrderMotion, synchronised, letters("k$"), AxisUse::required},
    {'g', 331, 331, 1, kOrderMotion, synchronised, letters("ki$"), AxisUse::required},
    {'g', 760, 760, 1, kOrderMotion, thread, letters("pijkrqhel$"), AxisUse::required},
};

}  // namespace

std::span<const CodeRow> thread_codes() { return kRows; }

}  // namespace kerf::interp
