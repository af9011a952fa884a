// Snapshots, restore after an abort, synchronisation, and what is visible during delivery.
#include <gtest/gtest.h>

#include <type_traits>

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

TEST(State, ActiveCodesAsClientsKnowThem) {
  Rig rig;
  const auto g = rig.interp.modal().active_g_codes();
  const std::array<std::int32_t, 17> expected{0,   800, -1,  170, 400, 210, 900, 940, 540,
                                              490, 990, 640, 970, 911, 80,  922, -1};
  EXPECT_EQ(g, expected);
  const auto m = rig.interp.modal().active_m_codes();
  const std::array<std::int32_t, 10> stopped{0, -1, 5, -1, 9, -1, 48, -1, 53, -1};
  EXPECT_EQ(m, stopped);
  (void)rig.mdi("G64 P.5 F100 S200 M4");
  EXPECT_EQ(rig.interp.modal().settings(), (std::array<double, 5>{1, 100, 200, 0.5, 0.5}));
  EXPECT_EQ(rig.interp.modal().active_m_codes()[2], 4);
}

/// Looks at the interpreter while a call is delivered.
TEST(State, IsAlreadyThatOfTheBlockDuringDelivery) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* out = open_memstream(&text, &size);
  struct World final : public Environment {
  } world;
  TextCanon printer(out);
  Interpreter* seen = nullptr;
  struct Peek {
    std::int32_t motion{-1}, line{-1};
    SourceLine source;
  } peek;
  class PeekCanon final : public Canon {
   public:
    PeekCanon(Interpreter*& i, Peek& p) : interp_(i), peek_(p) {}
    void next_block(const SourceLine& s) override { peek_.source = s, sequence = s.sequence; }
    void straight_feed(const Pose&) override {
      peek_.motion = interp_->modal().motion, peek_.line = interp_->modal().line;
    }
    int sequence{0};
    void use_length_units(Units) override {}
    void select_plane(Plane) override {}
    void set_g5x_offset(int, const Pose&) override {}
    void set_g92_offset(const Pose&) override {}
    void set_xy_rotation(double) override {}
    void use_tool_length_offset(const Pose&) override {}
    void set_feed_rate(double, double) override {}
    void set_feed_mode(int, FeedMode) override {}
    void set_feed_reference() override {}
    void set_motion_control_mode(PathMode, double) override {}
    void set_naivecam_tolerance(double) override {}
    void start_speed_feed_sync(int, double, bool) override {}
    void stop_speed_feed_sync() override {}
    void straight_traverse(const Pose&) override {}
    void arc_feed(const Arc&) override {}
    void straight_probe(const Pose&, ProbeKind) override {}
    void turn_probe_on() override {}
    void turn_probe_off() override {}
    void rigid_tap(const Pose&, double) override {}
    void dwell(double) override {}
    void set_spindle_speed(int, double) override {}
    void set_spindle_mode(int, double) override {}
    void start_spindle(int, SpindleDirection) override {}
    void stop_spindle(int) override {}
    void orient_spindle(int, double, int) override {}
    void wait_orient_complete(int, double) override {}
    void select_tool(int) override {}
    void start_change() override {}
    void change_tool() override {}
    void change_tool_number(int) override {}
    void set_tool_table_entry(const Tool&) override {}
    void reload_tooldata() override {}
    void set_mist(bool) override {}
    void set_flood(bool) override {}
    void set_motion_output_bit(int, bool) override {}
    void set_motion_output_value(int, double) override {}
    void set_aux_output_bit(int, bool) override {}
    void set_aux_output_value(int, double) override {}
    void wait_input(int, bool, WaitMode, double) override {}
    void enable_feed_override(bool) override {}
    void enable_speed_override(int, bool) override {}
    void enable_adaptive_feed(bool) override {}
    void enable_feed_hold(bool) override {}
    void program_stop() override {}
    void optional_program_stop() override {}
    void pallet_shuttle() override {}
    void program_end() override {}
    void on_reset() override {}
    void user_mcode(int, std::string_view, double, double) override {}
    void comment(std::string_view) override {}
    void message(std::string_view) override {}
    void print(std::string_view) override {}
    void log_open(std::string_view, bool) override {}
    void log(std::string_view) override {}
    void log_close() override {}

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
  std::fclose(out);
  std::free(text);
}

}  // namespace
}  // namespace kerf::interp
