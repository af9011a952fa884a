// Jogs: the jog pins of joints and axes. Speeds of HAL are machine units a minute, as in LinuxCNC.
//
// A held button or a deflected stick is a wanted velocity; whenever it changes, the jog is asked for anew or stopped. What
// task refused or ended is not asked for again while the button stays as it is.
#pragma once

#include <string>
#include <vector>

#include "clients/common/stat.hpp"
#include "clients/halui/pin_board.hpp"
#include "clients/halui/port.hpp"

namespace kerf::clients::halui {

/// Joints, or axes: one group of pins for each and one for the selected.
class JogGroup {
 public:
  /// `prefix`: "joint." or "axis."; a name ("0", "x") for each index that exists.
  struct Item {
    int index;
    std::string name;
  };
  JogGroup(PinBoard& board, const std::string& prefix, const std::vector<Item>& items,
           int motion_mode);
  void look(const PinBoard& board, const Stat& stat, Port& port, int selected);
  /// A jog without end was asked for.
  [[nodiscard]] bool runs() const noexcept { return runs_; }

 private:
  struct Buttons {
    Pin minus, plus, increment, increment_minus, increment_plus;
  };
  struct One {
    int index;
    std::string name;
    Buttons buttons;
    Pin analog;
    double wanted{0};  ///< of the last look
    bool runs{false};  ///< a jog without end was asked for
  };
  static Buttons add_buttons(PinBoard& board, const std::string& prefix);
  [[nodiscard]] double wanted(const PinBoard& board, const One& one, bool selected) const;
  void step(const PinBoard& board, const Buttons& buttons, const One& one, Port& port) const;
  [[nodiscard]] double speed_a_second(const PinBoard& board) const;

  int motion_mode_;  ///< in which these jogs are possible
  Pin speed_, deadband_;
  Buttons selected_;
  int last_selected_{0};
  /// False after another one was selected with a button held: what is selected begins to move by a press only.
  bool selected_armed_{true};
  bool runs_{false};
  std::vector<One> items_;
};

struct Jogs {
  JogGroup joints;
  JogGroup axes;
};

}  // namespace kerf::clients::halui
