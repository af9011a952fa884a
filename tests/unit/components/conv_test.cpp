// All conv_A_B of whole numbers and of floats to whole numbers, against arithmetic in 128 bits.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

__extension__ using Wide = __int128;

struct Kind {
  const char* name;
  Wide least, most, turn;
};
constexpr Kind kKinds[] = {
    {"s32", INT32_MIN, INT32_MAX, Wide{1} << 32},
    {"u32", 0, UINT32_MAX, Wide{1} << 32},
    {"s64", INT64_MIN, INT64_MAX, Wide{1} << 64},
    {"u64", 0, UINT64_MAX, Wide{1} << 64},
};

Wide value_of(const hal::TestBuilder& hal, const std::string& pin) {
  switch (hal.type(pin)) {
    case hal::Type::s32: return hal.get<std::int32_t>(pin);
    case hal::Type::u32: return hal.get<std::uint32_t>(pin);
    case hal::Type::s64: return hal.get<std::int64_t>(pin);
    default: return hal.get<std::uint64_t>(pin);
  }
}
Wide wrapped(Wide in, const Kind& to) {
  Wide rest = (in - to.least) % to.turn;
  if (rest < 0) rest += to.turn;
  return rest + to.least;
}

/// The numbers at which something may go wrong, as far as `from` has them.
std::vector<Wide> numbers(const Kind& from) {
  std::vector<Wide> out;
  for (const Kind& kind : kKinds)
    for (const Wide end : {kind.least, kind.most})
      for (int i = -2; i <= 2; ++i)
        if (end + i >= from.least && end + i <= from.most) out.push_back(end + i);
  return out;
}

void expect_converted(const std::string& name, const Kind& to, Wide in, const auto& put) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module(name), "c")) << name;
  const bool fits = in >= to.least && in <= to.most;
  put(hal);
  hal.run("c");
  EXPECT_TRUE(value_of(hal, "c.out") == wrapped(in, to)) << name;
  if (!hal.has("c.clamp")) {
    EXPECT_TRUE(fits) << name << " cannot say that a number does not fit";
    return;
  }
  EXPECT_EQ(hal.get<bool>("c.out-of-range"), !fits) << name;
  hal.set("c.clamp", true);
  hal.run("c");
  EXPECT_TRUE(value_of(hal, "c.out") == (in < to.least  ? to.least
                                         : in > to.most ? to.most
                                                        : in))
      << name;
  EXPECT_EQ(hal.get<bool>("c.out-of-range"), !fits) << name;
}

TEST(Conv, WholeNumbersOfAnyTypeToAnyOther) {
  for (const Kind& from : kKinds)
    for (const Kind& to : kKinds) {
      if (&from == &to) continue;
      const std::string name = std::string("conv_") + from.name + "_" + to.name;
      for (const Wide in : numbers(from))
        expect_converted(name, to, in, [&](hal::TestBuilder& hal) {
          hal.set("c.in", static_cast<std::int64_t>(in));  // TestBuilder keeps all 64 bits
        });
    }
}

TEST(Conv, FloatsToWholeNumbers) {
  const Kind whole = {"", -(Wide{1} << 70), Wide{1} << 70, 0};
  for (const Kind& to : kKinds)
    for (const Wide near : numbers(whole)) {
      const auto in = static_cast<double>(near);
      const auto exact = static_cast<Wide>(in);
      expect_converted(std::string("conv_float_") + to.name, to, exact,
                       [&](hal::TestBuilder& hal) { hal.set("c.in", in); });
    }
}

TEST(Conv, BitsAreZeroAndOne) {
  for (const char* kind : {"float", "s32", "u32", "s64", "u64"}) {
    hal::TestBuilder to, from;
    ASSERT_TRUE(to.create(module(std::string("conv_bit_") + kind), "c")) << kind;
    ASSERT_TRUE(from.create(module(std::string("conv_") + kind + "_bit"), "c")) << kind;
    for (const bool bit : {true, false}) {
      to.set("c.in", bit);
      to.run("c");
      if (to.type("c.out") == hal::Type::floating)
        EXPECT_EQ(to.get<double>("c.out"), bit ? 1.0 : 0.0);
      else
        EXPECT_TRUE(value_of(to, "c.out") == Wide{bit}) << kind;
      from.set("c.in", bit ? 1 : 0);
      from.run("c");
      EXPECT_EQ(from.get<bool>("c.out"), bit) << kind;
      EXPECT_FALSE(from.get<bool>("c.out-of-range")) << kind;
    }
    from.set("c.in", 7);
    from.run("c");
    EXPECT_TRUE(from.get<bool>("c.out")) << kind;
    EXPECT_TRUE(from.get<bool>("c.out-of-range")) << kind;
  }
}

}  // namespace
}  // namespace kerf::components
