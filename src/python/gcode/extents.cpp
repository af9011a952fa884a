// Arithmetic that previews need: arcs as straight pieces, and how large a part is.
#include <algorithm>
#include <cmath>

#include "python/gcode/canon.hpp"

namespace kerf::python {
namespace {

constexpr int kMostPieces = 128;

double number(const py::object& canon, const std::string& name, double fallback) {
  return py::getattr(canon, name.c_str(), py::float_(fallback)).cast<double>();
}

/// Offsets and rotation of the canon: program to machine coordinates.
struct Frame {
  rtapi::Pose g5x, g92;
  double c{1}, s{0};

  explicit Frame(const py::object& canon) {
    c = number(canon, "rotation_cos", 1);
    s = number(canon, "rotation_sin", 0);
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      const std::string letter(1, static_cast<char>(rtapi::kAxisLetters[i] + ('a' - 'A')));
      g5x[i] = number(canon, "g5x_offset_" + letter, 0);
      g92[i] = number(canon, "g92_offset_" + letter, 0);
    }
  }
  [[nodiscard]] rtapi::Pose to_machine(rtapi::Pose p) const {
    p = p + g92;
    const double x = p.x * c - p.y * s, y = p.x * s + p.y * c;
    p.x = x, p.y = y;
    return p + g5x;
  }
  [[nodiscard]] rtapi::Pose to_program(rtapi::Pose p) const {
    p = p - g5x;
    const double x = p.x * c + p.y * s, y = -p.x * s + p.y * c;
    p.x = x, p.y = y;
    return p - g92;
  }
};

/// arc_to_segments(canon, end1, end2, centre1, centre2, turns, axis_end, a, b, c, u, v, w, most=128): points behind canon.lo, all in
/// machine coordinates. canon.plane: 1 XY, 2 YZ, 3 XZ.
py::list arc_to_segments(const py::object& canon, double x1, double y1, double cx, double cy,
                         int turns, double z1, double a, double b, double c, double u, double v,
                         double w, int most) {
  const Frame frame(canon);
  const auto lo = canon.attr("lo").cast<py::sequence>();
  rtapi::Pose start;
  for (std::size_t i = 0; i < rtapi::kAxes && i < lo.size(); ++i) start[i] = lo[i].cast<double>();
  start = frame.to_program(start);
  const int plane = canon.attr("plane").cast<int>();
  // First and second axis of the plane, and its normal.
  const std::array<std::size_t, 3> axis = plane == 2   ? std::array<std::size_t, 3>{1, 2, 0}
                                          : plane == 3 ? std::array<std::size_t, 3>{2, 0, 1}
                                                       : std::array<std::size_t, 3>{0, 1, 2};
  rtapi::Pose end;
  end[axis[0]] = x1, end[axis[1]] = y1, end[axis[2]] = z1;
  end.a = a, end.b = b, end.c = c, end.u = u, end.v = v, end.w = w;
  const double from = std::atan2(start[axis[1]] - cy, start[axis[0]] - cx);
  double sweep = std::atan2(y1 - cy, x1 - cx) - from;
  // Ends that are one point make a whole turn.
  constexpr double kSame = 1e-9;
  if (turns < 0) {
    while (sweep > -kSame) sweep -= 2 * M_PI;
    sweep += 2 * M_PI * (turns + 1);
  } else {
    while (sweep < kSame) sweep += 2 * M_PI;
    sweep += 2 * M_PI * (turns > 0 ? turns - 1 : 0);
  }
  const double r0 = std::hypot(start[axis[0]] - cx, start[axis[1]] - cy);
  const double r1 = std::hypot(x1 - cx, y1 - cy);
  const int pieces =
      std::max(3, static_cast<int>(std::ceil(std::max(most, 1) * std::fabs(sweep) / (2 * M_PI))));
  py::list out;
  for (int i = 1; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    rtapi::Pose p = start + (end - start) * t;
    if (i < pieces) {
      const double angle = from + sweep * t, r = r0 + (r1 - r0) * t;
      p[axis[0]] = cx + r * std::cos(angle);
      p[axis[1]] = cy + r * std::sin(angle);
    } else {
      p = end;
    }
    const rtapi::Pose m = frame.to_machine(p);
    out.append(py::make_tuple(m.x, m.y, m.z, m.a, m.b, m.c, m.u, m.v, m.w));
  }
  return out;
}

/// calc_extents(moves, ...): each move is (line, start, end, ..., tool offset). Lowest and highest corner of the moves, then of the same
/// with each move's tool offset added.
py::tuple calc_extents(const py::args& lists) {
  constexpr double kFar = 9e99;
  std::array<std::array<double, 3>, 4> box{};
  for (std::size_t i = 0; i < 3; ++i) {
    box[0][i] = box[2][i] = kFar;
    box[1][i] = box[3][i] = -kFar;
  }
  for (const py::handle list : lists) {
    for (const py::handle item : list) {
      const auto move = item.cast<py::sequence>();
      const auto offset = move[move.size() - 1].cast<py::sequence>();
      for (const std::size_t which : {std::size_t{1}, std::size_t{2}}) {
        const auto point = move[which].cast<py::sequence>();
        for (std::size_t i = 0; i < 3; ++i) {
          const double p = point[i].cast<double>(), tip = p + offset[i].cast<double>();
          box[0][i] = std::min(box[0][i], p);
          box[1][i] = std::max(box[1][i], p);
          box[2][i] = std::min(box[2][i], tip);
          box[3][i] = std::max(box[3][i], tip);
        }
      }
    }
  }
  py::tuple out(4);
  for (std::size_t k = 0; k < 4; ++k) {
    py::list corner;
    for (const double v : box[k]) corner.append(v);
    out[k] = corner;
  }
  return out;
}

}  // namespace

void add_extents(py::module_& m) {
  m.def("arc_to_segments", arc_to_segments, py::arg("canon"), py::arg("end1"), py::arg("end2"),
        py::arg("centre1"), py::arg("centre2"), py::arg("turns"), py::arg("axis_end"), py::arg("a"),
        py::arg("b"), py::arg("c"), py::arg("u"), py::arg("v"), py::arg("w"),
        py::arg("most") = kMostPieces, "An arc of the canon as points in machine coordinates.");
  m.def("calc_extents", calc_extents,
        "(lowest, highest, lowest with tool offset, highest with tool offset) of lists of moves.");
}

}  // namespace kerf::python
