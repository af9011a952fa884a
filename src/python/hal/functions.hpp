// The functions of the module hal that concern all of HAL: look at anything, change signals, links and values.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf::python {

void add_functions(pybind11::module_& m);
/// What hal/query.py is made of: everything about one object as a dict, or None.
void add_queries(pybind11::module_& m);

}  // namespace kerf::python
