// Spindles: G96 G97, M3 M4 M5, M19. Manual: "G96, G97", "M3, M4, M5", "M19 Orient Spindle".
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

bool spindle_range(Core& c, const Block& b, int otherwise, const char* command, int& first,
                   int& last) {
  int n = 0;
  if (b.has('$') && !c.compat.spindle_word)
    return c.fail('$', "[RS274NGC]COMPAT = 2.7 knows one spindle", "Bad character '$' used");
  if (!c.integer(b, '$', otherwise, n)) return false;
  if (n < -1 || n >= c.settings.spindles) {
    return c.fail('$', "[TRAJ]SPINDLES says how many spindles there are",
                  "Spindle ($) number out of range in %s Command\nnum_spindles =%d. $=%d", command,
                  c.settings.spindles, n);
  }
  first = n < 0 ? 0 : n;
  last = n < 0 ? c.settings.spindles - 1 : n;
  return true;
}

bool one_spindle(Core& c, const Block& b, const char* error, int& spindle) {
  if (b.has('$') && !c.compat.spindle_word)
    return c.fail('$', "[RS274NGC]COMPAT = 2.7 knows one spindle", "Bad character '$' used");
  if (!c.integer(b, '$', 0, spindle)) return false;
  if (spindle >= 0 && spindle < c.settings.spindles) return true;
  return c.fail('$',
                spindle == -1 ? "All spindles at once are possible with M3, M4, M5, M51 and S only"
                              : "[TRAJ]SPINDLES says how many spindles there are",
                "%s", error);
}

double surface_speed_mm(const Core& c) { return c.state.units == Units::inch ? 304.8 : 1000.0; }

void announce_speed(Core& c, int spindle) {
  const auto n = static_cast<std::size_t>(spindle);
  const double factor = c.state.css[n] ? surface_speed_mm(c) : 1.0;
  c.out.call<&Canon::set_spindle_speed>(spindle, c.state.speed_rpm[n] * factor);
}

namespace {

bool turn(Core& c, const Block& b, int code) {
  int first = 0, last = 0;
  if (!spindle_range(c, b, c.compat.absent_spindle,
                     code == 3   ? "M3"
                     : code == 4 ? "M4"
                                 : "M5",
                     first, last))
    return false;
  for (int i = first; i <= last; ++i) {
    const auto n = static_cast<std::size_t>(i);
    c.state.orienting[n] = false;
    c.state.direction[n] = code == 3   ? SpindleDirection::clockwise
                           : code == 4 ? SpindleDirection::counterclockwise
                                       : SpindleDirection::stopped;
    if (code == 5)
      c.out.call<&Canon::stop_spindle>(i);
    else
      c.out.call<&Canon::start_spindle>(i, c.state.direction[n]);
  }
  return true;
}

bool orient(Core& c, const Block& b, int) {
  int spindle = 0;
  if (!one_spindle(c, b, "Spindle ($) number out of range in M19 Command", spindle)) return false;
  const double angle = b.get('r', 0);
  if (angle < 0 || angle > 360) return c.fail('r', "", "R value must be within 0..360 with M19");
  double mode = 0;
  if (b.has('p') && !near_integer(b['p'], mode))
    return c.fail('p', "P0 the shorter way, P1 clockwise, P2 counter-clockwise",
                  "P value not an integer with M19 G2 or G3");
  if (mode < 0 || mode > 2) return c.fail('p', "", "P value must be 0,1,or 2 with M19");
  if (b.has('q') && b['q'] <= 0)
    return c.fail('q', "Q is the longest wait in seconds", "Q word with M19 requires a value > 0");
  if (b.has('r') || b.has('p')) {
    const auto n = static_cast<std::size_t>(spindle);
    c.state.orienting[n] = true;
    c.state.direction[n] = SpindleDirection::stopped;
    c.out.call<&Canon::orient_spindle>(spindle, angle + c.settings.orient_offset_deg,
                                       static_cast<int>(mode));
  }
  if (b.has('q')) c.out.call<&Canon::wait_orient_complete>(spindle, b['q']);
  return true;
}

bool speed_mode(Core& c, const Block& b, int code) {
  int spindle = 0;
  if (!one_spindle(c, b, "Invalid spindle ($) number in Spindle Mode command", spindle))
    return false;
  if (code == 960 && !b.has('s'))
    return c.fail(0, "Write S with the surface speed", "S word missing with G96");
  if (b.has('d') && b['d'] <= 0)
    return c.fail('d', "D is the highest speed in rpm", "D word must be greater than 0 with G96");
  const auto n = static_cast<std::size_t>(spindle);
  c.state.css[n] = code == 960;
  c.state.css_max_rpm[n] = code == 960 ? b.get('d', 1e30) : 0;
  c.out.call<&Canon::set_spindle_mode>(spindle, c.state.css_max_rpm[n]);
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 960, 960, 14, kOrderSpindleMode, speed_mode, letters("d$"), AxisUse::none},
    {'g', 970, 970, 14, kOrderSpindleMode, speed_mode, letters("$"), AxisUse::none},
    {'m', 3, 5, 7, kOrderSpindle, turn, letters("$"), AxisUse::none},
    {'m', 19, 19, 7, kOrderSpindle, orient, letters("rqp$"), AxisUse::none},
};

}  // namespace

std::span<const CodeRow> spindle_codes() { return kRows; }

}  // namespace kerf::interp
