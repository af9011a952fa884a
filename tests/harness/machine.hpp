// Machine: a whole Kerf machine in this process, in one thread, on the virtual clock: realtime host with all components,
// planner, motion, task and io, wired by a real INI file and its HAL files.
//
//   auto m = harness::Machine::start();                 // configs/sim/mill
//   ASSERT_TRUE(m->ready()) << m->errors();
//   m->power_on_and_home();
//   EXPECT_TRUE(m->mdi("G0 X10"));
//   EXPECT_NEAR(m->joint(0), 10, 1e-9);
//   m->branch([&] { m->abort(); ... });                 // a copy of the machine at this very cycle
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/loader/module_source.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/clock/clock.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"

namespace kerf::rtapi {
class Segment;
}
namespace kerf::hal {
class Session;
}
namespace kerf::launcher {
struct HalStep;
}
namespace kerf::task {
class Client;
}

namespace kerf::harness {

struct MachineOptions {
  /// INI file; its whole folder is copied to a temporary one, so tests change no file of the tree.
  std::string ini{KERF_SOURCE_DIR "/configs/sim/mill/mill.ini"};
  /// Lines put behind the INI file's text ("[KERF]\nX = 1\n"); the first value of a key wins, so use `replace` to change one.
  std::string append;
  /// Text replacements in the INI file, first hit each; the old text must be there.
  std::vector<std::pair<std::string, std::string>> replace;
  /// More files (name, text) beside the INI file; executable when the text begins with #!.
  std::vector<std::pair<std::string, std::string>> files;
  /// HAL commands after those of the INI file, before the threads start.
  std::vector<std::string> hal;
  /// Takes clients, see Machine::connect().
  bool clients{false};
  /// Components of the test's own, beside all those of the product.
  std::vector<hal::StaticModule> modules;
};

class Machine {
 public:
  static std::unique_ptr<Machine> start(const MachineOptions& options = {});
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// False when start failed: errors() says why.
  [[nodiscard]] bool ready() const;
  /// All operator messages and start-up errors so far, a line each.
  [[nodiscard]] std::string errors() const;

  // --- time ---
  [[nodiscard]] rtapi::Nanos now() const;
  void run_for(double seconds);
  /// Runs until `done` or `limit_s` of virtual time; gives done().
  bool run_until(const std::function<bool()>& done, double limit_s = 600);
  /// One servo cycle.
  void cycle();

  // --- commands, through the same table as clients' ---
  /// Sends words as a person types them ({"jog", "x", "10"}); gives the id.
  std::uint64_t send(const std::vector<std::string>& words);
  [[nodiscard]] task::Reply outcome(std::uint64_t id) const;
  /// Sends and runs until the terminal outcome.
  task::Reply command(const std::vector<std::string>& words, double limit_s = 600);
  /// command() that must end in `done`.
  bool does(const std::vector<std::string>& words, double limit_s = 600);
  bool power_on();
  bool power_on_and_home();
  /// One MDI line, to its end.
  bool mdi(const std::string& line, double limit_s = 600);
  /// Writes a program into the temporary folder and opens it; gives its path.
  std::string write_program(const std::string& text, const std::string& name = "test.ngc");
  /// Opens and starts; does not wait.
  std::uint64_t start_program(const std::string& path);
  /// Opens, runs and waits for the end.
  task::Reply run_program(const std::string& path, double limit_s = 3600);
  task::Reply run_text(const std::string& text, double limit_s = 3600) {
    return run_program(write_program(text), limit_s);
  }
  task::Reply abort() { return command({"abort"}); }

  /// A client of its own over a socket, as programs have it; nullptr: MachineOptions::clients is not set.
  [[nodiscard]] std::unique_ptr<task::Client> connect();

  // --- what it does ---
  [[nodiscard]] motion::MotionStatus motion() const;
  [[nodiscard]] task::TaskStatus task() const;
  /// "G90 G0 X.. Y.. Z.." to the place that task shows: nothing may move on it.
  [[nodiscard]] std::string line_to_shown_place(std::string_view axes = "XYZ") const;
  [[nodiscard]] double joint(std::size_t j) const { return motion().joint[j].pos_cmd; }
  /// HAL pins, parameters and signals by name; a wrong name fails the test.
  [[nodiscard]] double get(const std::string& name) const;
  [[nodiscard]] bool bit(const std::string& name) const { return get(name) != 0; }
  /// "bit IN", "float OUT", "s32 I/O", or "" when there is no such pin.
  [[nodiscard]] std::string pin_kind(const std::string& name) const;
  /// "float RO", "s32 RW", or "".
  [[nodiscard]] std::string parameter_kind(const std::string& name) const;
  /// One halcmd line ("setp motion.probe-input 1"). False: it failed; the text is in errors().
  bool hal(const std::string& line);
  /// Called after each servo cycle, with the status of that cycle.
  void on_cycle(std::function<void(const motion::MotionStatus&)> f);
  /// The instance's memory, for clients that only read.
  [[nodiscard]] rtapi::Segment& segment() const;
  /// For user components of a test.
  [[nodiscard]] hal::Session& session() const;
  /// A participant of a test joins the machine's scheduler, behind those that are there; it has to leave before it ends.
  void add(rtapi::Participant& participant);
  void remove(rtapi::Participant& participant);
  /// Folder of this machine's copies of the INI file, tool table, programs.
  [[nodiscard]] const std::string& folder() const;

  /// Runs `body` in a copy of the machine at this very moment (a forked process) and gives how many test assertions failed in
  /// it, with their texts on stderr; a crash counts as one. The machine itself stays as it is.
  int branch(const std::function<void()>& body);

 private:
  struct Parts;
  static bool run_hal_steps(Parts& parts, const std::vector<launcher::HalStep>& steps,
                            const std::string& two_pass);
  Machine();
  std::unique_ptr<Parts> parts_;
};

}  // namespace kerf::harness
