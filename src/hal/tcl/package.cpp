// The Tcl package Hal, for tclsh and wish: `package require Hal`.
#include <signal.h>

#include "hal/tcl/connection.hpp"
#include "hal/tcl/tcl_hal.hpp"

namespace {

/// Lives as long as its interpreter.
struct Package {
  kerf::hal::tcl::Connection connection{false};
  kerf::hal::tcl::TclHal words{[this] { return connection.attach(); }};
};

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): Tcl calls it by this name
extern "C" __attribute__((visibility("default"))) int Hal_Init(Tcl_Interp* interpreter) {
  if (Tcl_PkgRequire(interpreter, "Tcl", "8.6", 0) == nullptr) return TCL_ERROR;
  ::signal(SIGPIPE, SIG_IGN);
  auto* package = new Package;
  package->words.install(interpreter);
  Tcl_CallWhenDeleted(
      interpreter, [](void* data, Tcl_Interp*) { delete static_cast<Package*>(data); }, package);
  return Tcl_PkgProvide(interpreter, "Hal", "1.0");
}
