// LawMaker: makes time laws ahead of the servo where jerk is limited, and takes them back (laws.hpp). Pure arithmetic in memory that it got at load time.
//
// One law is ahead at most: the child of the one that runs, or the one from rest where the path will stand or stands. It is made anew when more path has
// come, or when the feed that is wanted has changed; then it begins some milliseconds after where the servo is, more of them while laws come too late. Besides there are laws that stop, from
// moments kStopEvery apart, so that a hold begins within 20 ms.
#pragma once

#include <cstdint>

#include "motion/core/laws.hpp"
#include "motion/core/span.hpp"

namespace kerf::motion {

class LawMaker {
 public:
  LawMaker(Laws& laws, PlanGate& gate) noexcept : laws_(laws), gate_(gate) {}
  /// `joints`: for kinematics that mix axes too. False: no memory.
  [[nodiscard]] bool create(path::Memory& memory, bool joints) noexcept;
  void configure(const path::AxisLimits& limits, bool on, double longest_stop_s) noexcept;
  [[nodiscard]] bool on() const noexcept { return on_; }
  /// So far ahead of the servo a new law begins: what it learns while it runs.
  [[nodiscard]] double lead_s() const noexcept { return lead_; }
  void set_lead(double seconds) noexcept { lead_ = seconds; }

  /// What there is to know of a span; its number is the next one.
  struct Stretch {
    path::Piece piece;
    double from{0}, length{0};
    SpeedBounds speed;
    double acc{0}, jerk{0};  ///< its box
    bool by_law{false};
    bool stop_at_end{false}, block_end{false};
    bool blocks{false};  ///< blocks begin within it
  };
  /// `joints`: where kinematics mix axes.
  void add(std::uint64_t number, const Stretch& stretch, const path::JointCurve* joints) noexcept;
  /// Nothing of what was added will be driven any more.
  void forget() noexcept;

  /// Once a turn. `first`: the first span that the servo has not begun or is within; `next`: the first that has not been added. `now`: seconds.
  void run(const ServoView& view, const FeedScale& scale, bool single_step, std::uint64_t first,
           std::uint64_t next, double now) noexcept;
  /// The servo follows laws, or a law waits to be made anew: the next turn has to come soon.
  [[nodiscard]] bool busy() const noexcept { return busy_; }
  /// Of all laws since the start: how many were looked for and not found, and what it took. `work` is iterations times intervals.
  struct Count {
    std::uint64_t all{0}, failed{0}, intervals{0}, iterations{0}, work{0};
    std::uint64_t searched{0};  ///< by the solver
  };
  struct Counts {
    Count rests, children, stops;
  };
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  enum class State : std::int32_t { free, there, taken_back };
  struct Info {
    State state{State::free};
    bool final{false};  ///< it ends where the path has to stop
    bool wants{false};  ///< it ends for want of path
    bool rests{false};  ///< it brakes as hardly any feed is wanted
    bool single_step{false};
    bool overtaken{false};  ///< one that knows of another feed was tried in its place
    std::uint64_t number{0};
    std::uint64_t known{0};  ///< spans that there were
    std::uint64_t mark{0};   ///< the cycle after which no new one takes it
    std::uint64_t last_span{0};
    double last_left{0}, total{0};
    double begins{0};         ///< seconds into its parent
    double next_stop{0};      ///< seconds into it: from where a stop is wanted next
    bool stop_failed{false};  ///< the last one was not found, by the solver either
    double child_tried{-1};
    double made{0};  ///< when
    FeedScale scale;
  };
  struct Place {
    std::uint64_t span{0};
    double left{0};
    path::TimeLaw::Start start;
  };

  struct Window {
    bool final{true}, wants{false};  ///< see Info
    bool straight{true};             ///< all of it is one straight
  };

  void reclaim(const ServoView& view) noexcept;
  [[nodiscard]] std::size_t free_slot() const noexcept;
  [[nodiscard]] std::size_t find(std::uint64_t number) const noexcept;
  void take_back(std::size_t slot) noexcept;
  void keep_only(std::uint64_t running) noexcept;
  void prepare_rest(std::uint64_t span, double left, std::uint64_t running) noexcept;
  void stand(const LawPlace& at) noexcept;
  void follow(std::size_t running, const LawPlace& at) noexcept;
  /// False: none was found, or none is needed.
  [[nodiscard]] bool make_child(std::size_t running, double now, bool changed) noexcept;
  [[nodiscard]] double even_stop(const Place& place) const noexcept;
  [[nodiscard]] double feed_way(const Place& place) const noexcept;
  [[nodiscard]] bool feeds_bear(const Law& law, std::size_t from,
                                const FeedScale& before) const noexcept;
  void make_stop(std::size_t running, double now, double before) noexcept;
  [[nodiscard]] bool brake(std::size_t running, const LawKey& key, const Place& place, bool search,
                           Window& window) noexcept;
  enum class StopFound { no, yes, not_needed };
  [[nodiscard]] StopFound make_stop_at(std::size_t running, std::size_t slot, double begins,
                                       bool search) noexcept;
  [[nodiscard]] bool locate(std::size_t running, double t, LawKey& key,
                            Place& place) const noexcept;
  /// Where the law is `place.seconds` into interval `place.index`, from its start.
  [[nodiscard]] static double elapsed(const Law& law, const LawPlace& at) noexcept;
  /// More path; soon, as the servo stands; another feed; as little as it takes to begin, or to stop.
  enum class For { path, soon, feed, start, stop };
  [[nodiscard]] bool fill(const Place& place, std::uint64_t at_least, For what,
                          Window& out) noexcept;
  Info& publish(std::size_t slot, const LawKey& key, const Window& window) noexcept;
  [[nodiscard]] bool begins_at(const Place& place) const noexcept;
  [[nodiscard]] bool solved(path::TimeLaw::Result result, const Place& place,
                            Count& count) noexcept;
  [[nodiscard]] const Stretch& stretch(std::uint64_t n) const noexcept {
    return stretch_[n % kSpans];
  }
  [[nodiscard]] const path::JointCurve* joints(std::uint64_t n) const noexcept {
    return joints_.empty() || joints_[n % kSpans].count == 0 ? nullptr : &joints_[n % kSpans];
  }

  Laws& laws_;
  PlanGate& gate_;
  Info info_[Laws::kSlots];
  path::Buffer<Stretch> stretch_;
  path::Buffer<path::JointCurve> joints_;  ///< of them
  path::TimeLaw solver_;
  path::AxisLimits limits_;
  FeedScale scale_;
  double stop_s_{0};
  double lead_{0};  ///< s
  double now_{0};   ///< s
  std::uint64_t first_{0}, next_{0};
  Counts counts_;
  std::uint64_t worked_{0};  ///< of the solver, counted so far
  bool on_{false}, single_step_{false}, busy_{false};
};

}  // namespace kerf::motion
