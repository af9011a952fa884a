// write_fixed() writes what printf writes, whatever the value.
#include "interp/fixed_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

namespace kerf::interp {
namespace {

template <int Decimals>
void expect_as_printf(double value) {
  char ours[kLongestFixed], theirs[kLongestFixed];
  *write_fixed<Decimals>(ours, value) = '\0';
  std::snprintf(theirs, sizeof theirs, "%.*f", Decimals, value);
  ASSERT_STREQ(ours, theirs) << Decimals << " decimals of " << std::hexfloat << value;
}
void expect_all(double value) {
  for (const double v : {value, -value}) {
    expect_as_printf<4>(v);
    expect_as_printf<6>(v);
    expect_as_printf<1>(v);
  }
}

TEST(FixedText, EdgesAreAsPrintf) {
  for (const double v : {0.0,
                         1.0,
                         0.5,
                         0.25,
                         0.00005,
                         0.00004999999,
                         0.03125,
                         0.09375,
                         9.99995,
                         9.99994999,
                         99999.99995,
                         0.000078125,
                         1e-5,
                         5e-324,
                         std::numeric_limits<double>::min(),
                         std::numeric_limits<double>::max(),
                         1e15,
                         1e22,
                         1e300,
                         1099511627775.99995,
                         1099511627776.0,
                         1099511627776.03125,
                         9007199254740993.0,
                         std::numeric_limits<double>::infinity()})
    expect_all(v);
}

// Values with few binary digits behind the point lie exactly between two texts.
TEST(FixedText, TiesGoToTheEvenDigit) {
  for (int power = 1; power <= 40; ++power) {
    for (int n = 0; n < 4000; ++n) ASSERT_NO_FATAL_FAILURE(expect_all(std::ldexp(n, -power)));
  }
}

/// KERF_COUNT turns the dial.
TEST(FixedText, RandomValuesAreAsPrintf) {
  const char* const wanted = std::getenv("KERF_COUNT");
  const long count = wanted == nullptr ? 100000 : std::strtol(wanted, nullptr, 10);
  std::mt19937_64 rng(20240611);
  std::uniform_real_distribution<double> length(-3000, 3000), exponent(-30, 60);
  for (long i = 0; i < count; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_all(length(rng)));
    ASSERT_NO_FATAL_FAILURE(expect_all(length(rng) * std::exp2(exponent(rng))));
    // What programs write: decimals, and their neighbours in the last bit.
    const double decimal = static_cast<double>(static_cast<long>(rng() % 20000000)) / 20000;
    ASSERT_NO_FATAL_FAILURE(expect_all(decimal));
    ASSERT_NO_FATAL_FAILURE(expect_all(std::nextafter(decimal, 1e9)));
    const double any = std::bit_cast<double>(rng());
    if (std::isnan(any)) continue;
    ASSERT_NO_FATAL_FAILURE(expect_all(any));
  }
}

}  // namespace
}  // namespace kerf::interp
