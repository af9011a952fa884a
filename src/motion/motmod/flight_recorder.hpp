// FlightRecorder: writes the flight record (motion/api/flight_record.hpp), the servo cycle one half and the planner the other. @rt.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>

#include "motion/api/flight_record.hpp"
#include "motion/core/planner/planner.hpp"
#include "motion/core/rest_state.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/used_words.hpp"

namespace kerf::motion {

/// What the servo cycle reads, plain.
struct CycleInputs {
  Inputs in;
  std::uint64_t heartbeat{0};
  std::uint32_t abort_epoch{1}, enable_request{0};
  bool enable{false}, hold{false}, path_ring_empty{true};
  bool reserved[5]{};
};

/// New limits, and kinematics that are put in force with them.
struct ConfigRecord {
  MachineConfig config;
  bool all{false};  ///< Controller::configure(); else adopt()
  bool switches{false};
  bool reserved[2]{};
  std::int32_t kind{0};  ///< with `switches`
};

/// A standstill.
struct RestRecord {
  CycleInputs inputs;  ///< of its cycle
  Intent intent;
  Controller::Rest state;
  std::int64_t time_ns{0};
};

struct ModalRecord {
  Planner::Modal modal;
};

/// A turn of the planner.
struct TurnRecord {
  std::int64_t time_ns{0};
  std::uint64_t passes{0};       ///< PlanGate::passes() before the turn
  std::uint64_t abort_epoch{0};  ///< as the planner saw it
  std::uint64_t view_cycle{0};   ///< of the ServoView that it saw
};

namespace detail {
constexpr std::uint64_t flight_hash(std::initializer_list<std::size_t> values) noexcept {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const std::size_t v : values) h = (h ^ v) * 0x100000001b3ULL;
  return h;
}
}  // namespace detail
/// Raised by whoever gives something in a standstill's state another meaning and the same size.
inline constexpr std::size_t kFlightStateVersion = 1;
/// Layout of all that only motion knows. A record of another layout is refused by replay().
inline constexpr std::uint64_t kFlightStateAbi =
    detail::flight_hash({kFlightStateVersion,
                         sizeof(RestRecord),
                         sizeof(CycleInputs),
                         sizeof(ConfigRecord),
                         sizeof(ModalRecord),
                         sizeof(TurnRecord),
                         sizeof(Inputs),
                         sizeof(Controller::Rest),
                         sizeof(Executor::Rest),
                         sizeof(Joint),
                         sizeof(AxisMover),
                         sizeof(Guard),
                         sizeof(ExternalOffsets),
                         sizeof(OutputBank),
                         sizeof(Spindles),
                         sizeof(SpindleObserver),
                         sizeof(path::PathMode),
                         sizeof(FeedPerRev),
                         sizeof(ScrewTable),
                         offsetof(Controller::Rest, executor),
                         offsetof(Controller::Rest, guard),
                         offsetof(Controller::Rest, pose),
                         offsetof(Controller::Rest, heartbeat),
                         offsetof(Controller::Rest, seen)});

/// Bits of the commanded positions in 32.
[[nodiscard]] std::uint32_t check_sum(const Controller& controller) noexcept;

class FlightRecorder final : public Planner::Tap {
 public:
  /// `record`: of FlightRecord::bytes(servo_words) zero-filled bytes, or what another instance has written; null: records nothing.
  /// `segment`: where the recorded pins stand; null: there are none.
  void begin(FlightRecord* record, std::size_t servo_words, const rtapi::Segment* segment,
             std::int64_t period_ns, std::int32_t joints, std::int32_t spindles,
             std::int32_t extra_joints, std::int32_t digital, std::int32_t analog) noexcept;

  /// Pins of the first so many axes are read from now on; at the beginning of all.
  void use_axes(std::size_t count) noexcept;

  /// Servo thread, in this order in a cycle. Begins to fetch the room that cycle() writes to.
  void fetch() const noexcept { servo_.fetch(kUsualWords); }
  void config(const Controller& controller, const ConfigRecord& change) noexcept;
  /// `now`: what the cycle has read; the recorder adds `orders` to it. `intent_version`: another one than in the cycle before when
  /// *orders.values may have changed.
  void cycle(const Controller& controller, CycleInputs& now, const Orders& orders,
             std::uint64_t intent_version, std::int64_t now_ns) noexcept;
  /// Planner.
  void turn(std::int64_t now_ns, std::uint64_t passes, std::uint32_t abort_epoch,
            std::uint64_t view_cycle) noexcept override;
  void taken(const PathItem& item, const Planner::Modal& before, bool idle) noexcept override;

 private:
  void rest(const Controller& controller, std::int64_t now_ns) noexcept;
  void status(const MotionStatus& s) noexcept;
  void pins(std::uint64_t cycle) noexcept;

  FlightRecord* record_{nullptr};
  rtapi::OverwriteRing servo_, path_;
  const rtapi::Segment* segment_{nullptr};
  PinValues pin_values_;
  WordImage<PinValues> pin_image_;
  WordImage<CycleInputs> inputs_;
  WordImage<Intent> intent_;
  std::uint64_t intent_version_{~std::uint64_t{0}};  ///< of intent_; no cell has counted so far
  std::array<rtapi::WordPart, 6> inputs_parts_{};    ///< of what is read
  bool looks_at_all_{false};                      ///< in the next cycle: what is read has changed
  static constexpr std::size_t kUsualWords = 24;  ///< of a cycle's record
  static constexpr std::size_t kScratch =
      std::max({WordImage<Intent>::kRoom, WordImage<CycleInputs>::kRoom,
                WordImage<PinValues>::kRoom, sizeof(RestRecord) / 8, sizeof(ConfigRecord) / 8});
  std::uint64_t words_[kScratch];  ///< servo's
  std::uint64_t
      path_words_[std::max(sizeof(PathItem), sizeof(ModalRecord)) / 8 + 1];  ///< planner's
  RestRecord rest_record_;
  std::uint64_t last_rest_{0};
  bool at_rest_{false}, any_rest_{false};
  std::uint32_t turn_{0};             ///< of the planner: items that it took in one belong together
  rtapi::Word<std::uint64_t> cycle_;  ///< for the planner
};

static_assert(sizeof(RestRecord) / 8 <= FlightRecord::kLeastServoWords / 4);

}  // namespace kerf::motion
