// Numbers of Stat that halui asks for by name.
#pragma once

namespace kerf::clients::halui {

inline constexpr int kStateEstop = 1, kStateOn = 4;
inline constexpr int kModeManual = 1, kModeAuto = 2, kModeMdi = 3;
inline constexpr int kInterpIdle = 1;
inline constexpr int kMotionFree = 1, kMotionTeleop = 3;

[[nodiscard]] constexpr const char* mode_word(int mode) noexcept {
  return mode == kModeAuto ? "auto" : mode == kModeMdi ? "mdi" : "manual";
}

}  // namespace kerf::clients::halui
