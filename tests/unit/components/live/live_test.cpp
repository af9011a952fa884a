// Components in a running HAL: loaded by name, connected by signals, on the virtual clock.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <string>

#include "hal/client/find_stream.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/realtime_host.hpp"
#include "hal/tools/sample_reader.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"

#define KERF_TEST_MODULE(id) extern "C" const ::kerf::hal::Module kerf_hal_module_##id;
#include "modules.inc"
#undef KERF_TEST_MODULE

namespace kerf::components {
namespace {

constexpr hal::StaticModule kModules[] = {
#define KERF_TEST_MODULE(id) {#id, &kerf_hal_module_##id},
#include "modules.inc"
#undef KERF_TEST_MODULE
};

class LiveTest : public testing::Test {
 protected:
  void SetUp() override {
    auto made = hal::Host::create(*segment, clock, modules);
    ASSERT_TRUE(made.ok()) << made.error().message();
    host = std::move(made).value();
    realtime.emplace(*host);
    clock.add(*realtime);
  }
  /// One command as in a HAL file.
  hal::Reply command(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    return host->command(std::span<const std::string>(words));
  }
  void script(std::initializer_list<const char*> lines) {
    for (const char* line : lines) {
      const hal::Reply reply = command(line);
      ASSERT_TRUE(reply.ok()) << line << ": " << reply.text;
    }
  }
  bool has(const char* pin) { return hal::View(*segment).find_pin(pin).has_value(); }
  hal::Stream fifo() { return hal::find_stream(*segment, hal::kSamplerKey).value_or({}); }

  std::unique_ptr<rtapi::Segment> segment{rtapi::Segment::in_memory(std::size_t{16} << 20U)};
  rtapi::LocalScheduler clock;
  hal::StaticSource modules{kModules};
  std::unique_ptr<hal::Host> host;
  std::optional<hal::RealtimeHost> realtime;
};

TEST_F(LiveTest, ComponentsLoadUnderTheirDocumentedNames) {
  script({"loadrt and2 count=2", "loadrt or2 names=left,right", "loadrt sim_home_switch",
          "loadrt sim_spindle", "loadrt sim-axis count=3", "loadrt conv_float_s32",
          "loadrt siggen num_chan=2"});
  for (const char* pin : {"and2.1.out", "left.in0", "right.out", "sim-home-switch.0.home-sw",
                          "sim-spindle.0.position-fb", "sim-axis.2.pos-fb", "conv-float-s32.0.out",
                          "siggen.1.sine"}) {
    EXPECT_TRUE(has(pin)) << pin;
  }
  script({"unloadrt siggen", "loadrt siggen names=a,b"});
  EXPECT_TRUE(has("b.sine"));
  EXPECT_FALSE(has("siggen.1.sine"));
}

TEST_F(LiveTest, SamplerAndReaderSeeEveryCycle) {
  script({"loadrt threads name1=servo period1=1000000", "loadrt siggen", "loadrt sim-axis",
          "loadrt sampler depth=8 cfg=ffb", "addf siggen.0.update servo", "addf sim-axis.0 servo",
          "addf sampler.0 servo", "net cmd siggen.0.sine sim-axis.0.pos-cmd sampler.0.pin.0",
          "net fb sim-axis.0.pos-fb sampler.0.pin.1", "net home sim-axis.0.home-sw sampler.0.pin.2",
          "setp siggen.0.frequency 5", "setp siggen.0.amplitude 10", "setp sim-axis.0.lag 0.004",
          "setp sim-axis.0.home-switch-pos -5", "start"});
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  hal::SampleReader reader(fifo(), {.tagged = true, .count = 400}, out);
  clock.add(reader);
  ASSERT_TRUE(clock.run_until([&] { return reader.done(); }, rtapi::kSecond));
  EXPECT_EQ(reader.error(), "");
  clock.remove(reader);

  std::rewind(out);
  long number = 0;
  double cmd = 0, fb = 0, expected_fb = 0;
  int home = 0, rows = 0;
  while (std::fscanf(out, "%ld %lf %lf %d", &number, &cmd, &fb, &home) == 4) {
    ASSERT_EQ(number, rows);
    ++rows;
    EXPECT_NEAR(cmd, 10 * std::sin(2 * std::numbers::pi * 0.005 * rows), 2e-6);
    expected_fb += (cmd - expected_fb) * (1 - std::exp(-0.25));
    EXPECT_NEAR(fb, expected_fb, 1e-5);
    EXPECT_EQ(home, fb <= -5.0 ? 1 : 0);
  }
  EXPECT_EQ(rows, 400);
  std::fclose(out);
}

TEST_F(LiveTest, SamplerCanBeLoadedAgainAndItsReaderEnds) {
  script({"loadrt sampler depth=4 cfg=b"});
  std::FILE* out = std::tmpfile();
  hal::SampleReader reader(fifo(), {}, out);
  clock.add(reader);
  clock.run_until(10 * rtapi::kMillisecond);
  EXPECT_FALSE(reader.done());
  script({"unloadrt sampler"});
  clock.run_until(20 * rtapi::kMillisecond);
  EXPECT_TRUE(reader.done());
  clock.remove(reader);
  std::fclose(out);
  EXPECT_FALSE(fifo().valid());
  script({"loadrt sampler depth=9 cfg=ss"});
  EXPECT_EQ(fifo().depth(), 9U);
}

TEST_F(LiveTest, AFailedLoadLeavesNothingBehind) {
  struct Case {
    const char *line, *message;
  };
  constexpr Case kCases[] = {
      {"loadrt sampler cfg=bz depth=4", "unknown type letter in cfg=bz"},
      {"loadrt sampler cfg=b deph=4", "depth"},
      {"loadrt threads name1=a period1=5x", "not an integer"},
      {"loadrt threads name1=a period1=1000000 name2=b period2=500000", "period2 is shorter"},
      {"loadrt siggen names=a,b num_chan=2", "neither count= nor names="},
      {"loadrt siggen num_chan=2 count=2", "neither count= nor names="},
      {"loadrt simm_spindle", "sim_spindle"},
  };
  for (const Case& c : kCases) {
    const hal::Reply reply = command(c.line);
    EXPECT_FALSE(reply.ok()) << c.line;
    EXPECT_THAT(reply.text, testing::HasSubstr(c.message)) << c.line;
  }
  EXPECT_TRUE(hal::View(*segment).find_pin("siggen.0.sine") == std::nullopt);
  script({"loadrt sampler cfg=b depth=4", "loadrt siggen num_chan=2",
          "loadrt threads name1=a period1=1000000"});
}

}  // namespace
}  // namespace kerf::components
