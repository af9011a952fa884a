#include <gtest/gtest.h>

#include <array>
#include <string>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/base/static_vector.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::rtapi {
namespace {

TEST(FixedString, CutsAndSaysSo) {
  FixedString<4> s("abcdef");
  EXPECT_EQ(s.view(), "abcd");
  EXPECT_TRUE(s.truncated());
  s.assign("xy");
  EXPECT_FALSE(s.truncated());
  s.append("zwq");
  EXPECT_EQ(s.view(), "xyzw");
  EXPECT_TRUE(s.truncated());
  EXPECT_EQ(std::string(s.c_str()), "xyzw");
}

TEST(StaticVector, FullIsAValue) {
  StaticVector<int, 2> v;
  EXPECT_TRUE(v.push_back(1));
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  EXPECT_EQ(v.size(), 2U);
  EXPECT_EQ(v.back(), 2);
}

Result<int> half(int n) {
  if (n % 2 != 0) return fail(Errc::bad_argument, "odd", {"f.ini", 3, 0});
  return n / 2;
}
Result<int> quarter(int n) {
  KERF_TRY(const int h, half(n));
  return half(h);
}

TEST(Result, PassesErrorsUp) {
  EXPECT_EQ(*quarter(8), 2);
  const auto bad = quarter(6);
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().message(), "f.ini:3: odd");
}

TEST(Result, ReadOnTheWrongSideAborts) { EXPECT_DEATH((void)*half(3), "wrong side"); }

TEST(Pose, AxisByIndexAndLetter) {
  Pose p;
  for (std::size_t i = 0; i < kAxes; ++i) p[i] = static_cast<double>(i);
  EXPECT_EQ(p.w, 8);
  EXPECT_EQ(p.a, 3);
  EXPECT_EQ(axis_index('b'), 4);
  EXPECT_EQ(axis_index('Q'), -1);
  EXPECT_TRUE(is_rotary(3));
  EXPECT_FALSE(is_rotary(6));
}

TEST(Suggest, NearestNameOrNothing) {
  const std::array<std::string, 3> known{"MAX_VELOCITY", "MIN_LIMIT", "HOME"};
  EXPECT_EQ(nearest_name("MAX_VELOCTIY", known), "MAX_VELOCITY");
  EXPECT_EQ(did_you_mean("home", known), "; did you mean 'HOME'?");
  EXPECT_EQ(did_you_mean("QQQQQQ", known), "");
  EXPECT_EQ(edit_distance("ab", "ba"), 1U);
}

}  // namespace
}  // namespace kerf::rtapi
