// Jogs and the clients that hold them: who is killed or hangs moves nothing any more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "harness/machine.hpp"
#include "task/api/client.hpp"

namespace kerf::harness {
namespace {

/// Homed, with clients, in the mode that jogs an axis ("x") or a joint ("0").
std::unique_ptr<Machine> ready_to_jog(const char* what) {
  MachineOptions options;
  options.clients = true;
  auto m = Machine::start(options);
  EXPECT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  EXPECT_TRUE(m->does({"teleop", what[0] == 'x' ? "on" : "off"}));
  return m;
}

TEST(Jog, EndsWithTheClientThatHoldsIt) {
  double killed = 0;
  for (const char* what : {"x", "0"}) {
    auto m = ready_to_jog(what);
    auto client = m->connect();
    auto other = m->connect();
    ASSERT_TRUE(client->send({"jog", what, "50"}).ok());
    ASSERT_TRUE(other->send({"jog", what[0] == 'x' ? "y" : "1", "20", "30"}).ok());
    m->run_for(0.5);
    ASSERT_NEAR(m->motion().joint[0].vel_cmd, 50, 1e-6) << what;
    const double x = m->joint(0);
    client.reset();
    m->run_for(0.06);
    EXPECT_EQ(m->motion().joint[0].vel_cmd, 0) << what;
    EXPECT_LE(m->joint(0), x + 50 * 50 / 2.0 / 1000 + 50 * 0.003) << what;
    killed = std::max(killed, m->joint(0) - x);
    // A jog of a given length needs nobody.
    other.reset();
    m->run_for(3);
    EXPECT_NEAR(m->joint(1), 30, 1e-9) << what;
  }
  std::printf(
      "result: jog at 50 mm/s of a client that is killed: at rest after at most %.2f mm, of which "
      "1.25 to "
      "brake\n",
      killed);
}

/// A client that hangs keeps its connection; its lease says how long it may say nothing. At many moments of the jog.
TEST(Jog, EndsWithTheSilenceOfAClientThatHoldsALease) {
  constexpr double kVel = 50, kLease = 0.2, kBrake = kVel * kVel / 2 / 1000, kBeat = 0.02;
  int stalls = 0;
  double farthest = 0;
  for (const char* what : {"x", "0"}) {
    auto m = ready_to_jog(what);
    auto client = m->connect();
    EXPECT_EQ(m->command({"jog", what, "50", "3", "lease=1"}).state, task::CommandState::error);
    EXPECT_EQ(m->command({"jog", what, "50", "lease=0.01"}).state, task::CommandState::error);
    for (int kept = 0; kept < 10; ++kept) {
      ASSERT_TRUE(client->send({"jog", what, kept % 2 == 0 ? "50" : "-50", "lease=0.2"}).ok());
      double last = m->joint(0);
      for (int k = 0; k < kept; ++k) {
        m->run_for(0.137);
        ASSERT_TRUE(client->send({"jog-keep"}).ok());
      }
      m->run_for(0.002);
      last = m->joint(0);
      if (kept > 0) {
        EXPECT_NE(m->motion().joint[0].vel_cmd, 0) << "it lives";
      }
      m->run_for(kLease + kBeat + kVel / 1000 + 0.005);
      EXPECT_EQ(m->motion().joint[0].vel_cmd, 0) << what << kept;
      const double went = std::abs(m->joint(0) - last);
      EXPECT_LE(went, kVel * (kLease + kBeat + 0.005) + kBrake) << what << kept;
      farthest = std::max(farthest, went);
      ++stalls;
      m->run_for(1);
      EXPECT_EQ(m->motion().joint[0].vel_cmd, 0) << "and nothing starts it again";
    }
    EXPECT_NE(m->errors().find("said nothing for 2"), std::string::npos) << m->errors();
  }
  std::printf(
      "result: jogs at 50 mm/s of %d clients that stalled, lease 0.2 s: each at rest after at most "
      "%.2f mm, of which 1.25 to brake\n",
      stalls, farthest);
}

}  // namespace
}  // namespace kerf::harness
