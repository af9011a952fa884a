// Canon: what a G-code program asks of the machine, one call per canonical function.
//
// The interpreter calls a Canon while it executes blocks; task turns the calls into motion, `rs274` prints them,
// tests record them. A Canon is passive: it may queue, it must not wait and must not call the interpreter back
// except for `Interpreter::modal()`, which already shows the state after the block being delivered. Cutter compensation
// delivers a block, or the rest of one, while a later one is executed.
//
// Units everywhere in this file: mm for x y z u v w, degrees for a b c, seconds, rpm, feed per minute.
// Exception: in feed-per-revolution mode (G95) feeds are mm (degrees) per revolution.
//
// Positions of motion calls are *program coordinates*: what the program says after G20/G21, G90/G91 and cutter
// compensation, before work offset, rotation, G92 and tool offset. Machine coordinates follow from the offsets that
// the set_* calls announced before:
//
//     machine = R(xy_rotation) * (program + g92) + g5x + tool_offset
//
// where R turns x and y about Z, counter-clockwise positive. `CanonFrame` (canon_frame.hpp) tracks the offsets and
// converts both ways; use it and nothing else. Manual: "Coordinate Systems", "G-code Overview".
//
// A block is checked whole before its first call: a block in error makes no call at all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "rtapi/base/pose.hpp"

namespace kerf::interp {

using rtapi::Pose;

/// Where a block came from. `file` and `text` are valid only during the call.
struct SourceLine {
  std::uint32_t file_id{
      0};  ///< index of the file in this interpreter (Interpreter::file_name(id)); 0 is MDI
  std::int32_t line{0};        ///< counts from 1
  std::int32_t sequence{-1};   ///< N word, -1 without
  std::int32_t call_level{0};  ///< 0 in the main program
  std::int32_t main_line{0};   ///< the same line, or that of the main program whose call led to it
  std::string_view file;       ///< path as opened, "" for MDI
  std::string_view text;       ///< the line as written, without the line end
  /// Digits of the N word, as written, of the block that lets these calls go. With cutter compensation that is a later one.
  std::optional<std::string_view> label{};
};

/// G17, G18, G19 with normals +Z, +Y, +X; G17.1, G18.1, G19.1, in which only canned cycles work.
enum class Plane : std::uint8_t { xy, xz, yz, uv, uw, vw };
enum class Units : std::uint8_t { inch, mm };                               ///< G20, G21
enum class PathMode : std::uint8_t { exact_path, exact_stop, continuous };  ///< G61, G61.1, G64
enum class FeedMode : std::uint8_t {
  per_minute,
  per_revolution
};  ///< G93 arrives as per_minute, one feed per move
enum class SpindleDirection : std::uint8_t { stopped, clockwise, counterclockwise };
enum class ProbeKind : std::uint8_t {
  toward_error,  ///< G38.2: stop on contact, error without
  toward,        ///< G38.3
  away_error,    ///< G38.4: stop on loss of contact, error without
  away,          ///< G38.5
};
enum class WaitMode : std::uint8_t { immediate, rise, fall, high, low };  ///< L0-L4 of M66

/// A circular or helical move. The centre's component along the plane's normal is meaningless (0).
struct Arc {
  Pose
      end;  ///< program coordinates; all nine axes move linearly with the angle besides the two in the plane
  std::array<double, 3> center{};  ///< x y z, program coordinates
  Plane plane{Plane::xy};
  std::int32_t turns{
      1};  ///< > 0 counter-clockwise seen against the normal, < 0 clockwise; |turns| = number of started
  ///< turns: 1 is an arc of at most one full circle; start equal to end in the plane is a full circle
};

/// A control point of a spline, program coordinates, and its weight (greater than 0).
struct SplinePoint {
  double x{0}, y{0}, weight{1};
};

/// One row of the tool table. Number 0 with pocket 0 is "no tool" on non-random changers.
struct Tool {
  std::int32_t number{-1};
  std::int32_t pocket{-1};
  Pose offset{};  ///< length offsets, added by G43
  double diameter_mm{0};
  double front_angle_deg{0};
  double back_angle_deg{0};
  std::int32_t orientation{0};  ///< lathe, 0-9
};

/// The canonical functions. Every call of one block follows one `next_block`.
class Canon {
 public:
  virtual ~Canon() = default;

  /// The calls up to the next next_block come from this line. Called for each block that makes any call, and again
  /// for calls of it that had to wait.
  virtual void next_block(const SourceLine& source) = 0;

  // --- frame and units ---
  /// G20, G21. Says how the program is written; values of calls stay in mm.
  virtual void use_length_units(Units units) = 0;
  /// G17-G19. Arcs name their plane themselves.
  virtual void select_plane(Plane plane) = 0;
  /// Work offset. `system`: 1 = G54 ... 9 = G59.3.
  virtual void set_g5x_offset(int system, const Pose& offset) = 0;
  /// G92 and G52 offset, applied before rotation; zero when switched off.
  virtual void set_g92_offset(const Pose& offset) = 0;
  /// Rotation of the work coordinate system about Z (G10 L2 R), degrees, counter-clockwise.
  virtual void set_xy_rotation(double degrees) = 0;
  /// G43, G43.1, G43.2, G49: the whole tool offset, not an increment.
  virtual void use_tool_length_offset(const Pose& offset) = 0;

  // --- feed and path control ---
  /// Feed for following feed moves. `linear` is for moves of XYZ (else UVW), `angular` for moves of ABC only.
  /// Per minute or per revolution after set_feed_mode. G93: one call before each move, already mm/min of that move.
  virtual void set_feed_rate(double linear_mm_min, double angular_deg_min) = 0;
  /// G93 (announced as per_minute), G94, G95; `spindle` carries the revolutions of G95.
  virtual void set_feed_mode(int spindle, FeedMode mode) = 0;
  /// Feeds are measured at the tool tip in XYZ. Once at start.
  virtual void set_feed_reference() = 0;
  /// G61, G61.1, G64 P: `tolerance_mm` 0 = as far as the machine blends at most.
  virtual void set_motion_control_mode(PathMode mode, double tolerance_mm) = 0;
  /// G64 Q: lines within this distance of their chord may be merged; 0 = off.
  virtual void set_naivecam_tolerance(double tolerance_mm) = 0;
  /// G64 R: `type` is the planner to use ([TRAJ]SMOOTH_PLANNER, 0 with R0), `corner_factor` the R word.
  virtual void set_planner_mode(int type, double corner_factor) = 0;
  /// G33, G33.1, G76: moves follow the spindle until stopped. `velocity_mode` true = G95 (no index wait).
  virtual void start_speed_feed_sync(int spindle, double mm_per_revolution, bool velocity_mode) = 0;
  virtual void stop_speed_feed_sync() = 0;

  // --- motion, program coordinates ---
  virtual void straight_traverse(const Pose& end) = 0;
  virtual void straight_feed(const Pose& end) = 0;
  virtual void arc_feed(const Arc& arc) = 0;
  /// G5, G5.1 and G5.2-G5.3: in x and y along the NURBS of `order` (degree + 1) of these points, the other axes stand.
  /// Its knots are `order` times 0, then 1, 2, ..., then `order` times n - order + 1 for n points, so it begins at the
  /// first point, where the machine stands, and ends at the last. `NurbsCurve` (nurbs.hpp) computes it.
  virtual void nurbs_feed(std::span<const SplinePoint> points, int order) = 0;
  /// G38.x. The interpreter then needs synchronize() with the probe result.
  virtual void straight_probe(const Pose& end, ProbeKind kind) = 0;
  /// Before and after a probe move.
  virtual void turn_probe_on() = 0;
  virtual void turn_probe_off() = 0;
  /// G33.1.
  virtual void rigid_tap(const Pose& end, double return_scale) = 0;
  /// G4, and the dwells of cycles.
  virtual void dwell(double seconds) = 0;

  // --- spindle ---
  /// S word; never negative. rpm; in G96 mm/min of surface. The spindle turns only after start_spindle.
  virtual void set_spindle_speed(int spindle, double speed) = 0;
  /// G96: `css_max_rpm` > 0 is the limit D (1e30 without D) and speeds are mm/min of surface; G97: 0.
  virtual void set_spindle_mode(int spindle, double css_max_rpm) = 0;
  virtual void start_spindle(int spindle, SpindleDirection direction) = 0;
  virtual void stop_spindle(int spindle) = 0;
  /// M19. `mode`: 0 shortest way, 1 clockwise, 2 counter-clockwise; G87 gives 2 and 3 as LinuxCNC does. ORIENT_OFFSET is already added.
  virtual void orient_spindle(int spindle, double angle_deg, int mode) = 0;
  /// M19 Q: following calls wait for spindle.N.is-oriented at most this long, else error.
  virtual void wait_orient_complete(int spindle, double timeout_s) = 0;

  // --- tools ---
  /// T word: prepare. 0 is "no tool" on non-random changers.
  virtual void select_tool(int number) = 0;
  /// M6 begins: the changer may move axes. Not printed by the newest rs274.
  virtual void start_change() = 0;
  /// M6: put the selected tool into the spindle. The interpreter then needs synchronize() with the tool in the spindle.
  virtual void change_tool() = 0;
  /// M61 Q: the tool in the spindle has this number; nothing moves.
  virtual void change_tool_number(int number) = 0;
  /// G10 L1, L10, L11: a row of the tool table is changed and to be saved.
  virtual void set_tool_table_entry(const Tool& tool) = 0;
  /// The tool table changed as a whole; read it again.
  virtual void reload_tooldata() = 0;

  // --- coolant, inputs, outputs ---
  virtual void set_mist(bool on) = 0;
  virtual void set_flood(bool on) = 0;
  /// M62, M63: with the start of the next motion.
  virtual void set_motion_output_bit(int index, bool on) = 0;
  /// M67.
  virtual void set_motion_output_value(int index, double value) = 0;
  /// M64, M65: as soon as motion receives it; breaks blending.
  virtual void set_aux_output_bit(int index, bool on) = 0;
  /// M68.
  virtual void set_aux_output_value(int index, double value) = 0;
  /// M66. The interpreter then needs synchronize() with the input's value (0/1 or analog; -1 = time out).
  virtual void wait_input(int index, bool analog, WaitMode mode, double timeout_s) = 0;

  // --- overrides (M48-M53) ---
  virtual void enable_feed_override(bool on) = 0;
  virtual void enable_speed_override(int spindle, bool on) = 0;
  virtual void enable_adaptive_feed(bool on) = 0;
  virtual void enable_feed_hold(bool on) = 0;

  // --- program flow ---
  /// M0.
  virtual void program_stop() = 0;
  /// M1: whether it stops is the operator's switch, decided when it is reached.
  virtual void optional_program_stop() = 0;
  /// M60 and M30.
  virtual void pallet_shuttle() = 0;
  /// M2, M30.
  virtual void program_end() = 0;
  /// The closing % of a program without M2: modes stay, spindle and coolant too. For listings; needs no action.
  virtual void finish() {}
  /// M100-M199: run the user's program `path` (as Environment::find_user_mcode found it) with P and Q as text
  /// ("%f", "-1.000000" for a missing word). The interpreter then needs synchronize().
  virtual void user_mcode(int number, std::string_view path, double p, double q) = 0;

  // --- texts ---
  /// A comment of the program or an "interpreter: ..." remark. For listings only.
  virtual void comment(std::string_view text) = 0;
  /// (MSG, ...) and (DEBUG, ...): show to the operator.
  virtual void message(std::string_view text) = 0;
  /// (PRINT, ...): a line for standard output or the log.
  virtual void print(std::string_view text) = 0;
  /// (LOGOPEN, f), (LOGAPPEND, f), (LOG, text), (LOGCLOSE).
  virtual void log_open(std::string_view path, bool append) = 0;
  virtual void log(std::string_view text) = 0;
  virtual void log_close() = 0;
  /// (PROBEOPEN f): each probe that makes contact from here on adds a line with the nine numbers of #5061-#5069 to the file, which
  /// begins empty. Text listings have the comment instead.
  virtual void probe_log_open(std::string_view path) = 0;
  /// (PROBECLOSE)
  virtual void probe_log_close() = 0;
};

}  // namespace kerf::interp
