// Which parameters of a component take a list, as it declares them: the realtime host opens the component and looks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/client/session.hpp"

namespace kerf::hal {

/// Nothing when there is no such component or no host to ask.
std::optional<std::vector<std::string>> list_parameters(Session& session,
                                                        const std::string& component);

}  // namespace kerf::hal
