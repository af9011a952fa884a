#include "python/gcode/canon.hpp"

#include <algorithm>
#include <cmath>

#include "interp/nurbs.hpp"

namespace kerf::python {
namespace {

constexpr double kInch = 25.4;

/// Inches and degrees.
rtapi::Pose inches(rtapi::Pose p) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (!rtapi::is_rotary(i)) p[i] /= kInch;
  return p;
}

LineCode state_of(const interp::ModalState& modal) {
  LineCode code;
  const auto g = modal.active_g_codes();
  const auto m = modal.active_m_codes();
  std::copy(g.begin(), g.end(), code.gcodes.begin());
  std::copy(m.begin(), m.end(), code.mcodes.begin());
  code.feed_rate = modal.feed_word;
  code.speed = modal.speed_rpm[0];
  return code;
}

}  // namespace

py::object& PythonCanon::method(const char* name) {
  auto at = methods_.find(name);
  if (at == methods_.end())
    at = methods_.emplace(name, py::getattr(target_, name, py::object())).first;
  return at->second;
}

std::optional<py::object> PythonCanon::ask(const char* name) {
  py::object& f = method(name);
  if (!f) return std::nullopt;
  return f();
}

std::optional<py::object> PythonCanon::ask(const char* name, int argument) {
  py::object& f = method(name);
  if (!f) return std::nullopt;
  return f(argument);
}

void PythonCanon::begin_line(int line) { line_ = line; }

void PythonCanon::announce_line() {
  if (line_ == announced_) return;
  announced_ = line_;
  before_.sequence_number = line_;
  if (py::object& f = method("next_line")) f(before_);
  // What the next line finds.
  if (interpreter_ != nullptr) before_ = state_of(interpreter_->modal());
}

void PythonCanon::straight(const char* name, const rtapi::Pose& end) {
  end_ = end;
  const rtapi::Pose p = inches(end);
  call(name, p.x, p.y, p.z, p.a, p.b, p.c, p.u, p.v, p.w);
}

void PythonCanon::select_plane(interp::Plane plane) {
  plane_ = plane;
  const int number = plane == interp::Plane::yz ? 2 : plane == interp::Plane::xz ? 3 : 1;
  call("set_plane", number);
}

void PythonCanon::set_g5x_offset(int system, const rtapi::Pose& offset) {
  const rtapi::Pose p = inches(offset);
  call("set_g5x_offset", system, p.x, p.y, p.z, p.a, p.b, p.c, p.u, p.v, p.w);
}

void PythonCanon::set_g92_offset(const rtapi::Pose& offset) {
  const rtapi::Pose p = inches(offset);
  call("set_g92_offset", p.x, p.y, p.z, p.a, p.b, p.c, p.u, p.v, p.w);
}

void PythonCanon::use_tool_length_offset(const rtapi::Pose& offset) {
  const rtapi::Pose p = inches(offset);
  call("tool_offset", p.x, p.y, p.z, p.a, p.b, p.c, p.u, p.v, p.w);
}

void PythonCanon::set_feed_rate(double linear_mm_min, double) {
  call("set_feed_rate", linear_mm_min / kInch);
}

void PythonCanon::set_feed_mode(int, interp::FeedMode mode) {
  call("set_feed_mode", mode == interp::FeedMode::per_revolution ? 1 : 0);
}

void PythonCanon::arc_feed(const interp::Arc& arc) {
  end_ = arc.end;
  const rtapi::Pose p = inches(arc.end);
  const std::array<double, 3> c{arc.center[0] / kInch, arc.center[1] / kInch,
                                arc.center[2] / kInch};
  const auto send = [&](double e1, double e2, double c1, double c2, double axis_end) {
    call("arc_feed", e1, e2, c1, c2, arc.turns, axis_end, p.a, p.b, p.c, p.u, p.v, p.w);
  };
  if (arc.plane == interp::Plane::yz) return send(p.y, p.z, c[1], c[2], p.x);
  if (arc.plane == interp::Plane::xz) return send(p.z, p.x, c[2], c[0], p.y);
  send(p.x, p.y, c[0], c[1], p.z);
}

/// As the straight pieces of which previews are made.
void PythonCanon::nurbs_feed(std::span<const interp::SplinePoint> points, int order) {
  constexpr int kPiecesPerSpan = 20;
  const interp::NurbsCurve curve(points, order);
  const int pieces = kPiecesPerSpan * std::max(curve.spans(), 1);
  rtapi::Pose at = end_;
  for (int i = 1; i <= pieces; ++i) {
    const auto p = curve.at(static_cast<double>(curve.spans()) * i / pieces);
    at.x = p.x;
    at.y = p.y;
    straight("straight_feed", at);
  }
}

void PythonCanon::rigid_tap(const rtapi::Pose& end, double) {
  // It comes back to where it began.
  const rtapi::Pose p = inches(end);
  call("rigid_tap", p.x, p.y, p.z);
}

}  // namespace kerf::python
