// MdiButtons: halui.mdi-command-NN. A press executes its line in MDI mode; when nothing runs any more, task brings back the mode
// that was there before.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/common/stat.hpp"
#include "clients/halui/pin_board.hpp"
#include "clients/halui/port.hpp"

namespace kerf::clients::halui {

class MdiButtons {
 public:
  static constexpr std::size_t kMost = 64;  ///< as documented

  MdiButtons(PinBoard& board, std::vector<std::string> lines);
  void look(const PinBoard& board, const Stat& stat, Port& port);
  void show(PinBoard& board) const;

 private:
  void press(std::size_t n, const Stat& stat, Port& port);

  std::vector<std::string> lines_;
  std::vector<Pin> buttons_;
  Pin running_pin_;
  std::vector<std::uint64_t> running_;  ///< commands that have not ended
};

}  // namespace kerf::clients::halui
