// linuxcnc.positionlogger: remembers where the tool has been, for screens that draw its path.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "python/linuxcnc/geometry.hpp"
#include "python/linuxcnc/gl.hpp"
#include "python/linuxcnc/module.hpp"
#include "rtapi/clock/join_clock.hpp"

namespace kerf::python {
namespace {

constexpr std::size_t kColors = 6;
constexpr std::size_t kMostPoints = 10000;  ///< the oldest go
using Color = std::array<int, 4>;

class PositionLogger {
 public:
  PositionLogger(py::object stat, const std::array<Color, kColors>& colors, std::string geometry,
                 bool xyuv)
      : stat_(std::move(stat)), colors_(colors), geometry_(std::move(geometry)), xyuv_(xyuv) {}

  /// Looks every `interval` seconds, on the caller's thread, until stop().
  void start(double interval) {
    {
      const std::lock_guard lock(mutex_);
      running_ = true;
    }
    const auto clock = rtapi::make_real_clock();
    const py::gil_scoped_release no_gil;
    while (goes_on()) {
      sample();
      rtapi::WaitSpec spec;
      spec.wake_at(clock->now() + rtapi::seconds(std::max(interval, 0.001)));
      clock->wait(spec);
    }
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    points_.clear();
    drawn_.reset();
  }
  [[nodiscard]] std::size_t count() {
    const std::lock_guard lock(mutex_);
    return points_.size();
  }
  /// (x, y, z, a, -b, c) of the newest point, or of the last one that call() has drawn; None: there is none. With XYUV the second
  /// three are the point of the second plane.
  py::object last(int drawn) {
    const std::lock_guard lock(mutex_);
    if (drawn != 0 ? !drawn_.has_value() : points_.empty()) return py::none();
    const Point& p = drawn != 0 ? *drawn_ : points_.back();
    const auto& second = xyuv_ ? p.second : p.turned;
    return py::make_tuple(p.first[0], p.first[1], p.first[2], second[0], second[1], second[2]);
  }
  void set_depth(double z, double w) {
    const std::lock_guard lock(mutex_);
    depth_ = {z, w};
  }
  void set_colors(const std::array<Color, kColors>& colors) {
    const std::lock_guard lock(mutex_);
    colors_ = colors;
  }
  [[nodiscard]] py::tuple colors() {
    py::tuple out(kColors);
    for (std::size_t i = 0; i < kColors; ++i)
      out[i] = py::make_tuple(colors_[i][0], colors_[i][1], colors_[i][2], colors_[i][3]);
    return out;
  }
  /// Draws the path by OpenGL.
  void draw() {
    const Gl* gl = Gl::find();
    const std::lock_guard lock(mutex_);
    if (!points_.empty()) drawn_ = points_.back();
    if (gl == nullptr) return;
    // Colours of jog, traverse, feed, arc, tool change, probing.
    const auto draw_path = [&](auto place) {
      gl->begin(Gl::Shape::line_strip);
      for (const Point& p : points_) {
        gl->color(colors_[static_cast<std::size_t>(std::clamp(p.kind, 0, 5))]);
        gl->vertex(place(p));
      }
      gl->end();
    };
    draw_path([](const Point& p) { return p.first; });
    if (xyuv_) draw_path([](const Point& p) { return p.second; });
  }
  [[nodiscard]] py::list points() {
    const std::lock_guard lock(mutex_);
    py::list out;
    for (const Point& p : points_)
      out.append(py::make_tuple(p.first[0], p.first[1], p.first[2], p.kind));
    return out;
  }

 private:
  struct Point {
    std::array<double, 3> first{}, second{};
    std::array<double, 3> turned{};  ///< how screens draw the tool: A, -B, C in degrees
    int kind{0};                     ///< MOTION_TYPE_*, 0: jog
  };

  bool goes_on() {
    const std::lock_guard lock(mutex_);
    return running_;
  }

  void sample() {
    // A machine that is not there has no path.
    if (!live_.poll().ok()) return;
    const clients::Stat& s = live_.stat();
    const rtapi::Pose at = shown(s);
    Point p;
    const std::lock_guard lock(mutex_);
    if (xyuv_) {
      p.first = {at.x, at.y, depth_[0]};
      p.second = {at.u, at.v, depth_[1]};
    } else {
      p.first = p.second = vertex(geometry_, at);
    }
    p.turned = {at.a, -at.b, at.c};
    p.kind = s.motion_type;
    if (!points_.empty() && points_.back().kind == p.kind && close(points_.back(), p)) return;
    if (points_.size() == kMostPoints) points_.erase(points_.begin());
    points_.push_back(p);
  }

  /// Inches and degrees, the tool's tip.
  static rtapi::Pose shown(const clients::Stat& s) {
    rtapi::Pose p = s.position - s.tool_offset;
    const double inch = 1 / (25.4 * (s.linear_units > 0 ? s.linear_units : 1));
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      if (!rtapi::is_rotary(i)) p[i] *= inch;
    return p;
  }

  static bool close(const Point& a, const Point& b) {
    double distance = 0;
    for (std::size_t i = 0; i < 3; ++i)
      distance = std::max(
          {distance, std::fabs(a.first[i] - b.first[i]), std::fabs(a.second[i] - b.second[i])});
    return distance < 1e-7;
  }

  py::object stat_;
  LiveView live_;
  std::mutex mutex_;
  std::array<Color, kColors> colors_;
  std::string geometry_;
  std::array<double, 2> depth_{};
  bool xyuv_;
  bool running_{false};
  std::vector<Point> points_;
  std::optional<Point> drawn_;  ///< the newest when call() was last called
};

std::array<Color, kColors> colors_of(const py::args& args, std::size_t from) {
  std::array<Color, kColors> out{};
  for (std::size_t i = 0; i < kColors; ++i) {
    const auto color = args[from + i].cast<py::sequence>();
    if (color.size() != 4) throw py::type_error("a colour is (red, green, blue, alpha)");
    for (std::size_t k = 0; k < 4; ++k) out[i][k] = color[k].cast<int>();
  }
  return out;
}

}  // namespace

void add_logger(py::module_& m) {
  py::class_<PositionLogger> c(m, "positionlogger", "Remembers where the tool has been.");
  c.attr("__module__") = "linuxcnc";
  c.def(py::init([](const py::args& args) {
          if (args.size() < 8)
            throw py::type_error("function takes at least 8 arguments (" +
                                 std::to_string(args.size()) + " given)");
          if (!py::isinstance<StatObject>(args[0]))
            throw py::type_error("the first argument must be a linuxcnc.stat");
          return std::make_unique<PositionLogger>(args[0].cast<py::object>(), colors_of(args, 1),
                                                  args[7].cast<std::string>(),
                                                  args.size() > 8 && args[8].cast<int>() != 0);
        }),
        "positionlogger(stat, 6 colours (r, g, b, a), geometry, is_xyuv=0)")
      .def("start", &PositionLogger::start, py::arg("interval"),
           "Looks every `interval` seconds until stop(); for a thread of its own.")
      .def("stop", &PositionLogger::stop)
      .def("clear", &PositionLogger::clear)
      .def("last", &PositionLogger::last, py::arg("drawn") = 1,
           "(x, y, z, a, -b, c) of the last point that call() has drawn, with 0 of the newest; "
           "None before the first.")
      .def("call", &PositionLogger::draw, "Draws the path by OpenGL into the current window.")
      .def("set_depth", &PositionLogger::set_depth, py::arg("z"), py::arg("w"))
      .def("set_colors",
           [](PositionLogger& o, const py::args& args) {
             if (args.size() != kColors)
               throw py::type_error("function takes exactly 6 arguments (" +
                                    std::to_string(args.size()) + " given)");
             o.set_colors(colors_of(args, 0));
           })
      .def("get_colors", &PositionLogger::colors)
      .def("points", &PositionLogger::points, "Kerf's own: [(x, y, z, MOTION_TYPE_*), ...]")
      .def_property_readonly("npts", &PositionLogger::count);
}

}  // namespace kerf::python
