// What halsampler prints.
#include "hal/tools/sample_reader.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

class SampleReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    hal.set_arg("cfg", "fbsulk");
    hal.set_arg("depth", "3");
    ASSERT_TRUE(hal.create(module("sampler"), "sampler")) << hal.error();
    stream = hal::Stream::attach(hal.block(hal::stream_memory_name(hal::kSamplerKey)),
                                 hal::Stream::bytes(3, 6));
    ASSERT_TRUE(stream.valid());
    out = std::tmpfile();
    ASSERT_NE(out, nullptr);
  }
  void TearDown() override { std::fclose(out); }

  void sample(double value) {
    hal.set("sampler.0.pin.0", value);
    hal.run("sampler.0");
  }
  std::string printed() {
    std::fflush(out);
    std::string text(static_cast<std::size_t>(std::ftell(out)), ' ');
    std::rewind(out);
    EXPECT_EQ(std::fread(text.data(), 1, text.size(), out), text.size());
    return text;
  }
  rtapi::WaitSpec step(hal::SampleReader& reader, rtapi::Nanos now = 0) {
    rtapi::WaitSpec next;
    reader.step(now, next);
    return next;
  }

  hal::TestBuilder hal;
  hal::Stream stream;
  std::FILE* out{nullptr};
};

TEST_F(SampleReaderTest, PrintsALineASample) {
  hal.set("sampler.0.pin.1", true);
  hal.set("sampler.0.pin.2", -12);
  hal.set("sampler.0.pin.3", 4'000'000'000U);
  hal.set("sampler.0.pin.4", std::int64_t{-5'000'000'000});
  hal.set("sampler.0.pin.5", std::int64_t{7});
  sample(123.5);
  hal.set("sampler.0.pin.1", false);
  sample(-1e-7);
  hal::SampleReader reader(stream, {}, out);
  const rtapi::WaitSpec next = step(reader);
  EXPECT_FALSE(reader.done());
  EXPECT_EQ(next.until, rtapi::kForever);
  EXPECT_EQ(next.cells.size(), 1U);
  EXPECT_EQ(printed(),
            "123.500000 1 -12 4000000000 -5000000000 7 \n"
            "-0.000000 0 -12 4000000000 -5000000000 7 \n");
}

TEST_F(SampleReaderTest, EndsAtTheCountAndLeavesTheRest) {
  for (int i = 0; i < 3; ++i) sample(i);
  hal::SampleReader reader(stream, {.tagged = true, .count = 2}, out);
  step(reader);
  EXPECT_TRUE(reader.done());
  EXPECT_EQ(reader.error(), "");
  EXPECT_EQ(printed(), "0 0.000000 0 0 0 0 0 \n1 1.000000 0 0 0 0 0 \n");
  EXPECT_EQ(stream.size(), 1U);
}

TEST_F(SampleReaderTest, MarksEachGapWhereItIs) {
  for (int i = 0; i < 5; ++i) sample(i);  // 3 and 4 are lost
  hal::SampleReader reader(stream, {.tagged = true, .count = -1}, out);
  step(reader);
  sample(5);
  step(reader);
  EXPECT_EQ(printed(),
            "0 0.000000 0 0 0 0 0 \n1 1.000000 0 0 0 0 0 \n2 2.000000 0 0 0 0 0 \n"
            "overrun\n5 5.000000 0 0 0 0 0 \n");
}

TEST_F(SampleReaderTest, FailsWhenTheSamplerGoesButPrintsWhatItLeft) {
  sample(1);
  hal::SampleReader reader(stream, {.tagged = false, .count = 10}, out);
  stream.close();
  step(reader);
  EXPECT_TRUE(reader.done());
  EXPECT_EQ(reader.error(), "the sampler was unloaded");
  EXPECT_EQ(printed(), "1.000000 0 0 0 0 0 \n");
}

TEST_F(SampleReaderTest, FailsWhenItCannotWrite) {
  std::FILE* full = std::fopen("/dev/full", "w");
  if (full == nullptr) GTEST_SKIP() << "no /dev/full here";
  sample(1);
  hal::SampleReader reader(stream, {}, full);
  step(reader);
  EXPECT_TRUE(reader.done());
  EXPECT_NE(reader.error().find("cannot write"), std::string::npos);
  std::fclose(full);
}

}  // namespace
}  // namespace kerf::components
