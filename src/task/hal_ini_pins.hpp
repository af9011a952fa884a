// The ini.* pins in HAL: the user component inihal.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "hal/client/user_component.hpp"
#include "task/ini_pins.hpp"
#include "task/live_config.hpp"

namespace kerf::task {

class HalIniPins final : public IniPins {
 public:
  /// Makes the component and its pins; status() tells how that went. `session` must outlive it.
  HalIniPins(hal::Session& session, const std::vector<IniPin>& pins);
  [[nodiscard]] const rtapi::Status& status() const { return status_; }
  const std::vector<double>& read() override;

 private:
  using Pin = std::variant<hal::LinkIn<double>, hal::LinkIn<std::int32_t>, hal::LinkIn<bool>>;
  hal::UserComponent component_;
  std::vector<Pin> pins_;
  std::vector<double> values_;
  rtapi::Status status_;
};

}  // namespace kerf::task
