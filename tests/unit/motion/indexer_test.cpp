// Locking rotary indexers: they turn only while they are unlocked, and whatever ends a move locks them again.
#include <gtest/gtest.h>

#include "unit/motion/rig.hpp"

namespace kerf::motion::test {
namespace {

constexpr std::size_t kJoint = 3;

/// XYZA; A locks, and its lock takes some cycles either way.
struct Indexer : Rig {
  Indexer() : Rig(std::vector<int>{0, 1, 2, 3}) {
    config.axis[3].locking_joint = static_cast<std::int32_t>(kJoint);
    config.joint[3].rotary = true;
    apply_config();
  }
  void step() {
    const bool wants = controller->unlocks(kJoint);
    if (wants != in.joint[kJoint].is_unlocked) {
      if (++late >= lock_cycles && works) in.joint[kJoint].is_unlocked = wants, late = 0;
    } else {
      late = 0;
    }
    const double before = status().joint[kJoint].pos_cmd;
    const bool unlocked = in.joint[kJoint].is_unlocked;
    cycle();
    const double way = std::abs(status().joint[kJoint].pos_cmd - before);
    if (way > 1e-12 && !unlocked) moved_locked += way;
  }
  template <class F>
  bool until(F&& done, int limit = 20000) {
    for (int i = 0; i < limit; ++i) {
      step();
      if (done()) return true;
    }
    return false;
  }
  bool all_done() {
    return until([&] { return status().executed_seq >= seq && status().path_empty; });
  }
  bool index(double a, const Pose& at = {}) {
    Pose end = at;
    end.a = a;
    return line(end, 0, MotionKind::index_rotary);
  }
  int lock_cycles{20}, late{0};
  bool works{true};
  double moved_locked{0};
};

TEST(Indexer, unlocks_turns_locks_and_goes_on) {
  Indexer rig;
  rig.ready();
  rig.line({.x = 10}, 50);
  rig.index(90, {.x = 10});
  rig.line({.x = 20, .a = 90}, 50);
  ASSERT_TRUE(rig.until([&] { return rig.controller->unlocks(kJoint); }));
  EXPECT_NEAR(rig.status().pos_cmd.x, 10, 1e-9);
  EXPECT_EQ(rig.status().waiting_for, PathWait::indexer_unlocked);
  EXPECT_EQ(rig.status().waiting_index, 3);
  EXPECT_EQ(rig.status().kind, MotionKind::index_rotary);
  EXPECT_EQ(rig.status().executed_seq, 1U);
  ASSERT_TRUE(rig.until([&] { return rig.status().pos_cmd.a == 90; }));
  EXPECT_LT(rig.status().executed_seq, 2U) << "it is done when it is locked";
  ASSERT_TRUE(rig.until([&] { return rig.status().waiting_for == PathWait::indexer_locked; }));
  EXPECT_FALSE(rig.controller->unlocks(kJoint));
  EXPECT_TRUE(rig.in.joint[kJoint].is_unlocked);
  EXPECT_NEAR(rig.status().pos_cmd.x, 10, 1e-9);
  ASSERT_TRUE(rig.all_done());
  EXPECT_NEAR(rig.status().pos_cmd.x, 20, 1e-9);
  EXPECT_EQ(rig.status().pos_cmd.a, 90);
  EXPECT_FALSE(rig.in.joint[kJoint].is_unlocked);
  EXPECT_EQ(rig.moved_locked, 0);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Indexer, two_turns_in_a_row_lock_in_between) {
  Indexer rig;
  rig.ready();
  rig.index(90);
  rig.index(180);
  rig.index(180);
  int unlocks = 0;
  bool before = false;
  ASSERT_TRUE(rig.until([&] {
    const bool now = rig.controller->unlocks(kJoint);
    unlocks += now && !before ? 1 : 0;
    before = now;
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }));
  EXPECT_EQ(unlocks, 2) << "a turn of no length needs no lock";
  EXPECT_EQ(rig.moved_locked, 0);
  EXPECT_EQ(rig.status().pos_cmd.a, 180);
}

TEST(Indexer, refuses_what_would_turn_it_otherwise) {
  const auto refused = [](auto&& push, IndexerRefusal why) {
    Indexer rig;
    rig.ready();
    push(rig);
    rig.run(200);
    if (!rig.saw(Fault::indexer_refused)) return testing::AssertionFailure() << "no fault";
    const FaultRecord& f = rig.faults.back();
    if (f.index != 3 || f.value != static_cast<double>(why) || f.limit != 3)
      return testing::AssertionFailure() << f.index << " " << f.value << " " << f.limit;
    if (rig.status().pos_cmd.a != 0 || rig.status().pos_cmd.x != 0)
      return testing::AssertionFailure() << "it moved";
    return testing::AssertionSuccess();
  };
  using R = IndexerRefusal;
  EXPECT_TRUE(refused([](Indexer& r) { r.line({.a = 5}, 50); }, R::not_alone)) << "feed";
  EXPECT_TRUE(refused([](Indexer& r) { r.line({.a = 5}, 0, MotionKind::traverse); }, R::not_alone));
  EXPECT_TRUE(refused([](Indexer& r) { r.line({.x = 1, .a = 5}, 0, MotionKind::index_rotary); },
                      R::not_alone));
  EXPECT_TRUE(refused(
      [](Indexer& r) {
        ProbeMove m;
        m.end.a = 5;
        m.vel_mm_s = 1;
        r.push(m);
      },
      R::not_alone));
  EXPECT_TRUE(refused(
      [](Indexer& r) {
        ArcMove m;
        m.end = {.a = 5};
        m.centre[0] = 5;
        m.normal[2] = 1;
        m.vel_mm_s = 10;
        r.push(m);
      },
      R::not_alone));
  EXPECT_TRUE(refused(
      [](Indexer& r) {
        r.planner.set_unlock_pins(0b0111);
        r.index(5);
      },
      R::no_pins));
}

TEST(Indexer, sums_of_offsets_are_no_turn) {
  Indexer rig;
  rig.ready();
  rig.line({.x = 10, .a = 1e-13}, 50);
  ASSERT_TRUE(rig.all_done());
  EXPECT_TRUE(rig.faults.empty());
  EXPECT_NEAR(rig.status().pos_cmd.x, 10, 1e-9);
}

TEST(Indexer, an_abort_at_any_cycle_locks_it_and_the_path_goes_on_behind_the_lock) {
  int phases[4]{};
  for (int at = 0; at < 420; at += 3) {
    Indexer rig;
    rig.ready();
    rig.index(10);
    rig.line({.x = 3, .a = 10}, 50);
    for (int i = 0; i < at; ++i) rig.step();
    const PathWait wait = rig.status().waiting_for;
    const bool turning = rig.status().joint[kJoint].vel_cmd != 0;
    ++phases[wait == PathWait::indexer_unlocked ? 0
             : turning                          ? 1
             : wait == PathWait::indexer_locked ? 2
                                                : 3];
    rig.abort();
    ASSERT_TRUE(rig.until([&] { return rig.status().acked_epoch == rig.orders.abort_epoch; }));
    EXPECT_FALSE(rig.controller->unlocks(kJoint)) << "at " << at;
    const double here = rig.status().joint[kJoint].pos_cmd;
    // The next program begins behind the lock.
    Pose next = rig.status().pos_cmd;
    next.x += 1;
    rig.line(next, 50);
    double first = -1;
    ASSERT_TRUE(rig.until([&] {
      if (first < 0 && rig.status().joint[0].vel_cmd != 0)
        first = rig.in.joint[kJoint].is_unlocked ? 1 : 0;
      return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
    })) << "at "
        << at;
    EXPECT_EQ(first, 0) << "at " << at << ": X moved and A was not locked";
    EXPECT_EQ(rig.status().joint[kJoint].pos_cmd, here);
    EXPECT_EQ(rig.moved_locked, 0) << "at " << at;
    EXPECT_TRUE(rig.faults.empty()) << "at " << at;
  }
  for (const int n : phases) EXPECT_GT(n, 0) << "every phase has been met";
}

TEST(Indexer, off_at_any_cycle_takes_unlock_back_at_once) {
  for (int at = 0; at < 300; at += 5) {
    Indexer rig;
    rig.ready();
    rig.index(10);
    for (int i = 0; i < at; ++i) rig.step();
    rig.orders.enable = false;
    rig.step();
    EXPECT_FALSE(rig.controller->unlocks(kJoint)) << "at " << at;
    for (int i = 0; i < 50; ++i) rig.step();
    EXPECT_FALSE(rig.controller->unlocks(kJoint)) << "at " << at;
    EXPECT_FALSE(rig.in.joint[kJoint].is_unlocked) << "at " << at;
  }
}

TEST(Indexer, a_hold_keeps_it_as_it_is) {
  Indexer rig;
  rig.ready();
  rig.index(90);
  ASSERT_TRUE(rig.until([&] { return rig.status().pos_cmd.a > 20; }));
  rig.orders.hold = true;
  ASSERT_TRUE(rig.until([&] { return rig.status().joint[kJoint].vel_cmd == 0; }));
  for (int i = 0; i < 100; ++i) rig.step();
  EXPECT_TRUE(rig.controller->unlocks(kJoint));
  rig.orders.hold = false;
  ASSERT_TRUE(rig.all_done());
  EXPECT_EQ(rig.status().pos_cmd.a, 90);
  EXPECT_EQ(rig.moved_locked, 0);
}

TEST(Indexer, a_lock_lost_while_it_turns_stops_the_path) {
  Indexer rig;
  rig.ready();
  rig.index(90);
  rig.line({.x = 3, .a = 90}, 50);
  ASSERT_TRUE(rig.until([&] { return rig.status().pos_cmd.a > 20; }));
  rig.works = false;
  rig.in.joint[kJoint].is_unlocked = false;
  ASSERT_TRUE(rig.until([&] { return rig.status().joint[kJoint].vel_cmd == 0; }, 500));
  rig.run(50);
  EXPECT_TRUE(rig.saw(Fault::indexer_locked));
  EXPECT_FALSE(rig.controller->unlocks(kJoint));
  EXPECT_LT(rig.status().pos_cmd.a, 40);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
}

TEST(Indexer, one_that_never_unlocks_waits_and_says_so) {
  Indexer rig;
  rig.ready();
  rig.works = false;
  rig.index(90);
  EXPECT_FALSE(rig.until([&] { return rig.status().pos_cmd.a != 0; }, 3000));
  EXPECT_EQ(rig.status().waiting_for, PathWait::indexer_unlocked);
  rig.abort();
  ASSERT_TRUE(rig.until([&] { return rig.status().acked_epoch == rig.orders.abort_epoch; }));
  EXPECT_FALSE(rig.controller->unlocks(kJoint));
}

TEST(Indexer, adaptive_feed_below_zero_does_not_turn_it_back) {
  Indexer rig;
  rig.ready();
  OverrideEnable enables;
  enables.adaptive = true;
  rig.push(enables);
  rig.line({.x = 5}, 50);
  rig.index(90, {.x = 5});
  ASSERT_TRUE(rig.until([&] { return rig.status().pos_cmd.a > 20; }));
  rig.in.adaptive_feed = -1;
  ASSERT_TRUE(rig.until([&] { return rig.status().joint[kJoint].vel_cmd == 0; }));
  const double here = rig.status().pos_cmd.a;
  for (int i = 0; i < 300; ++i) rig.step();
  EXPECT_EQ(rig.status().pos_cmd.a, here);
  EXPECT_TRUE(rig.controller->unlocks(kJoint));
  rig.in.adaptive_feed = 1;
  ASSERT_TRUE(rig.all_done());
  EXPECT_EQ(rig.moved_locked, 0);
}

TEST(Indexer, jogs_need_it_unlocked_by_something_else) {
  Indexer rig;
  rig.ready();
  rig.works = false;
  rig.intent.mode = MotionMode::teleop;
  rig.run(5);
  const auto jog = [&] {
    auto& j = rig.intent.axis_jog[3];
    ++j.seq;
    j.kind = JogIntent::Kind::continuous;
    j.vel = 20;
    rig.run(100);
  };
  jog();
  EXPECT_TRUE(rig.saw(Fault::indexer_refused));
  EXPECT_EQ(rig.faults.back().index, kAxisJog + 3);
  EXPECT_EQ(rig.status().pos_cmd.a, 0);
  rig.in.joint[kJoint].is_unlocked = true;
  jog();
  EXPECT_GT(rig.status().pos_cmd.a, 0.5);
  rig.in.joint[kJoint].is_unlocked = false;
  rig.run(100);
  EXPECT_EQ(rig.status().joint[kJoint].vel_cmd, 0) << "lost: it stops";
  rig.intent.mode = MotionMode::free;
  rig.run(5);
  const double here = rig.status().joint[kJoint].pos_cmd;
  auto& j = rig.intent.joint_jog[kJoint];
  ++j.seq;
  j.kind = JogIntent::Kind::continuous;
  j.vel = -20;
  rig.run(50);
  EXPECT_EQ(rig.faults.back().index, 3);
  EXPECT_EQ(rig.faults.back().value, static_cast<double>(IndexerRefusal::locked));
  EXPECT_EQ(rig.status().joint[kJoint].pos_cmd, here);
}

}  // namespace
}  // namespace kerf::motion::test
