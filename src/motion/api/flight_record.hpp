// The flight record: what went into motion in the last minute and what came out, so that it can be run again.
//
// Motion writes it, always, into a block of the segment: the servo cycle into one ring, the planner into another, each without waiting for
// anybody. The launcher copies it into a file when a fault is raised or a process dies (launcher/flight_file.hpp), and motion-replay feeds the
// same to a controller and a planner of its own. What is recorded is complete from a standstill on: inputs, orders and intents of
// every cycle, limits, path items, and the state of the controller at each standstill. Positions are kept as a check sum of each cycle,
// and in clear every kStatusEvery cycles for people.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "motion/api/config.hpp"
#include "motion/api/path_items.hpp"
#include "motion/api/status.hpp"
#include "rtapi/base/fixed_string.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/overwrite_ring.hpp"
#include "rtapi/sync/word_part.hpp"

namespace kerf::motion {

/// Kinds of records. The number of each is its servo cycle.
enum class FlightKind : std::uint16_t {
  cycle =
      1,  ///< changed words of what the cycle read; extra: check sum of the joints' positions that it gave
  intent = 2,  ///< changed words of Intent, before the cycle of that number
  config = 3,  ///< ConfigRecord, before the cycle of that number
  rest = 4,    ///< a standstill behind the cycle of that number: all that a replay begins with
  status = 5,  ///< StatusRecord
  fault = 6,   ///< FaultRecord
  modal = 7,   ///< planner: what holds for the items behind it
  item =
      8,  ///< planner: a PathItem as it was taken, behind the cycle of that number; extra: the turn
  turn = 9,   ///< planner: TurnRecord; the items that it took then follow
  pins = 10,  ///< changed words of PinValues; extra 1: all of them
};

/// For people.
struct StatusRecord {
  std::int64_t time_ns{0};
  std::int32_t line{0};
  MotionKind kind{MotionKind::none};
  PathWait waiting_for{PathWait::none};
  MotionMode mode{MotionMode::free};
  std::int32_t enabled{0}, held{0};
  double vel_mm_s{0}, feed_override{1};
  double spindle_rpm{0};  ///< of spindle 0
  double joint[kMaxJoints]{}, ferror[kMaxJoints]{};
};

/// A pin, parameter or signal that [KERF]RECORD_PIN names. The launcher fills in the table while motion runs, an entry at a time.
struct RecordedPin {
  rtapi::FixedString<63> name;
  std::uint32_t type{0};         ///< hal::Type
  std::uint32_t every_cycle{0};  ///< looked at in each cycle; else with the status
  std::uint64_t link{0};         ///< place of its link slot in the segment
};
inline constexpr std::size_t kMaxRecordedPins = 16;
struct PinValues {
  std::uint64_t raw[kMaxRecordedPins]{};
};

/// The head of the block; the rings of the servo cycle and of the planner follow.
struct FlightRecord {
  static constexpr std::uint64_t kStatusEvery = 10;
  /// All pins are written anew, since older records give way.
  static constexpr std::uint64_t kPinsEvery = 1000;
  /// 8 MiB hold a minute of six joints that move all the time at 1 kHz, and 4 MiB some 5000 path items and the turns of the planner.
  static constexpr std::size_t kServoWords = std::size_t{1} << 20U;
  /// A small [KERF]SEGMENT_MB gets rings of a half, a quarter or an eighth.
  static constexpr std::size_t kLeastServoWords = kServoWords / 8;

  std::int64_t period_ns{0};
  std::int32_t joints{0}, spindles{0}, digital{0}, analog{0}, extra_joints{0}, reserved{0};
  std::uint64_t state_abi{0};  ///< of what only motion knows: motmod/flight_recorder.hpp
  std::uint64_t servo_words{0};
  rtapi::Word<std::uint32_t> pin_count{0};  ///< entries of `pin` that are filled in
  RecordedPin pin[kMaxRecordedPins];

  static constexpr std::size_t path_words(std::size_t servo_words) noexcept {
    return servo_words / 2;
  }
  static constexpr std::size_t head_bytes() noexcept {
    return (sizeof(FlightRecord) + 63) / 64 * 64;
  }
  static constexpr std::size_t bytes(std::size_t servo_words) noexcept {
    return head_bytes() + rtapi::OverwriteRing::bytes(servo_words) +
           rtapi::OverwriteRing::bytes(path_words(servo_words));
  }
  /// Handles for rings of so many words; who reads takes servo_words, once.
  [[nodiscard]] rtapi::OverwriteRing servo(std::size_t words) noexcept {
    return {reinterpret_cast<std::byte*>(this) + head_bytes(), words};
  }
  [[nodiscard]] rtapi::OverwriteRing path(std::size_t words) noexcept {
    return {reinterpret_cast<std::byte*>(this) + head_bytes() + rtapi::OverwriteRing::bytes(words),
            path_words(words)};
  }
};

inline constexpr const char* kFlightBlock = "flight-record";
inline constexpr std::uint64_t kFlightAbi =
    PathItems::abi_hash() ^
    (sizeof(FlightRecord) + sizeof(StatusRecord) + sizeof(Intent) * 3 + sizeof(MachineConfig) * 5) *
        0x9e3779b97f4a7c15ULL;

/// Faults after which the record is kept; the others are answers to an operator or a program.
[[nodiscard]] constexpr bool is_kept(Fault fault) noexcept {
  switch (fault) {
    case Fault::internal:
    case Fault::joint_hard_limit_min:
    case Fault::joint_hard_limit_max:
    case Fault::following_error:
    case Fault::amp_fault:
    case Fault::enable_lost:
    case Fault::heartbeat_lost:
    case Fault::home_failed:
    case Fault::no_inverse:
    case Fault::limit_velocity:
    case Fault::limit_acceleration:
    case Fault::limit_jerk:
    case Fault::limit_continuity:
    case Fault::probe_unexpected:
    case Fault::orient_fault:
    case Fault::spindle_fault:
    case Fault::sync_no_index:
    case Fault::sync_behind:
    case Fault::path_starved_internal:
    case Fault::overrun: return true;
    default: return false;
  }
}

/// A trivially copyable T as words, and which of them changed: (index, value) pairs, four indices to a word before the values.
template <class T>
class WordImage {
 public:
  static_assert(sizeof(T) % 8 == 0);
  static constexpr std::size_t kWords = sizeof(T) / 8;
  /// Room for changes(): all of them.
  static constexpr std::size_t kRoom = kWords + (kWords + 3) / 4 + 1;
  static_assert(kWords < 0xffff);

  /// Words of `out` used; 0: nothing changed. The image is `value` then.
  std::size_t changes(const T& value, std::uint64_t* out) noexcept {
    const rtapi::WordPart all{0, kWords};
    return changes(value, out, {&all, 1});
  }
  /// The same where only these words may have changed.
  std::size_t changes(const T& value, std::uint64_t* out,
                      std::span<const rtapi::WordPart> parts) noexcept {
    const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
    std::size_t n = 0;
    std::uint16_t index[kWords + 3];
    for (const rtapi::WordPart part : parts) {
      std::size_t i = part.first;
      // Most blocks are as they were, which is seen of all their words at once.
      for (; i + kBlock <= part.end; i += kBlock) {
        std::uint64_t now[kBlock];
        std::memcpy(now, bytes + i * 8, sizeof now);
        std::uint64_t differs = 0;
        for (std::size_t k = 0; k < kBlock; ++k) differs |= now[k] ^ words_[i + k];
        if (differs == 0) continue;
        for (std::size_t k = 0; k < kBlock; ++k) n = note(i + k, bytes, index, n);
      }
      for (; i < part.end; ++i) n = note(i, bytes, index, n);
    }
    if (n == 0) return 0;
    const std::size_t lists = (n + 3) / 4;
    out[0] = n;
    for (std::size_t i = n; i < 4 * lists; ++i) index[i] = 0;
    std::memcpy(out + 1, index, 8 * lists);
    for (std::size_t i = 0; i < n; ++i) out[1 + lists + i] = words_[index[i]];
    return 1 + lists + n;
  }
  /// The other way. False: these words are not of changes().
  bool apply(const std::uint64_t* in, std::size_t words) noexcept {
    if (words == 0) return true;
    const std::uint64_t n = in[0];
    if (n > kWords || words != 1 + (n + 3) / 4 + n) return false;
    const std::uint64_t lists = (n + 3) / 4;
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::uint64_t at = in[1 + i / 4] >> (16 * (i % 4)) & 0xffff;
      if (at >= kWords) return false;
      words_[at] = in[1 + lists + i];
    }
    return true;
  }
  void set(const T& value) noexcept { std::memcpy(words_, &value, sizeof(T)); }
  void get(T& value) const noexcept { std::memcpy(static_cast<void*>(&value), words_, sizeof(T)); }
  [[nodiscard]] const std::uint64_t* words() const noexcept { return words_; }

 private:
  static_assert(std::endian::native == std::endian::little,
                "four indices are a word as they stand");
  static constexpr std::size_t kBlock = 8;
  std::size_t note(std::size_t i, const std::byte* bytes, std::uint16_t* index,
                   std::size_t n) noexcept {
    std::uint64_t now = 0;
    std::memcpy(&now, bytes + i * 8, 8);
    // Without a branch: which words of a block change is not foreseen.
    index[n] = static_cast<std::uint16_t>(i);
    n += now != words_[i] ? 1U : 0U;
    words_[i] = now;
    return n;
  }

  std::uint64_t words_[kWords]{};
};

}  // namespace kerf::motion
