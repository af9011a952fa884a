#include "rtapi/clock/virtual_clock.hpp"

#include <dlfcn.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/shm/abstract_address.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {

namespace {

/// How often, in real ms, a waiting participant looks whether the one that runs is still alive.
constexpr int kLivenessMs = 100;
/// Real time for which a program that does not know of the clock may run between two waits.
constexpr Nanos kForeignMayKeep = kSecond;
/// Real time after which the holder of time or baton is named on stderr.
constexpr Nanos kNameHolderAfter = 5 * kSecond;

}  // namespace

/// Takes the mutex, also from a dead owner: every field is rewritten whole by its slot or checked by drop_dead, so the state is
/// usable as it is.
class VirtualClock::Lock {
 public:
  explicit Lock(ClockBlock& block) : block_(block) {
    if (pthread_mutex_lock(&block_.mutex) == EOWNERDEAD) pthread_mutex_consistent(&block_.mutex);
  }
  ~Lock() { pthread_mutex_unlock(&block_.mutex); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  ClockBlock& block_;
};

std::string VirtualClock::address(std::int32_t slot) const {
  return socket_name(instance_, "clock-" + std::to_string(slot));
}

Result<std::unique_ptr<VirtualClock>> VirtualClock::join(Segment& segment, ClockBlock& block,
                                                         Role role, std::string_view name,
                                                         bool foreign) {
  KERF_TRY(auto clock, take_place(segment, block, role, name, foreign));
  WaitSpec at_once;
  at_once.until = block.now_ns.get();
  clock->wait(at_once);
  return clock;
}

Result<std::unique_ptr<VirtualClock>> VirtualClock::take_place(Segment& segment, ClockBlock& block,
                                                               Role role, std::string_view name,
                                                               bool foreign) {
  if (!foreign) {
    // A shim that was preloaded into this process has nothing to do any more.
    using Disable = void();
    if (auto* disable = reinterpret_cast<Disable*>(dlsym(RTLD_DEFAULT, "kerf_time_shim_disable")))
      disable();
  }
  auto clock = std::unique_ptr<VirtualClock>(new VirtualClock(segment, block));
  clock->instance_ = segment.instance();
  clock->stop_fd_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  clock->socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (clock->stop_fd_ < 0 || clock->socket_ < 0)
    return fail(Errc::system, "no descriptors left for the virtual clock");
  {
    const Lock lock(block);
    clock->drop_dead();
    for (std::int32_t i = 0; i < ClockBlock::kSlots && clock->me_ < 0; ++i) {
      if (block.slot[i].state != ClockSlot::State::free) continue;
      sockaddr_un sun{};
      const socklen_t length = abstract_address(clock->address(i), sun);
      // The address of a slot that has just become free may still be in use: take the next.
      if (bind(clock->socket_, reinterpret_cast<const sockaddr*>(&sun), length) == 0)
        clock->me_ = i;
    }
    if (clock->me_ < 0)
      return fail(Errc::no_memory, "more than 64 participants on the virtual clock");
    ClockSlot& slot = block.slot[clock->me_];
    slot = ClockSlot{};
    slot.state = ClockSlot::State::waiting;
    slot.role = role;
    slot.order = block.joined++;
    slot.pid = getpid();
    slot.pid_start = process_start_time(slot.pid);
    slot.name = FixedString<31>(name);
    slot.foreign = foreign;
    slot.until = block.now_ns.get();
    block.joins.notify();
  }
  return clock;
}

VirtualClock::Handed VirtualClock::leave() {
  const Lock lock(block_);
  block_.slot[me_].state = ClockSlot::State::free;
  block_.joins.notify();
  if (block_.pacer == me_) block_.pacer = ClockBlock::kNobody;
  if (block_.baton != me_ && block_.baton != ClockBlock::kNobody) return {};
  block_.baton = ClockBlock::kNobody;
  me_ = -1;
  return dispatch();
}

VirtualClock::~VirtualClock() {
  // A forked child has this object too, but not the place.
  if (me_ >= 0 && owner_pid_ == getpid()) tell(leave());
  if (socket_ >= 0) close(socket_);
  if (stop_fd_ >= 0) close(stop_fd_);
}

bool VirtualClock::is_due(const ClockSlot& slot) const noexcept {
  if (slot.until <= block_.now_ns.get() || slot.outside_ready) return true;
  for (std::uint32_t i = 0; i < slot.cell_count && i < 8; ++i)
    if (segment_.at<Cell>(slot.cell[i])->count() != slot.seen[i]) return true;
  return false;
}

std::int32_t VirtualClock::first_due(bool& held) const noexcept {
  std::int32_t best = ClockBlock::kNobody;
  held = false;
  for (std::int32_t i = 0; i < ClockBlock::kSlots; ++i) {
    const ClockSlot& slot = block_.slot[i];
    if (slot.state != ClockSlot::State::waiting) continue;
    held = held || slot.holds_time;
    if (!is_due(slot)) continue;
    if (best == ClockBlock::kNobody) {
      best = i;
      continue;
    }
    const ClockSlot& other = block_.slot[best];
    if (slot.role < other.role || (slot.role == other.role && slot.order < other.order)) best = i;
  }
  return best;
}

const ClockSlot* VirtualClock::stalled_by() const noexcept {
  if (block_.baton != ClockBlock::kNobody) return &block_.slot[block_.baton];
  for (const ClockSlot& slot : block_.slot)
    if (slot.state == ClockSlot::State::waiting && slot.holds_time) return &slot;
  return nullptr;
}

bool VirtualClock::speaks() const noexcept {
  for (std::int32_t i = 0; i < me_; ++i)
    if (block_.slot[i].state == ClockSlot::State::waiting && !block_.slot[i].holds_time)
      return false;
  return !block_.slot[me_].holds_time;
}

Nanos VirtualClock::next_wake() const noexcept {
  Nanos next = kForever;
  for (const ClockSlot& slot : block_.slot)
    if (slot.state == ClockSlot::State::waiting) next = std::min(next, slot.until);
  return next;
}

bool VirtualClock::must_pace(Nanos next, Nanos& left) const noexcept {
  if (block_.speed <= 0) return false;
  const auto virtual_step = static_cast<double>(next - block_.paced_virtual_ns);
  const auto due = block_.paced_real_ns + static_cast<Nanos>(virtual_step / block_.speed);
  left = due - monotonic_now();
  return left > 0;
}

void VirtualClock::hand_to(std::int32_t slot) noexcept {
  block_.baton = slot;
  block_.slot[slot].state = ClockSlot::State::running;
  block_.slot[slot].outside_ready = false;
  if (block_.slot[slot].foreign) block_.foreign_since_ns = monotonic_now();
}

void VirtualClock::tell(Handed to) {
  while (to.slot != ClockBlock::kNobody) {
    sockaddr_un sun{};
    const socklen_t length = abstract_address(address(to.slot), sun);
    const char baton = 'b';
    // Where there is no room it has not looked at those before yet, and will.
    if (sendto(socket_, &baton, 1, MSG_NOSIGNAL | MSG_DONTWAIT,
               reinterpret_cast<const sockaddr*>(&sun), length) == 1 ||
        errno == EAGAIN)
      return;
    // Its socket is gone, so it is: go on without it. Others may have seen that too.
    const Lock lock(block_);
    if (block_.baton != to.slot || block_.slot[to.slot].order != to.order) return;
    block_.slot[to.slot].state = ClockSlot::State::free;
    block_.baton = ClockBlock::kNobody;
    to = dispatch();
  }
}

VirtualClock::Handed VirtualClock::dispatch() {
  for (;;) {
    bool held = false;
    const std::int32_t due = first_due(held);
    if (due != ClockBlock::kNobody) {
      hand_to(due);
      if (due == me_) return {};
      return {due, block_.slot[due].order};
    }
    if (held) return {};  // whoever finishes its outside work dispatches
    const Nanos next = next_wake();
    if (next == kForever) return {};  // all wait for something from outside
    Nanos left = 0;
    if (must_pace(next, left)) {
      // The one that dispatches sleeps for it, in wait().
      if (me_ >= 0 && block_.pacer == ClockBlock::kNobody) block_.pacer = me_;
      return {};
    }
    if (block_.speed > 0 && monotonic_now() - block_.paced_real_ns > kSecond) {
      // Never hurry after a stall.
      block_.paced_real_ns = monotonic_now();
      block_.paced_virtual_ns = next;
    }
    block_.now_ns.set(next);
  }
}

void VirtualClock::drop_dead() noexcept {
  for (std::int32_t i = 0; i < ClockBlock::kSlots; ++i) {
    ClockSlot& slot = block_.slot[i];
    if (slot.state == ClockSlot::State::free || slot.pid == getpid()) continue;
    if (process_lives(slot.pid, slot.pid_start)) continue;
    slot.state = ClockSlot::State::free;
    if (block_.baton == i) block_.baton = ClockBlock::kNobody;
    if (block_.pacer == i) block_.pacer = ClockBlock::kNobody;
  }
}

void VirtualClock::drop_baton_of_foreign() noexcept {
  if (block_.baton == ClockBlock::kNobody) return;
  const ClockSlot& holder = block_.slot[block_.baton];
  if (!holder.foreign || monotonic_now() - block_.foreign_since_ns < kForeignMayKeep) return;
  std::fprintf(
      stderr,
      "kerf: '%s' (process %lld) is not deterministic: it waits for something else than time\n",
      holder.name.c_str(), static_cast<long long>(holder.pid));
  // It stays `running`, so it is not counted until its next wait.
  block_.baton = ClockBlock::kNobody;
}

void VirtualClock::evict(Segment& segment, std::int64_t pid) {
  auto found = segment.find<ClockBlock>(ClockBlock::kName);
  if (!found.ok() || (*found)->mode != ClockMode::virtual_time) return;
  VirtualClock helper(segment, **found);
  helper.instance_ = segment.instance();
  helper.socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  Handed to;
  {
    const Lock lock(**found);
    for (ClockSlot& slot : (*found)->slot)
      if (slot.state != ClockSlot::State::free && slot.pid == pid)
        slot.pid_start = ~std::uint64_t{0};  // no process has this start time
    helper.drop_dead();
    if ((*found)->baton == ClockBlock::kNobody) to = helper.dispatch();
  }
  helper.tell(to);
}

bool VirtualClock::has_group(ClockBlock& block, std::int64_t group) {
  const Lock lock(block);
  for (const ClockSlot& slot : block.slot)
    if (slot.state != ClockSlot::State::free && getpgid(static_cast<pid_t>(slot.pid)) == group)
      return true;
  return false;
}

VirtualClock::Begun VirtualClock::begin_wait(const WaitSpec& spec,
                                             std::span<VirtualClock* const> places) {
  fds_ = spec.fds;
  const Lock lock(block_);
  ClockSlot& slot = block_.slot[me_];
  slot.until = spec.until;
  slot.holds_time = spec.holds_time;
  slot.cell_count = 0;
  for (const CellWatch& watch : spec.cells) {
    if (!segment_.contains(watch.cell)) {
      std::fprintf(stderr, "kerf: internal fault: '%s' waits for a cell outside the segment\n",
                   slot.name.c_str());
      std::abort();
    }
    slot.cell[slot.cell_count] = segment_.offset_of(watch.cell);
    slot.seen[slot.cell_count++] = watch.seen;
  }
  slot.state = ClockSlot::State::waiting;
  if (block_.baton == me_) block_.baton = ClockBlock::kNobody;
  Begun begun;
  if (block_.baton == ClockBlock::kNobody) begun.to = dispatch();
  begun.turn = with_baton(places);
  return begun;
}

VirtualClock* VirtualClock::next_turn(const WaitSpec& spec, std::span<VirtualClock* const> places) {
  const Begun begun = begin_wait(spec, places);
  if (begun.turn != nullptr) return begun.turn;
  tell(begun.to);
  return wait_in(places);
}

void VirtualClock::wait(const WaitSpec& spec) {
  VirtualClock* const place = this;
  (void)next_turn(spec, {&place, 1});
}

void VirtualClock::run(std::span<VirtualClock* const> places,
                       std::span<Participant* const> participants) {
  WaitSpec spec;
  spec.until = places.front()->now();
  VirtualClock* turn = places.front()->next_turn(spec, places);
  while (turn != nullptr && !any_stopped(places)) {
    const auto i = std::find(places.begin(), places.end(), turn) - places.begin();
    spec = {};
    participants[static_cast<std::size_t>(i)]->step(turn->now(), spec);
    if (any_stopped(places)) return;  // the destructor gives the baton on
    turn = turn->next_turn(spec, places);
  }
}

bool VirtualClock::any_stopped(std::span<VirtualClock* const> places) noexcept {
  return std::any_of(places.begin(), places.end(), [](const auto* p) { return p->stopped(); });
}

VirtualClock* VirtualClock::with_baton(std::span<VirtualClock* const> places) noexcept {
  ClockBlock& block = places.front()->block_;
  for (VirtualClock* place : places) {
    if (block.baton != place->me_) continue;
    for (const VirtualClock* p : places)
      if (block.pacer == p->me_) block.pacer = ClockBlock::kNobody;
    return place;
  }
  return nullptr;
}

VirtualClock* VirtualClock::wait_in(std::span<VirtualClock* const> places) {
  VirtualClock& first = *places.front();
  ClockBlock& block = first.block_;
  const auto paces = [&] {
    return std::any_of(places.begin(), places.end(),
                       [&](const auto* p) { return block.pacer == p->me_; });
  };
  std::vector<pollfd>& fds = first.polled_;
  const Nanos since = monotonic_now();
  bool named = false;
  char baton = 0;
  for (;;) {
    if (any_stopped(places)) return nullptr;  // the destructor gives the baton on if it came
    int timeout_ms = kLivenessMs;
    {
      const Lock lock(block);
      // It is back already, or whoever was to be told of it was gone.
      if (VirtualClock* const turn = with_baton(places); turn != nullptr) {
        while (recv(turn->socket_, &baton, 1, MSG_DONTWAIT) == 1) {
        }
        return turn;
      }
      Nanos left = 0;
      if (paces()) {
        const Nanos next = first.next_wake();
        timeout_ms = next != kForever && first.must_pace(next, left)
                         ? static_cast<int>(std::min<Nanos>(left / kMillisecond + 1, kLivenessMs))
                         : 0;
      }
    }
    fds.clear();
    for (const VirtualClock* place : places) {
      fds.push_back({place->socket_, POLLIN, 0});
      fds.push_back({place->stop_fd_, POLLIN, 0});
      for (const int fd : place->fds_) fds.push_back({fd, POLLIN, 0});
    }
    const int ready = poll(fds.data(), fds.size(), timeout_ms);
    bool told = false;
    auto at = fds.begin();
    for (VirtualClock* place : places) {
      // One is enough: another one, told late, only wakes once more.
      if (at->revents != 0) told = recv(place->socket_, &baton, 1, MSG_DONTWAIT) == 1 || told;
      at += 2 + static_cast<std::ptrdiff_t>(place->fds_.size());
    }
    if (told) {
      const Lock lock(block);
      if (VirtualClock* const turn = with_baton(places); turn != nullptr) return turn;
      continue;
    }
    if (any_stopped(places)) return nullptr;
    Handed to;
    {
      const Lock lock(block);
      at = fds.begin();
      for (VirtualClock* place : places) {
        at += 2;
        bool any = false;
        for (std::size_t i = 0; i < place->fds_.size(); ++i, ++at) any = any || at->revents != 0;
        if (!any) continue;
        block.slot[place->me_].outside_ready = true;
        place->fds_.clear();  // the baton is all that is missing now
      }
      for (const VirtualClock* place : places)
        if (block.pacer == place->me_) block.pacer = ClockBlock::kNobody;
      if (ready == 0) {
        first.drop_dead();
        first.drop_baton_of_foreign();
      }
      if (block.baton == ClockBlock::kNobody) to = first.dispatch();
      if (VirtualClock* const turn = with_baton(places); turn != nullptr) return turn;
    }
    first.tell(to);
    if (named || monotonic_now() - since <= kNameHolderAfter) continue;
    const Lock lock(block);
    const ClockSlot* holder = first.stalled_by();
    if (holder != nullptr && first.speaks()) {
      named = true;
      std::fprintf(stderr, "kerf: virtual time has stood still for 5 s: '%s' (process %lld) %s\n",
                   holder->name.c_str(), static_cast<long long>(holder->pid),
                   holder->state == ClockSlot::State::running ? "is running"
                                                              : "waits for something outside");
    }
  }
}

void VirtualClock::stop() noexcept {
  stop_.request();
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(stop_fd_, &one, sizeof one);
}

}  // namespace kerf::rtapi
