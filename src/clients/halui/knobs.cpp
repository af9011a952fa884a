#include "clients/halui/knobs.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::clients::halui {

Knob::Knob(PinBoard& board, const KnobRow& row, const std::string& prefix, int spindle)
    : row_(&row),
      spindle_(spindle),
      count_enable_(board.input(prefix + "count-enable", PinType::bit, 1)),
      counts_(board.input(prefix + "counts", PinType::s32)),
      decrease_(board.input(prefix + "decrease", PinType::bit)),
      direct_(board.input(prefix + "direct-value", PinType::bit)),
      increase_(board.input(prefix + "increase", PinType::bit)),
      scale_(board.input(prefix + "scale", PinType::real, row.scale)),
      value_(board.output(prefix + "value", PinType::real)) {
  if (row.has_reset) reset_ = board.input(prefix + "reset", PinType::bit);
}

double Knob::present(const Stat& stat, Port& port) {
  if (asked_id_ != 0 && port.outcome(asked_id_)) asked_id_ = 0;
  return asked_id_ != 0 ? asked_ : row_->value(stat, spindle_);
}

void Knob::ask(double value, Port& port) {
  if (!std::isfinite(value)) return;
  asked_ = std::max(value, 0.0);
  std::vector<std::string> words{row_->command, word(asked_)};
  if (spindle_ >= 0) words.push_back("spindle=" + std::to_string(spindle_));
  asked_id_ = port.send(words);
}

void Knob::look(const PinBoard& board, const Stat& stat, Port& port) {
  const double scale = board.value(scale_);
  const double turned = board.value(counts_) - board.before(counts_);
  double step = 0;
  if (board.rose(increase_)) step += scale;
  if (board.rose(decrease_)) step -= scale;
  const bool counts = turned != 0 && board.on(count_enable_);
  if (row_->has_reset && board.rose(reset_)) return ask(1, port);
  if (counts && board.on(direct_)) return ask(board.value(counts_) * scale, port);
  if (counts) step += turned * scale;
  if (step != 0) ask(present(stat, port) + step, port);
}

void Knob::show(PinBoard& board, const Stat& stat) const {
  board.set(value_, row_->value(stat, spindle_));
}

}  // namespace kerf::clients::halui
