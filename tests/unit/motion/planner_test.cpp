#include "motion/core/planner/planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>

#include "motion/core/path/buffer.hpp"
#include "motion/core/planner/ceilings.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

ArcMove arc_xy(const Pose& end, double cx, double cy, double vel) {
  ArcMove m;
  m.end = end;
  m.centre[0] = cx;
  m.centre[1] = cy;
  m.normal[2] = 1;
  m.vel_mm_s = vel;
  return m;
}

/// As the system gives large blocks: from the beginning of a page.
class WholePages final : public path::Memory {
 public:
  void* allocate(std::size_t bytes, std::size_t align) noexcept override {
    void* page = std::align(kPage, bytes, next_, room_);
    if (page == nullptr || align > kPage) return nullptr;
    next_ = static_cast<std::byte*>(page) + bytes;
    room_ -= bytes;
    return page;
  }
  static constexpr std::size_t kPage = 4096;

 private:
  static constexpr std::size_t kBytes = 2'000'000;
  std::unique_ptr<std::byte[]> memory_{new std::byte[kBytes]};
  void* next_{memory_.get()};
  std::size_t room_{kBytes};
};

TEST(PlannerMemory, ListsBeginInDifferentCacheLinesOfTheirPages) {
  WholePages memory;
  std::set<std::uintptr_t> lines;
  for (int i = 0; i < 64; ++i) {
    path::Buffer<double> list;
    ASSERT_TRUE(list.create(memory, 1000));
    const auto at = reinterpret_cast<std::uintptr_t>(list.begin());
    EXPECT_EQ(at % 64, 0U);
    lines.insert(at % WholePages::kPage / 64);
    list.assign(1000, 1);
    EXPECT_EQ(list.size(), 1000U);
  }
  EXPECT_EQ(lines.size(), 64U);
}

TEST(Planner, SoftLimitRefusesTheWholeMoveAndAllBehindItUntilTheNextEpoch) {
  Rig rig;
  rig.config.axis[0].max_limit = 50;
  rig.ready();
  rig.line({.x = 10}, 50);
  rig.line({.x = 60}, 50);
  rig.line({.y = 5}, 50);
  rig.run(3000);
  EXPECT_NEAR(rig.status().pos_cmd.x, 10, 1e-12);
  EXPECT_EQ(rig.status().pos_cmd.y, 0);
  ASSERT_EQ(rig.faults.size(), 1U);
  const FaultRecord& f = rig.faults[0];
  EXPECT_EQ(f.fault, Fault::axis_soft_limit_max);
  EXPECT_EQ(f.index, 0);
  EXPECT_EQ(f.value, 60);
  EXPECT_EQ(f.limit, 50);
  EXPECT_EQ(f.tag.line, 2);
  EXPECT_EQ(f.number, 1U);
  EXPECT_TRUE(rig.status().enabled) << "the machine is unharmed";
  rig.line({.y = 7}, 50);
  rig.run(500);
  EXPECT_EQ(rig.status().pos_cmd.y, 0);
  rig.abort();
  rig.run(3);
  rig.line({.x = 10, .y = 7}, 50);
  rig.run(1000);
  EXPECT_EQ(rig.status().pos_cmd.y, 7);
}

TEST(Planner, SoftLimitSeesTheBulgeOfAnArcAndTheLimitItselfIsAllowed) {
  Rig rig;
  rig.config.axis[1].max_limit = 10;
  rig.ready();
  rig.line({.x = 10}, 100);
  rig.push(arc_xy({.x = -10}, 0, 0, 100));
  EXPECT_GT(rig.finish(), 0) << "the top of the arc touches the limit";
  EXPECT_TRUE(rig.faults.empty());
  rig.line({.x = 10.01}, 100);
  rig.push(arc_xy({.x = -10.01}, 0, 0, 100));
  rig.run(3000);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::axis_soft_limit_max);
  EXPECT_NEAR(rig.faults[0].value, 10.01, 1e-9);
}

TEST(Planner, JointLimitsCountWhereTheyAreNarrowerThanTheAxis) {
  Rig rig;
  rig.config.joint[2].min_limit = -5;
  rig.ready();
  rig.line({.z = -6}, 50);
  rig.run(100);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::joint_soft_limit_min);
  EXPECT_EQ(rig.faults[0].index, 2);
}

TEST(Planner, FromOutsideTheLimitsTheWayBackIsOpen) {
  Rig rig;
  rig.in.joint[0].motor_pos_fb = 20;
  rig.config.joint[0].home_offset = rig.config.joint[0].home = 20;
  rig.config.axis[0].max_limit = 15;
  rig.ready();
  rig.line({.x = 10}, 50);
  EXPECT_GT(rig.finish(5000), 0);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Planner, ImpossibleItemsAreRefused) {
  const auto refused = [](PathItems::Variant body) {
    Rig rig;
    rig.ready();
    rig.push(body);
    rig.run(20);
    return rig.saw(Fault::bad_item) && rig.status().in_position;
  };
  LinearMove line;
  line.end.x = 1;
  EXPECT_TRUE(refused(line)) << "no feed";
  line.vel_mm_s = NAN;
  EXPECT_TRUE(refused(line));
  line.vel_mm_s = 10;
  line.end.x = NAN;
  EXPECT_TRUE(refused(line));
  EXPECT_TRUE(refused(arc_xy({.x = 1}, 0, 0, 10))) << "radius 0";
  EXPECT_TRUE(refused(OutputChange{.index = 64, .value = 1}));
  EXPECT_TRUE(refused(OutputChange{.index = -1, .analog = true}));
  EXPECT_TRUE(refused(SpindleChange{.spindle = 8}));
  EXPECT_TRUE(refused(SpindleChange{.speed_rpm = -5}));
  EXPECT_TRUE(refused(Dwell{-1}));
  EXPECT_TRUE(refused(Dwell{INFINITY}));
}

TEST(Planner, AnItemWithABrokenIndexIsInputNotACrash) {
  Rig rig;
  rig.ready();
  PathItem item;
  item.epoch = 1;
  item.seq = 1;
  // The index byte of the variant stands behind its storage; shared memory may hold anything.
  auto* bytes = reinterpret_cast<unsigned char*>(&item.body);
  for (std::size_t i = 0; i < sizeof item.body; ++i) bytes[i] = 77;
  ASSERT_TRUE(rig.path->push(item));
  rig.run(5);
  EXPECT_TRUE(rig.saw(Fault::bad_item));
}

TEST(Planner, OlderEpochsAreDroppedAndNewerOnesWaitForTheAck) {
  Rig rig;
  rig.ready();
  rig.plan = false;
  rig.line({.x = 10}, 50);
  rig.abort();
  rig.run(3);
  rig.line({.x = -3}, 50);
  rig.plan = true;
  EXPECT_GT(rig.finish(5000), 0);
  EXPECT_EQ(rig.status().pos_cmd.x, -3);
  EXPECT_EQ(rig.status().acked_epoch, 2U);
}

TEST(Planner, MoreItemsThanSpansWaitForRoom) {
  Rig rig;
  rig.ready();
  for (int i = 1; i <= 900; ++i) ASSERT_TRUE(rig.line({.x = 0.01 * i}, 50));
  EXPECT_GT(rig.finish(), 0);
  EXPECT_NEAR(rig.status().pos_cmd.x, 9, 1e-12);
  EXPECT_EQ(rig.status().executed_seq, 900U);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Planner, MovesWaitForCoordinatedModeEventsDoNot) {
  Rig rig;
  rig.enable();
  rig.push(OutputChange{.index = 3, .value = 1});
  rig.line({.x = 10}, 50);
  rig.run(200);
  EXPECT_EQ(rig.controller->outputs().digital, 8U);
  EXPECT_EQ(rig.status().executed_seq, 1U);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
}

TEST(Ceilings, LinesTakeWhatTheSlowestJointAllows) {
  Rig rig({0, 1, 2, 3});
  rig.config.joint[1].max_vel = 10;
  rig.config.joint[3].max_acc = 50;
  Curve c;
  Ceilings out;
  ASSERT_TRUE(make_line({}, {.x = 3, .y = 4}, 0xf, c));
  ASSERT_TRUE(ceilings_of(c, rig.kinematics, rig.config, {}, 1e9, out));
  EXPECT_DOUBLE_EQ(out.speed, 12.5);
  EXPECT_DOUBLE_EQ(out.acc, 1250);
  ASSERT_TRUE(make_line({}, {.x = 1, .a = 5}, 0xf, c));
  ASSERT_TRUE(ceilings_of(c, rig.kinematics, rig.config, {}, 1e9, out));
  EXPECT_DOUBLE_EQ(out.speed, 20);
  EXPECT_DOUBLE_EQ(out.acc, 10);
}

TEST(Ceilings, ACircleSharesTheAccelerationOfEachJoint) {
  Rig rig;
  Curve c;
  Ceilings out;
  ArcMove m = arc_xy({.x = 10}, 0, 0, 1);
  ASSERT_TRUE(make_arc({.x = 10}, m, c));
  ASSERT_TRUE(ceilings_of(c, rig.kinematics, rig.config, {}, 1e9, out));
  EXPECT_NEAR(out.speed, std::sqrt(0.8 * 1000 * 10), 0.1) << "0.8 of the limit for the curve";
  EXPECT_NEAR(out.acc, 600, 1);
  // A slow feed leaves nearly all of it for speeding up.
  ASSERT_TRUE(ceilings_of(c, rig.kinematics, rig.config, {}, 5, out));
  EXPECT_GT(out.acc, 990);
}

TEST(Ceilings, TrajectoryLimitsCap) {
  Rig rig;
  rig.config.traj_max_vel_mm_s = 30;
  rig.config.traj_max_acc_mm_s2 = 40;
  Curve c;
  Ceilings out;
  ASSERT_TRUE(make_line({}, {.x = 3, .y = 4}, 7, c));
  ASSERT_TRUE(ceilings_of(c, rig.kinematics, rig.config, {}, 1e9, out));
  EXPECT_EQ(out.speed, 30);
  EXPECT_EQ(out.acc, 40);
}

/// X is the square of joint 0, so each place has two solutions; the one nearer to `joint` is taken, and +  where both are as near.
class TwoWays final : public Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::both; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 1; }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    p.x = q[0] * q[0];
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    if (p.x < 0) return false;
    q[0] = q[0] < 0 ? -std::sqrt(p.x) : std::sqrt(p.x);
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t) const noexcept override { return -1; }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 1; }
};

TEST(SoftLimits, CountForTheSolutionThatTheJointsAreIn) {
  const TwoWays two_ways;
  for (const double side : {-1.0, 1.0}) {
    Rig rig(test::RigKinematics{two_ways});
    rig.config.joint[0].min_limit = side < 0 ? -5 : -2;
    rig.config.joint[0].max_limit = side < 0 ? 2 : 5;
    rig.config.joint[0].home = rig.config.joint[0].home_offset = 3 * side;
    rig.apply_config();
    rig.ready();
    ASSERT_NEAR(rig.status().joint[0].pos_cmd, 3 * side, 1e-9);
    rig.line({.x = 16}, 5);
    ASSERT_GT(rig.finish(), 0) << side;
    EXPECT_NEAR(rig.status().joint[0].pos_cmd, 4 * side, 1e-6);
    EXPECT_TRUE(rig.faults.empty()) << side;
    // The next move begins in the solution in which this one ended.
    rig.line({.x = 20}, 5);
    rig.line({.x = 30}, 5);
    rig.run(4000);
    EXPECT_TRUE(rig.saw(side < 0 ? Fault::joint_soft_limit_min : Fault::joint_soft_limit_max));
    EXPECT_LE(std::abs(rig.status().joint[0].pos_cmd), 5);
  }
}

}  // namespace
}  // namespace kerf::motion
