#include "clients/halui/mdi_buttons.hpp"

#include <algorithm>

#include "clients/halui/modes.hpp"

namespace kerf::clients::halui {
namespace {
/// So long the machine may need to come to rest after a line in error.
constexpr std::int64_t kPatienceNs = 2'000'000'000;
/// Between two tries to go back. Each that fails is a line for the operator, and an answer wakes halui at once.
constexpr std::int64_t kRetryNs = 200'000'000;

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
  const bool ours = !running_.empty() || back_to_mode_ != 0;
  if (stat.interp_state != kInterpIdle && !ours)
    return port.complain("halui." + button_name(n) + ": a program runs; '" + lines_[n] +
                         "' is not executed");
  if (!ours) {
    back_to_mode_ = stat.task_mode;
    back_to_joints_ = stat.task_mode == kModeManual && stat.motion_mode == kMotionFree;
    if (stat.task_mode != kModeMdi) (void)port.send({"mode", "mdi"});
  }
  going_back_ = 0;
  if (const auto id = port.send({"mdi", lines_[n]}); id != 0) running_.push_back(id);
}

void MdiButtons::look(const PinBoard& board, const Stat& stat, Port& port, std::int64_t now) {
  for (std::size_t n = 0; n < buttons_.size(); ++n)
    if (board.rose(buttons_[n])) press(n, stat, port);
  const bool were = !running_.empty();
  std::erase_if(running_, [&port](std::uint64_t id) { return port.outcome(id).has_value(); });
  if (!running_.empty() || back_to_mode_ == 0) return;
  if (were) give_up_ = now + kPatienceNs, retry_at_ = now;
  go_back(stat, port, now);
}

void MdiButtons::go_back(const Stat& stat, Port& port, std::int64_t now) {
  if (going_back_ != 0) {
    const auto reply = port.outcome(going_back_);
    if (!reply) return;
    going_back_ = 0;
    if (reply->state == task::CommandState::done) {
      if (back_to_joints_) (void)port.send({"teleop", "off"});
      back_to_mode_ = 0;
      return;
    }
  }
  // Somebody else has chosen a mode meanwhile, or the machine does not come to rest: it stays as it is.
  if ((stat.task_mode != kModeMdi && stat.task_mode != back_to_mode_) || now > give_up_ ||
      back_to_mode_ == kModeMdi) {
    back_to_mode_ = 0;
    return;
  }
  // Behind an abort the interpreter is idle before the machine stands: task changes no mode until then.
  if (stat.interp_state != kInterpIdle || stat.state == RcsState::exec || now < retry_at_) return;
  retry_at_ = now + kRetryNs;
  going_back_ = port.send({"mode", mode_word(back_to_mode_)});
}

void MdiButtons::show(PinBoard& board) const { board.set(running_pin_, running_.empty() ? 0 : 1); }

}  // namespace kerf::clients::halui
