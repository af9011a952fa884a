// Parameters of C modules (RTAPI_MP_INT and its kin), set from the words of loadrt.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// A parameter as a module declares it.
struct CParameter {
  std::string name, description;
  std::string type;          ///< "number" or "text"
  std::string default_text;  ///< of arrays ""
  unsigned elements{0};      ///< of an array; 0: it is none
};
std::vector<CParameter> c_parameters(void* library);

/// NAME=VALUE words; the module's variables are set before rtapi_app_main runs. Text of string parameters is kept in `texts`.
rtapi::Status set_c_parameters(void* library, std::span<const std::string> words,
                               std::vector<std::unique_ptr<char[]>>& texts);

}  // namespace kerf::hal
