#include "python/hal/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace kerf::python {

using rtapi::Errc;

PyObject* hal_error = nullptr;

namespace {
constexpr int kErrorLevel = 1;  // hal.MSG_ERR
int level = kErrorLevel;        // under the GIL
}  // namespace

void raise(PyObject* type, const std::string& text) {
  PyErr_SetString(type, text.c_str());
  throw py::error_already_set();
}

int message_level() noexcept { return level; }
void set_message_level(int new_level) noexcept { level = new_level; }

void say_error(const std::string& text) {
  if (level >= kErrorLevel) std::fprintf(stderr, "HAL: ERROR: %s\n", text.c_str());
}

int errno_of(const rtapi::Error& error) {
  switch (error.code) {
    case Errc::no_memory: return ENOMEM;
    case Errc::permission: return EPERM;
    case Errc::busy: return error.what.view().starts_with("HAL is locked") ? EPERM : EINVAL;
    case Errc::system:
    case Errc::protocol:
    case Errc::internal: return EIO;
    case Errc::dead:
    case Errc::cancelled: return ENOTCONN;
    default: return EINVAL;  // bad arguments, unknown and duplicate names, wrong types
  }
}

void raise_hal_error(const rtapi::Error& error) {
  if (error.code == Errc::dead) raise(hal_error, error.message());
  say_error(error.message());
  raise(hal_error, std::strerror(errno_of(error)));
}

void raise_os_error(int number) {
  errno = number;
  PyErr_SetFromErrno(PyExc_OSError);
  throw py::error_already_set();
}

void raise_os_error(const rtapi::Error& error) {
  say_error(error.message());
  raise_os_error(errno_of(error));
}

}  // namespace kerf::python
