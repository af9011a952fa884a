// The launcher's clock, with a waitpid in which a process ends just behind a look at it.
#include "launcher/supervised_clock.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <utility>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/virtual_clock.hpp"

namespace {
/// Looks at this process to come that find it running; behind the last of them it is killed and has ended.
pid_t g_victim = -1;
int g_looks = 0;
}  // namespace

// The linker sends all calls of waitpid here (--wrap).
extern "C" {
pid_t __real_waitpid(pid_t pid, int* status, int options);
pid_t __wrap_waitpid(pid_t pid, int* status, int options) {
  if (pid != g_victim || g_looks == 0) return __real_waitpid(pid, status, options);
  if (--g_looks == 0) {
    siginfo_t info{};
    kill(pid, SIGKILL);
    (void)waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT);
  }
  return 0;
}
}

namespace kerf::launcher {
namespace {

struct Supervised {
  explicit Supervised(const std::string& name)
      : segment(std::move(*rtapi::Segment::create(name + "-" + std::to_string(getpid())))) {
    EXPECT_TRUE(rtapi::make_clock(*segment, rtapi::ClockMode::real).ok());
    clock = std::make_unique<SupervisedClock>(
        *segment, std::move(*rtapi::join_clock(*segment, rtapi::Role::launcher, "test")),
        catch_stop_signals());
  }
  std::unique_ptr<rtapi::Segment> segment;
  std::unique_ptr<SupervisedClock> clock;
};

TEST(SupervisedClock, NoMomentOfAnEndIsLeftUntold) {
  for (int looks = 1; looks <= 5; ++looks) {
    SCOPED_TRACE("ends behind look " + std::to_string(looks));
    Supervised supervised("supervised-" + std::to_string(looks));
    auto child = Child::start({"sleep", "60"});
    ASSERT_TRUE(child.ok());
    supervised.clock->watch_child(*child);
    g_victim = child->pid();
    g_looks = looks;
    EXPECT_FALSE(supervised.clock->wait_until([] { return false; }, 5000));
    EXPECT_EQ(supervised.clock->reason().kind, StopReason::Kind::part_died);
    EXPECT_EQ(supervised.clock->reason().text,
              "sleep (process " + std::to_string(g_victim) + ") was killed by signal 9 (Killed)");
  }
  g_victim = -1;
}

TEST(SupervisedClock, TheRegularEndOfAScreenIsAWishAndOfAPartAFailure) {
  for (const bool screen : {true, false}) {
    Supervised supervised(screen ? "supervised-screen" : "supervised-part");
    auto child = Child::start({"true"});
    ASSERT_TRUE(child.ok());
    supervised.clock->watch_child(*child, screen);
    EXPECT_FALSE(supervised.clock->wait_until([] { return false; }, 5000));
    EXPECT_EQ(supervised.clock->reason().kind,
              screen ? StopReason::Kind::display_closed : StopReason::Kind::part_died);
  }
}

}  // namespace
}  // namespace kerf::launcher
