// What is beyond the rows recorded from LinuxCNC (peer_rows_test): sensors of one pocket each, counts, the slow move onto the mark.
#include <gtest/gtest.h>

#include <cmath>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

class CarouselTest : public testing::Test {
 protected:
  void load(const char* pockets, const char* encoding, const char* sensors, const char* dir = "2") {
    hal.set_arg("pockets", pockets);
    hal.set_arg("encoding", encoding);
    hal.set_arg("num_sense", sensors);
    hal.set_arg("dir", dir);
    ASSERT_TRUE(hal.create(module("carousel"), "carousel")) << hal.error();
    hal.set("carousel.0.fwd-dc", 1.0);
    hal.set("carousel.0.rev-dc", -1.0);
  }
  std::string refused(const char* pockets, const char* encoding, const char* dir) {
    hal::TestBuilder other;
    other.set_arg("pockets", pockets);
    other.set_arg("encoding", encoding);
    other.set_arg("dir", dir);
    EXPECT_FALSE(other.create(module("carousel"), "carousel"));
    return other.error();
  }
  bool bit(const char* name) { return hal.get<bool>(std::string("carousel.0.") + name); }
  double velocity() { return hal.get<double>("carousel.0.motor-vel"); }
  std::int32_t here() { return hal.get<std::int32_t>("carousel.0.current-position"); }
  hal::TestBuilder hal;
};

TEST_F(CarouselTest, OneSensorAPocketShowsNoneBetweenTwo) {
  load("5", "single", "5");
  hal.set("carousel.0.sense-1", true);
  hal.run("carousel.0");
  EXPECT_EQ(here(), 2);
  hal.set("carousel.0.pocket-number", 5);
  hal.set("carousel.0.enable", true);
  hal.set("carousel.0.sense-1", false);
  hal.run("carousel.0");
  EXPECT_EQ(here(), 0);
  EXPECT_TRUE(bit("motor-rev"));
  hal.set("carousel.0.sense-4", true);
  hal.run("carousel.0");
  EXPECT_TRUE(bit("ready"));
  EXPECT_EQ(velocity(), 0.0);
}

TEST_F(CarouselTest, FollowsAnotherPocketNumberUnderWay) {
  load("8", "single", "8");
  hal.set("carousel.0.sense-1", true);
  hal.set("carousel.0.pocket-number", 4);
  hal.set("carousel.0.enable", true);
  hal.run("carousel.0");
  EXPECT_TRUE(bit("motor-fwd"));
  hal.set("carousel.0.pocket-number", 0);
  hal.set("carousel.0.sense-1", false);
  hal.set("carousel.0.sense-3", true);
  hal.run("carousel.0");
  EXPECT_TRUE(bit("motor-fwd"));
  hal.set("carousel.0.sense-3", false);
  hal.set("carousel.0.sense-0", true);
  hal.run("carousel.0");
  EXPECT_TRUE(bit("ready")) << "below the first pocket there is none but it";
}

TEST_F(CarouselTest, JogsToTheNextPocketAndNotIntoTheGap) {
  load("8", "single", "8");
  hal.set("carousel.0.sense-1", true);
  hal.set("carousel.0.jog-fwd", true);
  hal.run("carousel.0");
  EXPECT_TRUE(bit("motor-fwd"));
  hal.set("carousel.0.sense-1", false);
  hal.run("carousel.0", 1'000'000, 5);
  EXPECT_TRUE(bit("motor-fwd"));
  hal.set("carousel.0.sense-2", true);
  hal.run("carousel.0");
  EXPECT_FALSE(bit("motor-fwd"));
}

TEST_F(CarouselTest, CountsHomeToTheIndexAndSeePocketsByTheirWidth) {
  load("6", "counts", "1");
  hal.set("carousel.0.scale", 50);
  hal.set("carousel.0.width", 10);
  hal.set("carousel.0.pocket-number", 3);
  hal.set("carousel.0.enable", true);
  hal.run("carousel.0", 1'000'000, 3);
  EXPECT_TRUE(bit("motor-fwd"));
  EXPECT_TRUE(bit("index-enable"));
  hal.set("carousel.0.counts", 730);
  hal.set("carousel.0.sense-0", true);
  hal.run("carousel.0");
  hal.set("carousel.0.sense-0", false);
  EXPECT_TRUE(bit("homed"));
  EXPECT_EQ(here(), 1);
  for (const std::int32_t at : {760, 774, 785, 815, 824}) {
    hal.set("carousel.0.counts", at);
    hal.run("carousel.0");
    EXPECT_TRUE(bit("motor-fwd")) << at;
  }
  EXPECT_EQ(here(), 2);
  hal.set("carousel.0.counts", 825);
  hal.run("carousel.0");
  EXPECT_EQ(here(), 3);
  EXPECT_TRUE(bit("ready"));
  EXPECT_FALSE(bit("motor-fwd"));
}

TEST_F(CarouselTest, CreepsBackOntoTheMarkWhenItHasRunPastIt) {
  load("6", "index", "2");
  hal.set("carousel.0.align-dc", 0.1);
  hal.set("carousel.0.decel-time", 0.01);
  hal.set("carousel.0.pocket-number", 2);
  hal.set("carousel.0.enable", true);
  const auto mark = [&](bool value) {
    hal.set("carousel.0.sense-1", value);
    hal.run("carousel.0");
  };
  hal.set("carousel.0.sense-0", true);
  mark(true);
  mark(true);
  mark(true);
  hal.set("carousel.0.sense-0", false);
  ASSERT_TRUE(bit("homed"));
  mark(false);
  EXPECT_EQ(velocity(), 1.0);
  mark(true);
  EXPECT_EQ(velocity(), 0.0);
  EXPECT_FALSE(bit("ready"));
  // It runs on past the mark.
  for (int i = 0; i < 12; ++i) mark(false);
  EXPECT_EQ(velocity(), -0.1);
  mark(true);
  EXPECT_EQ(velocity(), -0.1);
  mark(false);
  EXPECT_EQ(velocity(), 0.1);
  mark(true);
  EXPECT_TRUE(bit("ready"));
  EXPECT_EQ(here(), 2);
}

TEST_F(CarouselTest, WrongListsAreRefused) {
  EXPECT_NE(refused("", "gray", "2").find("pockets="), std::string::npos);
  EXPECT_NE(refused("4,x", "gray", "2").find("pockets="), std::string::npos);
  EXPECT_NE(refused("4", "grey", "2").find("encoding="), std::string::npos);
  EXPECT_NE(refused("4", "gray", "3").find("dir="), std::string::npos);
}

}  // namespace
}  // namespace kerf::components
