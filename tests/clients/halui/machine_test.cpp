// halui's pins on a whole machine: what it does when they are pressed, and what they show.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "clients/common/machine_view.hpp"
#include "clients/halui/hal_pins.hpp"
#include "clients/halui/layout.hpp"
#include "hal/client/session.hpp"
#include "harness/machine.hpp"

namespace kerf::clients::halui {
namespace {

using harness::Machine;

class MachinePort final : public Port {
 public:
  explicit MachinePort(Machine& machine) : machine_(machine) {}
  std::uint64_t send(const std::vector<std::string>& words) override {
    return machine_.send(words);
  }
  std::optional<task::Reply> outcome(std::uint64_t id) override {
    const auto reply = machine_.outcome(id);
    if (!task::is_terminal(reply.state)) return std::nullopt;
    return reply;
  }
  void complain(const std::string& text) override { complaints += text + "\n"; }
  std::string complaints;

 private:
  Machine& machine_;
};

class PanelMachine {
 public:
  explicit PanelMachine(const std::string& commands = "") {
    harness::MachineOptions options;
    options.append = "\n[HALUI]\n" + commands;
    machine = Machine::start(options);
    if (!machine->ready()) {
      ADD_FAILURE() << machine->errors();
      return;
    }
    const auto ini = ini::IniFile::load(machine->folder() + "/mill.ini");
    auto layout = read_layout(ini.file);
    if (!layout.ok()) {
      ADD_FAILURE() << layout.error().message();
      return;
    }
    port = std::make_unique<MachinePort>(*machine);
    halui = std::make_unique<Halui>(*layout, *port);
    pins = std::make_unique<HalPins>(machine->session(), halui->board());
    EXPECT_TRUE(pins->status().ok()) << pins->status().error().message();
    view = std::move(*MachineView::over(machine->segment()));
    tick();
  }
  ~PanelMachine() { pins.reset(); }
  PanelMachine(const PanelMachine&) = delete;
  PanelMachine& operator=(const PanelMachine&) = delete;

  void tick() {
    machine->run_for(0.005);
    ASSERT_TRUE(view->poll());
    pins->read_inputs();
    halui->update(view->stat(), machine->now());
    pins->write_outputs();
  }
  void run_for(double seconds) {
    for (double t = 0; t < seconds; t += 0.005) tick();
  }
  bool until(const std::string& pin, double limit_s = 30) {
    for (double t = 0; t < limit_s; t += 0.005) {
      if (bit(pin)) return true;
      tick();
    }
    return bit(pin);
  }
  void set(const std::string& pin, double value) {
    std::ostringstream text;
    text << "setp halui." << pin << " " << value;
    EXPECT_TRUE(machine->hal(text.str())) << pin;
  }
  void press(const std::string& pin) {
    set(pin, 1);
    run_for(0.02);
    set(pin, 0);
    run_for(0.02);
  }
  double get(const std::string& pin) { return machine->get("halui." + pin); }
  bool bit(const std::string& pin) { return get(pin) != 0; }
  void power_on_and_home() {
    press("estop.reset");
    EXPECT_FALSE(bit("estop.is-activated")) << machine->errors();
    press("machine.on");
    EXPECT_TRUE(until("machine.is-on", 2)) << machine->errors();
    press("home-all");
    EXPECT_TRUE(until("mode.is-teleop", 60)) << machine->errors();
  }
  void stands() {
    EXPECT_TRUE(machine->run_until([&] { return !machine->motion().jogging; }, 30));
    tick();
  }

  std::unique_ptr<Machine> machine;
  std::unique_ptr<MachinePort> port;
  std::unique_ptr<Halui> halui;
  std::unique_ptr<HalPins> pins;
  std::unique_ptr<MachineView> view;
};

TEST(HaluiMachine, HasTheDocumentedPins) {
  PanelMachine p("MDI_COMMAND = G0 X1\n");
  std::ifstream list(KERF_SOURCE_DIR "/tests/clients/halui/documented_pins.tsv");
  std::string type, dir, name, line;
  int checked = 0;
  while (std::getline(list, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    words >> type >> dir >> name;
    type += " ";
    type += dir;
    EXPECT_EQ(p.machine->pin_kind(name), type) << name;
    ++checked;
  }
  EXPECT_GT(checked, 200);
  EXPECT_EQ(static_cast<std::size_t>(checked), p.halui->board().pins().size());
}

TEST(HaluiMachine, StartsHomesAndStops) {
  PanelMachine p;
  EXPECT_TRUE(p.bit("estop.is-activated"));
  p.power_on_and_home();
  for (const char* j : {"0", "1", "2"}) EXPECT_TRUE(p.bit(std::string("joint.") + j + ".is-homed"));
  EXPECT_TRUE(p.bit("mode.is-manual"));
  p.press("mode.joint");
  EXPECT_TRUE(p.bit("mode.is-joint"));
  p.press("joint.1.unhome");
  EXPECT_FALSE(p.bit("joint.1.is-homed"));
  EXPECT_TRUE(p.bit("joint.0.is-homed"));
  p.press("joint.1.home");
  EXPECT_TRUE(p.until("joint.1.is-homed"));
  p.press("mode.mdi");
  EXPECT_TRUE(p.bit("mode.is-mdi"));
  p.press("mode.auto");
  EXPECT_TRUE(p.bit("mode.is-auto"));
  p.press("mode.teleop");
  EXPECT_TRUE(p.bit("mode.is-manual"));
  EXPECT_TRUE(p.bit("mode.is-teleop"));
  p.press("machine.off");
  EXPECT_FALSE(p.bit("machine.is-on"));
  EXPECT_FALSE(p.bit("estop.is-activated"));
  p.press("estop.activate");
  EXPECT_TRUE(p.bit("estop.is-activated"));
  EXPECT_EQ(p.port->complaints, "");
}

TEST(HaluiMachine, JogsTheAxisWhileTheButtonIsHeld) {
  PanelMachine p;
  p.power_on_and_home();
  const double x = p.get("axis.x.pos-commanded");
  p.set("axis.jog-speed", 1200);
  p.set("axis.x.plus", 1);
  p.run_for(0.5);
  EXPECT_NEAR(p.machine->get("axis.x.teleop-vel-cmd"), 20, 1e-6) << "machine units a minute";
  p.set("axis.x.plus", 0);
  p.run_for(0.1);
  EXPECT_EQ(p.machine->get("axis.x.teleop-vel-cmd"), 0);
  EXPECT_NEAR(p.get("axis.x.pos-commanded"), x + 10, 1);
  EXPECT_NEAR(p.get("axis.x.pos-feedback"), p.get("axis.x.pos-commanded"), 0.1);

  const double y = p.get("axis.y.pos-commanded");
  p.set("axis.y.analog", 0.5);
  p.run_for(0.3);
  EXPECT_NEAR(p.machine->get("axis.y.teleop-vel-cmd"), 10, 1e-6);
  p.set("axis.y.analog", 0.1);
  p.stands();
  EXPECT_GT(p.get("axis.y.pos-commanded"), y + 2);

  p.press("axis.z.select");
  const double z = p.get("axis.z.pos-commanded");
  p.set("axis.selected.increment", 1.5);
  p.press("axis.selected.increment-minus");
  p.stands();
  EXPECT_NEAR(p.get("axis.z.pos-commanded"), z - 1.5, 1e-9);
}

TEST(HaluiMachine, AHeldButtonJogsOnAndAHaluiThatHangsDoesNot) {
  PanelMachine p;
  p.power_on_and_home();
  p.set("axis.jog-speed", 300);
  p.set("axis.x.plus", 1);
  p.run_for(4);
  EXPECT_NEAR(p.machine->get("axis.x.teleop-vel-cmd"), 5, 1e-6) << "its lease is held";
  const double x = p.machine->joint(0);
  p.machine->run_for(1.2);
  EXPECT_EQ(p.machine->get("axis.x.teleop-vel-cmd"), 0);
  EXPECT_LE(p.machine->joint(0), x + 5 * 1.03 + 0.1);
  EXPECT_NE(p.machine->errors().find("said nothing"), std::string::npos);
  p.run_for(1);
  EXPECT_EQ(p.machine->get("axis.x.teleop-vel-cmd"), 0) << "only a new press begins anew";
  p.set("axis.x.plus", 0);
  p.run_for(0.1);
  p.set("axis.x.plus", 1);
  p.run_for(0.5);
  EXPECT_NEAR(p.machine->get("axis.x.teleop-vel-cmd"), 5, 1e-6);
}

TEST(HaluiMachine, JogsJointsInJointModeOnly) {
  PanelMachine p;
  p.power_on_and_home();
  const double at = p.machine->joint(1);
  p.set("joint.jog-speed", 600);
  p.set("joint.1.increment", 2);
  p.press("joint.1.increment-plus");
  p.run_for(0.5);
  EXPECT_EQ(p.machine->joint(1), at) << "in teleop mode";
  p.press("mode.joint");
  p.press("joint.1.increment-plus");
  p.run_for(0.1);
  p.stands();
  EXPECT_NEAR(p.machine->joint(1), at + 2, 1e-9);
  p.set("joint.1.minus", 1);
  p.run_for(0.3);
  p.set("joint.1.minus", 0);
  p.stands();
  EXPECT_LT(p.machine->joint(1), at);
  EXPECT_EQ(p.port->complaints, "");
}

TEST(HaluiMachine, RunsPausesStepsAndStopsAProgram) {
  PanelMachine p;
  p.power_on_and_home();
  p.press("program.run");
  EXPECT_NE(p.port->complaints.find("no program is open"), std::string::npos);
  EXPECT_TRUE(p.bit("mode.is-manual"));
  const auto file = p.machine->write_program("G1 F600 X20\nG1 X0\nM0\nG1 X5\nM2\n");
  ASSERT_TRUE(p.machine->does({"open", file}));
  EXPECT_TRUE(p.bit("program.is-idle"));
  p.press("program.run");
  p.run_for(0.3);
  EXPECT_TRUE(p.bit("program.is-running"));
  EXPECT_TRUE(p.bit("mode.is-auto"));
  p.press("program.pause");
  EXPECT_TRUE(p.bit("program.is-paused"));
  EXPECT_FALSE(p.bit("program.is-running"));
  p.run_for(0.3);
  const double x = p.machine->joint(0);
  p.run_for(0.3);
  EXPECT_EQ(p.machine->joint(0), x);
  p.press("program.resume");
  EXPECT_TRUE(p.bit("program.is-running"));
  EXPECT_TRUE(p.until("program.is-paused")) << "M0";
  EXPECT_NEAR(p.machine->joint(0), 0, 1e-6);
  p.press("program.resume");
  EXPECT_TRUE(p.until("program.is-idle"));
  EXPECT_NEAR(p.machine->joint(0), 5, 1e-6);
  p.press("program.run");
  p.run_for(0.3);
  p.press("program.stop");
  EXPECT_TRUE(p.until("program.is-idle", 2));
  EXPECT_TRUE(p.bit("mode.is-auto"));
  p.press("program.step");
  p.run_for(3);
  EXPECT_TRUE(p.bit("program.is-paused"));
  EXPECT_NEAR(p.machine->joint(0), 20, 1e-6) << "one block";
  p.press("abort");
  EXPECT_TRUE(p.until("program.is-idle", 2));
}

TEST(HaluiMachine, AnswersM0AndTheToolChange) {
  PanelMachine p;
  p.power_on_and_home();
  p.machine->hal("unlinkp iocontrol.0.tool-changed");
  const auto file = p.machine->write_program("M0\nT2 M6\nG0 X2\nM2\n");
  ASSERT_TRUE(p.machine->does({"open", file}));
  p.press("program.run");
  EXPECT_TRUE(p.until("prompt.is-waiting", 2)) << "M0";
  EXPECT_FALSE(p.bit("prompt.is-tool-change"));
  p.run_for(1);
  EXPECT_NEAR(p.machine->joint(0), 0, 1e-9);
  p.press("prompt.ok");
  EXPECT_TRUE(p.until("prompt.is-tool-change", 5)) << p.machine->errors();
  EXPECT_EQ(p.machine->get("halui.prompt.tool"), 2);
  p.press("prompt.ok");
  EXPECT_TRUE(p.until("program.is-idle", 5));
  EXPECT_FALSE(p.bit("prompt.is-waiting"));
  EXPECT_EQ(p.machine->get("halui.tool.number"), 2);
  EXPECT_NEAR(p.machine->joint(0), 2, 1e-6);
  EXPECT_EQ(p.port->complaints, "");
}

TEST(HaluiMachine, MdiButtonsExecuteTheirLineAndComeBack) {
  PanelMachine p("MDI_COMMAND = G0 X7\nMDI_COMMAND = G1 F600 Y3\n");
  p.power_on_and_home();
  p.set("mdi-command-00", 1);
  p.run_for(0.05);
  EXPECT_TRUE(p.bit("mode.is-mdi"));
  EXPECT_TRUE(p.bit("halui-mdi-is-running"));
  EXPECT_TRUE(p.bit("program.is-running"));
  p.set("mdi-command-00", 0);
  EXPECT_TRUE(p.until("mode.is-teleop", 10));
  EXPECT_TRUE(p.bit("mode.is-manual"));
  EXPECT_FALSE(p.bit("halui-mdi-is-running"));
  EXPECT_NEAR(p.machine->joint(0), 7, 1e-9);
  p.press("mode.auto");
  p.press("mdi-command-01");
  p.press("mdi-command-00");
  EXPECT_TRUE(p.bit("mode.is-mdi"));
  EXPECT_TRUE(p.until("mode.is-auto", 10));
  EXPECT_NEAR(p.machine->joint(1), 3, 1e-9);
}

TEST(HaluiMachine, AnMdiLineInErrorComesBackToo) {
  PanelMachine p("MDI_COMMAND = G1 X7\nMDI_COMMAND = G999\n");
  p.power_on_and_home();
  p.press("mdi-command-01");
  p.run_for(0.3);
  EXPECT_TRUE(p.bit("mode.is-manual")) << p.machine->errors();
  EXPECT_FALSE(p.bit("halui-mdi-is-running"));
}

TEST(HaluiMachine, OverridesAndMaxVelocity) {
  PanelMachine p;
  p.power_on_and_home();
  EXPECT_EQ(p.get("feed-override.value"), 1);
  p.set("feed-override.scale", 0.05);
  p.press("feed-override.decrease");
  EXPECT_NEAR(p.get("feed-override.value"), 0.95, 1e-12);
  p.set("feed-override.counts", -9);
  p.run_for(0.02);
  EXPECT_NEAR(p.get("feed-override.value"), 0.5, 1e-12);
  p.press("feed-override.reset");
  EXPECT_EQ(p.get("feed-override.value"), 1);
  const double max = p.get("max-velocity.value");
  EXPECT_GT(max, 0);
  p.set("max-velocity.scale", 1);
  p.set("max-velocity.direct-value", 1);
  p.set("max-velocity.counts", 10);
  p.run_for(0.02);
  EXPECT_NEAR(p.get("max-velocity.value"), 10, 1e-9);
  p.set("max-velocity.counts", 100000);
  p.run_for(0.02);
  EXPECT_NEAR(p.get("max-velocity.value"), max, 1e-9) << "not above [TRAJ]MAX_LINEAR_VELOCITY";
}

TEST(HaluiMachine, SpindleCoolantAndSwitches) {
  PanelMachine p;
  p.power_on_and_home();
  EXPECT_TRUE(p.bit("spindle.0.brake-is-on"));
  p.press("spindle.0.forward");
  EXPECT_TRUE(p.until("spindle.0.runs-forward", 2));
  const double speed = p.machine->get("spindle.0.speed-out");
  EXPECT_GT(speed, 0);
  EXPECT_TRUE(p.bit("mode.is-manual")) << "a spindle by hand keeps the mode";
  EXPECT_TRUE(p.bit("mode.is-teleop"));
  p.press("spindle.0.increase");
  p.run_for(0.1);
  EXPECT_EQ(p.machine->get("spindle.0.speed-out"), 101)
      << "1 rpm, and a hundred more; before, [SPINDLE_0] asked for " << speed;
  p.press("spindle.0.reverse");
  p.run_for(0.1);
  EXPECT_TRUE(p.bit("spindle.0.runs-backward"));
  p.press("spindle.0.stop");
  p.run_for(0.1);
  EXPECT_FALSE(p.bit("spindle.0.is-on"));
  p.press("spindle.0.brake-off");
  EXPECT_FALSE(p.bit("spindle.0.brake-is-on"));
  p.press("spindle.0.brake-on");
  EXPECT_TRUE(p.bit("spindle.0.brake-is-on"));
  for (const std::string name : {"flood", "mist"}) {
    p.press(name + ".on");
    EXPECT_TRUE(p.bit(name + ".is-on"));
    EXPECT_TRUE(p.machine->bit("iocontrol.0.coolant-" + name));
    p.press(name + ".off");
    EXPECT_FALSE(p.bit(name + ".is-on"));
  }
  for (const std::string name : {"program.optional-stop", "program.block-delete"}) {
    p.press(name + ".on");
    EXPECT_TRUE(p.bit(name + ".is-on")) << name;
    p.press(name + ".off");
    EXPECT_FALSE(p.bit(name + ".is-on")) << name;
  }
}

TEST(HaluiMachine, ToolAndPositions) {
  PanelMachine p;
  p.power_on_and_home();
  ASSERT_TRUE(p.machine->mdi("T1 M6 G43"));
  ASSERT_TRUE(p.machine->mdi("G10 L2 P1 X10 Y20 R90"));
  ASSERT_TRUE(p.machine->mdi("G0 X1 Y2"));
  p.tick();
  EXPECT_EQ(p.get("tool.number"), 1);
  EXPECT_GT(p.get("tool.diameter"), 0);
  EXPECT_NE(p.get("tool.length_offset.z"), 0);
  EXPECT_NEAR(p.get("axis.x.pos-relative"), 1, 1e-9);
  EXPECT_NEAR(p.get("axis.y.pos-relative"), 2, 1e-9);
  EXPECT_NEAR(p.get("axis.x.pos-commanded"), 8, 1e-9);
}

}  // namespace
}  // namespace kerf::clients::halui
