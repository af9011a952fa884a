// MdiButtons: halui.mdi-command-NN. A press executes its line in MDI mode; when all that was pressed is done, the mode that was
// there before comes back.
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
  void look(const PinBoard& board, const Stat& stat, Port& port, std::int64_t now);
  void show(PinBoard& board) const;

 private:
  void press(std::size_t n, const Stat& stat, Port& port);
  void go_back(const Stat& stat, Port& port, std::int64_t now);

  std::vector<std::string> lines_;
  std::vector<Pin> buttons_;
  Pin running_pin_;
  std::vector<std::uint64_t> running_;  ///< commands that have not ended
  int back_to_mode_{0};                 ///< 0: nowhere
  bool back_to_joints_{false};
  std::uint64_t going_back_{0};  ///< the command that does it
  std::int64_t give_up_{0}, retry_at_{0};
};

}  // namespace kerf::clients::halui
