#include <gtest/gtest.h>

#include "hal/core/test_builder.hpp"
#include "hal/stream.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

class SamplerTest : public testing::Test {
 protected:
  void load(const char* cfg, const char* depth) {
    hal.set_arg("cfg", cfg);
    hal.set_arg("depth", depth);
    ASSERT_TRUE(hal.create(module("sampler"), "sampler")) << hal.error();
  }
  hal::Stream stream(std::size_t channel = 0) {
    std::byte* block =
        hal.block(hal::stream_memory_name(hal::kSamplerKey + static_cast<std::uint32_t>(channel)));
    return block == nullptr ? hal::Stream() : hal::Stream::attach(block, std::size_t{1} << 24U);
  }
  std::int32_t s32(const char* name) { return hal.get<std::int32_t>(name); }
  hal::TestBuilder hal;
};

TEST_F(SamplerTest, RecordsEveryTypeInColumnOrder) {
  load("bFsulk", "4");
  EXPECT_EQ(hal.type("sampler.0.pin.0"), hal::Type::bit);
  EXPECT_EQ(hal.type("sampler.0.pin.1"), hal::Type::floating);
  EXPECT_EQ(hal.type("sampler.0.pin.2"), hal::Type::s32);
  EXPECT_EQ(hal.type("sampler.0.pin.3"), hal::Type::u32);
  EXPECT_EQ(hal.type("sampler.0.pin.4"), hal::Type::s64);
  EXPECT_EQ(hal.type("sampler.0.pin.5"), hal::Type::u64);
  hal.set("sampler.0.pin.0", true);
  hal.set("sampler.0.pin.1", -2.5);
  hal.set("sampler.0.pin.2", -7);
  hal.set("sampler.0.pin.3", 4'000'000'000U);
  hal.set("sampler.0.pin.4", std::int64_t{-5'000'000'000});
  hal.set("sampler.0.pin.5", std::int64_t{6'000'000'000});
  hal.run("sampler.0");
  hal::Stream fifo = stream();
  ASSERT_TRUE(fifo.valid());
  ASSERT_EQ(fifo.columns(), 6U);
  hal::StreamRow row;
  ASSERT_TRUE(fifo.front(row));
  EXPECT_EQ(row.number, 1U);
  EXPECT_TRUE(hal::from_raw<bool>(row.values[0]));
  EXPECT_EQ(hal::from_raw<double>(row.values[1]), -2.5);
  EXPECT_EQ(hal::from_raw<std::int32_t>(row.values[2]), -7);
  EXPECT_EQ(hal::from_raw<std::uint32_t>(row.values[3]), 4'000'000'000U);
  EXPECT_EQ(hal::from_raw<std::int64_t>(row.values[4]), -5'000'000'000);
  EXPECT_EQ(hal::from_raw<std::uint64_t>(row.values[5]), 6'000'000'000U);
  fifo.pop();
  EXPECT_FALSE(fifo.front(row));
}

TEST_F(SamplerTest, CountsWhatFindsNoRoomAndMarksTheGap) {
  load("s", "3");
  for (int i = 0; i < 5; ++i) {
    hal.set("sampler.0.pin.0", 100 + i);
    hal.run("sampler.0");
    EXPECT_EQ(s32("sampler.0.curr-depth"), std::min(i + 1, 3));
    EXPECT_EQ(hal.get<bool>("sampler.0.full"), i >= 2);
  }
  EXPECT_EQ(s32("sampler.0.overruns"), 2);
  EXPECT_EQ(s32("sampler.0.sample-num"), 5);

  hal::Stream fifo = stream();
  hal::StreamRow row;
  for (int i = 0; i < 3; ++i) {  // the old ones are kept
    ASSERT_TRUE(fifo.front(row));
    EXPECT_EQ(hal::from_raw<std::int32_t>(row.values[0]), 100 + i);
    EXPECT_EQ(row.lost_before, 0U);
    fifo.pop();
  }
  for (int i = 5; i < 7; ++i) {
    hal.set("sampler.0.pin.0", 100 + i);
    hal.run("sampler.0");
  }
  ASSERT_TRUE(fifo.front(row));
  EXPECT_EQ(row.number, 6U);
  EXPECT_EQ(row.lost_before, 2U);
  EXPECT_EQ(hal::from_raw<std::int32_t>(row.values[0]), 105);
  fifo.pop();
  ASSERT_TRUE(fifo.front(row));
  EXPECT_EQ(row.number, 7U);
  EXPECT_EQ(row.lost_before, 0U);
  EXPECT_FALSE(hal.get<bool>("sampler.0.full"));
}

TEST_F(SamplerTest, StandsWhileDisabledAndItsCountersCanBeSet) {
  load("b", "8");
  hal.run("sampler.0", 1'000'000, 2);
  hal.set("sampler.0.enable", false);
  hal.run("sampler.0", 1'000'000, 5);
  EXPECT_EQ(s32("sampler.0.sample-num"), 2);
  EXPECT_EQ(s32("sampler.0.curr-depth"), 2);
  hal::Stream fifo = stream();
  fifo.pop();
  hal.run("sampler.0");
  EXPECT_EQ(s32("sampler.0.curr-depth"), 1);  // the truth even so
  hal.set("sampler.0.enable", true);
  hal.set("sampler.0.sample-num", 40);
  hal.run("sampler.0");
  fifo.pop();
  hal::StreamRow row;
  ASSERT_TRUE(fifo.front(row));
  EXPECT_EQ(row.number, 41U);
}

TEST_F(SamplerTest, HasAFifoForEachChannel) {
  load("f,bb", "4,2");
  hal.run("sampler.1", 1'000'000, 2);
  EXPECT_EQ(stream(0).size(), 0U);
  EXPECT_EQ(stream(1).size(), 2U);
  EXPECT_TRUE(stream(1).full());
  EXPECT_EQ(stream(1).columns(), 2U);
}

TEST_F(SamplerTest, RunsThroughManyTurnsOfTheFifo) {
  load("s", "7");
  hal::Stream fifo = stream();
  hal::StreamRow row;
  std::int32_t expected = 0;
  for (int i = 0; i < 1000; ++i) {
    hal.set("sampler.0.pin.0", i);
    hal.run("sampler.0");
    while (i % 5 == 0 && fifo.front(row)) {
      ASSERT_EQ(hal::from_raw<std::int32_t>(row.values[0]), expected++);
      fifo.pop();
    }
  }
  EXPECT_EQ(s32("sampler.0.overruns"), 0);
  EXPECT_GT(expected, 990);
}

TEST(Sampler, RefusesBadParametersByName) {
  struct Case {
    const char *cfg, *depth, *message;
  };
  constexpr Case kCases[] = {
      {"", "10", "cfg= is missing"},
      {"bb", "", "depth= is missing"},
      {"bx", "10", "unknown type letter in cfg=bx; the letters are b f s u l k"},
      {"b,b", "10", "cfg= and depth= have lists of different lengths"},
      {"b", "10,10", "cfg= and depth= have lists of different lengths"},
      {"b", "0", "depth= must be a number from 1 to 10000000, not 0"},
      {"b", "ten", "depth= must be a number from 1 to 10000000, not ten"},
      {"ffffffffffffffffffffff", "10", "more than 21 pins in cfg=ffffffffffffffffffffff"},
  };
  for (const Case& c : kCases) {
    hal::TestBuilder hal;
    hal.set_arg("cfg", c.cfg);
    hal.set_arg("depth", c.depth);
    EXPECT_FALSE(hal.create(module("sampler"), "sampler"));
    EXPECT_EQ(hal.error(), c.message);
  }
}

}  // namespace
}  // namespace kerf::components
