// ModalState: everything a block leaves behind for the next one, as one plain value.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "interp/canon.hpp"
#include "interp/canon_frame.hpp"
#include "interp/letters.hpp"

namespace kerf::interp {

inline constexpr int kMaxSpindles = 8;

enum class DistanceMode : std::uint8_t { absolute, incremental };  ///< G90/G91, G90.1/G91.1
enum class ProgramFeedMode : std::uint8_t {
  inverse_time,
  per_minute,
  per_revolution
};                                                         ///< G93, G94, G95
enum class RetractMode : std::uint8_t { old_z, r_plane };  ///< G98, G99

/// What canned cycles remember while the motion code stays the same: the sticky numbers, as written.
struct CycleState {
  double clear_mm{0};       ///< where the depth axis stood before the first cycle
  bool clear_known{false};  ///< false: a move without a motion mode (G5) came between
  double r{0}, bottom{0};   ///< increments while G91
  double p{0}, q{0}, i{0}, j{0}, k{0}, d{0};
  std::int32_t spindle{0};  ///< `$`
  LetterMask known{0};      ///< letters given so far; z for the depth axis
};

/// Where the last G5 ended, for the direction of a G5 without I and J.
struct SplineEnd {
  Pose position;
  double p_mm{0}, q_mm{0};
  bool known{false};
};

/// Plain copyable; task attaches a copy to each queued item and gives it back to Interpreter::restore() after an abort.
/// Lengths in mm, angles in degrees, feeds in mm/min (degrees/min), speeds in rpm, whatever G20/G21 says.
/// G-codes are stored times ten (G38.2 = 382), as clients of the status channel know them.
/// A length in units of `unit_mm`. A word in inches went to mm and comes back: where it was a decimal it is that again, so that
/// halves round as they do for the word.
[[nodiscard]] inline double in_units(double mm, double unit_mm) noexcept {
  if (unit_mm == 1) return mm;
  const double back = mm / unit_mm;
  const double decimal = std::nearbyint(back * 1e6) / 1e6;
  return std::fabs(decimal - back) <= 4e-16 * std::fabs(back) ? decimal : back;
}

struct ModalState {
  Pose position;                  ///< end of the last move, program coordinates
  CanonFrame frame;               ///< active work offset, rotation, G92 offset, tool offset
  std::int32_t line{0};           ///< line of the block that made this state
  std::int32_t motion{800};       ///< group 1: 0 10 20 30 ... 890; 800 = none; -1: after G5.3
  std::int32_t plane_code{170};   ///< 170 180 190; 171 181 191: G17.1 ...
  std::int32_t cutter_comp{400};  ///< 400, 410 left, 420 right; G41.1 and G42.1 too
  bool comp_own_tool{false};      ///< compensation has a D; else it is of the tool in the spindle
  std::int32_t comp_orientation{0};
  double comp_diameter_mm{0};
  std::int32_t tool_offset_code{490};  ///< 430 431 432 490
  std::int32_t last_stop{-1};          ///< 0 1 2 30 60, -1: none
  std::int32_t tool_change{-1};        ///< 6 or 61 after a tool change, -1: none
  std::int32_t coord_system{1};        ///< 1 = G54 ... 9 = G59.3
  std::int32_t selected_tool{-1};      ///< last T, -1 none since the last change
  std::int32_t selected_pocket{-1};
  std::int32_t speed_spindle{0};  ///< spindle of the last S word and of G95, G96
  std::int32_t feed_spindle{0};
  double feed{0};          ///< last F in mm/min; G95: mm/rev; G93: 1/min. For moves of XYZ or UVW
  double feed_word{0};     ///< the same as written: degrees/min for moves of ABC only
  double tolerance_mm{0};  ///< G64 P
  double naivecam_tolerance_mm{0};
  std::array<double, kMaxSpindles> speed_rpm{};
  std::array<double, kMaxSpindles> css_max_rpm{};  ///< > 0: G96 with D
  std::array<SpindleDirection, kMaxSpindles> direction{};
  std::array<bool, kMaxSpindles> css{};  ///< G96
  std::array<bool, kMaxSpindles> speed_override{true, true, true, true, true, true, true, true};
  std::array<bool, kMaxSpindles> orienting{};  ///< M19 is the active code of group 7
  CycleState cycle;
  SplineEnd spline;
  std::int32_t nurbs_points{0};  ///< control points of the G5.2 block in progress
  std::int32_t nurbs_order{3};   ///< its L
  Units units{Units::mm};
  DistanceMode distance{DistanceMode::absolute};
  DistanceMode arc_distance{DistanceMode::incremental};
  ProgramFeedMode feed_mode{ProgramFeedMode::per_minute};
  RetractMode retract{RetractMode::r_plane};
  PathMode path{PathMode::continuous};
  bool lathe_diameter{false};  ///< G7
  bool g92_applied{false};
  bool mist{false}, flood{false};
  bool feed_override{true}, adaptive_feed{false}, feed_hold{true};
  bool percent_file{false};  ///< the program began with %

  [[nodiscard]] Plane plane() const noexcept {
    switch (plane_code) {
      case 180: return Plane::xz;
      case 190: return Plane::yz;
      case 171: return Plane::uv;
      case 181: return Plane::uw;
      case 191: return Plane::vw;
      default: return Plane::xy;
    }
  }
  /// mm per program unit.
  [[nodiscard]] double unit_mm() const noexcept { return units == Units::inch ? 25.4 : 1.0; }

  /// As `stat.gcodes` of the Python module: [0] line, then codes times ten in the order
  /// motion, non-modal (-1), plane, cutter compensation, units, distance, feed mode, coordinate system, tool offset,
  /// retract, path control, -1, spindle mode (G96/G97), arc distance, lathe diameter (G7/G8), G92 applied (923) or not (922).
  [[nodiscard]] std::array<std::int32_t, 17> active_g_codes() const noexcept;
  /// As `stat.mcodes`: [0] line, then stopping, spindle, tool change, mist, flood, overrides, adaptive feed, feed hold, 0; -1: none.
  [[nodiscard]] std::array<std::int32_t, 10> active_m_codes() const noexcept;
  /// As `stat.settings`: line, F, S, tolerance, naive-cam tolerance; F and tolerances in program units.
  [[nodiscard]] std::array<double, 5> settings() const noexcept;
};

}  // namespace kerf::interp
