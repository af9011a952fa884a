// PinBoard: pins by name, as plain numbers. The shell (HalPins, or a test) copies inputs in and outputs out.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace kerf::clients::halui {

enum class PinType : std::uint8_t { bit, s32, u32, real };

struct PinSpec {
  std::string name;  ///< behind "halui."
  PinType type{PinType::bit};
  bool input{true};
  double initial{0};
};

/// A pin's place on the board.
using Pin = std::size_t;

class PinBoard {
 public:
  Pin input(std::string name, PinType type, double initial = 0) {
    return add({std::move(name), type, true, initial});
  }
  Pin output(std::string name, PinType type) { return add({std::move(name), type, false, 0}); }

  [[nodiscard]] const std::vector<PinSpec>& pins() const noexcept { return pins_; }
  [[nodiscard]] double value(Pin pin) const noexcept { return now_[pin]; }
  [[nodiscard]] bool on(Pin pin) const noexcept { return now_[pin] != 0; }
  void set(Pin pin, double value) noexcept { now_[pin] = value; }
  /// It was off when the last look ended, and is on.
  [[nodiscard]] bool rose(Pin pin) const noexcept { return now_[pin] != 0 && before_[pin] == 0; }
  /// What it was when the last look ended.
  [[nodiscard]] double before(Pin pin) const noexcept { return before_[pin]; }
  /// The look at the inputs has ended.
  void remember() { before_ = now_; }

 private:
  Pin add(PinSpec spec) {
    now_.push_back(spec.initial);
    before_.push_back(spec.initial);
    pins_.push_back(std::move(spec));
    return pins_.size() - 1;
  }
  std::vector<PinSpec> pins_;
  std::vector<double> now_, before_;
};

}  // namespace kerf::clients::halui
