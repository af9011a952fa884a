// halui without HAL and without a machine: which pins there are, and which commands a change of them gives.
#include "clients/halui/halui.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf::clients::halui {
namespace {

class FakePort final : public Port {
 public:
  std::uint64_t send(const std::vector<std::string>& words) override {
    std::string line;
    for (const auto& w : words) line += (line.empty() ? "" : " ") + w;
    sent.push_back(line);
    return ++last;
  }
  std::optional<task::Reply> outcome(std::uint64_t id) override {
    const auto at = replies.find(id);
    if (at == replies.end()) return answers_at_once ? done(id) : std::nullopt;
    return at->second;
  }
  void complain(const std::string& text) override { complaints.push_back(text); }
  static std::optional<task::Reply> done(std::uint64_t id) {
    return task::Reply{.id = id, .state = task::CommandState::done, .text = ""};
  }
  std::vector<std::string> sent, complaints;
  std::map<std::uint64_t, task::Reply> replies;
  bool answers_at_once{true};
  std::uint64_t last{0};
};

struct Panel {
  explicit Panel(Layout layout = {.joints = 3,
                                  .spindles = 2,
                                  .axis_mask = 7,
                                  .home_all = true,
                                  .mdi_commands = {"G0 X1", "G0 X2"}})
      : halui(layout, port) {
    stat.task_state = 4;
    stat.motion_mode = 3;
    stat.joints = 3;
    stat.max_velocity = 100;
    look();
    take();
  }
  Pin at(const std::string& name) {
    const auto& pins = halui.board().pins();
    const auto found =
        std::find_if(pins.begin(), pins.end(), [&](const auto& p) { return p.name == name; });
    if (found == pins.end()) ADD_FAILURE() << "no pin halui." << name;
    return found == pins.end() ? 0 : static_cast<Pin>(found - pins.begin());
  }
  bool has(const std::string& name) {
    const auto& pins = halui.board().pins();
    return std::any_of(pins.begin(), pins.end(), [&](const auto& p) { return p.name == name; });
  }
  void set(const std::string& name, double value) { halui.board().set(at(name), value); }
  double get(const std::string& name) { return halui.board().value(at(name)); }
  void look() { halui.update(stat, now += 5'000'000); }
  /// Sets a pin, looks, and gives what was sent, "; " between.
  std::string change(const std::string& name, double value) {
    set(name, value);
    look();
    return take();
  }
  std::string press(const std::string& name) {
    const std::string out = change(name, 1);
    const std::string after = change(name, 0);
    return after.empty() ? out : out + " / " + after;
  }
  std::string take() {
    std::string all;
    for (const auto& s : port.sent) all += (all.empty() ? "" : "; ") + s;
    port.sent.clear();
    return all;
  }
  FakePort port;
  Stat stat;
  Halui halui;
  std::int64_t now{0};
};

TEST(Halui, ButtonsSendTheirCommandWhenTheyRise) {
  Panel p;
  p.stat.file = "a.ngc";
  const std::pair<const char*, const char*> expected[] = {
      {"abort", "abort"},
      {"program.stop", "abort"},
      {"estop.activate", "state estop"},
      {"machine.on", "state on"},
      {"machine.off", "state off"},
      {"flood.on", "flood on"},
      {"flood.off", "flood off"},
      {"mist.on", "mist on"},
      {"mist.off", "mist off"},
      {"mode.manual", "mode manual"},
      {"mode.auto", "mode auto"},
      {"mode.mdi", "mode mdi"},
      {"mode.joint", "teleop off"},
      {"mode.teleop", "teleop on"},
      {"program.run", "run"},
      {"program.step", "step"},
      {"program.block-delete.on", "block-delete on"},
      {"program.block-delete.off", "block-delete off"},
      {"program.optional-stop.on", "optional-stop on"},
      {"program.optional-stop.off", "optional-stop off"},
      {"home-all", "home"},
      {"joint.2.home", "home 2"},
      {"joint.2.unhome", "unhome 2"},
      {"joint.selected.home", "home 0"},
      {"spindle.1.stop", "spindle off spindle=1"},
      {"spindle.1.forward", "spindle forward spindle=1"},
      {"spindle.1.reverse", "spindle reverse spindle=1"},
      {"spindle.1.increase", "spindle increase spindle=1"},
      {"spindle.1.decrease", "spindle decrease spindle=1"},
      {"spindle.1.brake-on", "brake on 1"},
      {"spindle.1.brake-off", "brake off 1"},
      {"spindle.0.start", "spindle forward spindle=0 speed=1"},
  };
  for (const auto& [pin, command] : expected) EXPECT_EQ(p.press(pin), command) << pin;
  p.stat.settings[2] = 500;
  EXPECT_EQ(p.press("spindle.0.start"), "spindle forward spindle=0");
  p.stat.task_mode = 2;
  EXPECT_EQ(p.press("mode.teleop"), "mode manual; teleop on");
}

TEST(Halui, WhatIsOnFromTheStartDoesNothing) {
  FakePort port;
  Halui halui({.joints = 1, .axis_mask = 1}, port);
  const auto& pins = halui.board().pins();
  for (Pin i = 0; i < pins.size(); ++i)
    if (pins[i].input && pins[i].type == PinType::bit) halui.board().set(i, 1);
  Stat stat;
  stat.task_state = 4;
  halui.update(stat, 1);
  halui.update(stat, 2);
  EXPECT_EQ(port.sent.size(), 0U) << port.sent.front();
}

TEST(Halui, ButtonsThatMakeNoSenseNowAreQuiet) {
  Panel p;
  EXPECT_EQ(p.press("estop.reset"), "") << "not in estop; task would switch the drives off";
  p.stat.task_state = 1;
  EXPECT_EQ(p.press("estop.reset"), "state estop-reset");
  EXPECT_EQ(p.press("program.run"), "");
  EXPECT_EQ(p.port.complaints.size(), 1U) << "no program is open";
  EXPECT_EQ(p.press("program.pause"), "");
  EXPECT_EQ(p.press("program.resume"), "");
  p.stat.interp_state = 2;
  p.stat.file = "a.ngc";
  EXPECT_EQ(p.press("program.run"), "") << "it runs";
  EXPECT_EQ(p.press("program.pause"), "pause");
  EXPECT_EQ(p.press("program.resume"), "resume");
}

TEST(Halui, PinsFollowTheLayout) {
  Panel p({.joints = 2, .spindles = 1, .axis_mask = 0b101, .home_all = false});
  EXPECT_FALSE(p.has("home-all"));
  EXPECT_FALSE(p.has("mdi-command-00"));
  EXPECT_TRUE(p.has("axis.x.plus"));
  EXPECT_FALSE(p.has("axis.y.plus"));
  EXPECT_TRUE(p.has("axis.z.plus"));
  EXPECT_TRUE(p.has("joint.1.plus"));
  EXPECT_FALSE(p.has("joint.2.plus"));
  EXPECT_FALSE(p.has("spindle.1.start"));
  EXPECT_TRUE(p.has("tool.length_offset.w"));
  EXPECT_EQ(p.get("feed-override.count-enable"), 1);
  EXPECT_EQ(p.get("axis.jog-deadband"), 0.2);
}

TEST(Halui, KnobsAddStepsCountsAndDirectValues) {
  Panel p;
  EXPECT_EQ(p.press("feed-override.increase"), "feed-override 1.1000000000000001");
  EXPECT_EQ(p.press("feed-override.decrease"), "feed-override 0.90000000000000002");
  p.stat.feedrate = 0.5;
  EXPECT_EQ(p.press("feed-override.reset"), "feed-override 1");
  p.set("feed-override.scale", 0.25);
  EXPECT_EQ(p.change("feed-override.counts", 2), "feed-override 1");
  EXPECT_EQ(p.change("feed-override.counts", 1), "feed-override 0.25");
  EXPECT_EQ(p.change("feed-override.count-enable", 0), "");
  EXPECT_EQ(p.change("feed-override.counts", 100), "");
  EXPECT_EQ(p.change("feed-override.count-enable", 1), "") << "what was turned meanwhile is lost";
  EXPECT_EQ(p.change("feed-override.direct-value", 1), "");
  EXPECT_EQ(p.change("feed-override.counts", 3), "feed-override 0.75");
  p.set("max-velocity.scale", 10);
  EXPECT_EQ(p.press("max-velocity.decrease"), "max-velocity 90");
  p.set("spindle.1.override.scale", 0.5);
  EXPECT_EQ(p.press("spindle.1.override.decrease"), "spindle-override 0.5 spindle=1");
  p.set("rapid-override.scale", 5);
  EXPECT_EQ(p.press("rapid-override.decrease"), "rapid-override 0") << "never below 0";
  p.set("rapid-override.scale", std::nan(""));
  EXPECT_EQ(p.press("rapid-override.decrease"), "");
}

TEST(Halui, TwoTurnsBeforeTheAnswerAddUp) {
  Panel p;
  p.port.answers_at_once = false;
  p.set("feed-override.scale", 0.25);
  EXPECT_EQ(p.press("feed-override.increase"), "feed-override 1.25");
  EXPECT_EQ(p.press("feed-override.increase"), "feed-override 1.5");
}

TEST(Halui, JogsRunWhileTheButtonIsHeld) {
  Panel p;
  p.set("axis.jog-speed", 600);
  EXPECT_EQ(p.change("axis.x.plus", 1), "jog x 10 lease=1 in-mode=on");
  p.look();
  EXPECT_EQ(p.take(), "") << "once";
  EXPECT_EQ(p.change("axis.jog-speed", 1200), "jog x 20 lease=1 in-mode=on")
      << "the knob is turned meanwhile";
  EXPECT_EQ(p.change("axis.x.minus", 1), "jog-stop x") << "both buttons";
  EXPECT_EQ(p.change("axis.x.plus", 0), "jog x -20 lease=1 in-mode=on");
  EXPECT_EQ(p.change("axis.x.minus", 0), "jog-stop x");
  p.set("axis.y.increment", 0.5);
  EXPECT_EQ(p.press("axis.y.increment-minus"), "jog y 20 distance=-0.5 in-mode=on");
}

TEST(Halui, SticksActBeyondTheDeadband) {
  Panel p;
  p.set("axis.jog-speed", 60);
  EXPECT_EQ(p.change("axis.z.analog", 0.2), "");
  EXPECT_EQ(p.change("axis.z.analog", 0.5), "jog z 0.5 lease=1 in-mode=on");
  EXPECT_EQ(p.change("axis.z.analog", -1), "jog z -1 lease=1 in-mode=on");
  EXPECT_EQ(p.change("axis.z.analog", std::nan("")), "jog-stop z");
  EXPECT_EQ(p.change("axis.z.analog", 0.1), "");
}

TEST(Halui, JogsNeedTheirMode) {
  Panel p;
  p.set("axis.jog-speed", 60);
  p.set("joint.jog-speed", 60);
  EXPECT_EQ(p.change("joint.1.plus", 1), "") << "teleop: joints do not jog";
  p.stat.motion_mode = 1;
  p.look();
  EXPECT_EQ(p.take(), "") << "nor when the mode comes with the button held";
  EXPECT_EQ(p.change("joint.1.plus", 0), "");
  EXPECT_EQ(p.change("joint.1.plus", 1), "jog 1 1 lease=1 in-mode=on");
  EXPECT_EQ(p.change("axis.x.plus", 1), "");
  p.stat.task_mode = 2;
  EXPECT_EQ(p.change("joint.2.plus", 1), "");
  EXPECT_EQ(p.change("joint.1.plus", 0), "jog-stop 1") << "a stop works always";
}

TEST(Halui, TheSelectedOneMovesByAPressOnly) {
  Panel p;
  p.set("axis.jog-speed", 60);
  EXPECT_EQ(p.change("axis.selected.plus", 1), "jog x 1 lease=1 in-mode=on");
  EXPECT_EQ(p.press("axis.y.select"), "jog-stop x");
  EXPECT_EQ(p.get("axis.selected"), 1);
  EXPECT_EQ(p.get("axis.y.is-selected"), 1);
  EXPECT_EQ(p.get("axis.x.is-selected"), 0);
  p.look();
  EXPECT_EQ(p.take(), "");
  EXPECT_EQ(p.change("axis.selected.plus", 0), "");
  EXPECT_EQ(p.change("axis.selected.plus", 1), "jog y 1 lease=1 in-mode=on");
  p.set("joint.selected.increment", 2);
  p.stat.motion_mode = 1;
  p.set("joint.jog-speed", 60);
  EXPECT_EQ(p.press("joint.2.select"), "");
  EXPECT_EQ(p.press("joint.selected.increment-plus"), "jog 2 1 distance=2 in-mode=on");
  EXPECT_EQ(p.press("joint.selected.unhome"), "unhome 2");
}

TEST(Halui, MdiCommandsAreSentOneBehindTheOther) {
  Panel p;
  p.port.answers_at_once = false;
  EXPECT_EQ(p.press("mdi-command-01"), "mdi G0 X2 and-back=on");
  EXPECT_EQ(p.get("halui-mdi-is-running"), 1);
  p.stat.task_mode = 3;
  p.stat.interp_state = 2;
  EXPECT_EQ(p.press("mdi-command-00"), "mdi G0 X1 and-back=on") << "it waits in task's queue";
  p.port.replies[1] = *FakePort::done(1);
  p.look();
  EXPECT_EQ(p.get("halui-mdi-is-running"), 1);
  p.port.replies[2] = *FakePort::done(2);
  p.look();
  EXPECT_EQ(p.get("halui-mdi-is-running"), 0);
  EXPECT_EQ(p.take(), "");
}

TEST(Halui, MdiIsRefusedWhileAProgramRuns) {
  Panel p;
  p.stat.task_mode = 2;
  p.stat.interp_state = 2;
  EXPECT_EQ(p.press("mdi-command-00"), "");
  ASSERT_EQ(p.port.complaints.size(), 1U);
  EXPECT_NE(p.port.complaints[0].find("halui.mdi-command-00"), std::string::npos);
}

TEST(Halui, StatesFollowTheMachine) {
  Panel p;
  const auto shows = [&p](const char* name, double value) {
    p.look();
    EXPECT_NEAR(p.get(name), value, 1e-12) << name;
  };
  shows("machine.is-on", 1);
  shows("mode.is-teleop", 1);
  shows("mode.is-joint", 0);
  p.stat.task_state = 1;
  shows("estop.is-activated", 1);
  shows("machine.is-on", 0);
  p.stat.interp_state = 2;
  shows("program.is-running", 1);
  p.stat.task_paused = true;
  shows("program.is-running", 0);
  shows("program.is-paused", 1);
  shows("program.is-idle", 0);
  p.stat.joint[1].homed = p.stat.joint[1].max_soft_limit = true;
  shows("joint.1.is-homed", 1);
  shows("joint.1.on-soft-max-limit", 1);
  shows("joint.selected.is-homed", 0);
  (void)p.press("joint.1.select");
  shows("joint.selected.is-homed", 1);
  shows("joint.selected", 1);
  p.stat.spindle[1].direction = -1;
  p.stat.spindle[1].enabled = 1;
  shows("spindle.1.runs-backward", 1);
  shows("spindle.1.runs-forward", 0);
  shows("spindle.1.is-on", 1);
  p.stat.spindle[1].override_ = 0.75;
  shows("spindle.1.override.value", 0.75);
  p.stat.tool_in_spindle = 7;
  p.stat.tool_table = {ToolStat{}};
  p.stat.tool_table[0].id = 7;
  p.stat.tool_table[0].diameter = 6;
  shows("tool.number", 7);
  shows("tool.diameter", 6);
  p.stat.tool_offset.z = 12;
  shows("tool.length_offset.z", 12);
}

TEST(Halui, AProgramThatWaitsShowsIt) {
  Panel p;
  p.stat.waiting_for.object = rtapi::FixedString<63>("the home switch of joint 0");
  p.look();
  EXPECT_EQ(p.get("program.is-waiting"), 0) << "no program runs";
  p.stat.interp_state = 4;
  p.look();
  EXPECT_EQ(p.get("program.is-waiting"), 1);
  p.stat.waiting_for = {};
  p.look();
  EXPECT_EQ(p.get("program.is-waiting"), 0);
}

TEST(Halui, ThePromptIsAnsweredByItsNumber) {
  Panel p;
  EXPECT_EQ(p.press("prompt.ok"), "") << "nothing is asked";
  p.stat.prompt = {17, task::PromptKind::tool_change, 3, {}};
  p.look();
  EXPECT_EQ(p.get("prompt.is-waiting"), 1);
  EXPECT_EQ(p.get("prompt.is-tool-change"), 1);
  EXPECT_EQ(p.get("prompt.tool"), 3);
  EXPECT_EQ(p.press("prompt.ok"), "answer 17");
  p.stat.prompt = {18, task::PromptKind::stop, -1, {}};
  p.look();
  EXPECT_EQ(p.get("prompt.is-waiting"), 1);
  EXPECT_EQ(p.get("prompt.is-tool-change"), 0);
  EXPECT_EQ(p.get("prompt.tool"), 0);
  p.stat.prompt = {};
  p.look();
  EXPECT_EQ(p.get("prompt.is-waiting"), 0);
}

TEST(Halui, RelativePositionTakesOffToolOffsetRotationAndG92) {
  Panel p;
  p.stat.position.x = 10 - 3;  // program (2, 1) turned by 90 degrees about (10, 20), G92 (1, 2)
  p.stat.position.y = 20 + 3;
  p.stat.position.z = 5;
  p.stat.g5x_offset.x = 10;
  p.stat.g5x_offset.y = 20;
  p.stat.rotation_xy = 90;
  p.stat.g92_offset.x = 1;
  p.stat.g92_offset.y = 2;
  p.stat.tool_offset.z = 4;
  p.look();
  EXPECT_NEAR(p.get("axis.x.pos-relative"), 2, 1e-12);
  EXPECT_NEAR(p.get("axis.y.pos-relative"), 1, 1e-12);
  EXPECT_NEAR(p.get("axis.z.pos-relative"), 1, 1e-12);
  EXPECT_EQ(p.get("axis.z.pos-commanded"), 5);
}

}  // namespace
}  // namespace kerf::clients::halui
