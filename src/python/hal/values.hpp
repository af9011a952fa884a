// HAL values as Python objects and back.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "hal/core/port.hpp"
#include "hal/core/types.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::python {

namespace py = pybind11;

/// bool, float or int; of a port its size in bytes.
py::object to_python(hal::Type type, std::uint64_t raw, const rtapi::Segment& segment);
/// The queue of a port's value; not valid() when it has none, or when the value is nonsense.
hal::Port port_at(std::uint64_t raw, const rtapi::Segment& segment);
/// Raises what float(), int() and bool() raise, and OverflowError for what does not fit. Not for ports.
std::uint64_t from_python(hal::Type type, py::handle value);
/// As setp and sets take it.
std::string value_words(py::handle value);

/// unspecified for a number that is no HAL type.
hal::Type type_from_number(int number);
const char* type_label(hal::Type type);
const char* dir_label(hal::Dir dir);

}  // namespace kerf::python
