// FlightKeeper: copies the flight record of a running machine into a file when a fault was raised,
// an estop stopped a machine that did something, or a process has died.
#pragma once

#include <cstdint>
#include <future>
#include <string>
#include <vector>

#include "motion/api/shared.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::motion {
struct FlightRecord;
struct FlightFile;
}  // namespace kerf::motion

namespace kerf::task {
struct TaskShared;
}

namespace kerf::launcher {

class FlightKeeper {
 public:
  struct Options {
    std::string folder;      ///< made when it is needed
    int keep{20};            ///< files in it; the oldest are removed. 0: none are written
    std::string ini;         ///< said in the file
    std::string kinematics;  ///< loadrt words, likewise
    std::vector<std::string>
        pins;  ///< [KERF]RECORD_PIN: pins, parameters and signals that motion records, too
  };
  FlightKeeper(rtapi::Segment& segment, Options options);

  /// Looks for new faults; gives the file that was written, or "". What follows a fault for kAftermathLooks calls is in its file.
  /// A disk may be slow and nobody waits for it here: a later call tells of the file.
  [[nodiscard]] std::string look();
  /// Now, and waits for the disk; `why` becomes part of its name.
  [[nodiscard]] rtapi::Result<std::string> keep(const std::string& why, const std::string& text);
  /// Tells motion of the pins that exist by now; what is wrong with those that do not.
  [[nodiscard]] std::vector<std::string> choose_pins();
  /// From now on the machine is stopped by its own end: that estop is none to keep a record of.
  void closing();
  /// A fault that look() has seen and not written yet.
  [[nodiscard]] bool pending() const { return looks_left_ > 0; }
  /// The disk has not taken the last one yet, or nobody was told of it.
  [[nodiscard]] bool is_writing() const { return writing_.valid(); }

 private:
  bool attach();
  /// An estop that stopped something since the last look, also one that a client has reset since; "" or what it was, for the file.
  std::string new_estop();
  void look_for_estop();
  /// Copies the record, and writes it in a thread.
  std::future<rtapi::Result<std::string>> begin(const std::string& why, const std::string& text);
  /// All that a file says but for what stands in the rings.
  void describe(motion::FlightFile& file) const;

  static constexpr int kAftermathLooks = 2;
  rtapi::Segment& segment_;
  Options options_;
  motion::MotionShared* motion_{nullptr};
  motion::FlightRecord* record_{nullptr};
  std::uint64_t seen_{0};
  int looks_left_{0};
  bool closing_{false};
  std::string why_, text_;
  task::TaskShared* task_{nullptr};
  std::uint32_t estops_seen_{0};
  std::future<rtapi::Result<std::string>> writing_;  ///< its end is waited for
};

/// "flight-records" in the user's folder for what programs keep.
[[nodiscard]] std::string default_flight_folder();
/// `kerf record ...` and `kerf replay FILE`; gives the exit code.
int record_command(const std::vector<std::string>& words, const std::string& bin);

}  // namespace kerf::launcher
