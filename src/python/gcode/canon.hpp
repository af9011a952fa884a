// What a program does, as calls of a Python object: the canon of gcode.parse().
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "interp/interpreter.hpp"
#include "interp/null_canon.hpp"

namespace kerf::python {

namespace py = pybind11;

/// gcode.linecode: the modal state before a line.
struct LineCode {
  int sequence_number{0};
  std::array<int, 17> gcodes{};
  std::array<int, 10> mcodes{};
  double feed_rate{0}, speed{0};
};

/// Calls methods of a Python object; lengths in inches. A method that it does not have is left out. When one raises, nothing more
/// is called, and failed() has the exception.
class PythonCanon final : public interp::NullCanon {
 public:
  explicit PythonCanon(py::object target) : target_(std::move(target)) {}

  void use(const interp::Interpreter& interpreter) { interpreter_ = &interpreter; }
  [[nodiscard]] const std::exception_ptr& failed() const { return failed_; }
  [[nodiscard]] bool ended_by_percent() const { return percent_; }
  /// Asks for a value; nothing when there is no such method or attribute.
  [[nodiscard]] std::optional<py::object> ask(const char* name);
  [[nodiscard]] std::optional<py::object> ask(const char* name, int argument);
  /// Where the calls so far have led, program coordinates.
  [[nodiscard]] const rtapi::Pose& end() const { return end_; }
  [[nodiscard]] int selected_tool() const { return selected_; }
  void tool_changed(int slot) { call("change_tool", slot); }
  /// The calls of MDI lines belong to line 0.
  void begin_line(int line);

  // --- interp::Canon ---
  void next_block(const interp::SourceLine& source) override { begin_line(source.line); }
  void select_plane(interp::Plane plane) override;
  void set_g5x_offset(int system, const rtapi::Pose& offset) override;
  void set_g92_offset(const rtapi::Pose& offset) override;
  void set_xy_rotation(double degrees) override { call("set_xy_rotation", degrees); }
  void use_tool_length_offset(const rtapi::Pose& offset) override;
  void set_feed_rate(double linear_mm_min, double angular_deg_min) override;
  void set_feed_mode(int spindle, interp::FeedMode mode) override;
  void straight_traverse(const rtapi::Pose& end) override { straight("straight_traverse", end); }
  void straight_feed(const rtapi::Pose& end) override { straight("straight_feed", end); }
  void arc_feed(const interp::Arc& arc) override;
  void nurbs_feed(std::span<const interp::SplinePoint> points, int order) override;
  void straight_probe(const rtapi::Pose& end, interp::ProbeKind) override {
    straight("straight_probe", end);
  }
  void rigid_tap(const rtapi::Pose& end, double return_scale) override;
  void dwell(double seconds) override { call("dwell", seconds); }
  void select_tool(int number) override { selected_ = number; }
  void change_tool_number(int number) override { selected_ = number; }
  void finish() override { percent_ = true; }
  void user_mcode(int number, std::string_view, double p, double q) override {
    call("user_defined_function", number - 100, p, q);
  }
  void comment(std::string_view text) override { call("comment", std::string(text)); }
  void message(std::string_view text) override { call("message", std::string(text)); }

 private:
  /// The bound method, looked up once a name; empty when there is none.
  py::object& method(const char* name);
  void announce_line();
  void straight(const char* name, const rtapi::Pose& end);

  template <class... A>
  void call(const char* name, A&&... arguments) {
    if (failed_) return;
    try {
      announce_line();
      if (py::object& f = method(name)) f(std::forward<A>(arguments)...);
    } catch (...) {
      failed_ = std::current_exception();
    }
  }

  py::object target_;
  const interp::Interpreter* interpreter_{nullptr};
  std::map<std::string, py::object, std::less<>> methods_;
  LineCode before_;  ///< the state that the line under way found
  int line_{0}, announced_{-1};
  interp::Plane plane_{interp::Plane::xy};
  rtapi::Pose end_;
  int selected_{0};
  bool percent_{false};
  std::exception_ptr failed_;
};

/// gcode.arc_to_segments and gcode.calc_extents.
void add_extents(py::module_& m);

}  // namespace kerf::python
