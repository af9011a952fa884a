#include "rtapi/clock/local_scheduler.hpp"

#include <poll.h>

#include <algorithm>

namespace kerf::rtapi {

void LocalScheduler::add(Participant& participant) {
  Entry entry{&participant, {}};
  entry.spec.until = now_;
  const auto place = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return e.participant->role() > participant.role();
  });
  entries_.insert(place, entry);
}

void LocalScheduler::remove(Participant& participant) {
  std::erase_if(entries_, [&](const Entry& e) { return e.participant == &participant; });
}

bool LocalScheduler::is_due(const Entry& entry, Nanos now) noexcept {
  if (entry.spec.until <= now) return true;
  for (const CellWatch& watch : entry.spec.cells)
    if (watch.cell->count() != watch.seen) return true;
  return false;
}

bool LocalScheduler::settle() {
  for (;;) {
    std::size_t i = 0;
    bool holds = false;
    for (; i < entries_.size(); ++i) {
      if (is_due(entries_[i], now_)) break;
      holds = holds || entries_[i].spec.holds_time;
    }
    if (i == entries_.size()) return holds;
    // A step may add or remove participants, so the spec is written after it, by name.
    Participant* const participant = entries_[i].participant;
    WaitSpec spec;
    participant->step(now_, spec);
    for (Entry& entry : entries_)
      if (entry.participant == participant) entry.spec = spec;
  }
}

bool LocalScheduler::wait_outside() {
  std::vector<pollfd> fds;
  std::vector<std::size_t> owner;
  // All of them: while time stands, whoever is called from outside (by a client) still runs.
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    for (const int fd : entries_[i].spec.fds) {
      fds.push_back({fd, POLLIN, 0});
      owner.push_back(i);
    }
  }
  const int ready = poll(fds.data(), fds.size(), hold_limit_ms_);
  if (ready <= 0) {
    for (const Entry& entry : entries_)
      if (entry.spec.holds_time) stuck_ = entry.participant->name();
    return false;
  }
  for (std::size_t k = 0; k < fds.size(); ++k)
    if (fds[k].revents != 0) entries_[owner[k]].spec.until = now_;
  return true;
}

Nanos LocalScheduler::next_wake() const noexcept {
  Nanos next = kForever;
  for (const Entry& entry : entries_) next = std::min(next, entry.spec.until);
  return next;
}

void LocalScheduler::run_until(Nanos until) {
  (void)run_until([] { return false; }, until);
}

bool LocalScheduler::run_until(const std::function<bool()>& done, Nanos limit) {
  for (;;) {
    const bool held = settle();
    if (done()) return true;
    if (held) {
      if (!wait_outside()) return done();
      continue;
    }
    const Nanos next = next_wake();
    if (next > limit) {
      now_ = std::max(now_, limit);
      return false;
    }
    now_ = std::max(now_, next);
  }
}

}  // namespace kerf::rtapi
