// The standard glue of remapped codes, built in. Manual: "Standard Glue routines".
#pragma once

#include <string_view>

namespace kerf::interp {

class Core;
struct RemapCall;

/// A prolog, an epilog, or the whole body of a remapped code. False: core.fail() was called.
using NativeGlue = bool (*)(Core& core, RemapCall& call);

/// Null: there is none of this name.
[[nodiscard]] NativeGlue find_native_glue(std::string_view function);

}  // namespace kerf::interp
