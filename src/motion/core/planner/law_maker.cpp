#include "motion/core/planner/law_maker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::motion {
namespace {

constexpr std::size_t kNone = Laws::kSlots;
/// A child begins so long after where the servo is: a law takes milliseconds to make. Longer after one that came too late.
constexpr double kLead = 0.010, kMostLead = 0.080, kMoreLead = 1.5, kLessLead = 0.9;
/// Moments from which a stop is ready: with the cycle that sees an order it begins within 20 ms where the servo period is at most 2 ms.
constexpr double kStopLead = 0.006, kStopEvery = 0.018;
/// After one that was not found; and how much before, so often at most, it is looked for another.
constexpr double kStopAgain = 0.003, kStopBefore = 0.003;
constexpr int kStopsBefore = 2;
/// Time and intervals of a window that may go on beyond what it has to reach; the time when it is wanted soon; intervals when it is only to begin, and at most.
constexpr double kWindowTime = 0.6, kSoonTime = 0.3;
constexpr std::size_t kWindow = 400, kStart = 48;
/// A law for another feed, which the next may follow at once, sees so many stops of a straight from the speed that there is so much later, and so long (s);
/// it begins no stretch of which it has to see less than that share, and ends within one of which more than that is left.
constexpr double kFeedStops = 1.3, kFeedRise = 0.02, kFeedTime = 0.04, kWorthCutting = 0.2;
constexpr std::size_t kMost = Law::kSteps * 3 / 4;
/// A law is made longer when that share of it is driven, or so many stopping times are left of it and that share is driven: where intervals are short as many
/// as there may be take less.
constexpr double kShare = 0.75, kStopTimes = 1.5, kLeastShare = 0.1;
/// What follows a stop is made ready so long before.
constexpr double kRestAhead = 0.25;
/// A law that ends within so many times what even braking takes needs no stop beside it.
constexpr double kSoonAtRest = 1.1;
/// Of place (sigma), and of speed and acceleration as a share.
constexpr double kSamePlace = 1e-9, kSameSpeed = 1e-9;
/// A feed that falls to less than this (of x) is driven from rest: a law that leads to hardly any speed within an interval takes many times as long as a
/// stop. And from where on a feed that rises again is taken up without standing.
constexpr double kFarBelow = 2e-3, kGoesOn = 0.5;
/// From less than this (sigma/s) no law is begun: steps would be finer than rounding there.
constexpr double kMoves = 1e-7;
/// After a law that was not found.
constexpr double kRetry = 0.010;
/// Up to this share of what is wanted (of x) a law is not held back by it.
constexpr double kFree = 0.97;
/// A law from rest is not made again sooner for another feed (s): one that swings (adaptive feed) would have it made in each cycle, and it would never be
/// there for long. What is driven by the old one meanwhile is the beginning, up to its first child.
constexpr double kRestAgain = 0.040;
/// Of the estimated way to stop.
constexpr double kStopReserve = 1.5;
/// Stretches that take so long are divided into 1, 2 or 4 intervals a cubic.
constexpr double kDense = 0.0015, kMiddling = 0.004;

}  // namespace

bool LawMaker::create(path::Memory& memory, bool joints) noexcept {
  const std::size_t rows = joints ? path::TimeLaw::kRowsWithJoints : path::TimeLaw::kRows;
  return stretch_.create(memory, kSpans) && (!joints || joints_.create(memory, kSpans)) &&
         solver_.create(memory, Law::kSteps, rows);
}

void LawMaker::configure(const path::AxisLimits& limits, bool on, double longest_stop_s) noexcept {
  forget();  // made for other limits
  limits_ = limits;
  on_ = on;
  stop_s_ = longest_stop_s;
  if (stretch_.size() < kSpans) stretch_.assign(kSpans, Stretch{});
  joints_.assign(kSpans, path::JointCurve{});
}

void LawMaker::add(std::uint64_t number, const Stretch& stretch,
                   const path::JointCurve* joints) noexcept {
  stretch_[number % kSpans] = stretch;
  if (joints_.empty()) return;
  if (joints != nullptr)
    joints_[number % kSpans] = *joints;
  else
    joints_[number % kSpans].count = 0;
}

void LawMaker::forget() noexcept {
  for (std::size_t i = 0; i < Laws::kSlots; ++i) take_back(i);
}

/// Taken back at first; written anew when no cycle can have it any more. The servo may take a law in the cycle in which it is taken back. The view
/// read in the next turn is of that cycle's predecessor or later, so the one after the next cycle finds it gone or shows that it runs.
void LawMaker::take_back(std::size_t slot) noexcept {
  Info& info = info_[slot];
  if (info.state != State::there) return;
  gate_.pass([&] { laws_.head[slot].gone.publish(gate_.passes()); });
  rtapi::full_fence();
  info.state = State::taken_back;
  info.mark = 0;
}

void LawMaker::reclaim(const ServoView& view) noexcept {
  for (Info& info : info_) {
    if (info.state != State::taken_back) continue;
    if (info.mark == 0)
      info.mark = view.cycle;
    else if (view.cycle >= info.mark + 2 && view.law.number != info.number)
      info.state = State::free;
  }
}

std::size_t LawMaker::free_slot() const noexcept {
  for (std::size_t i = 0; i < Laws::kSlots; ++i)
    if (info_[i].state == State::free) return i;
  return kNone;
}

std::size_t LawMaker::find(std::uint64_t number) const noexcept {
  for (std::size_t i = 0; i < Laws::kSlots; ++i)
    if (info_[i].state != State::free && info_[i].number == number) return i;
  return kNone;
}

double LawMaker::elapsed(const Law& law, const LawPlace& at) noexcept {
  double t = at.seconds;
  for (std::size_t i = 0; i < at.index && i < law.count; ++i) t += law.step[i].seconds;
  return t;
}

/// The moment `t` of a law as the beginning of another. False: it is over by then.
bool LawMaker::locate(std::size_t running, double t, LawKey& key, Place& place) const noexcept {
  const Law& law = laws_.law[running];
  for (std::size_t i = 0; i < law.count; ++i) {
    const path::LawStep& step = law.step[i];
    if (t >= step.seconds) {
      t -= step.seconds;
      continue;
    }
    // About to rest there is nothing left to change.
    if (step.kind == path::LawStep::Kind::stop) return false;
    const path::LawState state = path::at(step, t);
    key.index = static_cast<std::uint32_t>(i);
    key.seconds = t;
    key.parent = info_[running].number;
    place.span = step.span;
    place.left = step.left + (step.length - state.s);
    place.start = {state.speed * state.speed, state.acc};
    return state.speed > kMoves && place.left > 0;
  }
  return false;
}

/// Adds the stretches from `place` on to the solver: to the next stop, or until enough of them are there. A law has to reach the end of span
/// `at_least`.
bool LawMaker::fill(const Place& place, std::uint64_t at_least, For what, Window& out) noexcept {
  const bool stops = what == For::stop;
  const double sees = what == For::feed ? feed_way(place) : path::kNoLimit;
  const double enough = what == For::path ? kWindowTime : what == For::soon ? kSoonTime : 0.0;
  const std::size_t most = what == For::start ? kStart : kWindow;
  solver_.begin(limits_);
  out = Window{};
  double left = place.left, way = 0, time = 0, acc = path::kNoLimit, jerk = path::kNoLimit;
  bool first = true;
  for (std::uint64_t n = place.span;; ++n) {
    if (n >= next_ || !stretch(n).by_law) {
      out.final = n < next_;
      out.wants = !out.final;
      break;
    }
    const Stretch& s = stretch(n);
    const double wish = wanted_x(s.speed, scale_);
    // It will stand before what is wanted to stand.
    if (!(wish > 0) && !first && !stops) break;
    // Of the next stretch it has to see next to nothing.
    if (what == For::feed && !first && sees - way < kWorthCutting * left) {
      out.final = false;
      break;
    }
    // At the programmed feed: how slow it is driven now says nothing of how the path bends.
    const double x = std::min(std::max(wish, s.speed.feed_cap), s.speed.cap);
    const double seconds = s.length / std::sqrt(x);
    const int fineness = stops || seconds < kDense ? 1 : seconds < kMiddling ? 2 : 4;
    const double end = s.from + s.length;
    double to = end;
    if (what == For::feed && way + left - sees > kWorthCutting * left) to = end - left + sees - way;
    if (!solver_.add(n, s.piece, end - left, to, end, s.speed.cap, wish > 0 ? wish : path::kNoLimit,
                     fineness, joints(n)))
      return false;
    if (to < end) {
      out.final = false;
      break;
    }
    out.straight = out.straight && s.piece.straight() && joints(n) == nullptr;
    // Where a block ends within a span it is driven from rest, by boxes (Executor::cut_).
    const bool step_ends = s.block_end || (n + 1 < next_ && stretch(n + 1).blocks);
    if (s.stop_at_end || (single_step_ && step_ends)) break;
    first = false;
    way += left;
    time += seconds;
    left = n + 1 < next_ ? stretch(n + 1).length : 0.0;
    if (stops) {
      acc = std::min(acc, s.acc);
      jerk = std::min(jerk, s.jerk);
      // It speeds up for a while yet.
      const double rise = (std::max(place.start.u, 0.0) + acc) / jerk;
      const double v = std::sqrt(place.start.x) + rise * std::max(place.start.u, acc) / 2;
      // Boxes of blends ahead make the way seem longer than it is; a stop ends wherever it can.
      if (way > kStopReserve * (v * v / (2 * acc) + v * rise) || solver_.intervals() > kMost) {
        out.final = false;
        break;
      }
    } else if (what == For::feed) {
      if (way > sees || solver_.intervals() > kMost) {
        out.final = false;
        break;
      }
    } else if (n >= at_least &&
               ((solver_.intervals() > most && time > enough) || solver_.intervals() > kMost)) {
      out.final = false;
      break;
    }
  }
  return solver_.intervals() > 0;
}

LawMaker::Info& LawMaker::publish(std::size_t slot, const LawKey& key,
                                  const Window& window) noexcept {
  Law& law = laws_.law[slot];
  laws_.head[slot].key = key;
  law.count = 0;
  Info& info = info_[slot];
  info = Info{};
  info.state = State::there;
  info.number = gate_.passes() + 1;  // of the pass below
  info.known = next_;
  info.final = window.final;
  info.wants = window.wants;
  info.single_step = single_step_;
  info.scale = scale_;
  info.made = now_;
  if (key.kind != LawKey::Kind::boxes) {
    for (const path::LawStep& step : solver_.law()) law.step[law.count++] = step;
    info.total = solver_.seconds();
    info.last_span = law.step[law.count - 1].span;
    info.last_left = law.step[law.count - 1].left;
  }
  gate_.pass([&] { laws_.head[slot].number.publish(info.number); });
  return info;
}

/// The solver vouches for all of its law but for what it was told of where the law begins.
bool LawMaker::begins_at(const Place& place) const noexcept {
  const path::LawStep& first = solver_.law().front();
  const path::LawState state = path::at(first, 0);
  const double v = std::sqrt(place.start.x);
  return first.span == place.span &&
         std::abs(first.left + first.length - place.left) <= kSamePlace &&
         std::abs(state.speed - v) <= kSameSpeed * (1 + v) &&
         (place.start.x <= 0 ||
          std::abs(state.acc - place.start.u) <= kSameSpeed * (1 + std::abs(place.start.u)));
}

bool LawMaker::solved(path::TimeLaw::Result result, const Place& place, Count& count) noexcept {
  ++count.all;
  count.intervals += solver_.intervals();
  count.iterations += static_cast<std::uint64_t>(solver_.iterations());
  count.searched += solver_.iterations() > 0 ? 1 : 0;
  count.work += solver_.work() - worked_;
  worked_ = solver_.work();
  if (result == path::TimeLaw::Result::ok && begins_at(place)) return true;
  ++count.failed;
  return false;
}

/// A law from rest there.
void LawMaker::prepare_rest(std::uint64_t span, double left, std::uint64_t running) noexcept {
  if (span >= next_ || !stretch(span).by_law) return;
  const double wish = wanted_x(stretch(span).speed, scale_);
  if (!(wish > 0) || awaits_feed(stretch(span).speed, wish)) return;
  const bool slow = wish < kLeastFromRest;
  std::size_t old = kNone;
  for (std::size_t i = 0; i < Laws::kSlots; ++i) {
    const LawKey& key = laws_.head[i].key;
    const Info& info = info_[i];
    if (info.state != State::there || info.number == running || key.parent != 0) continue;
    const bool fits = key.span == span && key.left == left && info.single_step == single_step_;
    const bool whole = !info.wants || info.known == next_;
    if (fits && whole && info.scale == scale_) return;
    if (fits && whole && now_ < info.made + kRestAgain) {
      busy_ = true;  // this has to be looked at again
      return;
    }
    if (fits && old == kNone)
      old = i;
    else
      take_back(i);
  }
  const std::size_t slot = free_slot();
  if (slot == kNone) return;
  LawKey key;
  key.kind = LawKey::Kind::rest;
  key.span = span;
  key.left = left;
  Window window;
  const Place place{span, left, {}};
  const auto solves = [&] { return solved(solver_.solve({}), place, counts_.rests); };
  // A single straight from rest to rest is driven in the least time by ramps; so is what has hardly any speed. What no law is found for, of few
  // intervals either, is driven as well as boxes can.
  if (!fill(place, span, For::soon, window) || (window.straight && window.final) || slow ||
      !(solves() || (fill(place, span, For::start, window) && solves())))
    key.kind = LawKey::Kind::boxes;
  // Until here the servo could begin with the old one.
  if (old != kNone) take_back(old);
  publish(slot, key, window);
}

/// Takes back what can follow on no law but `running`.
void LawMaker::keep_only(std::uint64_t running) noexcept {
  for (std::size_t i = 0; i < Laws::kSlots; ++i) {
    const std::uint64_t parent = laws_.head[i].key.parent;
    if (info_[i].state != State::there || info_[i].number == running || parent == 0) continue;
    // Of a child that is not run yet there may be stops.
    const std::size_t of = find(parent);
    const bool grandchild = of != kNone && info_[of].state == State::there &&
                            laws_.head[of].key.parent == running && running != 0;
    if (parent != running && !grandchild) take_back(i);
  }
}

/// The servo runs no law.
void LawMaker::stand(const LawPlace& at) noexcept {
  keep_only(0);
  if (at.rest_span != LawPlace::kNoSpan) return prepare_rest(at.rest_span, at.rest_left, 0);
  if (!at.moving) return prepare_rest(first_, stretch(first_).length, 0);
  // By boxes to the next rest.
  std::uint64_t n = first_;
  while (n < next_ && !stretch(n).stop_at_end) ++n;
  if (n + 1 < next_) prepare_rest(n + 1, stretch(n + 1).length, 0);
}

void LawMaker::follow(std::size_t running, const LawPlace& at) noexcept {
  const Law& law = laws_.law[running];
  const Info info = info_[running];
  const double now = elapsed(law, at);
  keep_only(info.number);
  std::size_t child = kNone;
  for (std::size_t i = 0; i < Laws::kSlots; ++i) {
    const LawKey& key = laws_.head[i].key;
    if (info_[i].state != State::there || key.parent != info.number) continue;
    if (info_[i].begins < now - Law::kSameMoment) {
      if (key.kind == LawKey::Kind::go)
        lead_ = std::min(std::max(lead_, kLead) * kMoreLead, kMostLead);
      take_back(i);
    } else if (key.kind == LawKey::Kind::go)
      child = i;
  }
  const bool stops = laws_.head[running].key.kind == LawKey::Kind::stop;
  const bool stays = info.single_step == single_step_ && !info.rests && !stops &&
                     !feeds_bear(law, at.index, info.scale);
  if (stays) info_[running].scale = scale_;
  const bool changed = !(info_[running].scale == scale_) || info.single_step != single_step_;
  const bool more = !info.final && (info.last_span + 1 < next_ || info.last_left > 0) &&
                    (now > kShare * info.total ||
                     (now > kLeastShare * info.total && info.total - now < kStopTimes * stop_s_));
  // One for more path that is not driven yet knows nothing of the feed: another takes its place, once, as a feed that swings would never have one.
  const bool overtakes = child != kNone && changed && !info_[child].overtaken &&
                         info_[child].scale == info.scale &&
                         info_[child].single_step == info.single_step;
  const bool due = child == kNone && (changed || more || stops) && now >= info.child_tried;
  if (!at.stands && (due || overtakes)) {
    if (overtakes) info_[child].overtaken = true;
    const bool made = make_child(running, now, changed);
    if (made && overtakes) take_back(std::exchange(child, kNone));
    info_[running].child_tried = now + kRetry;
  }
  if (!stops) make_stop(running, now, child == kNone ? info.total : info_[child].begins);
  if (child != kNone) make_stop(child, now - info_[child].begins, info_[child].total);
  if (child == kNone && (info.final || stops) && info.total - now < kRestAhead) {
    if (info.last_left > 0)
      prepare_rest(info.last_span, info.last_left, info.number);
    else if (info.last_span + 1 < next_)
      prepare_rest(info.last_span + 1, stretch(info.last_span + 1).length, info.number);
  }
}

bool LawMaker::make_child(std::size_t running, double now, bool changed) noexcept {
  const std::size_t slot = free_slot();
  LawKey key;
  Place place;
  const double begins = now + std::clamp(lead_, kLead, kMostLead);
  if (slot == kNone || !locate(running, begins, key, place)) return false;
  key.kind = LawKey::Kind::go;
  const bool stops = laws_.head[running].key.kind == LawKey::Kind::stop;
  const Info& from = info_[running];
  const std::uint64_t at_least = stops ? place.span : from.last_span;
  const double wish = wanted_x(stretch(place.span).speed, scale_);
  if (from.rests && from.single_step == single_step_ && wish < kGoesOn * place.start.x)
    return false;
  Window window;
  const bool rests = wish < kFarBelow * place.start.x && brake(running, key, place, false, window);
  const auto solves = [&](For what) {
    return fill(place, what == For::feed ? place.span : at_least, what, window) &&
           solved(solver_.solve(place.start), place, counts_.children);
  };
  // What cannot be seen through to a stop from near may be from farther, where there is more to see.
  const bool for_feed = changed && !stops;
  const bool found =
      rests || (for_feed && solves(For::feed)) ||
      (!(for_feed && window.final) && solves(changed || stops ? For::soon : For::path));
  if (!found) return false;
  if (rests) window.final = true;  // what comes next begins from rest
  Info& info = publish(slot, key, window);
  info.begins = begins;
  info.rests = rests;
  lead_ *= kLessLead;
  return true;
}

/// Below what any stop takes from there: even braking with all the acceleration that the axes have, on a straight.
double LawMaker::even_stop(const Place& place) const noexcept {
  const Stretch& s = stretch(place.span);
  const path::Vec slope = s.piece.first(s.from + s.length - place.left);
  double acc = path::kNoLimit;
  for (std::size_t i = 0; i < path::kAxes; ++i)
    if (slope[i] != 0) acc = std::min(acc, limits_.acc[i] / std::abs(slope[i]));
  return std::sqrt(place.start.x) / acc;
}

/// Whether the law is held back by feeds, as they were or are, from this interval on: where it is not it takes the least time with both.
bool LawMaker::feeds_bear(const Law& law, std::size_t from,
                          const FeedScale& before) const noexcept {
  if (before == scale_) return false;
  double free = 0;  // below this of x nothing is held back
  for (std::size_t i = from; i < law.count; ++i) {
    const path::LawStep& step = law.step[i];
    if (i == from || step.span != law.step[i - 1].span) {
      const SpeedBounds& speed = stretch(step.span).speed;
      const double was = wanted_x(speed, before), is = wanted_x(speed, scale_);
      free = was == is ? path::kNoLimit : kFree * std::min(was, is);
    }
    const double end = i + 1 < law.count ? law.step[i + 1].x : 0.0;
    if (std::max(step.x, end) > free) return true;
  }
  return false;
}

/// How far a law for another feed has to see.
double LawMaker::feed_way(const Place& place) const noexcept {
  const Stretch& s = stretch(place.span);
  path::LawStretch there;
  there.piece = s.piece;
  there.joints = joints(place.span);
  double acc = 0, jerk = 0;
  path::straight_limits(there, s.from + s.length - place.left, limits_, acc, jerk);
  // It speeds up until its acceleration has gone, and to what is wanted until the next law takes over.
  const double now = std::sqrt(place.start.x), wanted = std::sqrt(wanted_x(s.speed, scale_)),
               u = std::max(place.start.u, 0.0), gone_s = u / jerk;
  const double v = std::max(now + u * gone_s / 2, std::min(now + acc * kFeedRise, wanted));
  return kFeedStops * v * (v / (2 * acc) + acc / jerk + gone_s) + v * kFeedTime;
}

void LawMaker::make_stop(std::size_t running, double now, double before) noexcept {
  Info& info = info_[running];
  const double soonest = std::max(now + kStopLead, kStopLead / 2),
               begins = std::max(info.next_stop, soonest);
  // One is ready for a while.
  if (begins >= before || begins > std::max(now, 0.0) + kStopLead + kStopEvery) return;
  const std::size_t slot = free_slot();
  if (slot == kNone) return;
  // Where braking finds nothing it is asked for a little before. Else the solver is, at every second one of the moments that follow soon.
  const bool searches = !info.stop_failed;
  double at = begins;
  StopFound found = make_stop_at(running, slot, at, false);
  for (int i = 0; found == StopFound::no && i < kStopsBefore && at - kStopBefore >= soonest; ++i)
    found = make_stop_at(running, slot, at -= kStopBefore, false);
  if (found == StopFound::no && searches) found = make_stop_at(running, slot, at = begins, true);
  info.stop_failed = found == StopFound::no && searches;
  info.next_stop = found == StopFound::no ? begins + kStopAgain : at + kStopEvery;
}

/// From a place of the running law to rest, by the solver or by braking.
bool LawMaker::brake(std::size_t running, const LawKey& key, const Place& place, bool search,
                     Window& window) noexcept {
  const Law& law = laws_.law[running];
  const path::LawStep& step = law.step[key.index];
  const path::LawAlong along{&step, law.count - key.index, path::at(step, key.seconds).s};
  const bool filled = fill(place, place.span, For::stop, window);
  const auto result = !filled  ? path::TimeLaw::Result::failed
                      : search ? solver_.search_stop(place.start)
                               : solver_.brake_stop(place.start, along);
  return solved(result, place, counts_.stops);
}

/// By the solver, or by braking.
LawMaker::StopFound LawMaker::make_stop_at(std::size_t running, std::size_t slot, double begins,
                                           bool search) noexcept {
  LawKey key;
  Place place;
  if (!locate(running, begins, key, place)) return StopFound::not_needed;
  // About to end in rest anyway.
  if (info_[running].total - begins < kSoonAtRest * even_stop(place)) return StopFound::not_needed;
  key.kind = LawKey::Kind::stop;
  Window window;
  if (!brake(running, key, place, search, window)) return StopFound::no;
  publish(slot, key, window).begins = begins;
  return StopFound::yes;
}

void LawMaker::run(const ServoView& view, const FeedScale& scale, bool single_step,
                   std::uint64_t first, std::uint64_t next, double now) noexcept {
  busy_ = false;
  now_ = now;
  if (!on_) return;
  scale_ = scale;
  single_step_ = single_step;
  first_ = first;
  next_ = next;
  reclaim(view);
  if (view.law.number == 0) return stand(view.law);
  busy_ = true;
  const std::size_t running = find(view.law.number);
  if (running != kNone) follow(running, view.law);
}

}  // namespace kerf::motion
