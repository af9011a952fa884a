// The C API's backend in the realtime host.
#pragma once

namespace kerf::hal {
class Host;
}

namespace kerf::hal::capi {

/// From the main thread, before any realtime thread is made: rights to I/O ports, and where messages go.
void start_realtime() noexcept;
/// Modules that `host` loads may use the C API from now on.
void use_host(Host& host);
/// Before the host ends, when all modules are unloaded.
void forget_host();

}  // namespace kerf::hal::capi
