// Laws: time laws that the planner has made ahead (path/time_law.hpp), for the servo to follow where jerk is limited.
//
// A law begins where another one is at a given moment, or at rest at a given place, and ends in rest. The servo runs one law at a time. Where a child
// of it begins it changes over: to one that goes on as soon as its moment comes, to one that stops only while the path has to
// stand. Until a child is there the running law goes on, and its own end is a stop; so a planner that is late or dead costs time and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>

#include "motion/api/shared.hpp"
#include "motion/core/path/time_law.hpp"

namespace kerf::motion {

/// Where a law begins.
struct LawKey {
  enum class Kind : std::int32_t {
    go,   /**< takes over from law `parent`, `seconds` into its interval `index` */
    stop, /**< the same, while the path has to stand */
    rest, /**< from rest at `left` before the end of `span` */
    boxes /**< from there the servo looks ahead itself (ahead.hpp), up to the next rest: no steps */
  };
  Kind kind{Kind::go};
  std::uint32_t index{0};
  std::uint64_t parent{0};
  double seconds{0};
  std::uint64_t span{0};
  double left{0};
};

/// What the servo looks through in each cycle, for all laws side by side: their steps are far apart.
struct LawHead {
  /// That of the planner's pass (plan_gate.hpp) in which it was published, after all else of the law was written; 0: none. What a law says stays as it
  /// is until no cycle can read it any more.
  rtapi::Word<std::uint64_t> number{0};
  /// Of the pass in which it was taken back, larger than `number`; else that of an older law, or 0.
  rtapi::Word<std::uint64_t> gone{0};
  LawKey key;

  /// What of it can be taken in a cycle at whose beginning so many passes were done: its number, or 0.
  [[nodiscard]] std::uint64_t number_after(std::uint64_t passes) const noexcept {
    // Acquire: who sees the number sees the law; and with the number of a law that is written anew it has been seen as gone for long.
    const std::uint64_t n = number.observe();
    if (n == 0 || n > passes) return 0;
    const std::uint64_t g = gone.observe();
    return g > n && g <= passes ? 0 : n;
  }
};

struct Law {
  static constexpr std::size_t kSteps = 1024;
  /// Moments as near as this are one (s): cycles often end just where a law begins.
  static constexpr double kSameMoment = 1e-9;

  std::size_t count{0};
  path::LawStep step[kSteps];
};

struct Laws {
  static constexpr std::size_t kSlots = 16;
  LawHead head[kSlots];
  Law law[kSlots];
};

/// Where the servo is on which law.
struct LawPlace {
  std::uint64_t number{0};  ///< 0: on none
  std::uint32_t index{0};
  bool stands{false};  ///< the path has to stand
  bool moving{false};  ///< without a law
  double seconds{0};   ///< into the interval
  static constexpr std::uint64_t kNoSpan = ~std::uint64_t{0};
  /// At rest within a stretch that is to be driven by a law, or before it.
  std::uint64_t rest_span{kNoSpan};
  double rest_left{0};
};

/// The servo's end. @rt.
class LawRunner {
 public:
  explicit LawRunner(const Laws& laws) noexcept : laws_(laws) {}

  /// A new cycle: it sees what so many passes have left (PlanGate::done()), and all of the cycle sees the same.
  void look(std::uint64_t passes) noexcept { passes_ = passes; }
  [[nodiscard]] bool on() const noexcept { return law_ != nullptr; }
  void leave() noexcept { law_ = nullptr; }
  enum class Way { none, law, boxes };
  /// At rest at `left` before the end of `span`: a law that begins there is taken.
  [[nodiscard]] Way start(std::uint64_t span, double left) noexcept;

  struct Moved {
    double used{0};  ///< seconds
    double left{0};  ///< before the end of the span
    path::LawState state;
    bool span_ended{false}, rests{false};
    bool lost{false};  ///< the law is not about this span: a fault of ours
  };
  /// Goes on for `dt`, at most to the end of `span`.
  [[nodiscard]] Moved run(std::uint64_t span, bool stand, double dt) noexcept;
  void place(LawPlace& out) const noexcept;

 private:
  void take(std::size_t slot, std::uint64_t number) noexcept;
  [[nodiscard]] std::size_t child(bool stand, double& until) const noexcept;

  const Laws& laws_;
  const Law* law_{nullptr};
  std::uint64_t passes_{~std::uint64_t{0}};
  std::uint64_t number_{0};
  std::uint32_t index_{0};
  double seconds_{0};
};

}  // namespace kerf::motion
