// A stepgen of one motor with somebody who looks at its pins in every call of make-pulses.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "hal/core/test_builder.hpp"

namespace kerf::components {

constexpr std::int64_t kBaseNs = 50'000;
constexpr int kBasePerServo = 20;

struct Timing {
  std::int64_t length, space, setup, hold;
};

/// Watches step and dir call by call.
class PulseWatch {
 public:
  explicit PulseWatch(Timing t) : t_(t) {}
  void look(bool step, bool dir) {
    now_ns_ += kBaseNs;
    if (dir != dir_) {
      check(now_ns_ - fell_ns_ >= t_.hold, "dir changes too early after a pulse");
      check(!step_ && !step, "dir changes during a pulse");
      dir_ns_ = now_ns_;
    }
    if (step && !step_) {
      check(now_ns_ - fell_ns_ >= t_.space, "too little space between pulses");
      check(now_ns_ - dir_ns_ >= t_.setup, "a pulse too early after dir");
      rose_ns_ = now_ns_;
      count_ += dir ? -1 : 1;
    }
    if (!step && step_) {
      check(now_ns_ - rose_ns_ >= t_.length, "a pulse too short");
      fell_ns_ = now_ns_;
    }
    step_ = step;
    dir_ = dir;
  }
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The first break of the times, or "".
  [[nodiscard]] const std::string& wrong() const { return wrong_; }

 private:
  void check(bool good, const char* what) {
    if (!good && wrong_.empty()) wrong_ = what + (" at " + std::to_string(now_ns_)) + " ns";
  }
  Timing t_;
  std::int64_t now_ns_{0}, rose_ns_{-1'000'000'000}, fell_ns_{-1'000'000'000},
      dir_ns_{-1'000'000'000};
  std::int64_t count_{0};
  bool step_{false}, dir_{false};
  std::string wrong_;
};

class StepMachine {
 public:
  StepMachine(const hal::Module& stepgen, const Timing& t) : watch_(t) {
    hal_.set_arg("step_type", "0");
    made_ = hal_.create(stepgen, "stepgen");
    hal_.set("stepgen.0.steplen", t.length);
    hal_.set("stepgen.0.stepspace", t.space);
    hal_.set("stepgen.0.dirsetup", t.setup);
    hal_.set("stepgen.0.dirhold", t.hold);
    hal_.set("stepgen.0.enable", true);
  }
  [[nodiscard]] bool made() const { return made_; }
  hal::TestBuilder& hal() { return hal_; }
  PulseWatch& watch() { return watch_; }
  /// One servo period with this command.
  void servo(double command) {
    hal_.set("stepgen.0.position-cmd", command);
    hal_.run("stepgen.capture-position", kBaseNs * kBasePerServo);
    hal_.run("stepgen.update-freq", kBaseNs * kBasePerServo);
    for (int i = 0; i < kBasePerServo; ++i) {
      hal_.run("stepgen.make-pulses", kBaseNs);
      watch_.look(hal_.get<bool>("stepgen.0.step"), hal_.get<bool>("stepgen.0.dir"));
    }
  }
  /// Follows two sines of this size [units] for `periods` servo periods. Gives the greatest distance between motor and command
  /// [steps], without the first 0.2 s, in which it starts from rest; ends early when a time is broken.
  double follow_sines(double size, double scale, int periods, double& phase_s) {
    double worst = 0.0, command = last_;
    for (int i = 0; i < periods && watch_.wrong().empty(); ++i) {
      const double before = command;
      phase_s += 1e-3;
      command = size * (std::sin(2.0 * phase_s) + 0.4 * std::sin(0.37 * phase_s));
      servo(command);
      // It follows a period and a half behind (stepgen.cpp, follow): after this one it is halfway between the last two commands.
      const double expected = 0.5 * (command + before) * scale;
      if (++run_ > 200)
        worst = std::max(worst, std::fabs(static_cast<double>(watch_.count()) - expected));
    }
    last_ = command;
    return worst;
  }

 private:
  hal::TestBuilder hal_;
  PulseWatch watch_;
  bool made_{false};
  int run_{0};
  double last_{0.0};
};

}  // namespace kerf::components
