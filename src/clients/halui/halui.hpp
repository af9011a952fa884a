// Halui: operator's panel of HAL pins (manual: "HAL User Interface", halui(1)). Pure: the machine is a Stat, commands go to
// a Port, pins stand on a PinBoard; the shells are HalPins and HaluiParticipant.
//
//   Halui halui(layout, port);
//   ... make a HAL pin for each of halui.board().pins() ...
//   each time: copy the inputs to the board; halui.update(stat, now); copy the outputs from it
//
// Which pins there are, and what a pressed button or a state means, are the tables in tables.cpp. A button acts when its pin
// rises. What is on already when halui begins to look does nothing until it has been off: switching the machine on starts nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/common/stat.hpp"
#include "clients/halui/jogs.hpp"
#include "clients/halui/knobs.hpp"
#include "clients/halui/mdi_buttons.hpp"
#include "clients/halui/pin_board.hpp"
#include "clients/halui/port.hpp"

namespace kerf::clients::halui {

/// What decides which pins there are; from the INI file.
struct Layout {
  int joints{0};
  int spindles{1};
  std::uint32_t axis_mask{0};               ///< bit i: axis i of XYZABCUVW
  bool home_all{false};                     ///< some joint has a HOME_SEQUENCE
  std::vector<std::string> mdi_commands{};  ///< [HALUI]MDI_COMMAND
};

class Halui {
 public:
  /// `port` must outlive it.
  Halui(const Layout& layout, Port& port);

  [[nodiscard]] PinBoard& board() noexcept { return board_; }
  /// One look: acts on the inputs that changed since the last one and sets the outputs. `now`: any clock, in nanoseconds.
  void update(const Stat& stat, std::int64_t now);

 private:
  friend struct Tables;
  /// What a state is computed from.
  struct Scene {
    const Stat& stat;
    const Halui& halui;
  };
  using Press = void (Halui::*)(int);
  struct Button {
    Pin pin;
    Press press;
    int index;  ///< joint, axis, spindle or number; kSelected: the selected joint
  };
  struct State {
    Pin pin;
    double (*value)(const Scene&, int index);
    int index;
  };
  static constexpr int kSelected = -1;

  void make_pins();
  void add_joint_pins(const std::string& prefix, int index);
  [[nodiscard]] int joint(int index) const noexcept {
    return index == kSelected ? selected_joint_ : index;
  }
  [[nodiscard]] bool on() const noexcept;

  // Buttons.
  void abort(int);
  void estop_activate(int);
  void estop_reset(int);
  void machine_on(int);
  void machine_off(int);
  void flood_on(int);
  void flood_off(int);
  void mist_on(int);
  void mist_off(int);
  void mode_manual(int);
  void mode_auto(int);
  void mode_mdi(int);
  void mode_joint(int);
  void mode_teleop(int);
  void program_run(int);
  void program_pause(int);
  void program_resume(int);
  void program_step(int);
  void block_delete_on(int);
  void block_delete_off(int);
  void optional_stop_on(int);
  void optional_stop_off(int);
  void prompt_ok(int);
  void home_all(int);
  void joint_home(int index);
  void joint_unhome(int index);
  void joint_select(int index);
  void axis_select(int index);
  void spindle_start(int spindle);
  void spindle_forward(int spindle);
  void spindle_reverse(int spindle);
  void spindle_stop(int spindle);
  void spindle_increase(int spindle);
  void spindle_decrease(int spindle);
  void brake_on(int spindle);
  void brake_off(int spindle);

  void go_manual(bool teleop);
  void turn_spindle(int spindle, const char* way);

  Layout layout_;
  Port& port_;
  PinBoard board_;
  std::vector<Button> buttons_;
  std::vector<State> states_;
  std::vector<Knob> knobs_;
  MdiButtons mdi_;
  Jogs jogs_;
  std::int64_t keep_at_{0};    ///< when the jogs' lease is held next
  const Stat* stat_{nullptr};  ///< of the look in progress
  int selected_joint_{0};
  int selected_axis_{0};
  bool looked_{false};
};

}  // namespace kerf::clients::halui
