// The components under test.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hal/component.hpp"

namespace kerf::components {

/// By the name that loadrt takes (dashes and underscores are the same to it). Throws std::logic_error for an unknown one.
const hal::Module& module(std::string_view name);
const std::vector<const hal::Module*>& all_modules();

/// What the loader calls the first instance: "sim-home-switch.0", or the bare name of a singleton.
std::string first_prefix(const hal::Module& module);

}  // namespace kerf::components
