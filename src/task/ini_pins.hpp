// Where the command thread reads the ini.* pins; an interface, so that it is tested without HAL.
#pragma once

#include <vector>

namespace kerf::task {

class IniPins {
 public:
  virtual ~IniPins() = default;
  /// The present value of each pin, in the order of LiveConfig::pins().
  virtual const std::vector<double>& read() = 0;
};

}  // namespace kerf::task
