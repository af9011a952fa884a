// rtapi_snprintf's text against the C library's.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>

#include "hal/capi/format.hpp"

namespace kerf::hal::capi {
namespace {

struct Text {
  int length;
  std::string text;
  bool operator==(const Text& other) const = default;
};

Text ours(const char* fmt, ...) {
  char buffer[1200];
  std::va_list args;
  va_start(args, fmt);
  const int n = format_text(buffer, sizeof buffer, fmt, args);
  va_end(args);
  return {n, buffer};
}
Text theirs(const char* fmt, ...) {
  char buffer[1200];
  std::va_list args;
  va_start(args, fmt);
  const int n = std::vsnprintf(buffer, sizeof buffer, fmt, args);
  va_end(args);
  return {n, buffer};
}
std::ostream& operator<<(std::ostream& out, const Text& t) {
  return out << "[" << t.text << "] (" << t.length << ")";
}

std::string any_format(std::mt19937_64& random, const char* conversions) {
  static constexpr const char* kFlags[] = {"", "-", "+", " ", "#", "0", "-#", "+0", "# "};
  std::string fmt = std::string("%") + kFlags[random() % std::size(kFlags)];
  if (random() % 2 == 0) fmt += std::to_string(random() % 25);
  if (random() % 2 == 0) fmt += "." + std::to_string(random() % 22);
  return fmt + conversions[random() % std::strlen(conversions)];
}

double any_double(std::mt19937_64& random) {
  const std::uint64_t bits = random();
  double value = 0;
  switch (random() % 4) {
    case 0: std::memcpy(&value, &bits, sizeof value); return value;
    case 1: return static_cast<double>(bits % 2000) / 8 - 100;  // ties
    case 2: return static_cast<double>(bits % 1000000) / 1e9;
    default: return static_cast<double>(static_cast<std::int64_t>(bits)) / 1e15;
  }
}

TEST(FormatTest, FloatsAreTheLibrarys) {
  std::mt19937_64 random(42);
  for (int i = 0; i < 40000; ++i) {
    const std::string fmt = any_format(random, "feEgG");
    const double value = any_double(random);
    ASSERT_EQ(ours(fmt.c_str(), value), theirs(fmt.c_str(), value)) << fmt << " of " << value;
  }
}

TEST(FormatTest, IntegersAreTheLibrarys) {
  std::mt19937_64 random(43);
  for (int i = 0; i < 20000; ++i) {
    std::string fmt = any_format(random, "diouxX");
    static constexpr const char* kLengths[] = {"", "l", "ll", "h", "hh", "z"};
    fmt.insert(fmt.size() - 1, kLengths[random() % std::size(kLengths)]);
    const auto value = static_cast<long>(random() >> (random() % 64));
    ASSERT_EQ(ours(fmt.c_str(), value), theirs(fmt.c_str(), value)) << fmt << " of " << value;
  }
}

TEST(FormatTest, TheEndsOfTheRange) {
  for (const double value :
       {0.0, -0.0, DBL_MAX, -DBL_MAX, DBL_MIN, DBL_TRUE_MIN, HUGE_VAL, -HUGE_VAL, std::nan(""), 0.5,
        1.5, 2.5, 999999.5, 9.9999995, 1e15, 1e16, 1e22}) {
    for (const char* fmt :
         {"%f", "%.0f", "%g", "%.17g", "%e", "%.0e", "%#.0f", "%+08.2f", "%.100f"})
      EXPECT_EQ(ours(fmt, value), theirs(fmt, value)) << fmt << " of " << value;
  }
}

TEST(FormatTest, StringsAndTheRest) {
  EXPECT_EQ(ours("%s|%5s|%-5s|%.2s|%c|%%|%p", "a", "b", "c", "defg", 'h', nullptr).text,
            "a|    b|c    |de|h|%|(nil)");
  EXPECT_EQ(ours("%s", static_cast<const char*>(nullptr)).text, "(null)");
  EXPECT_EQ(ours("%*d|%-*d|%.*f", 5, 3, 5, 3, 1, 2.25).text, "    3|3    |2.2");
  EXPECT_EQ(ours("100%").text, "100%");
  EXPECT_EQ(ours("%y %d", 5).text, "%y 5");
}

TEST(FormatTest, WhatDoesNotFitIsCutAndCounted) {
  char buffer[8];
  std::memset(buffer, 'x', sizeof buffer);
  const auto into = [&](std::size_t size, const char* fmt, ...) {
    std::va_list args;
    va_start(args, fmt);
    const int n = format_text(buffer, size, fmt, args);
    va_end(args);
    return n;
  };
  EXPECT_EQ(into(6, "hello %s", "world"), 11);
  EXPECT_STREQ(buffer, "hello");
  EXPECT_EQ(buffer[6], 'x');
  EXPECT_EQ(into(0, "abc"), 3);
  EXPECT_EQ(buffer[0], 'h');
}

}  // namespace
}  // namespace kerf::hal::capi
