// What task queues for motion, in program order: the items of the path ring.
//
// One struct an item, declared once: `fields()` feeds loggers, tools and docs. Items are trivially copyable and hold no
// pointers, since they cross processes. Lengths in mm, angles in degrees, speeds in mm/s (deg/s for moves of rotary axes
// only), all in machine coordinates.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::motion {

using rtapi::Pose;

/// Which block an item comes from. `id` grows by at least one a block and is never reused in an instance's life, so the
/// state that task keeps for it can be found again after a stop.
struct SourceTag {
  std::uint64_t id{0};
  std::int32_t line{0};  ///< 1-based line in its file; 0: none (MDI, jog)
  std::int32_t file{0};  ///< task's number of the file
  std::int32_t call_level{0};
  std::int32_t main_line{
      0};  ///< of the main program: the same line, or that of the call which led to it
};

/// The values of `motion.motion-type` and stat.motion_type.
enum class MotionKind : std::int32_t {
  none = 0,
  traverse = 1,
  feed = 2,
  arc = 3,
  tool_change = 4,
  probing = 5,
  index_rotary = 6
};

/// Straight move from where the path ends to `end`.
struct LinearMove {
  static constexpr const char* kName = "linear-move";
  Pose end;
  double vel_mm_s{
      0};  ///< programmed speed along the feed metric; traverse: 0 = as fast as limits allow
  MotionKind kind{MotionKind::feed};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &LinearMove::end, "mm|deg");
    v("vel", &LinearMove::vel_mm_s, "mm/s");
    v("kind", &LinearMove::kind, "");
  }
};

/// Circle or helix about `normal` through `centre`, from where the path ends to `end`; axes outside its plane move
/// linearly with the angle. If the end radius differs from the start radius, the radius is linear in the angle.
struct ArcMove {
  static constexpr const char* kName = "arc-move";
  Pose end;
  double centre[3]{};  ///< x y z, mm
  double normal[3]{};  ///< unit vector; turning is right-handed about it
  std::int32_t turns{
      1};  ///< full turns, at least 1: 1 = up to and including one full circle, 2 = one more ...
  MotionKind kind{MotionKind::arc};
  double vel_mm_s{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &ArcMove::end, "mm|deg");
    v("centre", &ArcMove::centre, "mm");
    v("normal", &ArcMove::normal, "");
    v("turns", &ArcMove::turns, "");
    v("kind", &ArcMove::kind, "");
    v("vel", &ArcMove::vel_mm_s, "mm/s");
  }
};

/// A piece of a curve (G5, G5.1, G5.2), from where the path ends to `end`: q(s) = q0 + first s + second s^2/2 + third s^3/6, s from 0 to `length`,
/// with the third that leads to `end`. s is the length of the curve: |q'| is 1 within a thousandth in XYZ. Pieces that agree in direction and
/// second derivative where they meet are driven as one curve.
struct CubicMove {
  static constexpr const char* kName = "cubic-move";
  Pose end;
  Pose first, second;  ///< derivatives by s at the begin
  double length{0};
  double vel_mm_s{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &CubicMove::end, "mm|deg");
    v("first", &CubicMove::first, "");
    v("second", &CubicMove::second, "1/mm");
    v("length", &CubicMove::length, "mm");
    v("vel", &CubicMove::vel_mm_s, "mm/s");
  }
};

/// G4: the path stands for this time.
struct Dwell {
  static constexpr const char* kName = "dwell";
  double seconds{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("seconds", &Dwell::seconds, "s");
  }
};

/// M62-M65 (digital), M67 M68 (analog). Synchronised changes act with the next move's first cycle and never without a
/// next move; immediate ones act in their place in the queue, at rest.
struct OutputChange {
  static constexpr const char* kName = "output-change";
  std::int32_t index{0};
  bool analog{false};
  bool synchronised{false};
  std::int16_t reserved{0};
  double value{0};  ///< digital: 0 or 1
  template <class V>
  static constexpr void fields(V&& v) {
    v("index", &OutputChange::index, "");
    v("analog", &OutputChange::analog, "");
    v("synchronised", &OutputChange::synchronised, "");
    v("value", &OutputChange::value, "");
  }
};

/// M3 M4 M5 S M19 for one spindle. Acts in its place in the queue, without a stop of the path; feed moves behind it wait
/// for `spindle.N.at-speed` (only while it turns).
struct SpindleChange {
  static constexpr const char* kName = "spindle-change";
  enum class Action : std::int32_t {
    set_speed = 0,
    forward = 1,
    reverse = 2,
    stop = 3,
    orient = 4
  };
  std::int32_t spindle{0};
  Action action{Action::set_speed};
  double speed_rpm{0};        ///< commanded speed, not negative (S word)
  double css_factor{0};       ///< G96: speed = min(css_max_rpm, css_factor / radius); 0 in G97
  double css_max_rpm{0};      ///< above 0 in G96
  double css_center_x_mm{0};  ///< machine X of the axis that it turns about, without tool offset
  double orient_angle_deg{0};
  double orient_timeout_s{0};  ///< Fault::orient_fault when it takes longer; 0: no limit (M19 Q)
  std::int32_t orient_mode{0};
  bool wait_at_speed{true};
  bool reserved[3]{};
  template <class V>
  static constexpr void fields(V&& v) {
    v("spindle", &SpindleChange::spindle, "");
    v("action", &SpindleChange::action, "");
    v("speed", &SpindleChange::speed_rpm, "rpm");
    v("css-factor", &SpindleChange::css_factor, "mm/min");
    v("css-max", &SpindleChange::css_max_rpm, "rpm");
    v("css-center-x", &SpindleChange::css_center_x_mm, "mm");
    v("orient-angle", &SpindleChange::orient_angle_deg, "deg");
    v("orient-timeout", &SpindleChange::orient_timeout_s, "s");
    v("orient-mode", &SpindleChange::orient_mode, "");
  }
};

/// G61, G61.1, G64 P Q for the moves behind it.
struct PathControl {
  static constexpr const char* kName = "path-control";
  enum class Mode : std::int32_t {
    exact_path = 1,
    exact_stop = 2,
    continuous = 3
  };  ///< the canonical modes
  Mode mode{Mode::continuous};
  std::int32_t reserved{0};
  double tolerance_mm{0};
  double naive_cam_tolerance_mm{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("mode", &PathControl::mode, "");
    v("tolerance", &PathControl::tolerance_mm, "mm");
    v("naive-cam-tolerance", &PathControl::naive_cam_tolerance_mm, "mm");
  }
};

/// M48-M53: which overrides count for the moves behind it.
struct OverrideEnable {
  static constexpr const char* kName = "override-enable";
  bool feed{true};
  bool adaptive{false};
  bool feed_hold{true};
  bool spindle[kMaxSpindles]{true, true, true, true, true, true, true, true};
  template <class V>
  static constexpr void fields(V&& v) {
    v("feed", &OverrideEnable::feed, "");
    v("adaptive", &OverrideEnable::adaptive, "");
    v("feed-hold", &OverrideEnable::feed_hold, "");
    v("spindle", &OverrideEnable::spindle, "");
  }
};

/// The tool offset in force, for `motion.tooloffset.*` and for taking it out of shown positions. Moves nothing.
struct ToolOffset {
  static constexpr const char* kName = "tool-offset";
  Pose offset;
  template <class V>
  static constexpr void fields(V&& v) {
    v("offset", &ToolOffset::offset, "mm|deg");
  }
};

/// G38: a straight move that ends at the first change of `motion.probe-input`.
struct ProbeMove {
  static constexpr const char* kName = "probe-move";
  Pose end;
  double vel_mm_s{0};
  bool until_open{false};    ///< G38.4 G38.5: away from contact
  bool fail_is_error{true};  ///< G38.2 G38.4
  bool reserved[6]{};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &ProbeMove::end, "mm|deg");
    v("vel", &ProbeMove::vel_mm_s, "mm/s");
    v("until-open", &ProbeMove::until_open, "");
    v("fail-is-error", &ProbeMove::fail_is_error, "");
  }
};

/// G33, G76: a straight move whose place follows the turns of a spindle. Moves that follow each other without anything but outputs
/// between them are one thread: only the first waits for at-speed and index, and the rest never lose step.
struct SyncMove {
  static constexpr const char* kName = "sync-move";
  Pose end;
  double per_rev_mm{0};  ///< way in one revolution, along the feed metric of the move
  std::int32_t spindle{0};
  std::int32_t reserved{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &SyncMove::end, "mm|deg");
    v("per-rev", &SyncMove::per_rev_mm, "mm");
    v("spindle", &SyncMove::spindle, "");
  }
};

/// G33.1: to `end` in step with the spindle, back in step with the reversed spindle, and to rest where it began.
struct TapMove {
  static constexpr const char* kName = "tap-move";
  Pose end;
  double per_rev_mm{0};
  double return_factor{1};  ///< on the spindle's speed on the way back
  std::int32_t spindle{0};
  std::int32_t reserved{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("end", &TapMove::end, "mm|deg");
    v("per-rev", &TapMove::per_rev_mm, "mm");
    v("return-factor", &TapMove::return_factor, "");
    v("spindle", &TapMove::spindle, "");
  }
};

/// G95, G94: how the speeds of the moves behind it are meant. In G95 `vel_mm_s` counts at the spindle speed `rps`; in proportion to
/// spindle.N.speed-in the machine is faster or slower.
struct FeedPerRev {
  static constexpr const char* kName = "feed-per-rev";
  std::int32_t spindle{-1};  ///< -1: none, speeds are as they are
  std::int32_t reserved{0};
  double rps{0};
  template <class V>
  static constexpr void fields(V&& v) {
    v("spindle", &FeedPerRev::spindle, "");
    v("rps", &FeedPerRev::rps, "rev/s");
  }
};

/// Nothing but its tag: task learns from the executed sequence number that all before it is done.
struct Marker {
  static constexpr const char* kName = "marker";
  std::uint64_t value{0};
  bool drop_outputs{
      false};  ///< end of program: synchronised outputs that no move came for are forgotten
  bool reserved[7]{};
  template <class V>
  static constexpr void fields(V&& v) {
    v("value", &Marker::value, "");
    v("drop-outputs", &Marker::drop_outputs, "");
  }
};

/// A closed list of message types: visits, checks and hashes them.
template <class... M>
struct MessageSet {
  static_assert((std::is_trivially_copyable_v<M> && ...), "messages are bytes");
  static_assert((std::is_standard_layout_v<M> && ...), "messages have one layout");
  using Variant = std::variant<M...>;
  static_assert(std::is_trivially_copyable_v<Variant>, "a variant of bytes is bytes");

  /// Changes whenever a name, a field or a size changes; stands in the block's header so that processes of different builds
  /// refuse each other.
  static constexpr std::uint64_t abi_hash() {
    std::uint64_t h = 0xcbf29ce484222325ULL;
    const auto mix = [&h](std::uint64_t byte) { h = (h ^ byte) * 0x100000001b3ULL; };
    const auto text = [&mix](const char* s) {
      for (; *s != '\0'; ++s) mix(static_cast<unsigned char>(*s));
      mix(0);
    };
    (
        [&] {
          text(M::kName);
          mix(sizeof(M));
          M::fields([&](const char* name, auto, const char* unit) {
            text(name);
            text(unit);
          });
        }(),
        ...);
    return h;
  }
};

using PathItems =
    MessageSet<LinearMove, ArcMove, Dwell, OutputChange, SpindleChange, PathControl, OverrideEnable,
               ToolOffset, ProbeMove, Marker, SyncMove, TapMove, FeedPerRev, CubicMove>;

/// One place of the path ring. `epoch`: the abort epoch in force when it was queued; consumers drop items of older epochs.
struct PathItem {
  std::uint32_t epoch{0};
  std::uint32_t apart{
      0};  ///< 1: task does something between the item before and this one (coolant, a message), so that G64 Q must not merge them
  std::uint64_t seq{
      0};  ///< 1, 2, 3 ... in queue order, never reused; MotionStatus::executed_seq counts up to it
  SourceTag tag;
  PathItems::Variant body{Marker{}};
};
static_assert(sizeof(PathItem) <= 512, "bounded items (ring size)");
static_assert(std::is_trivially_copyable_v<PathItem>);

/// Whether a thread (SyncMove after SyncMove) is over when this comes.
[[nodiscard]] inline bool ends_thread(const PathItems::Variant& body) noexcept {
  if (const auto* change = std::get_if<OutputChange>(&body)) return !change->synchronised;
  if (const auto* spindle = std::get_if<SpindleChange>(&body))
    return spindle->action != SpindleChange::Action::set_speed;
  return std::holds_alternative<LinearMove>(body) || std::holds_alternative<ArcMove>(body) ||
         std::holds_alternative<CubicMove>(body) || std::holds_alternative<Dwell>(body) ||
         std::holds_alternative<ProbeMove>(body) || std::holds_alternative<TapMove>(body);
}

/// Visitor helper: one lambda an alternative, no catch-all; a new item type does not compile until it is handled.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace kerf::motion
