#include "task/hal_ini_pins.hpp"

namespace kerf::task {

HalIniPins::HalIniPins(hal::Session& session, const std::vector<IniPin>& pins)
    : component_(session, "inihal"), values_(pins.size()) {
  pins_.reserve(pins.size());
  for (const IniPin& pin : pins) {
    switch (pin.type) {
      case IniPin::Type::real:
        pins_.emplace_back(component_.pin<hal::LinkIn<double>>(pin.name, pin.initial, true));
        break;
      case IniPin::Type::integer:
        pins_.emplace_back(component_.pin<hal::LinkIn<std::int32_t>>(
            pin.name, static_cast<std::int32_t>(pin.initial), true));
        break;
      case IniPin::Type::flag:
        pins_.emplace_back(component_.pin<hal::LinkIn<bool>>(pin.name, pin.initial != 0, true));
        break;
    }
  }
  status_ = component_.ready();
}

const std::vector<double>& HalIniPins::read() {
  for (std::size_t i = 0; i < pins_.size(); ++i)
    values_[i] =
        std::visit([](const auto& pin) { return static_cast<double>(pin.get()); }, pins_[i]);
  return values_;
}

}  // namespace kerf::task
