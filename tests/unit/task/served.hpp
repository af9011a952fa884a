// A task that serves clients over its true socket.
#pragma once
#include "rig.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "task/api/client.hpp"

namespace kerf::task::testing {

/// A rig whose task listens under a name of its own.
struct Served : Rig {
  Served() {
    stop();
    segment.reset();
    instance = "t-task-" + std::to_string(::getpid());
    segment = std::move(rtapi::Segment::create(instance, 8U << 20U).value());
    shared = *segment->make<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
    fake = std::make_unique<FakeMotion>(*shared);
    TaskOptions options;
    options.pins = &pins;
    task = std::make_unique<Task>(loaded.file, *segment, nullptr, options);
    started = task->start();
    EXPECT_TRUE(started.ok()) << started.error().message();
    scheduler = std::make_unique<rtapi::LocalScheduler>();
    scheduler->add(*fake);
    for (auto* p : task->participants()) scheduler->add(*p);
    run_for(0.01);
  }
  std::string instance;
};

}  // namespace kerf::task::testing
