// The servo's end of time laws.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "motion/core/laws.hpp"
#include "motion/core/plan_gate.hpp"

namespace kerf::motion {
namespace {

/// Even acceleration over `length`.
path::LawStep even(std::uint64_t span, double length, double left, double v0, double v1) {
  path::LawStep s;
  s.length = length;
  s.x = v0 * v0;
  s.u = (v1 * v1 - v0 * v0) / (2 * length);
  s.seconds = 2 * length / (v0 + v1);
  s.span = span;
  s.left = left;
  return s;
}

path::LawStep to_rest(std::uint64_t span, double length, double left, double v) {
  path::LawStep s;
  s.kind = path::LawStep::Kind::stop;
  s.length = length;
  s.x = v * v;
  s.seconds = 3 * length / v;
  s.span = span;
  s.left = left;
  return s;
}

class Runner : public testing::Test {
 protected:
  void set(std::size_t slot, std::uint64_t number, const LawKey& key,
           const std::vector<path::LawStep>& steps) {
    Law& law = laws->law[slot];
    laws->head[slot].key = key;
    law.count = 0;
    for (const auto& s : steps) law.step[law.count++] = s;
    laws->head[slot].number.publish(number);
  }
  /// Law 1: 10 mm of span 7 and 5 of span 8 at 100 mm/s, then to rest at the end of 8.
  void SetUp() override {
    LawKey key;
    key.kind = LawKey::Kind::rest;
    key.span = 7;
    key.left = 10;
    set(0, 1, key, {even(7, 10, 0, 100, 100), even(8, 5, 1, 100, 100), to_rest(8, 1, 0, 100)});
  }
  static LawKey child(LawKey::Kind kind, std::uint32_t index, double seconds) {
    LawKey key;
    key.kind = kind;
    key.parent = 1;
    key.index = index;
    key.seconds = seconds;
    return key;
  }

  std::unique_ptr<Laws> laws{std::make_unique<Laws>()};
  LawRunner runner{*laws};
};

TEST_F(Runner, ACycleSeesWhatThePlannerHadDoneAtItsBeginning) {
  LawKey key;
  key.kind = LawKey::Kind::rest;
  key.span = 7;
  key.left = 10;
  set(0, 6, key, {to_rest(7, 10, 0, 100)});
  const auto sees = [&](std::uint64_t passes) {
    runner.leave();
    runner.look(passes);
    LawPlace at;
    if (runner.start(7, 10) == LawRunner::Way::law) runner.place(at);
    return at.number;
  };
  EXPECT_EQ(sees(5), 0U) << "published in pass 6";
  EXPECT_EQ(sees(6), 6U);
  laws->head[0].gone.publish(9);
  EXPECT_EQ(sees(8), 6U) << "taken back in pass 9";
  EXPECT_EQ(sees(9), 0U);
  set(0, 12, key, {to_rest(7, 10, 0, 100)});
  EXPECT_EQ(sees(11), 0U) << "another law stands there from pass 12 on";
  EXPECT_EQ(sees(12), 12U);
}

TEST(PlanGate, CountsAPassWhenItHasBeenMadeAndAsksBefore) {
  struct Asked final : PlanGate::Hold {
    void wait(std::uint64_t number) noexcept override { asked.push_back(number); }
    std::vector<std::uint64_t> asked;
  } hold;
  PlanGate gate;
  gate.pass([&] { EXPECT_EQ(gate.done(), 0U); });
  EXPECT_EQ(gate.done(), 1U);
  gate.resume_at(41, &hold);
  EXPECT_EQ(gate.pass([&] { return hold.asked.size(); }), 1U);
  EXPECT_EQ(hold.asked, std::vector<std::uint64_t>{42});
  EXPECT_EQ(gate.done(), 42U);
}

TEST_F(Runner, StartsOnlyWhereALawBegins) {
  EXPECT_EQ(runner.start(7, 9.5), LawRunner::Way::none);
  EXPECT_EQ(runner.start(8, 10), LawRunner::Way::none);
  EXPECT_FALSE(runner.on());
  EXPECT_EQ(runner.start(7, 10), LawRunner::Way::law);
  EXPECT_TRUE(runner.on());
}

TEST_F(Runner, GoesOverSpansToTheEndOfItsLaw) {
  ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
  auto m = runner.run(7, false, 0.05);
  EXPECT_NEAR(m.left, 5, 1e-12);
  EXPECT_EQ(m.used, 0.05);
  m = runner.run(7, false, 0.07);
  EXPECT_TRUE(m.span_ended);
  EXPECT_NEAR(m.used, 0.05, 1e-12);
  EXPECT_NEAR(m.state.speed, 100, 1e-9);
  m = runner.run(8, false, 0.06);
  EXPECT_FALSE(m.span_ended);
  EXPECT_LT(m.left, 1);
  m = runner.run(8, false, 1);
  EXPECT_TRUE(m.rests && m.span_ended);
  EXPECT_NEAR(m.used, 0.02, 1e-9);
  EXPECT_FALSE(runner.on());
}

TEST_F(Runner, ChangesOverAtTheMomentOfAChildAndToAStopOnlyToStand) {
  set(1, 2, child(LawKey::Kind::stop, 0, 0.02), {to_rest(7, 2, 6, 100)});
  set(2, 3, child(LawKey::Kind::go, 0, 0.03), {even(7, 7, 0, 100, 80), to_rest(8, 4, 2, 80)});
  for (const bool stand : {false, true}) {
    ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
    // In the cycle in which the moment comes.
    const auto m = runner.run(7, stand, 0.0355);
    LawPlace place;
    runner.place(place);
    EXPECT_EQ(place.number, stand ? 2U : 3U);
    EXPECT_NEAR(place.seconds, stand ? 0.0155 : 0.0055, 1e-12);
    EXPECT_LT(m.state.acc, 0);
    runner.leave();
  }
}

TEST_F(Runner, ASpanLastsAsLongAsItsLaw) {
  ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
  (void)runner.run(7, false, 0.1);
  auto m = runner.run(8, false, 0.05 + 0.03 * (1 - 1e-9));
  EXPECT_FALSE(m.span_ended);
  EXPECT_GT(m.left, 0);
  EXPECT_TRUE(runner.on());
  m = runner.run(8, false, 0.001);
  EXPECT_TRUE(m.span_ended && m.rests);
}

TEST_F(Runner, ACycleThatEndsWhereAChildBeginsTakesIt) {
  set(1, 2, child(LawKey::Kind::go, 0, 0.02 - 1e-12), {to_rest(7, 8, 0, 100)});
  ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
  for (int i = 0; i < 2; ++i) (void)runner.run(7, false, 0.01);
  (void)runner.run(7, false, 0.001);
  LawPlace place;
  runner.place(place);
  EXPECT_EQ(place.number, 2U);
}

TEST_F(Runner, WhatIsTakenBackOrMissedIsNotTaken) {
  set(1, 2, child(LawKey::Kind::go, 0, 0.02), {to_rest(7, 8, 0, 100)});
  ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
  laws->head[1].number.publish(0);
  (void)runner.run(7, true, 0.025);
  set(1, 4, child(LawKey::Kind::go, 0, 0.02), {to_rest(7, 8, 0, 100)});
  (void)runner.run(7, true, 0.025);
  LawPlace place;
  runner.place(place);
  EXPECT_EQ(place.number, 1U);
}

TEST_F(Runner, ALawOfAnotherSpanIsLost) {
  ASSERT_EQ(runner.start(7, 10), LawRunner::Way::law);
  const auto m = runner.run(9, false, 0.01);
  EXPECT_TRUE(m.lost);
  EXPECT_FALSE(runner.on());
}

}  // namespace
}  // namespace kerf::motion
