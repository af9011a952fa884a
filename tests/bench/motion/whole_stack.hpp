// The whole stack: programs as files through interpreter, task, planner and servo cycle, in virtual time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace kerf::bench {

/// What a program needed.
struct StackResult {
  double processor_s{0};  ///< of everything that runs
  double seconds{0};      ///< of virtual time
  double slowest{0};      ///< share of its feed, between the first and the last cycle at its feed
  std::string error;      ///< empty: none
};

/// The HAL function motion-controller from its first instruction to its last, with pins, status and flight record.
struct ServoCost {
  double mean_us{0}, p50_us{0}, p99_us{0};
  std::size_t cycles{0};
  std::string error;  ///< empty: none
};

struct StackProgram {
  std::string text;
  std::size_t lines{0};
  double feed_mm_s{0};
};

/// Lines of 0.05 to 0.2 mm over a smooth surface.
[[nodiscard]] StackProgram freeform_lines(int lines, bool merges, std::uint64_t seed);
/// Lines of 0.02 mm around circles at 100 mm/s: 5000 a second.
[[nodiscard]] StackProgram dense_lines(int lines, bool merges);

/// In this process, in one thread. `jerk` [mm/s3] 0: limited in acceleration only.
[[nodiscard]] StackResult run_in_harness(const StackProgram& program, double jerk);
/// Of each cycle of the program, or of 20 s of standing when it has no lines. Between cycles all else that a machine has runs in the same thread;
/// `sweeps`: other data stands in the caches besides, as after a pause in which other programs ran.
[[nodiscard]] ServoCost servo_function(const StackProgram& program, double jerk, bool sweeps);
/// With the true processes; start-up taken off.
[[nodiscard]] StackResult run_in_processes(const StackProgram& program, double jerk);

}  // namespace kerf::bench
