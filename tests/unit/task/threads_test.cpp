// The three participants on threads of their own, in real time, with a client hammering at them.
#include <gmock/gmock.h>
#include <unistd.h>

#include <thread>

#include "rig.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "task/api/client.hpp"

namespace kerf::task::testing {
namespace {

struct Threads {
  void start(rtapi::Participant& participant) {
    clocks.push_back(rtapi::make_real_clock());
    threads.emplace_back([&participant, clock = clocks.back().get()] {
      rtapi::run_participant(*clock, participant);
    });
  }
  ~Threads() {
    for (auto& c : clocks) c->stop();
    for (auto& t : threads) t.join();
  }
  std::vector<std::unique_ptr<rtapi::WaitClock>> clocks;
  std::vector<std::thread> threads;
};

TEST(Threads, mdi_and_aborts_from_a_client) {
  TempFolder folder;
  folder.write("tool.tbl", "T1 P1 Z10\n");
  folder.write("nc/M100", "#!/bin/sh\nexit 0\n", true);
  const auto loaded = ini::IniFile::load(folder.write("test.ini", kMillIni));
  auto segment = std::move(
      rtapi::Segment::create("t-threads-" + std::to_string(::getpid()), 8U << 20U).value());
  auto* shared = *segment->make<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  FakeMotion motion(*shared);
  motion.move_time = 3 * kMillisecond;
  FakePins pins;
  TaskOptions options;
  options.pins = &pins;
  Task task(loaded.file, *segment, nullptr, options);
  ASSERT_TRUE(task.start().ok());
  {
    Threads threads;
    threads.start(motion);
    for (auto* p : task.participants()) threads.start(*p);
    const auto clock = rtapi::make_real_clock();
    while (task.shared().ready.observe() == 0) {
      rtapi::WaitSpec spec;
      spec.wake_at(clock->now() + kMillisecond);
      clock->wait(spec);
    }
    auto client = std::move(Client::connect(*segment).value());
    const auto does = [&](const std::vector<std::string>& words) {
      const auto r = client->wait(*client->send(words), *clock, clock->now() + 20 * rtapi::kSecond);
      return r.ok() ? r->state : CommandState::received;
    };
    ASSERT_EQ(does({"state", "estop-reset"}), CommandState::done);
    ASSERT_EQ(does({"state", "on"}), CommandState::done);
    ASSERT_EQ(does({"home"}), CommandState::done);
    for (int i = 0; i < 15; ++i) {
      EXPECT_EQ(does({"mdi", "G0 X" + std::to_string(i)}), CommandState::done);
      EXPECT_EQ(does({"mdi", i % 3 == 0   ? "T1 M6"
                             : i % 3 == 1 ? "M100 P1"
                                          : "M8"}),
                CommandState::done);
      const auto move = *client->send({"mdi", "G4 P5"});
      const auto next = *client->send({"mdi", "G0 X100"});
      EXPECT_EQ(does({"abort"}), CommandState::done);
      const rtapi::Nanos limit = clock->now() + 20 * rtapi::kSecond;
      EXPECT_EQ(client->wait(move, *clock, limit)->state, CommandState::aborted);
      EXPECT_EQ(client->wait(next, *clock, limit)->state, CommandState::aborted);
    }
    TaskStatus status;
    ASSERT_TRUE(client->status(status));
    EXPECT_EQ(status.commands.received,
              status.commands.done + status.commands.errors + status.commands.aborted);
  }
  task.shut_down();
}

TEST(Clients, flood_of_one_does_not_keep_the_heartbeat_waiting) {
  TempFolder folder;
  folder.write("tool.tbl", "T1 P1 Z10\n");
  folder.write("nc/.keep", "");
  const auto loaded = ini::IniFile::load(folder.write("test.ini", kMillIni));
  auto segment =
      std::move(rtapi::Segment::create("t-flood-" + std::to_string(::getpid()), 8U << 20U).value());
  ASSERT_TRUE(segment->make<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi).ok());
  FakePins pins;
  TaskOptions options;
  options.pins = &pins;
  Task task(loaded.file, *segment, nullptr, options);
  ASSERT_TRUE(task.start().ok());
  rtapi::Participant* command = task.participants()[0];
  rtapi::WaitSpec first;
  command->step(0, first);
  auto client = std::move(Client::connect(*segment).value());
  int sent = 0;
  while (sent < 100 && client->send({"wait"}).ok()) ++sent;
  ASSERT_GT(sent, 40);
  const auto received = [&task] { return task.status().commands.received; };
  for (std::uint64_t step = 1; step <= 2; ++step) {
    rtapi::WaitSpec next;
    command->step(static_cast<rtapi::Nanos>(step), next);
    EXPECT_EQ(received(), 16 * step);
  }
  for (rtapi::Nanos step = 3; step < 12; ++step) {
    rtapi::WaitSpec next;
    command->step(step, next);
  }
  EXPECT_EQ(received(), static_cast<std::uint64_t>(sent)) << "all are served in the end";
  task.shut_down();
}

}  // namespace
}  // namespace kerf::task::testing
