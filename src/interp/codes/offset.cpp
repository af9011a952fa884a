// Work offsets and reference points: G10, G28, G30, G52, G54-G59.3, G92.
// Manual: "G10", "G28", "G30", "G52", "G54-G59.3", "G92", "Coordinate Systems".
#include <algorithm>
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

int base_of(int system) { return kG5xOffset + 20 * (system - 1); }

void announce_system(Core& c, bool with_g92) {
  c.out.call<&Canon::set_g5x_offset>(c.state.coord_system, c.state.frame.g5x());
  if (with_g92) c.out.call<&Canon::set_g92_offset>(c.state.frame.g92());
  c.out.call<&Canon::set_xy_rotation>(c.state.frame.rotation_deg());
}

/// The offsets of a system as the parameters have them; G92 and tool offset stay.
CanonFrame frame_of(const Core& c, int system) {
  CanonFrame f = c.state.frame;
  f.set_g5x_offset(c.params.pose(base_of(system), c.settings.machine_unit_mm));
  f.set_xy_rotation(c.params.get(base_of(system) + 9));
  return f;
}

bool coord_system(Core& c, const Block&, int code) {
  const int system = code <= 590 ? code / 10 - 53 : code - 590 + 6;
  // A system that is on already stays as it is, parameters written by hand included.
  if (system == c.state.coord_system) {
    c.comment("interpreter: continuing to use same coordinate system");
    return true;
  }
  c.state.coord_system = system;
  c.params.set(kCoordSystem, system);
  c.set_frame(frame_of(c, system));
  announce_system(c, true);
  return true;
}

void store_system(Core& c, int system, const Pose& g5x) {
  c.params.set_pose(base_of(system), g5x, c.settings.machine_unit_mm);
  if (system == c.state.coord_system) {
    c.set_frame(frame_of(c, system));
    announce_system(c, false);
  } else {
    c.comment("interpreter: setting coordinate system origin");
  }
}

/// P of G10; `absent` without it.
bool g10_number(Core& c, const Block& b, int absent, int& number) {
  double rounded = absent;
  if (b.has('p') && !near_integer(b['p'], rounded))
    return c.fail('p', "P is a whole number", "P value not an integer with G10");
  number = static_cast<int>(std::clamp(rounded, -1e9, 1e9));
  return true;
}

bool g10_system_word(Core& c, const Block& b, int l, int& system) {
  if (b.has('i') || b.has('j'))
    return c.fail(b.has('i') ? 'i' : 'j', "Tool angles belong to G10 L1",
                  "I J words not allowed with G10 L2");
  if (!g10_number(c, b, -1, system)) return false;
  if (system < 0 || system > 9)
    return c.fail('p', "P0 is the active system, P1 is G54, P9 is G59.3",
                  "P value out of range (0-9) with G10 L%d", l);
  if (system == 0) system = c.state.coord_system;
  if (c.state.cutter_comp != 400 && system == c.state.coord_system)
    return c.fail(0, "Write G40 before",
                  "Cannot change the active coordinate system with cutter radius compensation on");
  return true;
}

bool g10_l2(Core& c, const Block& b) {
  int system = 0;
  if (!g10_system_word(c, b, 2, system)) return false;
  Pose g5x = c.params.pose(base_of(system), c.settings.machine_unit_mm);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (b.has_axis(i)) g5x[i] = c.axis_word(b, i);
  }
  if (b.has('r')) c.params.set(base_of(system) + 9, b['r']);
  store_system(c, system, g5x);
  return true;
}

// The named axes shall read the given values where the machine stands, seen from that system.
bool g10_l20(Core& c, const Block& b) {
  int system = 0;
  if (b.has('r')) return c.fail('r', "Use G10 L2 for the rotation", "R not allowed in G10 L20");
  if (!g10_system_word(c, b, 20, system)) return false;
  CanonFrame f = frame_of(c, system);
  const Pose machine = c.state.frame.to_machine(c.tool_position());
  Pose wanted = f.to_program(machine);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (b.has_axis(i)) wanted[i] = c.axis_word(b, i);
  }
  const Pose g5x = f.g5x() + machine - f.to_machine(wanted);
  store_system(c, system, g5x);
  return true;
}

/// G10 L1 sets tool offsets, L10 and L11 measure them: the named axes shall read the given values with the tool's
/// offset on, in the active system (L10) or in G59.3 (L11).
bool g10_tool(Core& c, const Block& b, int l) {
  int number = 0;
  if (!g10_number(c, b, -1, number)) return false;
  if (number < 1)
    return c.fail('p', "P is the tool number", "P value out of range with G10 L%d", l);
  const auto found = c.find_tool(number);
  if (!found)
    return c.fail('p', "Add the tool to the tool table, or choose another",
                  "Requested tool %d not found in the tool table", number);
  bool axes = false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) axes = axes || b.has_axis(i);
  if (!axes && !b.has('r') && !b.has('i') && !b.has('j') && !b.has('q'))
    return c.fail('l', "Write the axis words, R, I, J or Q to set",
                  "G10 L1 without offsets has no effect");
  Tool t = *found;
  double q = t.orientation;
  if (b.has('q') && !near_integer(b['q'], q))
    return c.fail('q', "Orientations go from 0 to 9", "Q number in G10 is not an integer");
  const int orientation = static_cast<int>(std::clamp(q, -1.0, 10.0));
  if (orientation < 0 || orientation > 9)
    return c.fail('q', "Orientations go from 0 to 9", "Invalid tool orientation");
  t.orientation = orientation;
  if (b.has('r')) t.diameter_mm = 2 * c.mm(b['r']);
  if (b.has('i')) t.front_angle_deg = b['i'];
  if (b.has('j')) t.back_angle_deg = b['j'];
  if (l == 1) {
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (b.has_axis(i)) t.offset[i] = c.axis_word(b, i);
    }
  } else {
    CanonFrame f = c.state.frame;
    if (l == 11) f = frame_of(c, 9), f.set_g92_offset({});
    const Pose machine = c.state.frame.to_machine(c.tool_position());
    // What is not named reads on as with the present row.
    f.use_tool_length_offset(t.offset);
    Pose wanted = f.to_program(machine);
    f.use_tool_length_offset({});
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (b.has_axis(i)) wanted[i] = c.axis_word(b, i);
    }
    const Pose offset = machine - f.to_machine(wanted);
    // In a turned system a value of X or Y takes both axes of the machine.
    const bool turned = f.rotation_deg() != 0 && (b.has_axis(0) || b.has_axis(1));
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (b.has_axis(i) || (turned && i < 2)) t.offset[i] = offset[i];
    }
  }
  c.out.call<&Canon::set_tool_table_entry>(t);
  c.tool_changes.push_back(t);
  if (c.spindle_tool.number == t.number) {
    const int pocket = c.spindle_tool.pocket;
    c.spindle_tool = t;
    c.spindle_tool.pocket = pocket;
  }
  return true;
}

bool g10(Core& c, const Block& b, int) {
  int l = 0;
  if (!c.integer(b, 'l', -1, l)) return false;
  switch (l) {
    case 0:
      c.out.call<&Canon::reload_tooldata>();
      c.changed_tools.clear();
      return true;
    case 1:
    case 10:
    case 11: return g10_tool(c, b, l);
    case 2: return g10_l2(c, b);
    case 20: return g10_l20(c, b);
    default: return c.fail('l', "", "Line with G10 does not have L0, L1, L10, L11, L2, or L20");
  }
}

// By way of the point of the axis words; the axes named there (all without words) then go to the stored position.
bool go_reference(Core& c, const Block& b, int code) {
  c.machine_place = true;
  Pose between;
  if (!c.target(b, between)) return false;
  const Pose home = c.state.frame.to_program(
      c.params.pose(code == 280 ? kG28Home : kG30Home, c.settings.machine_unit_mm));
  Pose end = b.has_axes() ? between : home;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (b.has_axis(i)) end[i] = home[i];
    if ((c.settings.axis_mask >> i & 1U) == 0) end[i] = c.state.position[i];
  }
  Pose at = c.state.position;
  for (const Pose& to : {between, end}) {
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if ((c.settings.indexer_mask >> i & 1U) == 0 || at[i] == to[i]) continue;
      at[i] = to[i];
      index_traverse(c, at);
    }
    c.out.call<&Canon::straight_traverse>(to);
    at = to;
  }
  c.state.position = end;
  return true;
}

bool store_reference(Core& c, const Block&, int code) {
  c.machine_place = true;
  c.params.set_pose(code == 281 ? kG28Home : kG30Home, c.machine_position(),
                    c.settings.machine_unit_mm);
  return true;
}

void apply_g92(Core& c, const Pose& offset, bool applied) {
  CanonFrame f = c.state.frame;
  f.set_g92_offset(offset);
  c.set_frame(f);
  c.state.g92_applied = applied;
  c.params.set(kG92Applied, applied ? 1 : 0);
  c.out.call<&Canon::set_g92_offset>(offset);
}

bool g92(Core& c, const Block& b, int code) {
  const double unit = c.settings.machine_unit_mm;
  if (code == 922) {
    apply_g92(c, {}, false);
    return true;
  }
  if (code == 923) {
    apply_g92(c, c.params.pose(kG92Offset, unit), true);
    return true;
  }
  if (code == 921) {
    apply_g92(c, {}, false);
    c.params.set_pose(kG92Offset, {}, unit);
    return true;
  }
  if (!b.has_axes())
    return c.fail(0, "Write the values that the axes shall have, e.g. X0",
                  "All axes missing with g52 or g92");
  Pose offset = c.state.frame.g92();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!b.has_axis(i)) continue;
    const double v = c.axis_word(b, i);
    offset[i] = code == 520 ? v : offset[i] + c.state.position[i] - v;
  }
  apply_g92(c, offset, true);
  c.params.set_pose(kG92Offset, offset, unit);
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 100, 100, 0, kOrderReference, g10, letters("lprqij"), AxisUse::optional},
    {'g', 280, 280, 0, kOrderReference, go_reference, 0, AxisUse::optional},
    {'g', 281, 281, 0, kOrderReference, store_reference, 0, AxisUse::none},
    {'g', 300, 300, 0, kOrderReference, go_reference, 0, AxisUse::optional},
    {'g', 301, 301, 0, kOrderReference, store_reference, 0, AxisUse::none},
    {'g', 520, 520, 0, kOrderReference, g92, 0, AxisUse::required},
    {'g', 540, 540, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 550, 550, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 560, 560, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 570, 570, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 580, 580, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 590, 593, 12, kOrderCoordSystem, coord_system, 0, AxisUse::none},
    {'g', 920, 920, 0, kOrderReference, g92, 0, AxisUse::required},
    {'g', 921, 923, 0, kOrderReference, g92, 0, AxisUse::none},
};

}  // namespace

std::span<const CodeRow> offset_codes() { return kRows; }

}  // namespace kerf::interp
