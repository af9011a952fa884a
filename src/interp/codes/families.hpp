// The families of codes: each file lists its rows and defines their handlers.
#pragma once

#include <array>
#include <span>

#include "interp/core.hpp"
#include "interp/dialect.hpp"

namespace kerf::interp {

[[nodiscard]] std::span<const CodeRow> motion_codes();  ///< G0 G1 G4 G38.x G53 G80
[[nodiscard]] std::span<const CodeRow> arc_codes();     ///< G2 G3
[[nodiscard]] std::span<const CodeRow> cycle_codes();   ///< G73 G74 G81-G89
[[nodiscard]] std::span<const CodeRow> spline_codes();  ///< G5 G5.1 G5.2 G5.3
[[nodiscard]] std::span<const CodeRow>
mode_codes();  ///< planes, units, distance, feed mode, path, retract
[[nodiscard]] std::span<const CodeRow> offset_codes();   ///< G10 G28 G30 G52 G54-G59.3 G92
[[nodiscard]] std::span<const CodeRow> tool_codes();     ///< G43 G49 M6 M61
[[nodiscard]] std::span<const CodeRow> comp_codes();     ///< G40 G41 G42 G41.1 G42.1
[[nodiscard]] std::span<const CodeRow> spindle_codes();  ///< G96 G97 M3-M5 M19
[[nodiscard]] std::span<const CodeRow> thread_codes();   ///< G33 G33.1 G76
[[nodiscard]] std::span<const CodeRow> lathe_codes();    ///< G70 G71 G72
[[nodiscard]] std::span<const CodeRow> io_codes();       ///< M7-M9 M48-M53 M62-M68
[[nodiscard]] std::span<const CodeRow> program_codes();  ///< M0-M2 M30 M60 M100-M199
[[nodiscard]] std::span<const CodeRow> state_codes();    ///< M70-M73

/// True after core.fail(): the code must not be used with compensation on.
[[nodiscard]] bool refused_by_compensation(Core& c, const Block& b, char letter, int code);
/// M72: compensation as it was, with its D; without one, the radius is that of the tool in the spindle.
[[nodiscard]] bool restore_compensation(Core& c, const ModalState& was);
[[nodiscard]] bool stop_compensation(Core& c);
/// Centre of an arc in the ZX plane from its I and K (G90.1, G91.1) or R word; s is Z, h is X.
[[nodiscard]] bool arc_center_xz(Core& c, const Block& b, std::array<double, 2> from,
                                 std::array<double, 2> to, bool ccw, double& center_z,
                                 double& center_x);
/// Refuses a missing feed. `what`: "g1", "arc"; `zero_feed`: the message for F0.
[[nodiscard]] bool check_feed(Core& c, const Block& b, const char* what, const char* zero_feed);
/// In G93: the feed of this move, from its length in mm, else in degrees.
void inverse_time_feed(Core& c, const Block& b, double linear_mm, double angular_deg);
/// Length by which a feed counts: XYZ, else UVW in mm; only rotary axes: degrees.
void feed_length(const Pose& from, const Pose& to, double& linear_mm, double& angular_deg);
/// The one spindle that `$` names, 0 without. Error: no such spindle, or all of them; its text is of the other control.
[[nodiscard]] bool one_spindle(Core& c, const Block& b, const char* error, int& spindle);
/// mm/min of one unit of S in G96: S is written in m/min or feet/min.
[[nodiscard]] double surface_speed_mm(const Core& c);
/// Announces the S of a spindle.
void announce_speed(Core& c, int spindle);
/// A traverse of one locking indexer.
void index_traverse(Core& c, const Pose& end);
/// The calls that bring the path mode of the state back (after cycles).
void announce_path_mode(Core& c);
/// First and last spindle that `$` names (-1: all). Error: no such spindle.
[[nodiscard]] bool spindle_range(Core& c, const Block& b, int otherwise, const char* command,
                                 int& first, int& last);

/// M2 and M30 (`code`), and M99 where it ends the main program.
[[nodiscard]] bool end_program(Core& c, int code);
/// DISABLE_G92_PERSISTENCE at the end of a program.
void reset_g92_at_end(Core& c);

}  // namespace kerf::interp
