// The program halui beside the true processes.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "../../machine/kerf_process.hpp"

namespace kerf::launcher::test {
namespace {

/// What a command of the build prints, without the last newline.
std::string run(const std::string& instance, const std::string& command) {
  const std::string bin = std::string(KERF_BUILD_DIR) + "/bin";
  const std::string line = "PATH='" + bin + "':\"$PATH\" KERF_INSTANCE=" + instance + " '" + bin +
                           "/'" + command + " 2>&1";
  FILE* pipe = popen(line.c_str(), "r");
  std::string out;
  std::array<char, 512> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) out += buffer.data();
  pclose(pipe);
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

class Panel {
 public:
  explicit Panel(Kerf& kerf) : kerf_(kerf) {}
  std::string get(const std::string& name) { return run(kerf_.instance(), "halcmd getp " + name); }
  void set(const std::string& name, const std::string& value) {
    EXPECT_EQ(run(kerf_.instance(), "halcmd setp " + name + " " + value), "");
  }
  bool until(const std::string& name, const std::string& value) {
    for (int waited = 0; waited < Kerf::kLimitMs; waited += 20) {
      if (get(name) == value) return true;
      pause_ms(20);
    }
    ADD_FAILURE() << name << " is " << get(name) << ", not " << value << "\n" << kerf_.output();
    return false;
  }
  /// Holds the button until the machine shows that it has seen it.
  bool press(const std::string& button, const std::string& lamp, const std::string& value) {
    set(button, "1");
    const bool seen = until(lamp, value);
    set(button, "0");
    pause_ms(50);
    return seen;
  }

 private:
  Kerf& kerf_;
};

TEST(HaluiProcess, StartsWithTheMachineAndItsJogsEndWithIt) {
  Mill mill("halui");
  mill.change("[HAL]\n", "[HAL]\nHALUI = halui\n");
  Kerf kerf(mill, "halui", {});
  ASSERT_TRUE(kerf.wait_output("runs; end it with")) << kerf.output();
  Panel panel(kerf);
  ASSERT_TRUE(panel.until("halui.estop.is-activated", "TRUE"));
  ASSERT_TRUE(panel.press("halui.estop.reset", "halui.estop.is-activated", "FALSE"));
  ASSERT_TRUE(panel.press("halui.machine.on", "halui.machine.is-on", "TRUE"));
  EXPECT_NE(run(kerf.instance(), "linuxcnctop -p task_state").find("STATE_ON"), std::string::npos);
  EXPECT_NE(run(kerf.instance(), "linuxcnctop --json").find("\"task_state\":4"), std::string::npos);
  panel.set("halui.joint.jog-speed", "600");
  panel.set("halui.joint.0.plus", "1");
  ASSERT_TRUE(panel.until("joint.0.kb-jog-active", "TRUE"));
  const auto halui = kerf.parts("halui");
  ASSERT_EQ(halui.size(), 1U);
  kill(halui[0], SIGKILL);
  // The launcher takes a machine down that has lost a part; either way nothing moves on.
  EXPECT_NE(kerf.wait_exit(), -1);
  EXPECT_EQ(kerf.leftovers(), "");
}

TEST(HaluiProcess, LoadedByHandItsJogStopsWhenItIsKilled) {
  Mill mill("haluihand");
  Kerf kerf(mill, "haluihand", {});
  ASSERT_TRUE(kerf.wait_output("runs; end it with")) << kerf.output();
  Panel panel(kerf);
  EXPECT_EQ(run(kerf.instance(), "halcmd loadusr -W halui -ini " + mill.ini() + " >/dev/null"), "");
  ASSERT_TRUE(panel.until("halui.estop.is-activated", "TRUE"));
  ASSERT_TRUE(panel.press("halui.estop.reset", "halui.estop.is-activated", "FALSE"));
  ASSERT_TRUE(panel.press("halui.machine.on", "halui.machine.is-on", "TRUE"));
  panel.set("halui.joint.jog-speed", "600");
  panel.set("halui.joint.0.plus", "1");
  ASSERT_TRUE(panel.until("joint.0.kb-jog-active", "TRUE"));
  const auto halui = kerf.parts("halui");
  ASSERT_EQ(halui.size(), 1U);
  kill(halui[0], SIGKILL);
  EXPECT_TRUE(panel.until("joint.0.kb-jog-active", "FALSE"));
  EXPECT_EQ(panel.get("motion.motion-enabled"), "TRUE") << "the machine is well";
  kerf.signal(SIGTERM);
  EXPECT_EQ(kerf.wait_exit(), 0);
  EXPECT_EQ(kerf.leftovers(), "");
}

}  // namespace
}  // namespace kerf::launcher::test
