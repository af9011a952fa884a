// HalPins: the pins of a PinBoard in HAL, as the user component `halui`.
#pragma once

#include <variant>
#include <vector>

#include "clients/halui/pin_board.hpp"
#include "hal/client/user_component.hpp"

namespace kerf::clients::halui {

class HalPins {
 public:
  /// Makes the component and its pins; status() tells how that went. Both must outlive it.
  HalPins(hal::Session& session, PinBoard& board);
  [[nodiscard]] const rtapi::Status& status() const { return status_; }

  void read_inputs();
  void write_outputs();

 private:
  template <class T>
  using In = hal::LinkIn<T>;
  template <class T>
  using Out = hal::LinkOut<T>;
  using Link = std::variant<In<bool>, In<std::int32_t>, In<std::uint32_t>, In<double>, Out<bool>,
                            Out<std::int32_t>, Out<std::uint32_t>, Out<double>>;
  template <class T>
  Link make(const PinSpec& spec);

  PinBoard& board_;
  hal::UserComponent component_;
  std::vector<Link> links_;
  rtapi::Status status_;
};

}  // namespace kerf::clients::halui
