#include "motion/core/laws.hpp"

#include <algorithm>

namespace kerf::motion {
namespace {
/// Intervals passed in one cycle. The rest of the cycle is lost beyond that, not the path.
constexpr int kStepsPerCycle = 64;
/// A span ends where its law says so, not where rounding leaves nothing of it: the last bit of a stop takes its time (sigma).
constexpr double kNotYet = 1e-12;
constexpr std::size_t kNone = Laws::kSlots;
}  // namespace

void LawRunner::take(std::size_t slot, std::uint64_t number) noexcept {
  law_ = &laws_.law[slot];
  number_ = number;
  index_ = 0;
  seconds_ = 0;
}

LawRunner::Way LawRunner::start(std::uint64_t span, double left) noexcept {
  for (std::size_t i = 0; i < Laws::kSlots; ++i) {
    const LawHead& head = laws_.head[i];
    const std::uint64_t number = head.number_after(passes_);
    if (number == 0 || head.key.span != span || head.key.left != left) continue;
    if (head.key.kind == LawKey::Kind::boxes) return Way::boxes;
    if (head.key.kind != LawKey::Kind::rest) continue;
    take(i, number);
    return Way::law;
  }
  return Way::none;
}

/// The slot of the law to change over to within the interval in execution, at the latest `until` seconds into it, which becomes the moment.
std::size_t LawRunner::child(bool stand, double& until) const noexcept {
  std::size_t found = kNone;
  for (std::size_t i = 0; i < Laws::kSlots; ++i) {
    const LawHead& head = laws_.head[i];
    if (head.number_after(passes_) == 0) continue;
    const LawKey& key = head.key;
    if (key.parent != number_ || key.index != index_) continue;
    const bool takes = key.kind == LawKey::Kind::go || (key.kind == LawKey::Kind::stop && stand);
    if (!takes || key.seconds < seconds_ - Law::kSameMoment || key.seconds > until) continue;
    // Where both begin at once, standing counts.
    const bool stops = found != kNone && laws_.head[found].key.kind == LawKey::Kind::stop;
    if (stops && key.seconds == until) continue;
    found = i;
    until = key.seconds;
  }
  return found;
}

LawRunner::Moved LawRunner::run(std::uint64_t span, bool stand, double dt) noexcept {
  Moved out;
  for (int n = 0; n < kStepsPerCycle; ++n) {
    const path::LawStep& step = law_->step[index_];
    if (step.span != span) {
      out.lost = true;
      leave();
      return out;
    }
    double until = step.seconds;
    const std::size_t next = child(stand, until);
    const double ahead = std::max(0.0, until - seconds_);
    if (dt - out.used < ahead) {
      seconds_ += dt - out.used;
      out.used = dt;
      break;
    }
    out.used += ahead;
    seconds_ = until;
    if (next != kNone) {
      take(next, laws_.head[next].number_after(passes_));
      continue;
    }
    if (index_ + 1 >= law_->count) {
      out.left = step.left;
      out.rests = true;
      out.span_ended = step.left <= 0;
      leave();
      return out;
    }
    ++index_;
    seconds_ = 0;
    const path::LawStep& following = law_->step[index_];
    if (following.span != span) {
      out.span_ended = true;
      out.state = path::at(following, 0);
      return out;
    }
  }
  const path::LawStep& step = law_->step[index_];
  out.state = path::at(step, seconds_);
  out.left = std::max(step.left + (step.length - out.state.s), kNotYet);
  return out;
}

void LawRunner::place(LawPlace& out) const noexcept {
  out.number = law_ != nullptr ? number_ : 0;
  out.index = index_;
  out.seconds = seconds_;
}

}  // namespace kerf::motion
