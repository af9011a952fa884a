// AskedKinematics: the planner's questions to kinematics in C are worked out in servo cycles, and only real answers count.
#include <gtest/gtest.h>

#include <cstddef>

#include "motion/core/planner/asked_kinematics.hpp"

namespace kerf::motion {
namespace {

/// Joint 0 is twice X; nothing is reached beyond 100.
class Doubling final : public Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::both; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 1; }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    p.x = q[0] / factor;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    ++calls;
    began_at = q[0];
    if (p.x > 100) return false;
    q[0] = factor * p.x;
    return true;
  }
  [[nodiscard]] std::int32_t kinds() const noexcept override { return 2; }
  [[nodiscard]] std::int32_t kind() const noexcept override { return kind_now; }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t) const noexcept override { return -1; }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 1; }
  mutable int calls{0};
  mutable double began_at{0};
  double factor{2};
  std::int32_t kind_now{0};
};

struct Asking {
  Doubling real;
  AskedKinematics asked{real};
  /// Asks for n places from `first` on; true: complete, and `sum` is of real answers.
  bool ask(int n, double first = 0) {
    all = true;
    sum = 0;
    for (int i = 0; i < n; ++i) {
      JointVector q{};
      all = asked.inverse({.x = first + 0.01 * i}, q) && all;
      sum += q[0];
    }
    return asked.complete();
  }
  /// Servo cycles until the answers are there.
  int cycles() {
    int n = 1;
    while (!asked.serve() && n < 1000) ++n;
    return n;
  }
  bool all{true};
  double sum{0};
};

TEST(AskedKinematics, AnswersAreWorkedOutByTheServoCycleAlone) {
  Asking a;
  EXPECT_FALSE(a.ask(100));
  EXPECT_EQ(a.real.calls, 0) << "never in the planner's thread";
  EXPECT_FALSE(a.ask(100)) << "asked again before they are there";
  EXPECT_EQ(a.cycles(), 2) << "64 a cycle";
  EXPECT_EQ(a.real.calls, 100);
  EXPECT_TRUE(a.ask(100));
  EXPECT_TRUE(a.all);
  double wanted = 0;
  for (int i = 0; i < 100; ++i) wanted += 0.02 * i;
  EXPECT_DOUBLE_EQ(a.sum, wanted);
  EXPECT_EQ(a.real.calls, 100) << "nothing is worked out twice";
}

TEST(AskedKinematics, ACycleWithoutQuestionsDoesNothing) {
  Asking a;
  EXPECT_FALSE(a.asked.serve());
  EXPECT_EQ(a.real.calls, 0);
  EXPECT_TRUE(a.asked.complete());
}

TEST(AskedKinematics, TheFirstSearchBeginsWhereItsQuestionSaysAndEachNextAtTheAnswerBefore) {
  Asking a;
  JointVector near{};
  near[0] = 7;
  EXPECT_TRUE(a.asked.inverse({.x = 50}, near));
  EXPECT_FALSE(a.asked.complete());
  a.cycles();
  EXPECT_EQ(a.real.began_at, 7);
  JointVector other{};
  other[0] = 9;
  EXPECT_TRUE(a.asked.inverse({.x = 50}, near));
  EXPECT_EQ(near[0], 100);
  EXPECT_TRUE(a.asked.inverse({.x = 51}, near));
  EXPECT_TRUE(a.asked.inverse({.x = 52}, other));
  EXPECT_FALSE(a.asked.complete());
  a.cycles();
  EXPECT_EQ(a.real.began_at, 102) << "at the answer for 51, which began at the one for 50";
}

TEST(AskedKinematics, APlaceOutOfReachIsNoAnswer) {
  Asking a;
  EXPECT_FALSE(a.ask(3, 99.995));
  a.cycles();
  EXPECT_TRUE(a.ask(3, 99.995));
  EXPECT_FALSE(a.all);
}

TEST(AskedKinematics, AnswersOfOneKindAreNoneOfAnother) {
  Asking a;
  (void)a.ask(3, 10);
  a.cycles();
  a.real.kind_now = 1;
  a.real.factor = 5;
  EXPECT_FALSE(a.ask(3, 10)) << "those of kind 0 are forgotten";
  a.cycles();
  EXPECT_TRUE(a.ask(3, 10));
  EXPECT_NEAR(a.sum, 5 * (10 + 10.01 + 10.02), 1e-9);
}

TEST(AskedKinematics, MoreThanThereIsRoomForAreNeverSaidToBeComplete) {
  Asking a;
  constexpr int kTooMany = 3000;
  for (int round = 0; round < 200; ++round) {
    EXPECT_FALSE(a.ask(kTooMany, -20));
    (void)a.asked.serve();
  }
  // What does fit still works.
  for (int round = 0; round < 200 && !a.ask(1800, -20); ++round) (void)a.asked.serve();
  EXPECT_TRUE(a.ask(1800, -20) || [&] {
    a.cycles();
    return a.ask(1800, -20);
  }());
}

}  // namespace
}  // namespace kerf::motion
