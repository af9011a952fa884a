// Functions behind a thunk of ours: those of C modules, and those that run once.
#pragma once

#include "hal/component.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::hal {

struct CFunction {
  void (*code)(void* argument, long period_ns);
  void* argument;
};

/// @rt. FunctionThunk whose object is a CFunction.
void run_c_function(void* object, const Period& period) noexcept;

/// A function that runs in one cycle only (`initf`).
struct OnceFunction {
  FunctionThunk thunk{nullptr};
  void* object{nullptr};
  rtapi::Word<std::uint32_t> done{0};
};

/// @rt. FunctionThunk whose object is a OnceFunction.
void run_once(void* object, const Period& period) noexcept;

}  // namespace kerf::hal
