#include "clients/halui/mdi_buttons.hpp"

#include <algorithm>

#include "clients/halui/modes.hpp"

namespace kerf::clients::halui {
namespace {
std::string button_name(std::size_t n) {
  return std::string("mdi-command-") + (n < 10 ? "0" : "") + std::to_string(n);
}
}  // namespace

MdiButtons::MdiButtons(PinBoard& board, std::vector<std::string> lines)
    : lines_(std::move(lines)), running_pin_(board.output("halui-mdi-is-running", PinType::bit)) {
  lines_.resize(std::min(lines_.size(), kMost));
  for (std::size_t n = 0; n < lines_.size(); ++n)
    buttons_.push_back(board.input(button_name(n), PinType::bit));
}

void MdiButtons::press(std::size_t n, const Stat& stat, Port& port) {
  if (stat.task_mode == kModeAuto && stat.interp_state != kInterpIdle)
    return port.complain("halui." + button_name(n) + ": a program runs; '" + lines_[n] +
                         "' is not executed");
  if (const auto id = port.send({"mdi", lines_[n], "and-back=on"}); id != 0) running_.push_back(id);
}

void MdiButtons::look(const PinBoard& board, const Stat& stat, Port& port) {
  for (std::size_t n = 0; n < buttons_.size(); ++n)
    if (board.rose(buttons_[n])) press(n, stat, port);
  std::erase_if(running_, [&port](std::uint64_t id) { return port.outcome(id).has_value(); });
}

void MdiButtons::show(PinBoard& board) const { board.set(running_pin_, running_.empty() ? 0 : 1); }

}  // namespace kerf::clients::halui
