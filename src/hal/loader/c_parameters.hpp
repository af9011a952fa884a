// Parameters of C modules (RTAPI_MP_INT and its kin), set from the words of loadrt.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// NAME=VALUE words; the module's variables are set before rtapi_app_main runs. Text of string parameters is kept in `texts`.
rtapi::Status set_c_parameters(void* library, std::span<const std::string> words,
                               std::vector<std::unique_ptr<char[]>>& texts);

}  // namespace kerf::hal
