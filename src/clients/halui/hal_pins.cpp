#include "clients/halui/hal_pins.hpp"

#include <type_traits>

namespace kerf::clients::halui {

template <class T>
HalPins::Link HalPins::make(const PinSpec& spec) {
  const T initial = static_cast<T>(spec.initial);
  if (spec.input) return component_.pin<In<T>>(spec.name, initial);
  return component_.pin<Out<T>>(spec.name, initial);
}

HalPins::HalPins(hal::Session& session, PinBoard& board)
    : board_(board), component_(session, "halui") {
  for (const PinSpec& spec : board_.pins()) {
    switch (spec.type) {
      case PinType::bit: links_.push_back(make<bool>(spec)); break;
      case PinType::s32: links_.push_back(make<std::int32_t>(spec)); break;
      case PinType::u32: links_.push_back(make<std::uint32_t>(spec)); break;
      case PinType::real: links_.push_back(make<double>(spec)); break;
    }
  }
  status_ = component_.ready();
}

void HalPins::read_inputs() {
  for (Pin pin = 0; pin < links_.size(); ++pin)
    std::visit(
        [this, pin](const auto& link) {
          using L = std::decay_t<decltype(link)>;
          if constexpr (L::kDir == hal::Dir::in) board_.set(pin, static_cast<double>(link.get()));
        },
        links_[pin]);
}

void HalPins::write_outputs() {
  for (Pin pin = 0; pin < links_.size(); ++pin)
    std::visit(
        [this, pin](auto& link) {
          using L = std::decay_t<decltype(link)>;
          if constexpr (L::kDir == hal::Dir::out)
            link = static_cast<typename L::Item>(board_.value(pin));
        },
        links_[pin]);
}

}  // namespace kerf::clients::halui
