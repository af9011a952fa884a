#include "python/linuxcnc/gl.hpp"

#include <dlfcn.h>

namespace kerf::python {
namespace {

template <class F>
bool load(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(::dlsym(library, name));
  return function != nullptr;
}

}  // namespace

const Gl* Gl::find() {
  static const Gl* const found = []() -> const Gl* {
    void* library = ::dlopen("libGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return nullptr;
    auto* gl = new Gl();  // for the life of the process
    const bool whole =
        load(library, "glBegin", gl->begin_) && load(library, "glEnd", gl->end_) &&
        load(library, "glVertex3d", gl->vertex_) && load(library, "glColor4ub", gl->color_) &&
        load(library, "glColor4d", gl->color_real_) && load(library, "glLoadName", gl->name_);
    return whole ? gl : nullptr;
  }();
  return found;
}

void Gl::color(const std::array<int, 4>& c) const {
  const auto byte = [](int v) { return static_cast<unsigned char>(v < 0 ? 0 : v > 255 ? 255 : v); };
  color_(byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3]));
}

}  // namespace kerf::python
