// A picture of HAL, as text for graphviz's `dot`: boxes with pins, signals between them, functions coloured by their thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/core/view.hpp"

namespace kerf::hal {

struct GraphOptions {
  /// Of boxes ("and2.0", "joint.0"), pins or signals, as `show` takes them; empty: all. What is linked to a match is drawn too.
  std::vector<std::string> patterns;
  bool values{false};    ///< write values at pins and signals
  bool all_pins{false};  ///< pins that are not linked too
};

/// A pin of which only the name is known: its program is not there (`--from FILE.hal`).
struct StrangePin {
  std::string name;
  std::string signal;
  Dir dir{Dir::unspecified};  ///< as arrows say
};

/// The same HAL gives the same text.
std::string graph_dot(const View& view, const GraphOptions& options,
                      std::span<const StrangePin> strangers = {});

/// Box that a pin is drawn in: its name's words up to the last number ("joint.0", "hm2_7i96.0.stepgen.00") or, if that is longer, the
/// instance that one of its component's functions is named after.
std::string box_of(std::string_view pin, std::span<const std::string> functions);

}  // namespace kerf::hal
