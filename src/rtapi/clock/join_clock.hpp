// How real programs get their clock.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {

class Segment;

enum class ClockMode : std::uint8_t { real = 0, virtual_time = 1 };

/// Makes the clock block of a new segment; once, by the segment's maker. `speed` (virtual only): at most so many virtual seconds
/// a real one, for people at a screen; 0: as fast as the CPU allows.
Status make_clock(Segment& segment, ClockMode mode, double speed = 0);

/// real, when the segment has no clock block.
ClockMode clock_mode(const Segment& segment);

/// Once for each thread that runs a participant. On the virtual clock the call returns when it is this participant's turn to
/// run, and virtual time stands while it runs, so join late and wait soon.
///
/// `foreign`: the thread belongs to a program that does not know of the clock; when it keeps others waiting for a second, time goes
/// on without it until its next wait.
Result<std::unique_ptr<WaitClock>> join_clock(Segment& segment, Role role, std::string_view name,
                                              bool foreign = false);

/// Runs participants in the thread that joins: on the real clock one, on the virtual clock several too, each in a place of its own, in the order in
/// which they are given; what goes from one to the other is no change of threads then.
class SharedThread {
 public:
  /// Takes their places; bad_argument: several on the real clock.
  static Result<std::unique_ptr<SharedThread>> join(Segment& segment,
                                                    std::span<Participant* const> participants);
  virtual ~SharedThread() = default;
  /// Until stop(), which any thread may call.
  virtual void run() = 0;
  virtual void stop() noexcept = 0;
};

/// True when a process of this process group lives in the instance's virtual time. Whoever waits for such a process must not
/// hold time.
bool lives_in_virtual_time(const Segment& segment, std::int64_t process_group);
/// Notified each time somebody joins or leaves the virtual clock; nullptr on the real one.
const Cell* clock_joins(const Segment& segment);

/// A real clock without a segment.
std::unique_ptr<WaitClock> make_real_clock();

/// The virtual clock that libkerf_time.so, preloaded into this program, has joined or (`join`) joins for this thread; nullptr
/// where there is none. It belongs to the thread and lives as long.
WaitClock* shim_clock(bool join);

/// A reader of the instance's time that never waits (halcmd, tools).
std::unique_ptr<Clock> read_clock(Segment& segment);

}  // namespace kerf::rtapi
