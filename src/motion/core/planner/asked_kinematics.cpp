#include "motion/core/planner/asked_kinematics.hpp"

namespace kerf::motion {

bool AskedKinematics::answer_of(const Pose& world, JointVector& joint) const noexcept {
  if (in_flight()) {
    missing_ = true;
    joint = last_;
    return true;
  }
  if (served_.kind() != kind_of_answers_) {
    kind_of_answers_ = served_.kind();
    known_ = count_ = cursor_ = 0;
  }
  // The same move asks the same in the same order.
  if (cursor_ < known_ && question_[cursor_] == world) {
    const std::size_t at = cursor_++;
    if (has_answer_[at]) joint = last_ = answer_[at];
    return has_answer_[at];
  }
  for (std::size_t at = 0; at < known_; ++at) {
    if (!(question_[at] == world)) continue;
    cursor_ = at + 1;
    if (has_answer_[at]) joint = last_ = answer_[at];
    return has_answer_[at];
  }
  missing_ = true;
  if (count_ == known_) begin_ = joint;
  if (count_ < kMost) question_[count_++] = world;
  joint = last_;
  return true;
}

bool AskedKinematics::all_answered() const noexcept {
  cursor_ = 0;
  if (!missing_) {
    if (!in_flight()) known_ = count_ = 0;
    return true;
  }
  missing_ = false;
  if (in_flight()) return false;
  if (count_ == known_) {
    // The answers came just now, or there is no room for another question: then all of them are asked again.
    if (count_ == kMost) known_ = count_ = 0;
    return false;
  }
  asked_.publish(asked_.get() + 1);
  return false;
}

bool AskedKinematics::serve() noexcept {
  const std::uint64_t round = asked_.observe();
  if (round == answered_.get()) return false;
  if (round != round_) {
    round_ = round;
    next_ = known_;
    start_ = begin_;
  }
  for (std::size_t n = 0; n < kPerCycle && next_ < count_; ++n, ++next_) {
    JointVector at = start_;
    has_answer_[next_] = served_.inverse(question_[next_], at);
    answer_[next_] = at;
    if (has_answer_[next_]) start_ = at;
  }
  if (next_ < count_) return false;
  known_ = count_;
  answered_.publish(round);
  return true;
}

}  // namespace kerf::motion
