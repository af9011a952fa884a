// The compiled half of the Python module hal; hal/__init__.py is the other.
#include <pybind11/pybind11.h>

#include "hal/stream.hpp"
#include "python/hal/component.hpp"
#include "python/hal/errors.hpp"
#include "python/hal/functions.hpp"
#include "python/hal/link.hpp"
#include "python/hal/stream.hpp"

namespace kerf::python {

PYBIND11_MODULE(_hal, m) {
  m.doc() = "Compiled half of the module hal.";
  hal_error = PyErr_NewException("hal.error", PyExc_Exception, nullptr);
  if (hal_error == nullptr) throw py::error_already_set();
  m.attr("error") = py::reinterpret_borrow<py::object>(hal_error);
  Link::watch_forks();
  add_component(m);
  add_stream(m);
  add_shared_memory(m);
  add_functions(m);
  add_queries(m);
  m.attr("sampler_base") = hal::kSamplerKey;
  m.attr("streamer_base") = hal::kStreamerKey;
  m.def("_end", &Link::end, "Leaves HAL with all components of this process.");
}

}  // namespace kerf::python
