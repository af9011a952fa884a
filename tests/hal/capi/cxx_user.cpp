// hal.h in C++: a program that makes pins, sets a value and ends without hal_exit.
#include <hal.h>
#include <rtapi_math.h>
#include <rtapi_mutex.h>
#include <rtapi_string.h>

#include <cstdio>

struct Pins {
  hal_float_t* angle;
  hal_u32_t* turns;
};

int main() {
  const int id = hal_init("cxx");
  if (id < 0) return 1;
  auto* pins = static_cast<Pins*>(hal_malloc(sizeof(Pins)));
  if (pins == nullptr) return 1;
  if (hal_pin_float_new("cxx.angle", HAL_OUT, &pins->angle, id) != 0) return 1;
  if (hal_pin_u32_newf(HAL_OUT, &pins->turns, id, "cxx.turns") != 0) return 1;
  hal_real_t reference = nullptr;
  if (hal_pin_new_real(id, HAL_OUT, &reference, 0.5, "cxx.%d", 7) != 0) return 1;
  *pins->angle = std::sin(M_PI / 2);
  *pins->turns = 3;
  hal_set_real(reference, hal_get_real(reference) + 1);
  if (hal_ready(id) != 0) return 1;
  char name[8];
  rtapi_strxcpy(name, "too long a name");
  std::printf("c++: %g %u %g %s\n", *pins->angle, *pins->turns, hal_get_real(reference), name);
  return 0;
}
