// The parts of the compiled half of the Python module linuxcnc; linuxcnc/__init__.py is the other.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "clients/common/machine_view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::python {

namespace py = pybind11;

/// The exception linuxcnc.error; set once, when the module is made.
extern PyObject* linuxcnc_error;
[[noreturn]] void throw_error(const std::string& text);

/// The machine of KERF_INSTANCE as a stat object sees it. Attached at need, and anew when another machine has started.
class LiveView {
 public:
  /// Takes a new copy; an error when no machine runs.
  rtapi::Status poll();
  [[nodiscard]] const clients::Stat& stat() const {
    static const clients::Stat nothing;
    return view_ ? view_->stat() : nothing;
  }
  /// Null before the first poll().
  [[nodiscard]] const clients::MachineView* view() const { return view_.get(); }

 private:
  std::unique_ptr<clients::MachineView> view_;
};

/// A linuxcnc.stat
struct StatObject {
  LiveView live;
  [[nodiscard]] const clients::Stat& stat() const { return live.stat(); }
};

void add_stat(py::module_& m);
void add_command(py::module_& m);
void add_error_channel(py::module_& m);
void add_logger(py::module_& m);
void add_ini(py::module_& m);
void add_geometry(py::module_& m);

}  // namespace kerf::python
