// AskedKinematics: kinematics that only the servo cycle may call, for the planner. Its questions go there and come back.
//
// The planner works on with guesses until all that it needs at once has been asked, then waits for a cycle or some, and does the same again
// with what has been answered. The result counts when none of its answers was a guess (Kinematics::complete).
#pragma once

#include <cstddef>
#include <cstdint>

#include "motion/api/kinematics.hpp"
#include "motion/api/shared.hpp"

namespace kerf::motion {

/// inverse() answers what the servo cycle has worked out, and notes what it has not. Until complete() is true the planner asks all of it again.
class AskedKinematics final : public Kinematics {
 public:
  explicit AskedKinematics(const Kinematics& served) noexcept : served_(served) {}

  [[nodiscard]] KinematicsType type() const noexcept override { return served_.type(); }
  [[nodiscard]] std::int32_t joints() const noexcept override { return served_.joints(); }
  [[nodiscard]] bool forward(const JointVector&, Pose&) const noexcept override { return false; }
  // Inline, as all of its virtual functions: this library is built without type information, which others may need of it.
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    return answer_of(world, joint);
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    return served_.axis_of_joint(joint);
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return served_.axis_mask(); }
  [[nodiscard]] std::int32_t kinds() const noexcept override { return served_.kinds(); }
  [[nodiscard]] std::int32_t kind() const noexcept override { return served_.kind(); }
  [[nodiscard]] bool complete() const noexcept override { return all_answered(); }
  [[nodiscard]] bool answers_at_once() const noexcept override { return false; }

  /// @rt. In each servo cycle: works out some of what is asked. The first search of a round begins at the joints that came with its first question,
  /// each next one at the answer before. True: all of it is there now.
  bool serve() noexcept;

 private:
  static constexpr std::size_t kMost = 2048;  ///< what is asked together
  static constexpr std::size_t kPerCycle = 64;

  [[nodiscard]] bool answer_of(const Pose& world, JointVector& joint) const noexcept;
  [[nodiscard]] bool all_answered() const noexcept;
  [[nodiscard]] bool in_flight() const noexcept { return answered_.observe() != asked_.get(); }

  const Kinematics& served_;
  // Written by the planner while nothing is in flight, but for the answers.
  mutable Pose question_[kMost];
  JointVector answer_[kMost];
  bool has_answer_[kMost];
  mutable std::size_t known_{0}, count_{0}, cursor_{0};
  mutable bool missing_{false};
  mutable std::int32_t kind_of_answers_{0};
  mutable JointVector last_{},
      begin_{};  ///< the last real answer; where the first search of the round begins
  mutable rtapi::Word<std::uint64_t> asked_{0};  ///< number of the round of questions
  rtapi::Word<std::uint64_t> answered_{0};
  // The servo cycle's own.
  std::uint64_t round_{0};
  std::size_t next_{0};
  JointVector start_{};
};

}  // namespace kerf::motion
