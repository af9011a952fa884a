// The flight record of a machine, run again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "harness/machine.hpp"
#include "launcher/flight_keeper.hpp"
#include "motion/replay/replay.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::harness {
namespace {

motion::FlightFile record_of(Machine& m) {
  motion::FlightFile file;
  auto block =
      hal::View(m.segment()).block<motion::FlightRecord>(motion::kFlightBlock, motion::kFlightAbi);
  EXPECT_TRUE(block.ok());
  auto shared =
      hal::View(m.segment()).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  EXPECT_TRUE(shared.ok());
  if (block.ok() && shared.ok()) file.take(**block, **shared);
  return file;
}

std::uint64_t file_end(const motion::FlightFile& file) {
  std::uint64_t end = 0;
  rtapi::OverwriteRing::for_each(
      file.servo, [&](const auto& head, const std::uint64_t*) { end = head.number; });
  return end;
}

/// Leaves out all before the last standstill that is 3000 cycles before the end; gives its cycle.
std::uint64_t begin_late(motion::FlightFile& file) {
  std::size_t last = 0, at = 0;
  std::uint64_t number = 0;
  rtapi::OverwriteRing::for_each(file.servo, [&](const auto& head, const std::uint64_t* /*words*/) {
    if (head.kind == static_cast<int>(motion::FlightKind::rest) &&
        head.number + 3000 < file_end(file))
      last = at, number = head.number;
    at += head.words + 2U;
  });
  file.servo.erase(file.servo.begin(), file.servo.begin() + static_cast<std::ptrdiff_t>(last));
  return number;
}

motion::ReplayResult replay_of(const motion::FlightFile& file) {
  const auto segment = rtapi::Segment::in_memory();
  rtapi::LocalScheduler clock;
  hal::StaticSource modules(hal::static_components());
  auto host = hal::Host::create(*segment, clock, modules);
  EXPECT_TRUE((*host)->command({"loadrt", "trivkins", "coordinates=XYZ"}).ok());
  auto* kinematics = static_cast<motion::Kinematics*>((*host)->service(motion::kKinematicsService));
  return motion::replay(file, *kinematics);
}

constexpr const char* kPath =
    "G21 G90 G64 P0.05\nS1000 M3\nG0 X20 Y20 Z-10\nG1 X60 F2400\nG2 X60 Y40 J10\nG1 X20 Y30\nT2 "
    "M6\nG0 X30\nG1 Y60 "
    "F1500\nM62 P1\nG3 X20 Y50 R15\nG4 P0.2\nG1 X90 Y20 Z-30\nM2\n";

TEST(FlightRecord, APlainRunIsTheSameToTheLastBit) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_EQ(m->run_text(kPath).state, task::CommandState::done) << m->errors();
  ASSERT_TRUE(m->does({"mode", "manual"}));
  ASSERT_TRUE(m->does({"jog", "x", "-30", "10"}));
  m->run_for(1);
  const auto result = replay_of(record_of(*m));
  EXPECT_TRUE(result.same()) << motion::report(result);
  EXPECT_GT(result.cycles, 5000U);
}

TEST(FlightRecord, AFaultComesAgainInItsCycle) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto path = m->write_program(kPath);
  for (const double seconds : {0.3, 1.1, 2.0, 3.3}) {
    const int failed = m->branch([&] {
      m->start_program(path);
      m->run_for(seconds / 2);
      m->does({"feed-override", "0.7"});
      m->run_for(seconds / 4);
      m->send({"pause"});
      m->run_for(seconds / 8);
      m->send({"resume"});
      m->run_for(seconds / 8);
      // The motor of X stands still from now on.
      ASSERT_TRUE(m->hal("unlinkp joint.0.motor-pos-fb"));
      m->run_for(2);
      m->does({"mode", "manual"});
      const auto file = record_of(*m);
      const auto result = replay_of(file);
      EXPECT_TRUE(result.same()) << seconds << ": " << motion::report(result);
      const bool met =
          std::any_of(result.replayed.begin(), result.replayed.end(), [](const auto& f) {
            return f.fault.fault == motion::Fault::following_error && f.fault.index == 0;
          });
      EXPECT_TRUE(met) << motion::report(result);
    });
    EXPECT_EQ(failed, 0) << seconds;
  }
}

TEST(FlightRecord, ExternalOffsetsAndScrewsAreInIt) {
  MachineOptions options;
  options.replace = {{"[AXIS_Z]\n", "[AXIS_Z]\nOFFSET_AV_RATIO = 0.2\n"},
                     {"[JOINT_0]\n", "[JOINT_0]\nCOMP_FILE = x.comp\n"}};
  options.files = {{"x.comp", "0 0.3 0.2\n50 0.1 0.4\n100 -0.2 0\n"}};
  options.hal = {"setp axis.z.eoffset-enable 1", "setp axis.z.eoffset-scale 0.001"};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X10 Y10 Z-20"));
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts 1500"));
  // Longer than two standstills lie apart, so that a later one has the offset in it.
  m->run_for(12);
  const auto path = m->write_program(kPath);
  m->start_program(path);
  m->run_for(1.2);
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts -500"));
  m->run_for(0.8);
  ASSERT_TRUE(m->hal("unlinkp joint.0.motor-pos-fb"));
  m->run_for(2);
  auto file = record_of(*m);
  ASSERT_FALSE(file.screws.empty());
  const auto whole = replay_of(file);
  EXPECT_TRUE(whole.same()) << motion::report(whole);
  EXPECT_FALSE(whole.recorded.empty());
  const std::uint64_t number = begin_late(file);
  const auto late = replay_of(file);
  EXPECT_GT(number, whole.from_cycle + 5000);
  EXPECT_EQ(late.from_cycle, number);
  EXPECT_TRUE(late.same()) << motion::report(late);
}

TEST(FlightRecord, WhatWasSetBeforeTheStandstillHolds) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G64 P0.2 Q0.2"));
  ASSERT_TRUE(m->mdi("G43.1 Z5"));
  ASSERT_TRUE(m->mdi("G0 X10 Y10 Z-20"));
  ASSERT_TRUE(m->does({"feed-override", "0.8"}));
  m->run_for(12);
  // Short lines, nearly straight, that Q joins.
  std::string lines = "G21 G90 F2400\n";
  for (int i = 0; i < 120; ++i)
    lines +=
        "G1 X" + std::to_string(10 + 0.7 * i) + " Y" + std::to_string(10 + 0.1 * (i % 2)) + "\n";
  ASSERT_EQ(m->run_text(lines + "M2\n").state, task::CommandState::done) << m->errors();
  auto file = record_of(*m);
  const std::uint64_t number = begin_late(file);
  const auto late = replay_of(file);
  EXPECT_GT(late.from_cycle, 10'000U);
  EXPECT_EQ(late.from_cycle, number);
  EXPECT_TRUE(late.same()) << motion::report(late);
}

// A small segment has a small record, and the machine starts and can be replayed all the same.
TEST(FlightRecord, IsSmallerInASmallSegment) {
  for (const std::size_t mib : {16U, 32U, 64U}) {
    const auto segment = rtapi::Segment::in_memory(mib << 20U);
    rtapi::LocalScheduler clock;
    hal::StaticSource modules(hal::static_components());
    auto host = hal::Host::create(*segment, clock, modules);
    ASSERT_TRUE(host.ok());
    ASSERT_TRUE((*host)->command({"loadrt", "trivkins", "coordinates=XYZ"}).ok());
    const auto reply =
        (*host)->command({"loadrt", "motmod", "servo_period_nsec=1000000", "num_joints=3"});
    ASSERT_TRUE(reply.ok()) << mib << ": " << reply.text;
    auto block =
        hal::View(*segment).block<motion::FlightRecord>(motion::kFlightBlock, motion::kFlightAbi);
    ASSERT_TRUE(block.ok());
    EXPECT_EQ((*block)->servo_words, motion::FlightRecord::kServoWords * mib / 64) << mib;
    // Half of what was free is so still: for the pins of a machine.
    const rtapi::RegionHead& shared = segment->region(rtapi::Region::shared);
    EXPECT_GT(shared.end - shared.used.get(), (mib << 20U) / 2 * 2 / 5) << mib;
  }
}

TEST(FlightRecord, ChosenPinsAreInIt) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  auto block =
      hal::View(m->segment()).block<motion::FlightRecord>(motion::kFlightBlock, motion::kFlightAbi);
  ASSERT_TRUE(block.ok());
  motion::FlightRecord& record = **block;
  const hal::View view(m->segment());
  const auto choose = [&](std::size_t i, const char* name, hal::Type type, std::uint64_t link) {
    record.pin[i].name.assign(name);
    record.pin[i].type = static_cast<std::uint32_t>(type);
    record.pin[i].every_cycle = type == hal::Type::floating ? 0 : 1;
    record.pin[i].link = link;
    record.pin_count.publish(static_cast<std::uint32_t>(i + 1));
  };
  const auto link_of = [&](const char* name) {
    return m->segment().offset_of(view.pin_slot(name).link);
  };
  choose(0, "motion.motion-enabled", hal::Type::bit, link_of("motion.motion-enabled"));
  choose(1, "joint.1.pos-cmd", hal::Type::floating, link_of("joint.1.pos-cmd"));
  // Places that are none: nothing happens.
  choose(2, "far", hal::Type::bit, std::uint64_t{1} << 40U);
  choose(3, "odd", hal::Type::bit, 12345);
  choose(4, "nowhere", hal::Type::u64, 64);
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 Y12.5"));
  m->run_for(0.1);
  ASSERT_TRUE(m->does({"state", "estop"}));
  m->run_for(0.1);
  const std::string text = motion::show(record_of(*m), 60);
  EXPECT_NE(text.find(" motion.motion-enabled joint.1.pos-cmd far odd nowhere\n"),
            std::string::npos);
  EXPECT_NE(text.find(" FALSE 0 FALSE FALSE"), std::string::npos) << "before it was on";
  EXPECT_NE(text.find(" TRUE 12.5 FALSE FALSE"), std::string::npos) << "at the place";
  EXPECT_NE(text.find(" FALSE 12.5 FALSE FALSE"), std::string::npos) << "after the estop";
}

TEST(FlightRecord, ADifferenceIsSeen) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_EQ(m->run_text("G0 X20\nG1 X30 F600\nM2\n").state, task::CommandState::done);
  auto file = record_of(*m);
  // One path item less.
  ASSERT_TRUE(replay_of(file).same());
  std::size_t at = 0, cut = 0, length = 0;
  rtapi::OverwriteRing::for_each(file.path, [&](const auto& head, const std::uint64_t* words) {
    motion::PathItem item;
    if (head.kind == static_cast<int>(motion::FlightKind::item)) {
      std::memcpy(static_cast<void*>(&item), words, sizeof item);
      if (length == 0 && std::holds_alternative<motion::LinearMove>(item.body))
        cut = at, length = head.words + 2U;
    }
    at += head.words + 2U;
  });
  ASSERT_GT(length, 0U);
  file.path.erase(file.path.begin() + static_cast<std::ptrdiff_t>(cut),
                  file.path.begin() + static_cast<std::ptrdiff_t>(cut + length));
  const auto result = replay_of(file);
  EXPECT_FALSE(result.same());
}

/// An estop that stops something leaves a record; one that switches an idle machine off in the evening leaves none.
TEST(FlightRecord, AnEstopThatStopsSomethingIsKept) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  launcher::FlightKeeper::Options options;
  options.folder = m->folder() + "/flights";
  launcher::FlightKeeper keeper(m->segment(), options);
  /// What it has written half a minute later, at half a second a look.
  const auto written = [&] {
    std::string path;
    for (int i = 0; i < 60; ++i) {
      m->run_for(0.5);
      if (const std::string now = keeper.look(); !now.empty()) path = now;
    }
    for (int ms = 0; ms < 20000 && path.empty() && keeper.is_writing(); ++ms) {
      ::usleep(1000);  // for the disk
      path = keeper.look();
    }
    return path;
  };
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_EQ(written(), "");
  ASSERT_TRUE(m->does({"state", "estop"}));
  EXPECT_EQ(written(), "") << "nothing ran";
  ASSERT_TRUE(m->power_on());
  EXPECT_EQ(written(), "");
  m->start_program(m->write_program("G1 X200 F300\nM2\n"));
  m->run_for(0.3);  // less than a look ago
  ASSERT_TRUE(m->does({"state", "estop"}));
  const std::string path = written();
  EXPECT_NE(path.find("/0001-estop.flight"), std::string::npos) << path;
  std::FILE* in = std::fopen(path.c_str(), "r");
  ASSERT_NE(in, nullptr);
  motion::FlightFile file;
  EXPECT_EQ(file.read(in), "");
  std::fclose(in);
  EXPECT_EQ(file.text("text"), "estop, asked for by a client");
  // Its spindle alone.
  ASSERT_TRUE(m->power_on() && m->mdi("M3 S500"));
  EXPECT_EQ(written(), "");
  ASSERT_TRUE(m->does({"state", "estop"}));
  EXPECT_NE(written().find("/0002-estop.flight"), std::string::npos);
  // One that a client takes back at once, between two looks, from the machine on to the machine on.
  ASSERT_TRUE(m->power_on() && m->mdi("M3 S500"));
  EXPECT_EQ(written(), "");
  ASSERT_TRUE(m->does({"state", "estop"}));
  ASSERT_TRUE(m->power_on());
  EXPECT_NE(written().find("/0003-estop.flight"), std::string::npos);
  // From outside, of a program.
  m->start_program(m->write_program("G1 X100 F300\nM2\n"));
  m->run_for(0.3);
  ASSERT_TRUE(m->hal("unlinkp iocontrol.0.emc-enable-in"));
  ASSERT_TRUE(m->hal("setp iocontrol.0.emc-enable-in 0"));
  m->run_for(0.05);
  ASSERT_TRUE(m->hal("setp iocontrol.0.emc-enable-in 1"));
  ASSERT_TRUE(m->power_on());
  EXPECT_NE(written().find("/0004-estop.flight"), std::string::npos);
  // The end of the machine is an estop of its own, and what came right before it is another.
  ASSERT_TRUE(m->mdi("M3 S500"));
  const auto before_the_end = [&](bool estop) {
    launcher::FlightKeeper last(m->segment(), options);
    EXPECT_EQ(last.look(), "");
    if (estop) {
      EXPECT_TRUE(m->does({"state", "estop"}));
    }
    last.closing();
    EXPECT_TRUE(m->does({"state", "estop"}));
    (void)last.look();
    return last.pending();
  };
  EXPECT_EQ(m->branch([&] { EXPECT_FALSE(before_the_end(false)); }), 0);
  EXPECT_EQ(m->branch([&] { EXPECT_TRUE(before_the_end(true)); }), 0);
}

}  // namespace
}  // namespace kerf::harness
