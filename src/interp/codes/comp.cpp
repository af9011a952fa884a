// Cutter radius compensation: G40, G41, G42, G41.1, G42.1, and what it forbids while it is on.
// Manual: "G40", "G41, G42", "G41.1, G42.1", "Cutter Radius Compensation"; refusals: "It is an error if" of each code.
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

bool off(Core& c, const Block&, int) {
  if (!c.compensation.turn_off()) return false;
  c.state.cutter_comp = 400;
  c.comment("interpreter: cutter radius compensation off");
  return true;
}

/// G41, G42: the tool of D, without D or with D0 that in the spindle.
bool tool_of_d(Core& c, const Block& b, int code, Tool& tool) {
  tool = c.spindle_tool;
  if (!b.has('d')) return true;
  double number = 0;
  if (!near_integer(b['d'], number) || number < 0)
    return c.fail('d', "D is a tool number; G41.1 and G42.1 take a diameter",
                  "G%d requires D word to be a whole number", code / 10);
  if (number == 0 && !c.settings.random_toolchanger) return true;
  const auto found = c.env.find_tool(static_cast<int>(std::fmin(number, 1e9)));
  if (!found)
    return c.fail('d', "Add the tool to the tool table, or choose another",
                  "Requested tool %d not found in the tool table",
                  static_cast<int>(std::fmin(number, 1e9)));
  tool = *found;
  return true;
}

bool dynamic(Core& c, const Block& b, int code, double& diameter_mm, int& orientation) {
  if (!b.has('d'))
    return c.fail(0, "D is the diameter of the tool", "G%d.1 with no D word", code / 10);
  diameter_mm = c.mm(b['d']);
  if (!b.has('l')) return true;
  if (c.state.plane_code != 180)
    return c.fail('l', "Write G18 before, or leave L out",
                  "G%d.1 with L word, but plane is not G18", code / 10);
  if (b['l'] < 0) return c.fail('l', "", "Negative l word used");
  if (!c.integer(b, 'l', 0, orientation)) return false;
  return orientation <= 9 || c.fail('l', "Orientations go from 0 to 9", "Invalid tool orientation");
}

/// A negative diameter changes the side; what status shows is the side that the tool is on.
void start(Core& c, bool left, double diameter_mm, int orientation, bool own_tool) {
  if (diameter_mm < 0) left = !left;
  c.state.comp_diameter_mm = std::fabs(diameter_mm);
  c.state.comp_orientation = orientation;
  c.state.comp_own_tool = own_tool;
  c.compensation.turn_on(left, std::fabs(diameter_mm), orientation);
  c.state.cutter_comp = left ? 410 : 420;
  c.comment(left ? "interpreter: cutter radius compensation on left"
                 : "interpreter: cutter radius compensation on right");
}

bool on(Core& c, const Block& b, int code) {
  if (c.state.plane_code != 170 && c.state.plane_code != 180)
    return c.fail(0, "Write G17 or G18 before",
                  "Cutter radius compensation allowed only in XY, XZ planes");
  if (c.state.cutter_comp != 400)
    return c.fail(0, "Write G40 before", "Cannot turn cutter radius comp on when on");
  double diameter_mm = 0;
  int orientation = 0;
  if (code % 10 == 1) {
    if (!dynamic(c, b, code, diameter_mm, orientation)) return false;
  } else {
    Tool tool;
    if (!tool_of_d(c, b, code, tool)) return false;
    diameter_mm = tool.diameter_mm;
    orientation = tool.orientation;
    if (orientation < 0 || orientation > 9)
      return c.fail('d', "Orientations go from 0 to 9", "Invalid tool orientation");
    if (orientation != 0 && c.state.plane_code != 180)
      return c.fail(0, "Write G18 before, or set Q of the tool to 0",
                    "G%d with lathe tool, but plane is not G18", code / 10);
  }
  start(c, code == 410 || code == 411, diameter_mm, orientation,
        b.has('d') && (code % 10 == 1 || b['d'] != 0 || c.settings.random_toolchanger));
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 400, 400, 7, kOrderCutterComp, off, 0, AxisUse::none},
    {'g', 410, 411, 7, kOrderCutterComp, on, letters("dl"), AxisUse::none},
    {'g', 420, 421, 7, kOrderCutterComp, on, letters("dl"), AxisUse::none},
};

/// What a program must not do while compensation is on. Codes that are refused only at times ask by themselves.
struct Refusal {
  char letter;
  std::int16_t first, last;
  const char* text;
};
constexpr const char* kNoAnalogWait =
    "Cannot wait for analog input with cutter radius compensation on";
constexpr const char* kNoOverrides = "Cannot enable overrides with cutter radius compensation on";
constexpr Refusal kRefusals[] = {
    {'g', 280, 280, "Cannot use g28 or g30 with cutter radius comp"},
    {'g', 281, 281, "Cannot set reference point with cutter compensation in effect"},
    {'g', 300, 300, "Cannot use g28 or g30 with cutter radius comp"},
    {'g', 301, 301, "Cannot set reference point with cutter compensation in effect"},
    {'g', 380, 389, "Cannot probe with cutter radius comp on"},
    {'g', 430, 490, "Cannot change tool offset with cutter radius compensation on"},
    {'g', 520, 520, "Cannot change axis offsets with cutter radius comp"},
    {'g', 540, 593, "Cannot change coordinate systems with cutter radius compensation on"},
    {'g', 610, 640, "Cannot change control mode with cutter radius compensation on"},
    {'g', 330, 330, "Cannot use g33 with cutter radius compensation on"},
    {'g', 331, 331, "Cannot use g33.1 with cutter radius compensation on"},
    {'g', 730, 740, "Cannot use canned cycles with cutter compensation on"},
    {'g', 760, 760, "Cannot use G76 threading cycle with cutter radius compensation on"},
    {'g', 810, 890, "Cannot use canned cycles with cutter compensation on"},
    {'g', 920, 923, "Cannot change axis offsets with cutter radius comp"},
    {'g', 980, 990, "Cannot change retract mode with cutter radius compensation on"},
    {'m', 6, 6, "Cannot change tools with cutter radius compensation on"},
    {'m', 48, 48, kNoOverrides},
    {'m', 49, 53, "Cannot disable overrides with cutter radius compensation on"},
    {'m', 62, 62, "Cannot set motion output with cutter radius compensation on"},
    {'m', 63, 63, "Cannot set motion digital output with cutter radius compensation on"},
    {'m', 64, 65, "Cannot set auxiliary digital output with cutter radius compensation on"},
    {'m', 66, 66, "Cannot wait for digital input with cutter radius compensation on"},
    {'m', 67, 67, "Cannot set motion analog output with cutter radius compensation on"},
    {'m', 68, 68, "Cannot set auxiliary analog output with cutter radius compensation on"},
};

}  // namespace

bool refused_by_compensation(Core& c, const Block& b, char letter, int code) {
  for (const Refusal& r : kRefusals) {
    if (r.letter != letter || code < r.first || code > r.last) continue;
    const char* text = r.text;
    if (letter == 'm' && code == 66 && b.has('e')) text = kNoAnalogWait;
    if (letter == 'm' && code >= 50 && code <= 53 && b.get('p', 1) != 0) text = kNoOverrides;
    c.fail(0, "Write G40 before", "%s", text);
    return true;
  }
  return false;
}

bool restore_compensation(Core& c, const ModalState& was) {
  const bool left = was.cutter_comp == 410;
  if (was.comp_own_tool) {
    start(c, left, was.comp_diameter_mm, was.comp_orientation, true);
  } else {
    const bool xz = c.state.plane_code == 180;
    start(c, left, std::fabs(c.spindle_tool.diameter_mm), xz ? c.spindle_tool.orientation : 0,
          false);
  }
  return true;
}

bool stop_compensation(Core& c) { return off(c, {}, 400); }

std::span<const CodeRow> comp_codes() { return kRows; }

}  // namespace kerf::interp
