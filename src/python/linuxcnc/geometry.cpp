#include "python/linuxcnc/geometry.hpp"

#include <algorithm>
#include <cmath>

#include "python/linuxcnc/gl.hpp"
#include "python/linuxcnc/module.hpp"

namespace kerf::python {
namespace {

/// What A, B and C turn about; under the GIL.
struct Turning {
  std::array<double, 3> offsets{};  ///< the work offsets, as the screen told them
  bool about_offsets{false};        ///< else about the machine's origin
};
Turning& turning() {
  static Turning state;
  return state;
}

rtapi::Pose pose(const py::handle& values) {
  const auto list = values.cast<py::sequence>();
  rtapi::Pose p;
  for (std::size_t i = 0; i < rtapi::kAxes && i < list.size(); ++i) p[i] = list[i].cast<double>();
  return p;
}

/// One line, in pieces where it turns.
void line(const Gl& gl, std::string_view geometry, const rtapi::Pose& from, const rtapi::Pose& to) {
  constexpr double kDegreesPerPiece = 5;
  double turned = 0;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (rtapi::is_rotary(i)) turned = std::max(turned, std::fabs(to[i] - from[i]));
  const int pieces = std::max(1, static_cast<int>(std::ceil(turned / kDegreesPerPiece)));
  for (int i = 0; i < pieces; ++i) {
    const rtapi::Pose way = to - from;
    gl.vertex(vertex(geometry, from + way * (static_cast<double>(i) / pieces)));
    gl.vertex(vertex(geometry, from + way * (static_cast<double>(i + 1) / pieces)));
  }
}

void draw_lines(const std::string& geometry, const py::list& lines, int for_selection) {
  const Gl* gl = Gl::find();
  if (gl == nullptr) return;
  if (for_selection == 0) gl->begin(Gl::Shape::lines);
  for (const py::handle item : lines) {
    const auto entry = item.cast<py::sequence>();
    if (for_selection != 0) {
      gl->name(entry[0].cast<unsigned>());
      gl->begin(Gl::Shape::lines);
    }
    line(*gl, geometry, pose(entry[1]), pose(entry[2]));
    if (for_selection != 0) gl->end();
  }
  if (for_selection == 0) gl->end();
}

/// Each a small cross: (line, (red, green, blue), x, y, z, plane 0 XY, 1 XZ, 2 YZ).
void draw_dwells(const std::string& geometry, const py::list& dwells, double alpha,
                 int for_selection, int is_lathe) {
  constexpr double kArm = 0.03;  // inch
  const Gl* gl = Gl::find();
  if (gl == nullptr) return;
  for (const py::handle item : dwells) {
    const auto entry = item.cast<py::sequence>();
    const auto color = entry[1].cast<py::sequence>();
    const int plane = is_lathe != 0 ? 1 : entry[5].cast<int>();
    rtapi::Pose at;
    for (std::size_t i = 0; i < 3; ++i) at[i] = entry[i + 2].cast<double>();
    if (for_selection != 0) gl->name(entry[0].cast<unsigned>());
    gl->color(color[0].cast<double>(), color[1].cast<double>(), color[2].cast<double>(), alpha);
    gl->begin(Gl::Shape::lines);
    const std::size_t first = plane == 2 ? 1 : 0, second = plane == 0 ? 1 : 2;
    for (const double side : {-1.0, 1.0}) {
      rtapi::Pose from = at, to = at;
      from[first] -= kArm, to[first] += kArm;
      from[second] -= side * kArm, to[second] += side * kArm;
      line(*gl, geometry, from, to);
    }
    gl->end();
  }
}

}  // namespace

std::array<double, 3> vertex(std::string_view geometry, const rtapi::Pose& point) {
  std::array<double, 3> p{};
  const std::array<double, 3> about =
      turning().about_offsets ? turning().offsets : std::array<double, 3>{};
  const auto turn = [&](std::size_t from, std::size_t to, double degrees) {
    const double angle = degrees * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
    const double a = p[from] - about[from], b = p[to] - about[to];
    p[from] = about[from] + a * c - b * s;
    p[to] = about[to] + a * s + b * c;
  };
  // From the tool to the work: the last letter moves first.
  for (std::size_t i = geometry.size(); i-- > 0;) {
    const int axis = rtapi::axis_index(geometry[i]);
    if (axis < 0) continue;
    const double sign = i > 0 && geometry[i - 1] == '-' ? -1 : 1;
    const double value = sign * point[static_cast<std::size_t>(axis)];
    switch (axis) {
      case 3: turn(1, 2, value); break;
      case 4: turn(2, 0, value); break;
      case 5: turn(0, 1, value); break;
      default: p[static_cast<std::size_t>(axis % 3)] += value; break;
    }
  }
  return p;
}

void add_geometry(py::module_& m) {
  m.def(
      "vertex9",
      [](const std::string& geometry, const py::sequence& point) {
        const auto v = vertex(geometry, pose(point));
        return py::make_tuple(v[0], v[1], v[2]);
      },
      py::arg("geometry"), py::arg("point"), "Where a nine-axis point is drawn: (x, y, z).");
  m.def(
      "line9",
      [](const std::string& geometry, const py::sequence& from, const py::sequence& to) {
        if (const Gl* gl = Gl::find()) line(*gl, geometry, pose(from), pose(to));
      },
      py::arg("geometry"), py::arg("start"), py::arg("end"),
      "Draws a line by OpenGL, between glBegin(GL_LINES) and glEnd().");
  m.def("draw_lines", draw_lines, py::arg("geometry"), py::arg("lines"),
        py::arg("for_selection") = 0, "Draws [(line, start, end, ...), ...] by OpenGL.");
  m.def("draw_dwells", draw_dwells, py::arg("geometry"), py::arg("dwells"), py::arg("alpha"),
        py::arg("for_selection"), py::arg("is_lathe"),
        "Draws [(line, colour, x, y, z, plane), ...] as crosses by OpenGL.");
  m.def(
      "gui_rot_offsets",
      [](double x, double y, double z) {
        turning().offsets = {x, y, z};
      },
      py::arg("x"), py::arg("y"), py::arg("z"),
      "The work offsets, about which A, B and C turn what is drawn after gui_respect_offsets(.., "
      "1).");
  m.def(
      "gui_respect_offsets",
      [](const std::string&, int respect) { turning().about_offsets = respect != 0; },
      py::arg("coordinates"), py::arg("respect"),
      "Whether A, B and C turn what is drawn about the work offsets ('!' in [DISPLAY]GEOMETRY) or "
      "about the machine's origin.");
}

}  // namespace kerf::python
