// conv_FROM_TO: a value as another type. The build gives KERF_FROM and KERF_TO, the HAL names of the two types.
#include <cmath>
#include <limits>
#include <type_traits>

#include "hal/component.hpp"

namespace kerf::components {

namespace {
#define KERF_TEXT_OF(x) #x
#define KERF_TEXT(x) KERF_TEXT_OF(x)
#define KERF_TYPE_OF(x) type_##x
#define KERF_TYPE(x) KERF_TYPE_OF(x)
// The HAL name of double is a keyword of C++, so all have a prefix.
using type_bit = bool;
using type_float = double;
using type_s32 = std::int32_t;
using type_u32 = std::uint32_t;
using type_s64 = std::int64_t;
using type_u64 = std::uint64_t;
using From = KERF_TYPE(KERF_FROM);
using To = KERF_TYPE(KERF_TO);

template <class T>
inline constexpr bool kIsFloat = std::is_same_v<T, double>;

/// Whether every value of From is one of To.
constexpr bool always_fits() {
  if (std::is_same_v<From, bool> || kIsFloat<To>) return true;
  if (kIsFloat<From>) return false;
  return std::numeric_limits<From>::digits <= std::numeric_limits<To>::digits &&
         (std::is_signed_v<To> || !std::is_signed_v<From>);
}

/// -1 below the range of To, 1 above it, 0 within.
template <class T>
constexpr int side(T in) noexcept {
  using Limits = std::numeric_limits<To>;
  if constexpr (always_fits()) {
    return 0;
  } else if constexpr (kIsFloat<T>) {
    // The first number above the range: a power of two, exact as a float.
    constexpr To kHalf = Limits::max() / 2;
    constexpr double kEnd =
        std::is_same_v<To, bool> ? 2.0 : 2.0 * (static_cast<double>(kHalf) + 1.0);
    const double whole = std::trunc(in);
    if (whole >= kEnd) return 1;
    return whole < static_cast<double>(Limits::min()) ? -1 : 0;
  } else {
    if (in < T{0}) {
      if (!std::is_signed_v<To>) return -1;
      return static_cast<std::int64_t>(in) < static_cast<std::int64_t>(Limits::min()) ? -1 : 0;
    }
    return static_cast<std::uint64_t>(in) > static_cast<std::uint64_t>(Limits::max()) ? 1 : 0;
  }
}

/// The value modulo the range of To.
template <class T>
To wrapped(T in) noexcept {
  if constexpr (std::is_same_v<To, bool>) {
    return in != T{0};
  } else if constexpr (kIsFloat<T>) {
    if (std::isinf(in))
      return in < 0.0 ? std::numeric_limits<To>::min() : std::numeric_limits<To>::max();
    constexpr double kTurn = 18446744073709551616.0;
    double rest = std::fmod(std::trunc(in), kTurn);
    const bool negative = rest < 0.0;
    if (negative) rest = -rest;
    const auto size = static_cast<std::uint64_t>(rest);
    return static_cast<To>(negative ? 0U - size : size);
  } else {
    return static_cast<To>(in);
  }
}
// Without linkage: there are several of the name.
class Conv final : public hal::Component<Conv> {
 public:
  static constexpr hal::Info kInfo{
      .name = "conv-" KERF_TEXT(KERF_FROM) "-" KERF_TEXT(KERF_TO),
      .summary = "Converts a value from " KERF_TEXT(KERF_FROM) " to " KERF_TEXT(KERF_TO),
      .notes = always_fits()
                   ? std::string_view("Every value of the one type has its like in the other.")
                   : std::string_view(
                         "A fraction is cut off (towards zero). What does not fit into the "
                         "other type sets out-of-range; it is brought to the nearest value "
                         "that does with clamp, and wraps around without. Not-a-number gives "
                         "zero and out-of-range.")};
  explicit Conv(hal::Builder& b) noexcept : Component(b) {
    if constexpr (!always_fits()) {
      out_of_range_.declare(b, b.full_name("out-of-range"),
                            "True while in does not fit into the type of out");
      clamp_.declare(b, b.full_name("clamp"),
                     "True: stop at the ends of the range; false: wrap around");
    }
  }

 private:
  hal::In<From> in_{pin<hal::In<From>>("in", "Value to convert")};
  hal::Out<To> out_{pin<hal::Out<To>>("out", "The value as the other type")};
  hal::Out<bool> out_of_range_;
  hal::Param<bool> clamp_;

  void update(const hal::Period&) noexcept {
    const From in = in_;
    if constexpr (always_fits()) {
      out_ = static_cast<To>(in);
    } else {
      bool fits = false;
      To out{};
      bool is_number = true;
      if constexpr (kIsFloat<From>) is_number = !std::isnan(in);
      if (is_number) {
        const int where = side(in);
        fits = where == 0;
        out = wrapped(in);
        if (!fits && clamp_)
          out = where < 0 ? std::numeric_limits<To>::min() : std::numeric_limits<To>::max();
      }
      out_of_range_ = !fits;
      out_ = out;
    }
  }
  hal::Function update_{function<&Conv::update>("", "Computes out from in")};
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Conv)
