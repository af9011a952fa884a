// The virtual clock of real processes: a discrete-event scheduler in the instance's segment.
//
// One participant runs at a time, over all processes: the one that holds the baton. In wait() it states what it waits for and
// hands the baton to the first participant, in fixed order, whose wait is met at this instant; when there is none and nobody
// holds time, time moves to the earliest wake-up. A notified Cell is seen in that same decision, so a notify always comes
// before any later wait of the notifier. The state stands in the segment behind a robust mutex; the baton is a datagram.
// A participant whose process died is found by whoever waits (or by evict()) and removed.
#pragma once

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/clock/join_clock.hpp"

namespace kerf::rtapi {

class Segment;

/// One participant's place. All but what is said otherwise under ClockBlock::mutex.
struct ClockSlot {
  enum class State : std::uint32_t { free = 0, running = 1, waiting = 2 };
  State state{State::free};
  Role role{Role::user_component};
  std::uint32_t order{0};  ///< of registration
  std::int64_t pid{0};
  std::uint64_t pid_start{0};
  FixedString<31> name;
  Nanos until{0};
  bool holds_time{false};
  bool foreign{false};        ///< a program that does not know of the clock (libkerf_time.so)
  bool outside_ready{false};  ///< a descriptor became ready
  std::uint32_t cell_count{0};
  std::uint64_t cell[8]{};  ///< offsets in the segment
  std::uint64_t seen[8]{};
};

struct ClockBlock {
  static constexpr const char* kName = "clock";
  static constexpr std::int32_t kSlots = 64;
  static constexpr std::int32_t kNobody = -1;
  ClockMode mode{ClockMode::real};
  double speed{0};
  pthread_mutex_t mutex{};       ///< shared and robust; virtual clock only
  Word<std::int64_t> now_ns{0};  ///< read by anybody at any time
  std::int32_t baton{kNobody};   ///< slot that runs
  std::int32_t pacer{kNobody};   ///< slot that waits in real time before time moves on (speed > 0)
  std::uint32_t joined{0};
  Cell joins;                        ///< notified by each join and leave
  std::int64_t foreign_since_ns{0};  ///< real time at which a foreign slot got the baton
  std::int64_t paced_real_ns{0};     ///< real and virtual time of the last step of a paced clock
  std::int64_t paced_virtual_ns{0};
  ClockSlot slot[kSlots]{};
};

class VirtualClock final : public WaitClock {
 public:
  static Result<std::unique_ptr<VirtualClock>> join(Segment& segment, ClockBlock& block, Role role,
                                                    std::string_view name, bool foreign = false);
  /// The same without its first turn: that is for run().
  static Result<std::unique_ptr<VirtualClock>> take_place(Segment& segment, ClockBlock& block,
                                                          Role role, std::string_view name,
                                                          bool foreign = false);
  /// Steps participants of this thread, each in its place: what goes from one to the other is no change of threads. Until one of the clocks
  /// is stopped.
  static void run(std::span<VirtualClock* const> places,
                  std::span<Participant* const> participants);
  ~VirtualClock() override;
  VirtualClock(const VirtualClock&) = delete;
  VirtualClock& operator=(const VirtualClock&) = delete;

  [[nodiscard]] Nanos now() const noexcept override { return block_.now_ns.get(); }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
  /// Watched cells must stand in the segment: other processes decide on them.
  void wait(const WaitSpec& spec) override;
  void stop() noexcept override;
  [[nodiscard]] bool stopped() const noexcept override { return stop_.requested(); }

  /// True when a process of this process group takes part.
  static bool has_group(ClockBlock& block, std::int64_t group);
  /// Takes a dead process out at once (its parent knows first).
  static void evict(Segment& segment, std::int64_t pid);

 private:
  VirtualClock(Segment& segment, ClockBlock& block) : segment_(segment), block_(block) {}
  class Lock;
  Segment& segment_;
  ClockBlock& block_;
  std::int32_t me_{-1};
  pid_t owner_pid_{getpid()};
  int socket_{-1};
  int stop_fd_{-1};
  StopWord stop_;
  std::string instance_;
  StaticVector<int, 64> fds_;  ///< of this wait; none any more when one of them was ready
  std::vector<pollfd> polled_;

  [[nodiscard]] bool is_due(const ClockSlot& slot) const noexcept;
  /// Who has the baton now and does not know it yet; `order` tells it from a later participant in that place.
  struct Handed {
    std::int32_t slot{ClockBlock::kNobody};
    std::uint32_t order{0};
  };
  /// Gives the free baton away, moving time when nobody can run now. Under the lock; what it gives is to be told after it.
  [[nodiscard]] Handed dispatch();
  /// Not under the lock, which is the first that whoever is told takes: it would be woken only to wait for it.
  void tell(Handed to);
  /// Whose turn it is in this thread's places; else who is to be told that he has the baton.
  struct Begun {
    VirtualClock* turn{nullptr};
    Handed to;
  };
  /// Says what this place waits for, and gives the baton away.
  [[nodiscard]] Begun begin_wait(const WaitSpec& spec, std::span<VirtualClock* const> places);
  /// The same, and waits for the next turn of one of them; nullptr: one was stopped.
  VirtualClock* next_turn(const WaitSpec& spec, std::span<VirtualClock* const> places);
  [[nodiscard]] static bool any_stopped(std::span<VirtualClock* const> places) noexcept;
  /// Waits in these places of this thread: the one that has the baton, or nullptr when one was stopped.
  static VirtualClock* wait_in(std::span<VirtualClock* const> places);
  /// Under the lock.
  [[nodiscard]] static VirtualClock* with_baton(std::span<VirtualClock* const> places) noexcept;
  /// Gives the place back, and the baton away.
  [[nodiscard]] Handed leave();
  /// First in order among those that can run now, or kNobody; `held` tells whether somebody holds time.
  [[nodiscard]] std::int32_t first_due(bool& held) const noexcept;
  /// The participant that keeps time from moving, or null when time is free. Under the lock.
  [[nodiscard]] const ClockSlot* stalled_by() const noexcept;
  /// True for one of the participants that only wait for time: the one that complains for all.
  [[nodiscard]] bool speaks() const noexcept;
  /// Virtual time of the next wake-up, or kForever.
  [[nodiscard]] Nanos next_wake() const noexcept;
  /// True when a paced clock must let real time pass before time moves to `next`; this slot then sleeps for `left` ns.
  bool must_pace(Nanos next, Nanos& left) const noexcept;
  void hand_to(std::int32_t slot) noexcept;
  void drop_dead() noexcept;
  /// Takes the baton from a foreign program that keeps it: it blocks in a way that the shim does not see.
  void drop_baton_of_foreign() noexcept;
  [[nodiscard]] std::string address(std::int32_t slot) const;
};

}  // namespace kerf::rtapi
