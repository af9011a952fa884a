// View: what it shows while somebody changes HAL, or died while he did.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

#include "hal/core/registry.hpp"
#include "hal/core/view.hpp"
#include "harness/no_tsan.hpp"

namespace kerf::hal {
namespace {

using testing::HasSubstr;

class ViewTest : public testing::Test {
 protected:
  std::string instance_ = "test-view-" + std::to_string(::getpid());
  std::unique_ptr<rtapi::Segment> segment_ = std::move(rtapi::Segment::create(instance_)).value();
};

TEST_F(ViewTest, ALongListIsWholeThoughTheWriterNeverRests) {
  KERF_NOT_UNDER_TSAN();
  auto registry = std::move(Registry::create(*segment_)).value();
  auto* fixed = *registry->add_component("fixed", ComponentKind::realtime);
  // Pins that stay stand between pins that come and go.
  constexpr int kFixed = 1500;
  const auto add_moving = [&](int i) {
    auto* c = *registry->add_component("moving." + std::to_string(i), ComponentKind::realtime);
    (void)registry->add_pin(*c, "moving." + std::to_string(i), Type::bit, Dir::in, 0);
  };
  for (int i = 0; i < kFixed; ++i) {
    (void)registry->add_pin(*fixed, "fixed." + std::to_string(i), Type::bit, Dir::out, 1);
    add_moving(i);
  }
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    for (unsigned i = 0;; i = (i * 7919U + 13U) % kFixed) {
      if (auto* c = registry->find_component("moving." + std::to_string(i)); c != nullptr)
        registry->remove_component(*c);
      add_moving(static_cast<int>(i));
    }
  }
  const View view(*segment_, 8);
  const auto& generation = registry->root().generation;
  for (int look = 0; look < 20; ++look) {
    // The child has its turn before each look.
    for (const auto before = generation.get(); generation.get() < before + 200;) {
      ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "the child has had its time";
      ::sched_yield();
    }
    int found = 0;
    std::set<std::string> names;
    for (const auto& pin : view.pins()) {
      EXPECT_TRUE(names.insert(pin.name).second) << pin.name << " comes twice";
      if (!pin.name.starts_with("fixed")) continue;
      ++found;
      ASSERT_EQ(pin.owner, "fixed");
      ASSERT_EQ(pin.raw, 1U);
    }
    EXPECT_EQ(found, kFixed);
  }
  EXPECT_FALSE(view.stuck());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST_F(ViewTest, AWriterThatDiedInAChangeIsAnError) {
  KERF_NOT_UNDER_TSAN();
  const pid_t child = ::fork();
  if (child == 0) {
    auto registry = std::move(Registry::create(*segment_)).value();
    auto* c = *registry->add_component("c", ComponentKind::realtime);
    (void)registry->add_pin(*c, "c.p", Type::bit, Dir::in, 0);
    auto& generation = registry->root().generation;
    generation.set(generation.get() + 1);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  const View view(*segment_);
  EXPECT_FALSE(view.find_pin("c.p").has_value());
  EXPECT_TRUE(view.stuck());
  EXPECT_TRUE(view.pins().empty());
  EXPECT_EQ(view.health().error().code, rtapi::Errc::dead);
  EXPECT_THAT(view.value("c.p").error().message(), HasSubstr("halrun -U"));
}

}  // namespace
}  // namespace kerf::hal
