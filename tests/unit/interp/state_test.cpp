// Snapshots, restore after an abort, synchronisation, and what is visible during delivery.
#include <gtest/gtest.h>

#include <type_traits>

#include "interp/null_canon.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

static_assert(std::is_trivially_copyable_v<ModalState>, "task copies it with each queued item");

TEST(State, RestoreTakesModesAndOffsetsBackWithoutACall) {
  Rig rig;
  (void)rig.mdi("G0 X10");
  (void)rig.mdi("G92 X1");
  const ModalState before = rig.interp.modal();
  (void)rig.run("G20 G91 G55 G18 F5 M3 S10\nG92.1\nG10 L2 P2 X5\nG43.1 Z4\nG1 X3\n(abort,x)\n");
  rig.interp.abort();
  rig.interp.restore(before);
  EXPECT_EQ(rig.calls(), "");
  EXPECT_EQ(rig.interp.modal().active_g_codes(), before.active_g_codes());
  EXPECT_EQ(rig.interp.modal().frame, before.frame);
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5220 #5420"), "1 9 1 1");
  Pose machine;
  machine.x = 42;
  rig.interp.synchronize({.machine_position = machine});
  EXPECT_EQ(rig.debug("%d#5420 #<_abs_x>"), "33 42");
}

TEST(State, SynchronizeMovesOnlyThePosition) {
  Rig rig;
  (void)rig.mdi("G10 L2 P1 X5 R90");
  Pose machine;
  machine.x = 5;
  machine.y = 7;
  rig.interp.synchronize({.machine_position = machine});
  EXPECT_NEAR(rig.interp.modal().position.x, 7, 1e-12);
  EXPECT_NEAR(rig.interp.modal().position.y, 0, 1e-12);
}

TEST(State, RestoreTakesTheLengthOfTheToolNowInTheSpindle) {
  for (const char* restore : {"M72", "M73"}) {
    Rig rig;
    rig.world.files.set_tool({1, 1, Pose{0, 0, 10}, 0, 0, 0, 0});
    rig.world.files.set_tool({2, 2, Pose{0, 0, 20}, 0, 0, 0, 0});
    const bool by_return = std::string(restore) == "M73";
    const std::string body = by_return ? "M73\nT2 M6\nG49\n" : "M70\nT2 M6\nG49\nM72\n";
    (void)rig.run("o1 sub\n" + body + "o1 endsub\nM61 Q1\nG43\no1 call\n(end)\n");
    EXPECT_EQ(rig.interp.modal().frame.tool().z, 20) << restore;
    EXPECT_EQ(rig.interp.modal().tool_offset_code, 430) << restore;
  }
}

TEST(State, SaveAfterM73LeavesTheRestoreOnReturnOn) {
  Rig rig;
  (void)rig.run("o1 sub\nM73\nG91\nM70\nG18\no1 endsub\nG90 G17\no1 call\n(end)\n");
  EXPECT_EQ(rig.interp.modal().plane_code, 170);
  EXPECT_EQ(rig.interp.modal().active_g_codes()[6], 910) << "M70 saved anew";
}

TEST(State, ActiveCodesAsClientsKnowThem) {
  Rig rig;
  const auto g = rig.interp.modal().active_g_codes();
  const std::array<std::int32_t, 17> expected{0,   800, -1,  170, 400, 210, 900, 940, 540,
                                              490, 990, 640, -1,  970, 911, 80,  922};
  EXPECT_EQ(g, expected);
  const auto m = rig.interp.modal().active_m_codes();
  const std::array<std::int32_t, 10> stopped{0, -1, 5, -1, 9, -1, 48, -1, 53, 0};
  EXPECT_EQ(m, stopped);
  (void)rig.mdi("G64 P.5 F100 S200 M4");
  EXPECT_EQ(rig.interp.modal().settings(), (std::array<double, 5>{1, 100, 200, 0.5, 0.5}));
  EXPECT_EQ(rig.interp.modal().active_m_codes()[2], 4);
}

/// Looks at the interpreter while a call is delivered.
TEST(State, IsAlreadyThatOfTheBlockDuringDelivery) {
  struct World final : public Environment {
  } world;
  Interpreter* seen = nullptr;
  struct Peek {
    std::int32_t motion{-1}, line{-1};
    SourceLine source;
  } peek;
  class PeekCanon final : public NullCanon {
   public:
    PeekCanon(Interpreter*& i, Peek& p) : interp_(i), peek_(p) {}
    void next_block(const SourceLine& s) override { peek_.source = s; }
    void straight_feed(const Pose&) override {
      peek_.motion = interp_->modal().motion;
      peek_.line = interp_->modal().line;
    }

   private:
    Interpreter*& interp_;
    Peek& peek_;
  } canon(seen, peek);
  Interpreter interp(world, canon);
  seen = &interp;
  interp.init();
  ASSERT_TRUE(interp.open_text("a.ngc", "\nN7 G1 X1 F5\n").ok());
  ASSERT_EQ(interp.execute_next(), Outcome::ok);
  ASSERT_EQ(interp.execute_next(), Outcome::ok);
  EXPECT_EQ(peek.motion, 10);
  EXPECT_EQ(peek.line, 2);
  EXPECT_EQ(peek.source.line, 2);
  EXPECT_EQ(peek.source.sequence, 7);
  EXPECT_EQ(peek.source.call_level, 0);
}

}  // namespace
}  // namespace kerf::interp
