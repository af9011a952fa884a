// Knob: a value that buttons, counts of an encoder or a direct value set: overrides and the maximum velocity.
//
//   .increase .decrease   a rising edge adds or takes `scale`
//   .counts               while count-enable: each count is worth `scale`; with direct-value, counts * scale is the value itself
//   .reset                1, where there is such a pin
#pragma once

#include <string>

#include "clients/common/stat.hpp"
#include "clients/halui/pin_board.hpp"
#include "clients/halui/port.hpp"

namespace kerf::clients::halui {

/// What is different between knobs.
struct KnobRow {
  const char* command;  ///< of task; takes value=
  double scale;         ///< initial value of the pin
  bool has_reset;
  double (*value)(const Stat&, int index);
};

class Knob {
 public:
  /// `prefix`: "feed-override."; `spindle` below 0: the command takes none.
  Knob(PinBoard& board, const KnobRow& row, const std::string& prefix, int spindle);
  void look(const PinBoard& board, const Stat& stat, Port& port);
  void show(PinBoard& board, const Stat& stat) const;

 private:
  [[nodiscard]] double present(const Stat& stat, Port& port);
  void ask(double value, Port& port);

  const KnobRow* row_;
  int spindle_;
  Pin count_enable_, counts_, decrease_, direct_, increase_, reset_{0}, scale_, value_;
  /// The last value asked for, while the status does not show it yet: two turns in a row add up.
  double asked_{0};
  std::uint64_t asked_id_{0};
};

}  // namespace kerf::clients::halui
