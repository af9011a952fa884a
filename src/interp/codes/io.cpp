// Coolant, overrides, inputs and outputs: M7-M9, M48-M53, M62-M68. Manual: the sections of these names.
#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

bool coolant(Core& c, const Block&, int code) {
  if (code == 7) c.out.call<&Canon::set_mist>(c.state.mist = true);
  if (code == 8) c.out.call<&Canon::set_flood>(c.state.flood = true);
  if (code == 9) {
    c.out.call<&Canon::set_mist>(c.state.mist = false);
    c.out.call<&Canon::set_flood>(c.state.flood = false);
  }
  return true;
}

void feed_override(Core& c, bool on) {
  c.state.feed_override = on;
  c.out.call<&Canon::enable_feed_override>(on);
}

bool speed_override(Core& c, const Block& b, int otherwise, const char* command, bool on) {
  int first = 0, last = 0, number = 0;
  if (!c.integer(b, '$', otherwise, number)) return false;
  if (number < -1 || number >= c.settings.spindles)
    return c.fail('$', "[TRAJ]SPINDLES says how many spindles there are",
                  "Invalid spindle ($) number in %s command", command);
  if (!spindle_range(c, b, otherwise, command, first, last)) return false;
  for (int i = first; i <= last; ++i) {
    c.state.speed_override[static_cast<std::size_t>(i)] = on;
    c.out.call<&Canon::enable_speed_override>(i, on);
  }
  return true;
}

/// M48 and M49 without $ are for every spindle, M51 for spindle 0.
bool overrides(Core& c, const Block& b, int code) {
  const bool on = code == 48 || (code > 49 && (!b.has('p') || b['p'] != 0));
  switch (code) {
    case 48:
    case 49: feed_override(c, on); return speed_override(c, b, -1, code == 48 ? "M48" : "M49", on);
    case 50: feed_override(c, on); return true;
    case 51: return speed_override(c, b, 0, "M51", on);
    case 52:
      c.state.adaptive_feed = on;
      c.out.call<&Canon::enable_adaptive_feed>(on);
      return true;
    default:
      c.state.feed_hold = on;
      c.out.call<&Canon::enable_feed_hold>(on);
      return true;
  }
}

bool digital_output(Core& c, const Block& b, int code) {
  int index = 0;
  if (!c.integer(b, 'p', -1, index)) return false;
  if (index < 0)
    return c.fail('p', "P is the number of the output", "No valid P word with M%d", code);
  const bool on = code == 62 || code == 64;
  if (code <= 63)
    c.out.call<&Canon::set_motion_output_bit>(index, on);
  else
    c.out.call<&Canon::set_aux_output_bit>(index, on);
  return true;
}

bool analog_output(Core& c, const Block& b, int code) {
  int index = 0;
  if (!c.integer(b, 'e', -1, index)) return false;
  if (index < 0)
    return c.fail('e', "E is the number of the output", "Invalid analog index with M%d", code);
  if (!b.has('q')) return c.fail(0, "Q is the value", "Q word missing with M%d", code);
  if (code == 67)
    c.out.call<&Canon::set_motion_output_value>(index, b['q']);
  else
    c.out.call<&Canon::set_aux_output_value>(index, b['q']);
  return true;
}

bool wait_input(Core& c, const Block& b, int) {
  int p = 0, e = 0, l = 0;
  if (!c.integer(b, 'p', -1, p) || !c.integer(b, 'e', -1, e) || !c.integer(b, 'l', 0, l))
    return false;
  if (b.has('p') && b.has('e'))
    return c.fail('e', "Use either",
                  "Invalid to select both a digital and an analog input with M66");
  const bool analog = b.has('e');
  if (p < 0 && e < 0)
    return c.fail(b.has('p') ? 'p' : 'e', "P is a digital, E an analog input",
                  "Need to have either a valid P or a valid E word with M66");
  if (l < 0 || l > 4)
    return c.fail('l', "L goes from 0 to 4", "Invalid wait mode (L word) with M66");
  const double timeout = l != 0 ? b.get('q', 0) : 0;  // Q means nothing to L0
  if (l != 0 && timeout <= 0)
    return c.fail(b.has('q') ? 'q' : 'l', "Write Q with the longest wait in seconds",
                  "Zero timeout with wait type != immediate return");
  if (analog && l != 0)
    return c.fail('l', "Only L0 works with E",
                  "Can't select analog input with wait type != immediate return");
  c.out.call<&Canon::wait_input>(analog ? e : p, analog, static_cast<WaitMode>(l), timeout);
  c.ask_sync(SyncReason::wait_input);
  return true;
}

constexpr CodeRow kRows[] = {
    {'m', 7, 9, 8, kOrderCoolant, coolant, 0, AxisUse::none},
    {'m', 48, 49, 9, kOrderOverride, overrides, letters("$"), AxisUse::none},
    {'m', 50, 50, 9, kOrderOverride, overrides, letters("p"), AxisUse::none},
    {'m', 51, 51, 9, kOrderOverride, overrides, letters("p$"), AxisUse::none},
    {'m', 52, 53, 9, kOrderOverride, overrides, letters("p"), AxisUse::none},
    {'m', 62, 65, 5, kOrderIo, digital_output, letters("p"), AxisUse::none},
    {'m', 66, 66, 5, kOrderIo, wait_input, letters("pelq"), AxisUse::none},
    {'m', 67, 68, 5, kOrderIo, analog_output, letters("eq"), AxisUse::none},
};

}  // namespace

std::span<const CodeRow> io_codes() { return kRows; }

}  // namespace kerf::interp
