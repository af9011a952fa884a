#include "bench/motion/stops.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

#include "bench/motion/runs.hpp"
#include "motion/core/path/time_law.hpp"
#include "motion/core/ramp.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::bench {
namespace {

namespace path = motion::path;
using path::LawStep;
using path::TimeLaw;

constexpr std::size_t kRoom = 3000;
constexpr double kFar = 1e9;
/// Moments, and how much later the planner tries again where it has found no stop (law_maker.cpp).
constexpr double kEvery = 0.007, kAgain = 0.003;
/// A law is driven over so many stretches at most.
constexpr std::size_t kStretches = 250;
/// A window for a stop is so many times as long as that of a stop within the boxes of its stretches (law_maker.cpp).
constexpr double kReserve = 1.5;
/// Ends that the solver is asked for: shares of the way of the best stop, from, to, ratio of neighbours.
constexpr double kNearest = 0.55, kFarthest = 1.7, kNext = 1.09;

/// Where a law is at some moment.
struct State {
  double t{0};
  std::size_t span{0};
  double from{0};  ///< sigma from its start
  TimeLaw::Start start;
  path::LawAlong along;
};

struct Stop {
  double seconds{kFar};
  double way{0};
};

Stop stop_of(const TimeLaw& law) {
  Stop out{law.seconds(), 0};
  for (const LawStep& s : law.law()) out.way += s.length;
  return out;
}

class Stops {
 public:
  Stops(const Program& program, double jerk) : curve_(curve_of(program, jerk, limits_)) {
    limits_.jerks = true;
    ok_ = law_.create(heap_, kRoom);
  }

  StopsResult run(std::size_t most) {
    StopsResult out;
    for (std::size_t k = 0, begin = 0; ok_ && k < curve_.size() && out.moments < most; ++k) {
      if (!curve_[k].stop_at_end && k + 1 < curve_.size() && k + 1 - begin < kStretches) continue;
      begin_ = begin;
      end_ = k + 1;
      begin = k + 1;
      if (whole()) look(out, most);
    }
    if (out.moments > 0) out.mean /= static_cast<double>(out.moments);
    return out;
  }

 private:
  bool add(std::size_t n, double from, double to, double wish, int fineness) {
    const motion::PathSpan& s = curve_[n];
    return !(to > from) ||
           law_.add(n, s.piece, s.from + from, s.from + to, s.from + s.length,
                    path::axis_cap(s.piece, s.from + from, s.from + s.length, limits_), wish,
                    fineness);
  }

  /// The law of all of [begin_, end_) from rest.
  bool whole() {
    law_.begin(limits_);
    for (std::size_t n = begin_; n < end_; ++n)
      if (!add(n, 0, curve_[n].length, curve_[n].speed.feed_cap, 4)) return false;
    if (law_.solve({}) != TimeLaw::Result::ok) return false;
    run_.assign(law_.law().begin(), law_.law().end());
    total_ = law_.seconds();
    return true;
  }

  [[nodiscard]] bool at(double t, State& out) const {
    out.t = t;
    for (const LawStep& step : run_) {
      if (t >= step.seconds) {
        t -= step.seconds;
        continue;
      }
      if (step.kind == LawStep::Kind::stop) return false;
      const path::LawState state = path::at(step, t);
      out.span = static_cast<std::size_t>(step.span);
      out.from = curve_[out.span].length - step.left - (step.length - state.s);
      out.start = {state.speed * state.speed, state.acc};
      out.along = {&step, static_cast<std::size_t>(run_.data() + run_.size() - &step), state.s};
      return state.speed > 0;
    }
    return false;
  }

  /// What the planner would add for a stop.
  bool window(const State& at) {
    law_.begin(limits_);
    double way = 0, acc = path::kNoLimit, jerk = path::kNoLimit, from = at.from;
    for (std::size_t n = at.span; n < end_; ++n, from = 0) {
      const motion::PathSpan& s = curve_[n];
      if (!add(n, from, s.length, s.speed.feed_cap, 1)) return false;
      way += s.length - from;
      acc = std::min(acc, s.even_acc);
      jerk = std::min(jerk, s.even_jerk);
      const double rise = (std::max(at.start.u, 0.0) + acc) / jerk;
      const double v = std::sqrt(at.start.x) + rise * std::max(at.start.u, acc) / 2;
      if (way > kReserve * (v * v / (2 * acc) + v * rise)) break;
    }
    return true;
  }

  /// The solver's best of several ends.
  Stop scanned(const State& at, double way) {
    Stop best;
    for (double share = kNearest; share < kFarthest; share *= kNext) {
      law_.begin(limits_);
      double left = share * way, from = at.from;
      for (std::size_t n = at.span; n < end_ && left > 0; ++n, from = 0) {
        const double to = std::min(curve_[n].length, from + left);
        if (!add(n, from, to, path::kNoLimit, 4)) return best;
        left -= to - from;
      }
      if (left > 0) break;
      if (law_.solve(at.start) == TimeLaw::Result::ok && law_.seconds() < best.seconds)
        best = stop_of(law_);
    }
    return best;
  }

  struct Moment {
    State at;
    Stop brake, search, ours, best;
  };

  void look(StopsResult& out, std::size_t most) {
    std::vector<Moment> moments;
    const std::size_t room = most - out.moments;
    for (double t = kEvery; t < total_ && moments.size() < room; t += kEvery) {
      Moment m;
      if (!at(t, m.at)) continue;
      if (window(m.at) && law_.brake_stop(m.at.start, m.at.along) == TimeLaw::Result::ok)
        m.brake = stop_of(law_);
      if (window(m.at) && law_.search_stop(m.at.start) == TimeLaw::Result::ok)
        m.search = stop_of(law_);
      m.ours = m.brake.seconds < kFar    ? m.brake
               : m.search.seconds < kFar ? m.search
                                         : as_planned(m.at);
      m.best = m.brake.seconds < m.search.seconds ? m.brake : m.search;
      if (m.best.seconds >= kFar) m.best = {total_ - t, m.ours.way};
      const Stop scan = scanned(m.at, m.best.way);
      if (scan.seconds < m.best.seconds) m.best = scan;
      m.best.seconds = std::min(m.best.seconds, m.ours.seconds);
      moments.push_back(m);
    }
    // To go on with the law and to stop later is a way to stop too.
    for (std::size_t i = moments.size(); i-- > 0;) {
      Moment& m = moments[i];
      m.best.seconds = std::min(m.best.seconds, total_ - m.at.t);
      if (i + 1 == moments.size()) continue;
      const Moment& next = moments[i + 1];
      const double wait = next.at.t - m.at.t + next.best.seconds;
      m.best.seconds = std::min(m.best.seconds, wait);
    }
    for (const Moment& m : moments) note(m, out);
  }

  /// Neither braking nor the solver find one: the planner tries again somewhat later, every second time with the solver too; in the end the law ends.
  Stop as_planned(const State& from) {
    bool searches = false;
    for (double t = from.t + kAgain; t < total_; t += kAgain, searches = !searches) {
      State m;
      if (!at(t, m)) break;
      if (!window(m)) continue;
      const auto result =
          searches ? law_.solve_stop(m.start, m.along) : law_.brake_stop(m.start, m.along);
      if (result != TimeLaw::Result::ok) continue;
      Stop out = stop_of(law_);
      out.seconds += t - from.t;
      return out.seconds < total_ - from.t ? out : Stop{total_ - from.t, out.way};
    }
    return {total_ - from.t, 0};
  }

  void note(const Moment& m, StopsResult& out) {
    const double ratio = std::min(m.ours.seconds, total_ - m.at.t) / m.best.seconds;
    ++out.moments;
    out.searched += m.brake.seconds < kFar ? 0 : 1;
    out.over += ratio > 1.1 ? 1 : 0;
    out.mean += ratio;
    out.worst = std::max(out.worst, ratio);
  }

  path::AxisLimits limits_;
  std::vector<motion::PathSpan> curve_;
  motion::test::HeapMemory heap_;
  TimeLaw law_;
  bool ok_{false};
  std::size_t begin_{0}, end_{0};
  std::vector<LawStep> run_;
  double total_{0};
};

}  // namespace

StopsResult stops(const Program& program, double jerk, std::size_t most) {
  return Stops(program, jerk).run(most);
}

}  // namespace kerf::bench
