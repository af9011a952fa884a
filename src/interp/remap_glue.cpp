#include "interp/remap_glue.hpp"

#include <cmath>

#include "interp/codes/families.hpp"
#include "interp/core.hpp"

namespace kerf::interp {

namespace {

int whole(double v) { return static_cast<int>(std::nearbyint(v)); }

bool no_tool(const Core& c, int number) { return number == 0 && !c.settings.random_toolchanger; }

Tool empty_spindle() { return Tool{0, 0, {}, 0, 0, 0, 0}; }

// --- T ---

bool prepare_prolog(Core& c, RemapCall& call) {
  if (!call.block.has('t')) return c.fail(0, "Write T with a number", "T requires a tool number");
  const int number = whole(call.block['t']);
  int pocket = -1;
  if (!no_tool(c, number)) {
    const auto tool = c.env.find_tool(number);
    if (!tool)
      return c.fail('t', "Add the tool to the tool table, or choose another",
                    "T%d: pocket not found", number);
    pocket = tool->pocket;
  }
  return c.set_local("tool", number) && c.set_local("pocket", pocket);
}

bool prepare_epilog(Core& c, RemapCall& call) {
  const int number = whole(c.local("tool", call.block.get('t', 0)));
  if (c.sub_value <= 0)
    return c.fail(0, "The sub returns a positive value when all is well",
                  "T%d: aborted (return code %.1f)", number, c.sub_value);
  if (call.builtin_used) return true;
  c.state.selected_tool = number;
  c.state.selected_pocket = whole(c.local("pocket", -1));
  c.out.call<&Canon::select_tool>(number);
  return true;
}

// --- M6, M61 ---

/// #5600 and #5601 of tool changers that report faults: a negative reason stops, another is shown.
bool changer_fault(Core& c) {
  if (c.params.get(kChangerFault) <= 0) return true;
  const int reason = whole(c.params.get(kChangerReason));
  if (reason < 0)
    return c.fail(0, "See to the tool changer; #5601 is its reason", "Toolchanger hard fault %d",
                  reason);
  c.out.call<&Canon::message>(c.out.keep("Toolchanger soft fault " + std::to_string(reason)));
  return true;
}

bool change_prolog(Core& c, RemapCall&) {
  if (!changer_fault(c)) return false;
  if (c.state.selected_tool < 0)
    return c.fail(0, "Write T with a number before M6", "M6: no tool prepared");
  if (c.state.cutter_comp != 400)
    return c.fail(0, "Write G40 before", "Cannot change tools with cutter radius compensation on");
  return c.set_local("tool_in_spindle", c.parameter(kToolNumber)) &&
         c.set_local("selected_tool", c.state.selected_tool) &&
         c.set_local("current_pocket", c.spindle_tool.pocket) &&
         c.set_local("selected_pocket", c.state.selected_pocket);
}

bool change_epilog(Core& c, RemapCall& call) {
  if (c.sub_value <= 0)
    return c.fail(0, "The sub returns a positive value when all is well",
                  "M6 aborted (return code %.1f)", c.sub_value);
  if (!changer_fault(c)) return false;
  if (call.builtin_used) return true;
  int number = c.state.selected_tool < 0 ? 0 : c.state.selected_tool;
  const int pocket = whole(c.local("selected_pocket", c.state.selected_pocket));
  if (pocket != c.state.selected_pocket) {  // the sub chose another
    const auto other = c.env.find_pocket(pocket);
    if (!other)
      return c.fail(0, "#<selected_pocket> must be a pocket of the tool table",
                    "M6: no tool in pocket %d", pocket);
    number = other->number;
    c.out.call<&Canon::select_tool>(number);
  }
  c.out.call<&Canon::change_tool>();
  c.spindle_tool = no_tool(c, number)
                       ? empty_spindle()
                       : c.env.find_tool(number).value_or(Tool{number, pocket, {}, 0, 0, 0, 0});
  c.state.tool_change = 6;
  c.state.selected_tool = c.state.selected_pocket = -1;
  c.ask_sync(SyncReason::tool_change);
  return true;
}

bool settool_prolog(Core& c, RemapCall& call) {
  if (!call.block.has('q'))
    return c.fail(0, "Q is the number of the tool", "M61 requires a Q parameter");
  int number = 0;
  if (!c.integer(call.block, 'q', 0, number)) return false;
  if (number < 0) return c.fail('q', "", "M61: Q value < 0");
  int pocket = 0;
  if (!no_tool(c, number)) {
    const auto tool = c.env.find_tool(number);
    if (!tool)
      return c.fail('q', "Add the tool to the tool table, or choose another",
                    "M61 failed: requested tool %d not in table", number);
    pocket = tool->pocket;
  }
  return c.set_local("tool", number) && c.set_local("pocket", pocket);
}

bool settool_epilog(Core& c, RemapCall& call) {
  if (c.sub_value <= 0)
    return c.fail(0, "The sub returns a positive value when all is well",
                  "M61 aborted (return code %.1f)", c.sub_value);
  if (call.builtin_used) return true;
  const int number = whole(c.local("tool", 0));
  const auto tool =
      no_tool(c, number) ? std::optional<Tool>(empty_spindle()) : c.env.find_tool(number);
  if (!tool)
    return c.fail(0, "Add the tool to the tool table, or choose another",
                  "M61 failed: requested tool %d not in table", number);
  c.spindle_tool = *tool;
  c.state.tool_change = 61;
  c.out.call<&Canon::change_tool_number>(number);
  return true;
}

// --- S, F: the built-in word runs with the value that the sub left ---

bool speed_prolog(Core& c, RemapCall& call) {
  if (!call.block.has('s')) return c.fail(0, "Write S with a speed", "S requires a value");
  return c.set_local("speed", call.block['s']);
}

bool speed_epilog(Core& c, RemapCall& call) {
  if (c.sub_value <= 0)
    return c.fail(0, "The sub returns a positive value when all is well",
                  "S: remap procedure returned %f", c.sub_value);
  if (call.builtin_used) return true;
  Block b = call.block;
  b.mask |= letters("s");
  b.value[static_cast<std::size_t>(letter_index('s'))] = c.local("speed", 0);
  return c.speed_word(b);
}

bool feed_prolog(Core& c, RemapCall& call) {
  if (!call.block.has('f')) return c.fail(0, "Write F with a feed", "F requires a value");
  return c.set_local("feed", call.block['f']);
}

bool feed_epilog(Core& c, RemapCall& call) {
  // A sub without a value is accepted, as it always was for F.
  if (c.sub_value < 0)
    return c.fail(0, "The sub returns a positive value when all is well",
                  "F: remap procedure returned %f", c.sub_value);
  if (call.builtin_used) return true;
  Block b = call.block;
  b.mask |= letters("f");
  b.value[static_cast<std::size_t>(letter_index('f'))] = c.local("feed", 0);
  return c.feed_word(b);
}

// --- cycles ---

/// Words of a cycle that hold until the code changes: the axes and R. The others are for their block.
constexpr LetterMask kSticky = letters("xyzuvwr");

bool cycle_conditions(Core& c, const RemapCall& call) {
  const Block& b = call.block;
  const char* name = call.remap->name.c_str();
  if ((b.mask & letters("abc")) != 0)
    return c.fail(b.has('a') ? 'a' : b.has('b') ? 'b' : 'c', "", "%s: ABC not allowed", name);
  if ((b.mask & letters("xyz")) != 0 && (b.mask & letters("uvw")) != 0)
    return c.fail(0, "Use axes of one group", "%s: can't combine UVW and XYZ", name);
  if (b.has('l') && (b['l'] <= 0 || std::fabs(b['l'] - std::nearbyint(b['l'])) > kTolerance))
    return c.fail('l', "", "%s: L must be a positive integer", name);
  if (b.has('p') && b['p'] < 0) return c.fail('p', "", "%s: P must not be negative", name);
  if (c.state.feed <= 0) return c.fail(0, "Write F before", "%s: feed rate is zero", name);
  if (c.state.feed_mode == ProgramFeedMode::inverse_time)
    return c.fail(0, "Write G94 before", "%s: cannot use inverse time feed with a cycle", name);
  if (c.state.cutter_comp != 400)
    return c.fail(0, "Write G40 before", "Cannot use canned cycles with cutter compensation on");
  return true;
}

bool cycle_prolog(Core& c, RemapCall& call) {
  if (!cycle_conditions(c, call)) return false;
  auto& sticky = c.sticky_words[call.remap->code];
  if (c.state.motion != call.remap->code) sticky.fill(std::nullopt);
  for (int i = 0; i < kLetters; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if ((kSticky >> i & 1U) == 0) continue;
    if ((call.block.mask >> i & 1U) != 0) sticky[n] = call.block.value[n];
    if (sticky[n]) (void)c.set_local(kLetterNames.substr(n, 1), *sticky[n]);
  }
  const auto r = sticky[static_cast<std::size_t>(letter_index('r'))];
  if (!r || *r <= 0)
    return c.fail(r ? 'r' : 0, "R is the height to retract to",
                  r ? "%s: R must be greater than 0" : "%s: R word missing",
                  call.remap->name.c_str());
  return call.block.has('l') || c.set_local("l", 1);
}

bool cycle_epilog(Core& c, RemapCall& call) {
  if (call.remap->letter == 'g') c.state.motion = call.remap->code;
  return true;
}

// --- lathes: T indexes, M6 does nothing ---

bool ignore_m6(Core&, RemapCall&) { return true; }

/// T201: tool 2 with its offset and the wear offset 1 (row 10001 of the tool table).
bool index_with_wear(Core& c, RemapCall& call) {
  if (!call.block.has('t')) return c.fail(0, "Write T with a number", "T requires a tool number");
  const int word = whole(call.block['t']);
  const int number = word < 100 ? word : word / 100;
  const int wear = word < 100 ? 0 : word % 100;
  Pose offset;
  Tool in_spindle = empty_spindle();
  for (const int row : {number, wear > 0 ? 10000 + wear : 0}) {
    if (row == 0) continue;
    const auto tool = c.env.find_tool(row);
    if (!tool)
      return c.fail('t',
                    "Tool NNWW is tool NN of the table with the wear offset of tool 10000 + WW",
                    "T%d: requested tool %d not found in the tool table", word, row);
    if (row == number) in_spindle = *tool;
    offset = offset + tool->offset;
  }
  c.spindle_tool = in_spindle;
  c.state.tool_change = 61;
  c.out.call<&Canon::change_tool_number>(number);
  CanonFrame f = c.state.frame;
  f.use_tool_length_offset(offset);
  c.set_frame(f);
  c.state.tool_offset_code = number == 0 ? 490 : 430;
  c.out.call<&Canon::use_tool_length_offset>(offset);
  return true;
}

struct Row {
  std::string_view name;
  NativeGlue run;
};
constexpr Row kRows[] = {
    {"prepare_prolog", prepare_prolog}, {"prepare_epilog", prepare_epilog},
    {"change_prolog", change_prolog},   {"change_epilog", change_epilog},
    {"settool_prolog", settool_prolog}, {"settool_epilog", settool_epilog},
    {"setspeed_prolog", speed_prolog},  {"setspeed_epilog", speed_epilog},
    {"setfeed_prolog", feed_prolog},    {"setfeed_epilog", feed_epilog},
    {"cycle_prolog", cycle_prolog},     {"cycle_epilog", cycle_epilog},
    {"ignore_m6", ignore_m6},           {"index_lathe_tool_with_wear", index_with_wear},
};

}  // namespace

NativeGlue find_native_glue(std::string_view function) {
  for (const Row& r : kRows) {
    if (r.name == function) return r.run;
  }
  return nullptr;
}

bool is_native_glue(std::string_view function) { return find_native_glue(function) != nullptr; }

}  // namespace kerf::interp
