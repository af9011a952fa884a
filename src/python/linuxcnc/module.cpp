// The compiled half of the Python module linuxcnc.
#include "python/linuxcnc/module.hpp"

#include "rtapi/shm/process.hpp"

namespace kerf::python {

PyObject* linuxcnc_error = nullptr;

void throw_error(const std::string& text) {
  PyErr_SetString(linuxcnc_error, text.c_str());
  throw py::error_already_set();
}

namespace {

/// False when task has ended, in whatever way; the copy of its segment stays readable for ever.
bool lives(const clients::MachineView& view) {
  if (view.task_shared().ready.observe() == 0) return false;
  // A zombie that nobody fetches (in a container, say) is as dead as one that is gone.
  return view.task().pid <= 0 || rtapi::process_lives(view.task().pid, 0);
}

}  // namespace

rtapi::Status LiveView::poll() {
  if (view_ && view_->poll() && lives(*view_)) return {};
  view_.reset();
  auto view = clients::MachineView::attach(rtapi::default_instance());
  if (!view.ok()) return rtapi::Failure{view.error()};
  if (!lives(**view))
    return rtapi::fail(rtapi::Errc::dead,
                       "milltask of instance '" + (*view)->segment().instance() + "' has ended");
  view_ = std::move(*view);
  return {};
}

PYBIND11_MODULE(_linuxcnc, m) {
  m.doc() = "Compiled half of the module linuxcnc.";
  linuxcnc_error = PyErr_NewException("linuxcnc.error", PyExc_Exception, nullptr);
  if (linuxcnc_error == nullptr) throw py::error_already_set();
  m.attr("error") = py::reinterpret_borrow<py::object>(linuxcnc_error);
  m.attr("version") = KERF_VERSION;
  add_stat(m);
  add_command(m);
  add_error_channel(m);
  add_logger(m);
  add_ini(m);
  add_geometry(m);
}

}  // namespace kerf::python
