// streamer: rows to pins, by call and by clock.
#include <gtest/gtest.h>

#include "hal/core/test_builder.hpp"
#include "hal/stream.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

class StreamerTest : public testing::Test {
 protected:
  void load(const char* cfg, const char* depth) {
    hal.set_arg("cfg", cfg);
    hal.set_arg("depth", depth);
    ASSERT_TRUE(hal.create(module("streamer"), "streamer")) << hal.error();
  }
  hal::Stream stream(std::uint32_t channel = 0) {
    std::byte* block = hal.block(hal::stream_memory_name(hal::kStreamerKey + channel));
    return block == nullptr ? hal::Stream() : hal::Stream::attach(block, std::size_t{1} << 24U);
  }
  void feed(int first, int last) {
    hal::Stream fifo = stream();
    for (int i = first; i <= last; ++i) {
      const std::uint64_t row[1] = {hal::to_raw(static_cast<double>(i))};
      ASSERT_TRUE(fifo.write(row));
    }
  }
  double value() { return hal.get<double>("streamer.0.pin.0"); }
  std::int32_t s32(const char* name) { return hal.get<std::int32_t>(name); }
  hal::TestBuilder hal;
};

TEST_F(StreamerTest, WritesEveryTypeInColumnOrder) {
  load("bFsulk", "4");
  hal::Stream fifo = stream();
  ASSERT_EQ(fifo.types(), "bfsulk");
  const std::uint64_t row[6] = {1,
                                hal::to_raw(-2.5),
                                hal::to_raw(std::int32_t{-7}),
                                hal::to_raw(std::uint32_t{4'000'000'000}),
                                hal::to_raw(std::int64_t{-5'000'000'000}),
                                hal::to_raw(std::uint64_t{6'000'000'000})};
  ASSERT_TRUE(fifo.write(row));
  hal.run("streamer.0");
  EXPECT_TRUE(hal.get<bool>("streamer.0.pin.0"));
  EXPECT_EQ(hal.get<double>("streamer.0.pin.1"), -2.5);
  EXPECT_EQ(hal.get<std::int32_t>("streamer.0.pin.2"), -7);
  EXPECT_EQ(hal.get<std::uint32_t>("streamer.0.pin.3"), 4'000'000'000U);
  EXPECT_EQ(hal.get<std::int64_t>("streamer.0.pin.4"), -5'000'000'000);
  EXPECT_EQ(hal.get<std::uint64_t>("streamer.0.pin.5"), 6'000'000'000U);
}

TEST_F(StreamerTest, TakesARowACallAndCountsWhatIsMissing) {
  load("f", "10");
  EXPECT_TRUE(hal.get<bool>("streamer.0.empty"));
  feed(1, 3);
  for (int i = 1; i <= 3; ++i) {
    hal.run("streamer.0");
    EXPECT_EQ(value(), i);
    EXPECT_EQ(s32("streamer.0.curr-depth"), 4 - i);
    EXPECT_FALSE(hal.get<bool>("streamer.0.empty"));
  }
  EXPECT_EQ(s32("streamer.0.underruns"), 0);
  hal.run("streamer.0", 1'000'000, 2);
  EXPECT_EQ(value(), 3);
  EXPECT_EQ(s32("streamer.0.curr-depth"), 0);
  EXPECT_TRUE(hal.get<bool>("streamer.0.empty"));
  EXPECT_EQ(s32("streamer.0.underruns"), 2);
  hal.set("streamer.0.underruns", 0);
  hal.run("streamer.0");
  EXPECT_EQ(s32("streamer.0.underruns"), 1);
}

TEST_F(StreamerTest, StandsWhileDisabledButShowsTheDepth) {
  load("f", "10");
  feed(1, 2);
  hal.set("streamer.0.enable", false);
  hal.run("streamer.0", 1'000'000, 3);
  EXPECT_EQ(value(), 0);
  EXPECT_EQ(s32("streamer.0.curr-depth"), 2);
  EXPECT_FALSE(hal.get<bool>("streamer.0.empty"));
  hal.set("streamer.0.enable", true);
  hal.run("streamer.0");
  EXPECT_EQ(value(), 1);
}

// Captured from LinuxCNC 2.9: the value after each call of streamer.0 while the clock pin goes 0 0 1 1 0 1 0 0 1 0 1 1 0 0.
TEST_F(StreamerTest, TakesRowsAtTheEdgesThatTheClockModeNames) {
  constexpr int kClock[] = {0, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0};
  constexpr int kExpected[4][14] = {{1, 2, 3, 4, 5, 6, 6, 6, 6, 6, 6, 6, 6, 6},
                                    {0, 0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4},
                                    {0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 4},
                                    {0, 0, 1, 1, 2, 3, 4, 4, 5, 6, 6, 6, 6, 6}};
  constexpr int kUnderruns[] = {8, 0, 0, 2};
  load("f", "10");
  for (int mode = 0; mode < 4; ++mode) {
    SCOPED_TRACE(mode);
    while (!stream().empty()) stream().pop();
    hal.set("streamer.0.clock-mode", mode);
    hal.set("streamer.0.pin.0", 0.0);
    hal.set("streamer.0.underruns", 0);
    feed(1, 6);
    for (std::size_t i = 0; i < std::size(kClock); ++i) {
      hal.set("streamer.0.clock", kClock[i] != 0);
      hal.run("streamer.0");
      EXPECT_EQ(value(), kExpected[mode][i]) << i;
    }
    EXPECT_EQ(s32("streamer.0.underruns"), kUnderruns[mode]);
  }
  hal.set("streamer.0.clock-mode", 9);  // nonsense: nothing moves
  hal.run("streamer.0");
  EXPECT_EQ(s32("streamer.0.underruns"), 2);
}

TEST_F(StreamerTest, HasAFifoForEachChannel) {
  load("f,bb", "4,2");
  EXPECT_EQ(stream(0).depth(), 4U);
  EXPECT_EQ(stream(1).types(), "bb");
  EXPECT_FALSE(stream(2).valid());
}

}  // namespace
}  // namespace kerf::components
