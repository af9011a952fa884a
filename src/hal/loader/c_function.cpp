#include "hal/loader/c_function.hpp"

namespace kerf::hal {

void run_c_function(void* object, const Period& period) noexcept {
  const auto& function = *static_cast<const CFunction*>(object);
  function.code(function.argument, static_cast<long>(period.nominal_ns));
}

void run_once(void* object, const Period& period) noexcept {
  auto& function = *static_cast<OnceFunction*>(object);
  if (function.done.get() != 0) return;
  function.done.set(1);
  function.thunk(function.object, period);
}

}  // namespace kerf::hal
