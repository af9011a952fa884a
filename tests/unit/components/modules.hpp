// The components under test, by the name that loadrt takes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hal/component.hpp"

namespace kerf::components {

/// Throws std::logic_error for a name that no component has.
const hal::Module& module(std::string_view name);
const std::vector<const hal::Module*>& all_modules();

/// What the loader calls the first instance: "sim-home-switch.0", or the bare name of a singleton.
std::string first_prefix(const hal::Module& module);

}  // namespace kerf::components
