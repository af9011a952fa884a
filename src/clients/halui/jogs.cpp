#include "clients/halui/jogs.hpp"

#include <cmath>

#include "clients/halui/modes.hpp"

namespace kerf::clients::halui {
namespace {
constexpr double kDeadband = 0.2;          ///< initial value of the pins
constexpr const char* kLease = "lease=1";  ///< should this program hang, its jogs stop
}  // namespace

JogGroup::Buttons JogGroup::add_buttons(PinBoard& board, const std::string& prefix) {
  return {board.input(prefix + "minus", PinType::bit), board.input(prefix + "plus", PinType::bit),
          board.input(prefix + "increment", PinType::real),
          board.input(prefix + "increment-minus", PinType::bit),
          board.input(prefix + "increment-plus", PinType::bit)};
}

JogGroup::JogGroup(PinBoard& board, const std::string& prefix, const std::vector<Item>& items,
                   int motion_mode)
    : motion_mode_(motion_mode),
      speed_(board.input(prefix + "jog-speed", PinType::real)),
      deadband_(board.input(prefix + "jog-deadband", PinType::real, kDeadband)),
      selected_(add_buttons(board, prefix + "selected.")) {
  for (const Item& item : items) {
    const std::string own = prefix + item.name + ".";
    const Buttons buttons = add_buttons(board, own);
    items_.push_back({item.index, item.name, buttons, board.input(own + "analog", PinType::real)});
  }
}

double JogGroup::speed_a_second(const PinBoard& board) const {
  const double speed = board.value(speed_) / 60;
  return std::isfinite(speed) ? speed : 0;
}

double JogGroup::wanted(const PinBoard& board, const One& one, bool selected) const {
  const auto sign = [&board](const Buttons& b) {
    return (board.on(b.plus) ? 1.0 : 0.0) - (board.on(b.minus) ? 1.0 : 0.0);
  };
  double factor = sign(one.buttons);
  if (factor == 0 && selected) factor = sign(selected_);
  const double stick = board.value(one.analog);
  // NaN is no deflection.
  if (factor == 0 && std::fabs(stick) > std::fabs(board.value(deadband_)) && std::isfinite(stick))
    factor = stick;
  return factor * speed_a_second(board);
}

void JogGroup::step(const PinBoard& board, const Buttons& buttons, const One& one,
                    Port& port) const {
  const int way =
      (board.rose(buttons.increment_plus) ? 1 : 0) - (board.rose(buttons.increment_minus) ? 1 : 0);
  const double distance = board.value(buttons.increment), speed = speed_a_second(board);
  if (way == 0 || !std::isfinite(distance) || distance == 0 || speed == 0) return;
  (void)port.send(
      {"jog", one.name, word(std::fabs(speed)), "distance=" + word(way * distance), "in-mode=on"});
}

void JogGroup::look(const PinBoard& board, const Stat& stat, Port& port, int selected) {
  const bool possible = stat.task_state == kStateOn && stat.task_mode == kModeManual &&
                        stat.motion_mode == motion_mode_;
  const bool held = board.on(selected_.plus) || board.on(selected_.minus);
  if (!held)
    selected_armed_ = true;
  else if (selected != last_selected_)
    selected_armed_ = false;
  last_selected_ = selected;
  runs_ = false;
  for (One& one : items_) {
    const bool chosen = one.index == selected;
    const double now = wanted(board, one, chosen && selected_armed_);
    const bool news = now != one.wanted;
    one.wanted = now;
    if (news && one.runs && now == 0) {
      (void)port.send({"jog-stop", one.name});
      one.runs = false;
    } else if (news && now != 0 && possible) {
      one.runs = port.send({"jog", one.name, word(now), kLease, "in-mode=on"}) != 0;
    }
    runs_ = runs_ || one.runs;
    if (!possible) continue;
    step(board, one.buttons, one, port);
    if (chosen) step(board, selected_, one, port);
  }
}

}  // namespace kerf::clients::halui
