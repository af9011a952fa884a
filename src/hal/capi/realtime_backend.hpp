// The C API's backend in the realtime host.
#pragma once

namespace kerf::hal {
class CModules;
class Host;
}  // namespace kerf::hal

namespace kerf::hal::capi {

/// From the main thread, before any realtime thread is made: rights to I/O ports, and where messages go.
void start_realtime() noexcept;
/// Modules that `host` loads may use the C API from now on.
void use_host(Host& host);
/// Before the host ends, when all modules are unloaded.
void forget_host();
/// nullptr without a host.
CModules* modules_of_host() noexcept;

}  // namespace kerf::hal::capi
