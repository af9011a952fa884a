#include <gtest/gtest.h>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

struct Gate {
  const char* name;
  bool out[4];  // for in0,in1 = 00, 10, 01, 11
};

TEST(Logic, GatesFollowTheirTruthTables) {
  constexpr Gate kGates[] = {
      {"and2", {false, false, false, true}},
      {"or2", {false, true, true, true}},
  };
  for (const Gate& gate : kGates) {
    SCOPED_TRACE(gate.name);
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module(gate.name), "g")) << hal.error();
    for (unsigned row = 0; row < 4; ++row) {
      hal.set("g.in0", (row & 1U) != 0);
      hal.set("g.in1", (row & 2U) != 0);
      hal.run("g");
      EXPECT_EQ(hal.get<bool>("g.out"), gate.out[row]) << "row " << row;
    }
  }
}

TEST(Logic, NotInverts) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("not"), "not.0"));
  hal.run("not.0");
  EXPECT_TRUE(hal.get<bool>("not.0.out"));
  hal.set("not.0.in", true);
  hal.run("not.0");
  EXPECT_FALSE(hal.get<bool>("not.0.out"));
}

TEST(Logic, GatesChangeNothingUntilTheyRun) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("or2"), "or2.0"));
  hal.set("or2.0.in0", true);
  EXPECT_FALSE(hal.get<bool>("or2.0.out"));
}

}  // namespace
}  // namespace kerf::components
