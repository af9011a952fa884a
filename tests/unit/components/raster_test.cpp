// raster, and port pins of the C++ API.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hal/core/test_builder.hpp"
#include "hal/port_pins.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

class Echo final : public hal::Component<Echo> {
 public:
  static constexpr hal::Info kInfo{.name = "echo", .summary = "Gives back four bytes at a time"};
  using Component::Component;

 private:
  hal::PortIn in_{pin<hal::PortIn>("in", "Bytes")};
  hal::PortOut out_{pin<hal::PortOut>("out", "The same bytes")};
  void update(const hal::Period&) noexcept {
    char four[4];
    if (out_.writable() >= 4 && in_.read(four, 4)) (void)out_.write(four, 4);
  }
  hal::Function update_{function<&Echo::update>("", "Moves four bytes")};
};

TEST(PortPins, PassBytesWholeOrNotAtAll) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create<Echo>("e"));
  EXPECT_EQ(hal.type("e.in"), hal::Type::port);
  EXPECT_EQ(hal.dir("e.out"), hal::Dir::out);
  hal.run("e");  // no queue yet
  hal::Port to = hal.make_queue("e.in", 10);
  hal::Port from = hal.make_queue("e.out", 6);
  ASSERT_TRUE(to.write("abcdefgh", 8));
  EXPECT_FALSE(to.write("ijk", 3)) << "8 of 10 are taken";
  hal.run("e", 1'000'000, 3);
  EXPECT_EQ(to.readable(), 4U) << "the second four have no room";
  char got[5] = {};
  ASSERT_TRUE(from.read(got, 4));
  EXPECT_STREQ(got, "abcd");
  hal.run("e");
  ASSERT_TRUE(from.read(got, 4));
  EXPECT_STREQ(got, "efgh");
}

class Raster : public testing::Test {
 protected:
  Raster() {
    EXPECT_TRUE(hal.create(module("raster"), "r")) << hal.error();
    port = hal.make_queue("r.program", 256);
  }
  void put(const std::string& text) {
    ASSERT_TRUE(port.write(text.data(), static_cast<std::uint32_t>(text.size())));
  }
  double at(double position) {
    hal.set("r.position", position);
    hal.run("r");
    return hal.get<double>("r.output");
  }
  void run(bool on) {
    hal.set("r.run", on);
    hal.run("r");
  }
  std::int32_t state() { return hal.get<std::int32_t>("r.state"); }
  std::int32_t code() {
    EXPECT_EQ(hal.get<bool>("r.fault"), hal.get<std::int32_t>("r.fault-code") != 0);
    return hal.get<std::int32_t>("r.fault-code");
  }
  hal::TestBuilder hal;
  hal::Port port;
};

TEST_F(Raster, GivesEachPixelItsPower) {
  put("0.5;4;10;4;0F80%");
  EXPECT_EQ(at(7.0), 0.0);
  run(true);
  EXPECT_EQ(hal.get<double>("r.program-position"), 7.0);
  EXPECT_EQ(hal.get<std::int32_t>("r.count"), 4);
  EXPECT_TRUE(hal.get<bool>("r.active"));
  EXPECT_FALSE(hal.get<bool>("r.enabled"));
  EXPECT_EQ(at(7.49), 0.0);
  EXPECT_EQ(at(7.55), 0.0);
  EXPECT_TRUE(hal.get<bool>("r.enabled")) << "over the first pixel, whose value is 0";
  EXPECT_EQ(at(7.61), 100.0);
  EXPECT_EQ(at(7.69), 100.0);
  EXPECT_NEAR(at(7.71), 800.0 / 15.0, 1e-12);
  EXPECT_EQ(hal.get<std::uint32_t>("r.current-pixel-value"), 8U);
  EXPECT_NEAR(at(7.69), 800.0 / 15.0, 1e-12) << "back by less than a pixel";
  EXPECT_EQ(at(7.55), 0.0) << "back by more";
  EXPECT_FALSE(hal.get<bool>("r.enabled"));
  EXPECT_NEAR(at(7.75), 800.0 / 15.0, 1e-12);
  EXPECT_EQ(at(std::nan("")), 0.0);
  EXPECT_EQ(at(7.85), 0.0);
  EXPECT_EQ(state(), 2);
  EXPECT_EQ(at(7.95), 0.0);
  EXPECT_EQ(state(), 3);
  EXPECT_FALSE(hal.get<bool>("r.active"));
  EXPECT_EQ(code(), 0);
  EXPECT_EQ(port.readable(), 0U);
  run(false);
  EXPECT_EQ(state(), 0);
}

TEST_F(Raster, RunsBackwardsAndLineAfterLine) {
  put("0;8;2;3;FF0080%\n-1;12;-2;2;FFF800%\n");
  at(0.0);
  run(true);
  EXPECT_EQ(hal.get<double>("r.output"), 100.0);
  EXPECT_EQ(at(0.6), 0.0);
  EXPECT_NEAR(at(1.2), 12800.0 / 255.0, 1e-9);
  EXPECT_EQ(at(1.6), 0.0);
  EXPECT_EQ(at(-2.0), 0.0) << "at the end until run goes";
  at(2.0);
  run(false);
  run(true);
  EXPECT_EQ(at(1.1), 0.0);
  EXPECT_EQ(at(0.8), 100.0);
  EXPECT_NEAR(at(0.4), 100.0 * 0x800 / 0xfff, 1e-9);
  EXPECT_EQ(at(-0.1), 0.0);
  EXPECT_EQ(state(), 3);
  EXPECT_EQ(code(), 0);
}

TEST_F(Raster, PixelsPassedWithinOneCycleAreLeftOut) {
  put("0;4;1;6;123456%");
  run(true);
  EXPECT_NEAR(at(4.5), 500.0 / 15.0, 1e-9);
  EXPECT_EQ(at(100.0), 0.0);
  EXPECT_EQ(state(), 3);
  EXPECT_EQ(code(), 0);
}

TEST_F(Raster, AWriterMayKeepAheadOfThePosition) {
  run(true);
  EXPECT_EQ(state(), 1);
  put("0;4;1;");
  hal.run("r");
  EXPECT_EQ(state(), 1);
  put("2000;");
  for (int i = 0; i < 2000; ++i) {
    put("9");
    ASSERT_NEAR(at(i + 0.5), 60.0, 1e-9) << i;
  }
  put("%");
  EXPECT_EQ(at(2000.0), 0.0);
  EXPECT_EQ(state(), 3);
}

TEST_F(Raster, TheEndOfRunDropsTheRestOfItsProgramOnly) {
  put("0;4;1;6;12");
  run(true);
  at(0.5);
  run(false);
  EXPECT_EQ(hal.get<double>("r.output"), 0.0);
  run(true);  // while the rest has not come
  EXPECT_EQ(state(), 4);
  put("3456%0;4;1;1;F%");
  hal.run("r");
  EXPECT_EQ(state(), 2);
  EXPECT_EQ(hal.get<double>("r.output"), 100.0);
}

TEST_F(Raster, SaysWhatItCannotRead) {
  struct Row {
    const char* program;
    std::int32_t code;
  };
  for (const Row& row :
       {Row{"a;4;1;1;F%", 1}, Row{"0;4;1;%", 1}, Row{"0;4.5;1;1;F%", 1}, Row{"0;;1;1;F%", 1},
        Row{"0;6;1;1;F%", 2}, Row{"0;36;1;1;F%", 2}, Row{"0;0;1;1;F%", 2}, Row{"0;4;0;1;F%", 3},
        Row{"0;4;1;0;%", 4}, Row{"0;4;1;-3;F%", 4}, Row{"0;4;1;2000000;F%", 4},
        Row{"0;4;1;1;G%", 5}, Row{"0;4;1;2;%", 5}, Row{"0;8;1;2;F", 6}, Row{"", 0}}) {
    put(row.program);
    at(0.5);
    run(true);
    at(1.0);
    EXPECT_EQ(code(), row.code) << row.program;
    EXPECT_EQ(hal.get<double>("r.output"), 0.0);
    hal.set("r.reset", true);
    run(false);
    hal.set("r.reset", false);
    EXPECT_EQ(code(), 0);
    EXPECT_EQ(state(), 0);
    EXPECT_EQ(port.readable(), 0U);
  }
  put("0;4;1;1;FF%");
  at(0.0);
  run(true);
  EXPECT_EQ(hal.get<double>("r.output"), 100.0);
  at(1.0);
  EXPECT_EQ(code(), 7);
  put(std::string(200, ' '));
  hal.set("r.reset", true);
  run(false);
  hal.set("r.reset", false);
  put(std::string(200, '1'));
  run(true);
  EXPECT_EQ(code(), 1) << "no end to the first number";
}

}  // namespace
}  // namespace kerf::components
