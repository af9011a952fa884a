// Tools: G40, G43 G43.1 G43.2 G49, M6, M61. Manual: the sections of these names.
#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

void apply_offset(Core& c, const Pose& offset, int code) {
  CanonFrame f = c.state.frame;
  f.use_tool_length_offset(offset);
  c.set_frame(f);
  c.state.tool_offset_code = code;
  c.out.call<&Canon::use_tool_length_offset>(offset);
}

/// Length offset of tool H; without H that of the tool in the spindle.
bool offset_of_h(Core& c, const Block& b, Pose& offset) {
  int h = -1;
  if (!c.integer(b, 'h', -1, h)) return false;
  if (!b.has('h')) {
    offset = c.spindle_tool.offset;
    return true;
  }
  // H0 is the tool in the spindle, but tool 0 of the table on random changers (manual: "G43").
  const bool in_spindle = h == c.spindle_tool.number || (h == 0 && !c.settings.random_toolchanger);
  const auto tool = in_spindle ? std::optional<Tool>(c.spindle_tool) : c.find_tool(h);
  if (!tool)
    return c.fail('h', "Add the tool to the tool table, or choose another",
                  "Requested tool %d not found in the tool table", h);
  offset = tool->offset;
  return true;
}

bool tool_offset(Core& c, const Block& b, int code) {
  Pose offset = c.state.frame.tool();
  if (code == 490) {
    offset = {};
  } else if (code == 430) {
    if (!offset_of_h(c, b, offset)) return false;
  } else {
    if (code == 432) {
      if (!b.has('h') && !b.has_axes())
        return c.fail(0, "Write H with a tool number, or axis words",
                      "G43.2: No axes specified and H word missing");
      if (b.has('h') && b.has_axes())
        return c.fail('h', "Write two lines: each adds its offset",
                      "G43.2: Can not have both H and axis words");
      Pose more;
      if (b.has('h') && !offset_of_h(c, b, more)) return false;
      offset = offset + more;
    }
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (!b.has_axis(i)) continue;
      const double v = c.axis_word(b, i);
      offset[i] = code == 432 ? offset[i] + v : v;
    }
  }
  apply_offset(c, offset, code);
  return true;
}

bool change_tool(Core& c, const Block&, int) {
  const int number = c.state.selected_tool < 0 ? 0 : c.state.selected_tool;
  c.out.call<&Canon::start_change>();
  for (int i = 0; i < c.settings.spindles && !c.settings.spindle_on_during_change; ++i) {
    c.state.direction[static_cast<std::size_t>(i)] = SpindleDirection::stopped;
    c.out.call<&Canon::stop_spindle>(i);
  }
  c.out.call<&Canon::change_tool>();
  c.state.tool_change = 6;
  // What synchronize() will confirm or correct.
  const bool none = number == 0 && !c.settings.random_toolchanger;
  c.spindle_tool = none ? Tool{0, 0, {}, 0, 0, 0, 0}
                        : c.find_tool(number).value_or(Tool{number, 0, {}, 0, 0, 0, 0});
  if (c.settings.retain_g43 && c.state.tool_offset_code == 430)
    apply_offset(c, c.spindle_tool.offset, 430);
  c.ask_sync(SyncReason::tool_change);
  return true;
}

bool set_tool_number(Core& c, const Block& b, int) {
  int number = 0;
  if (!c.integer(b, 'q', -1, number)) return false;
  if (number < 0)
    return c.fail('q', "", "Need non-negative Q-word to specify tool number with M61");
  const bool none = number == 0 && !c.settings.random_toolchanger;
  const auto tool = none ? std::optional<Tool>(Tool{0, 0, {}, 0, 0, 0, 0}) : c.find_tool(number);
  if (!tool)
    return c.fail('q', "Add the tool to the tool table, or choose another",
                  "Requested tool %d not found in the tool table", number);
  c.spindle_tool = *tool;
  c.state.tool_change = 61;
  c.out.call<&Canon::change_tool_number>(number);
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 430, 430, 8, kOrderToolOffset, tool_offset, letters("h"), AxisUse::none},
    {'g', 431, 431, 8, kOrderToolOffset, tool_offset, 0, AxisUse::optional},
    {'g', 432, 432, 8, kOrderToolOffset, tool_offset, letters("h"), AxisUse::optional},
    {'g', 490, 490, 8, kOrderToolOffset, tool_offset, 0, AxisUse::none},
    {'m', 6, 6, 6, kOrderToolChange, change_tool, 0, AxisUse::none},
    {'m', 61, 61, 6, kOrderToolChange, set_tool_number, letters("q"), AxisUse::none},
};

}  // namespace

std::span<const CodeRow> tool_codes() { return kRows; }

}  // namespace kerf::interp
