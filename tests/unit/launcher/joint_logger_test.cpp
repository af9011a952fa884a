#include <gtest/gtest.h>

#include <memory>

#include "hal/core/test_builder.hpp"
#include "motion/api/joint_log.hpp"
#include "motion/api/shared.hpp"

extern "C" const kerf::hal::Module kerf_hal_module_joint_logger;

namespace kerf {
namespace {

class JointLoggerTest : public testing::Test {
 protected:
  void cycle(double x) {
    status_.cycle += 1;
    status_.time_ns += 1'000'000;
    status_.servo_period_ns = 1'000'000;
    status_.joints = 3;
    status_.current.id = 7;
    status_.current.line = 12;
    status_.pos_cmd.x = x;
    status_.joint[0].pos_cmd = x;
    motion_->status.write(status_);
    hal_.run("joint-logger");
  }
  motion::JointLog& log() { return *reinterpret_cast<motion::JointLog*>(hal_.block("joint-log")); }

  std::unique_ptr<motion::MotionShared> motion_ = std::make_unique<motion::MotionShared>();
  motion::MotionStatus status_;
  hal::TestBuilder hal_;
};

TEST_F(JointLoggerTest, NeedsMotion) {
  EXPECT_FALSE(hal_.create(kerf_hal_module_joint_logger, "joint-logger"));
  EXPECT_NE(hal_.error().find("load motmod first"), std::string::npos);
}

TEST_F(JointLoggerTest, RecordsEachCycleOnce) {
  hal_.provide(motion::kMotionService, motion_.get());
  ASSERT_TRUE(hal_.create(kerf_hal_module_joint_logger, "joint-logger")) << hal_.error();
  hal_.run("joint-logger");  // motion has not said anything yet
  EXPECT_EQ(log().ring.size(), 0U);
  cycle(1.5);
  hal_.run("joint-logger");  // the same cycle again
  cycle(2.5);
  ASSERT_EQ(log().ring.size(), 2U);
  EXPECT_EQ(hal_.get<std::int32_t>("joint-logger.curr-depth"), 2);
  const motion::JointSample* s = log().ring.front();
  EXPECT_EQ(s->cycle, 1U);
  EXPECT_EQ(s->joint[0], 1.5);
  EXPECT_EQ(s->position[0], 1.5);
  EXPECT_EQ(s->joints, 3);
  EXPECT_EQ(s->line, 12);
  EXPECT_EQ(s->block, 7U);
  EXPECT_EQ(s->period_ns, 1'000'000);
}

TEST_F(JointLoggerTest, CountsWhatFindsNoRoom) {
  hal_.provide(motion::kMotionService, motion_.get());
  ASSERT_TRUE(hal_.create(kerf_hal_module_joint_logger, "joint-logger"));
  const std::size_t room = decltype(motion::JointLog::ring)::capacity();
  for (std::size_t i = 0; i < room + 3; ++i) cycle(static_cast<double>(i));
  EXPECT_EQ(log().ring.size(), room);
  EXPECT_EQ(log().dropped.get(), 3U);
  EXPECT_EQ(hal_.get<std::int32_t>("joint-logger.dropped"), 3);
  EXPECT_EQ(log().ring.front()->cycle, 1U);
}

}  // namespace
}  // namespace kerf
