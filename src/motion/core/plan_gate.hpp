// PlanGate: numbers what passes between planner and servo, so that a flight record tells what each servo cycle could see of the planner,
// and a replay shows it no sooner and no later.
#pragma once

#include <cstdint>

#include "motion/api/shared.hpp"

namespace kerf::motion {

/// Each change that the servo sees, and each look at what the servo changes, is a pass of the planner's.
class PlanGate {
 public:
  /// Holds the planner of a replay.
  class Hold {
   public:
    /// Returns when pass `number` may be made.
    virtual void wait(std::uint64_t number) noexcept = 0;

   protected:
    ~Hold() = default;
  };

  /// Planner: makes a pass, which is what f does.
  template <class F>
  auto pass(F&& f) noexcept {
    const Done done(*this);
    return f();
  }
  [[nodiscard]] std::uint64_t passes() const noexcept { return passes_; }

  /// Servo: at the beginning of a cycle, before it looks at anything of the planner's. @rt
  [[nodiscard]] std::uint64_t done() const noexcept { return done_.observe(); }

  /// Replay: from here on.
  void resume_at(std::uint64_t passes, Hold* hold) noexcept {
    passes_ = passes;
    hold_ = hold;
  }

 private:
  struct Done {
    explicit Done(PlanGate& g) noexcept : gate(g) {
      ++gate.passes_;
      if (gate.hold_ != nullptr) gate.hold_->wait(gate.passes_);
    }
    // Release: who sees the number sees all that was done in the passes up to it.
    ~Done() { gate.done_.publish(gate.passes_); }
    Done(const Done&) = delete;
    Done& operator=(const Done&) = delete;
    PlanGate& gate;
  };

  std::uint64_t passes_{0};  ///< the planner's own
  Hold* hold_{nullptr};
  rtapi::Word<std::uint64_t> done_{0};
};

}  // namespace kerf::motion
