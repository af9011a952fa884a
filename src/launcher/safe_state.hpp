// SafeState: the outputs that [SAFE_STATE]PIN declares, brought about by whoever is left. docs/safety.md
//
// Motion sets its own outputs (motion.digital-out-NN, motion.analog-out-NN) in the cycle in which the machine goes off. All others are
// set here: when the machine goes off, at its end, and when a process has died. Without the realtime process nothing drives a pin any
// more, so then every declared value is written, for the user components that read it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

/// One line of [SAFE_STATE]PIN.
struct SafePin {
  std::string name;
  std::string value;
  ini::Position at;
};

class SafeState {
 public:
  /// The segment must outlive it.
  SafeState(const rtapi::Segment& segment, std::vector<SafePin> pins);
  ~SafeState();
  SafeState(const SafeState&) = delete;
  SafeState& operator=(const SafeState&) = delete;

  [[nodiscard]] bool empty() const { return pins_.empty(); }
  /// After the HAL files: each name is there and takes its value. An error names the line of the INI file; `warnings`: pins that
  /// somebody else writes, a line each.
  rtapi::Status check(std::vector<std::string>& warnings) const;
  /// Writes the values. `host_lives`: motion's own and those that a component drives are left to these.
  void apply(bool host_lives) const;
  /// Takes the drives' enable away; motion then sets its own outputs in its next cycle.
  void disable() const;
  /// The drives are on; false without motion.
  [[nodiscard]] bool enabled() const;

  /// Watches for the machine going off: before each wait of the launcher, and behind it.
  void add_to(rtapi::WaitSpec& spec) const;
  void look();

 private:
  const rtapi::Segment& segment_;
  std::vector<SafePin> pins_;
  bool was_enabled_{false};
};

/// [SAFE_STATE]COMMAND, when the realtime process is dead: all at once, each for a second at most. Complaints, a line each.
[[nodiscard]] std::vector<std::string> run_safe_commands(
    const std::vector<std::vector<std::string>>& commands);

}  // namespace kerf::launcher
