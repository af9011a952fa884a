// How the realtime host switches the machine off when nobody watches over it any more.
#pragma once

#include <string_view>

namespace kerf::hal {

/// A component that has drives offers it: builder().provide(kSwitchOff, &switch_off), as long as it lives. From the call on its drives
/// go off in the next cycle and stay off, whoever asks for them. Called by a thread that is not realtime, once or again.
struct SwitchOff {
  void (*now)(void* machine) noexcept {nullptr};
  void* machine{nullptr};
};
inline constexpr std::string_view kSwitchOff = "switch-off";

}  // namespace kerf::hal
