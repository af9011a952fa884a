#include "task/older_pin_names.hpp"

#include <string>

namespace kerf::task {
namespace {

/// In 2.7 there is one spindle, and its pins are motion's: motion.spindle-on is spindle.0.on.
constexpr const char* kSpindlePins[] = {
    "at-speed",  "brake",         "forward",       "index-enable",
    "inhibit",   "is-oriented",   "locked",        "on",
    "orient",    "orient-angle",  "orient-fault",  "orient-mode",
    "reverse",   "revs",          "speed-cmd-rps", "speed-in",
    "speed-out", "speed-out-abs", "speed-out-rps", "speed-out-rps-abs"};

}  // namespace

rtapi::Status ask_for_older_pin_names(hal::Session& session, interp::Compat compat) {
  if (compat != interp::Compat::v2_7) return {};
  for (const char* pin : kSpindlePins) {
    const auto asked = hal::ask(session, {"alias-later", std::string("spindle.0.") + pin,
                                          std::string("motion.spindle-") + pin});
    if (!asked.ok()) return rtapi::Failure{asked.error()};
  }
  return {};
}

}  // namespace kerf::task
