// SpindleRig: a Rig with a spindle in front of it: ramp, encoder with counts and index, in the terms of spindle.0's pins.
#pragma once

#include <algorithm>
#include <cmath>

#include "rig.hpp"

namespace kerf::motion::test {

struct SpindleRig : Rig {
  double acceleration{20};  ///< revolutions/s2; 0: the wanted speed at once
  double counts{0};         ///< a revolution; 0: no steps
  double angle{0.37};       ///< from the index, counted through
  double rps{0};
  double disturbance{0};  ///< added to the wanted speed
  bool index{true};       ///< the encoder has one
  bool zero_at_index{true};
  std::size_t number{0};   ///< which spindle it is
  std::int32_t passed{0};  ///< index pulses that were asked for

  explicit SpindleRig(std::vector<int> axes = {0, 1, 2})
      : SpindleRig(RigKinematics(std::move(axes))) {}
  explicit SpindleRig(const RigKinematics& moved_by) : Rig(moved_by) {
    for (auto& s : config.spindle) s = SpindleConfig{};
    config.spindles = 2;
    apply_config();
  }

  /// One servo cycle of machine and spindle.
  void cycle() {
    Rig::cycle();
    const SpindleOutputs& out = controller->spindles().outputs(number);
    SpindleInputs& to = in.spindle[number];
    if (out.index_order != 0) to.index_enable = out.index_order > 0;
    const double wanted = out.speed_rpm / 60 + (out.on ? disturbance : 0.0);
    const double missing = wanted - rps, step = acceleration * kPeriod;
    rps = step <= 0 || std::abs(missing) <= step ? wanted : rps + std::copysign(step, missing);
    const double before = angle;
    angle += rps * kPeriod;
    if (to.index_enable && index && std::floor(angle) != std::floor(before)) {
      to.index_enable = false;
      if (zero_at_index) zero = angle > before ? std::floor(angle) : std::floor(before);
      index_at = angle > before ? std::floor(angle) : std::floor(before);
      ++passed;
    }
    const double since = angle - zero;
    to.revs = counts > 0 ? std::floor(since * counts) / counts : since;
    to.speed_in_rps = rps;
    to.at_speed = std::abs(rps - wanted) <= 0.02 * std::abs(wanted) + 1e-9;
  }
  void run(int n) {
    for (int i = 0; i < n; ++i) cycle();
  }
  template <class F>
  int run_until(F&& done, int limit = 100000) {
    for (int i = 0; i < limit; ++i) {
      cycle();
      if (done()) return i + 1;
    }
    return -1;
  }
  int finish(int limit = 200000) {
    return run_until([&] { return status().executed_seq >= seq && status().path_empty; }, limit);
  }
  void ready() { Rig::ready(); }
  void turn(double rpm, bool forward = true) {
    SpindleChange m;
    m.spindle = static_cast<std::int32_t>(number);
    m.action = forward ? SpindleChange::Action::forward : SpindleChange::Action::reverse;
    m.speed_rpm = rpm;
    push(m);
  }
  void thread(const Pose& end, double per_rev) {
    SyncMove m;
    m.spindle = static_cast<std::int32_t>(number);
    m.end = end;
    m.per_rev_mm = per_rev;
    push(m);
  }
  void tap(const Pose& end, double per_rev, double factor = 1) {
    TapMove m;
    m.spindle = static_cast<std::int32_t>(number);
    m.end = end;
    m.per_rev_mm = per_rev;
    m.return_factor = factor;
    push(m);
  }

  double index_at{0};  ///< angle of the index passed last
  double zero{0};      ///< angle at which the counter is 0
};

}  // namespace kerf::motion::test
