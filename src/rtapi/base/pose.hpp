// Pose: a point in the nine axes of RS274NGC.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace kerf::rtapi {

inline constexpr std::size_t kAxes = 9;
inline constexpr std::string_view kAxisLetters = "XYZABCUVW";

/// x y z u v w in mm, a b c in degrees, wherever Kerf computes; files and pins in other units are converted at the border.
struct Pose {
  double x{0}, y{0}, z{0}, a{0}, b{0}, c{0}, u{0}, v{0}, w{0};

  /// Axis by index in XYZABCUVW order; i must be below kAxes.
  constexpr double& operator[](std::size_t i) noexcept { return *member(*this, i); }
  constexpr double operator[](std::size_t i) const noexcept { return *member(*this, i); }

  friend constexpr bool operator==(const Pose&, const Pose&) = default;
  friend constexpr Pose operator+(Pose l, const Pose& r) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) l[i] += r[i];
    return l;
  }
  friend constexpr Pose operator-(Pose l, const Pose& r) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) l[i] -= r[i];
    return l;
  }
  friend constexpr Pose operator*(Pose p, double k) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) p[i] *= k;
    return p;
  }

 private:
  template <class Self>
  static constexpr auto member(Self& p, std::size_t i) noexcept -> decltype(&p.x) {
    switch (i) {
      case 0: return &p.x;
      case 1: return &p.y;
      case 2: return &p.z;
      case 3: return &p.a;
      case 4: return &p.b;
      case 5: return &p.c;
      case 6: return &p.u;
      case 7: return &p.v;
      default: return &p.w;
    }
  }
};

/// True for A, B, C.
constexpr bool is_rotary(std::size_t axis) noexcept { return axis >= 3 && axis <= 5; }

/// Index of an axis letter of either case in XYZABCUVW, or -1.
constexpr int axis_index(char letter) noexcept {
  const char upper = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 32) : letter;
  const auto at = kAxisLetters.find(upper);
  return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

}  // namespace kerf::rtapi
