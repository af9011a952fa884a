// hal.stream and hal.shm: memory that this process shares with other components.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf::python {

void add_stream(pybind11::module_& m);
void add_shared_memory(pybind11::module_& m);

}  // namespace kerf::python
