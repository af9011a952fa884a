// How failures become Python exceptions. No C++ exception leaves the module but through pybind11, which turns it into one.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "rtapi/base/result.hpp"

namespace kerf::python {

namespace py = pybind11;

/// hal.error; made by the module's initialisation, never given back.
extern PyObject* hal_error;

[[noreturn]] void raise(PyObject* type, const std::string& text);

/// What is printed on stderr: a number of hal.MSG_*.
int message_level() noexcept;
void set_message_level(int level) noexcept;
/// "HAL: ERROR: text" on stderr, unless the message level is MSG_NONE.
void say_error(const std::string& text);

/// The errno that the published C API returns for such an error.
int errno_of(const rtapi::Error& error);
/// Says the error's text on stderr and raises hal.error with the errno's meaning, which is all that scripts may compare with.
/// Without a running HAL the text itself is raised.
[[noreturn]] void raise_hal_error(const rtapi::Error& error);
/// The same as an OSError with number and meaning.
[[noreturn]] void raise_os_error(const rtapi::Error& error);
[[noreturn]] void raise_os_error(int number);

}  // namespace kerf::python
