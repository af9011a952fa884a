// How a realtime function says something to the operator.
#pragma once

#include <string_view>

namespace kerf::hal {

/// One line at a time, cut when it is too long. It shows on the screens of the machine, and on the terminal of the realtime host.
/// A component asks for it while it is constructed: static_cast<OperatorLine*>(builder().find_service(kOperatorLine)); nullptr:
/// nobody would hear. It lives as long as the component.
struct OperatorLine {
  void (*put)(void* to, std::string_view text) noexcept {nullptr};
  void* to{nullptr};
  /// @rt.
  void error(std::string_view text) const noexcept { put(to, text); }
};
inline constexpr std::string_view kOperatorLine = "operator-line";

}  // namespace kerf::hal
