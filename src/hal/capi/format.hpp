// printf's text without printf: nothing is allocated, no locale is asked.
#pragma once

#include <cstdarg>
#include <cstddef>

namespace kerf::hal::capi {

/// @rt. As vsnprintf(3) for d i u o x X c s p f F e E g G (a and A print as g), %, flags, width, precision and length modifiers; `L` counts as a double.
/// %n and wide characters print as they stand. Floating-point numbers are exact and rounded half to even, at most kMostPrecision digits
/// behind the point. Gives the length of the whole text; what does not fit is cut, and the buffer always ends with a zero.
int format_text(char* buffer, std::size_t size, const char* fmt, std::va_list args) noexcept;
inline constexpr int kMostPrecision = 100;

}  // namespace kerf::hal::capi
