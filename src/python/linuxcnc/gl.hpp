// The few calls of OpenGL with which screens have paths drawn into their own window; found when they are first needed, so that
// scripts need no OpenGL.
#pragma once

#include <array>

namespace kerf::python {

class Gl {
 public:
  enum class Shape : unsigned { lines = 1, line_strip = 3 };

  /// Null where there is no OpenGL. Calls are for a thread that has made a context its own.
  static const Gl* find();

  void begin(Shape shape) const { begin_(static_cast<unsigned>(shape)); }
  void end() const { end_(); }
  void vertex(const std::array<double, 3>& p) const { vertex_(p[0], p[1], p[2]); }
  void color(const std::array<int, 4>& c) const;
  void color(double red, double green, double blue, double alpha) const {
    color_real_(red, green, blue, alpha);
  }
  /// What a click finds.
  void name(unsigned number) const { name_(number); }

 private:
  Gl() = default;
  void (*begin_)(unsigned){nullptr};
  void (*end_)(){nullptr};
  void (*vertex_)(double, double, double){nullptr};
  void (*color_)(unsigned char, unsigned char, unsigned char, unsigned char){nullptr};
  void (*color_real_)(double, double, double, double){nullptr};
  void (*name_)(unsigned){nullptr};
};

}  // namespace kerf::python
