#include "hal/core/test_builder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerf::hal {
namespace {

class Scale final : public Component<Scale> {
 public:
  static constexpr Info kInfo{.name = "scale", .summary = "gain"};
  using Component::Component;

 private:
  In<double> in_{pin<In<double>>("in", "Input")};
  Param<double> gain_{param<Param<double>>("gain", "Gain", 2.0)};
  Out<double> out_{pin<Out<double>>("out", "in * gain")};
  PinArray<In<bool>, 4> bits_{pins<In<bool>, 4>(
      "bit-##", static_cast<std::size_t>(int_arg("bits", 2, "Number of bits")), "Bit ##")};
  void update(const Period&) noexcept { out_ = in_ * gain_; }
  Function update_{function<&Scale::update>("", "Recompute out")};
};

// A thread's functions touch no more memory than they must: docs/timing.md.
static_assert(sizeof(In<bool>) == sizeof(void*) && sizeof(Param<double>) == sizeof(void*));
static_assert(std::is_empty_v<Component<Scale>>);
// HAL knows where a pin's handle stands.
static_assert(!std::is_copy_constructible_v<In<bool>> && !std::is_move_constructible_v<Out<bool>>);
static_assert(!std::is_copy_assignable_v<Io<bool>>);

TEST(TestBuilder, RunsAComponentByPinNames) {
  TestBuilder hal;
  ASSERT_TRUE(hal.create<Scale>("scale.0")) << hal.error();
  hal.set("scale.0.in", 3);
  hal.run("scale.0");
  EXPECT_EQ(hal.get<double>("scale.0.out"), 6.0);
  EXPECT_THAT(hal.items(), testing::ElementsAre("scale.0.in", "scale.0.gain", "scale.0.out",
                                                "scale.0.bit-00", "scale.0.bit-01"));
}

TEST(TestBuilder, LinksPinsLikeASignal) {
  TestBuilder hal;
  ASSERT_TRUE(hal.create<Scale>("a"));
  ASSERT_TRUE(hal.create<Scale>("b"));
  hal.link({"a.out", "b.in"});
  hal.set("a.in", 1.5);
  hal.run("a");
  hal.run("b");
  EXPECT_EQ(hal.get<double>("b.out"), 6.0);
}

TEST(TestBuilder, LatchesTheFirstErrorAndNamesWrongNames) {
  TestBuilder hal;
  hal.set_arg("bits", "5");
  EXPECT_FALSE(hal.create<Scale>("scale.0"));
  EXPECT_EQ(hal.error(), "more pins than the component has room for");
  EXPECT_THROW(hal.set("scale.0.inn", 1), std::logic_error);
  EXPECT_THROW((void)hal.get<bool>("scale.0.in"), std::logic_error);
}

}  // namespace
}  // namespace kerf::hal
