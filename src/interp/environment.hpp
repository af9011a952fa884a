// Environment: what an interpreter asks of the world, and Settings: what the INI says once.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interp/canon.hpp"
#include "interp/remap.hpp"

namespace kerf::interp {

class ScriptHost;

/// Whose manual rules where the manuals of LinuxCNC differ ([RS274NGC]COMPAT = 2.7, 2.8).
enum class Compat : std::uint8_t { v2_7, v2_8, newest };

/// [RS274NGC]LOG_LEVEL: what Environment::log() gets; each level has those before it too.
enum class LogLevel : int {
  nothing = -1,
  errors = 0,  ///< blocks in error
  calls =
      1,  ///< programs and MDI lines that begin, programs that end, subs, bodies of remapped codes
  blocks = 2,  ///< each block, as written
};

/// Fixed for the life of an interpreter. Keys: [RS274NGC], [TRAJ], [EMCIO] of the INI (integrator manual).
struct Settings {
  double machine_unit_mm{
      1.0};  ///< mm per machine unit ([TRAJ]LINEAR_UNITS): unit of parameters 5061-5390 and 5401-5410
  std::optional<Units> start_units{};  ///< G20/G21 at start; absent: as the machine's unit
  int spindles{1};                     ///< [TRAJ]SPINDLES, 1-8
  std::uint32_t axis_mask{0x1FF};      ///< bit i = axis i of XYZABCUVW exists ([TRAJ]COORDINATES)
  std::uint32_t indexer_mask{
      0};  ///< axes with [AXIS_L]LOCKING_INDEXER_JOINT: they move alone, by G0
  bool random_toolchanger{false};        ///< [EMCIO]RANDOM_TOOLCHANGER
  bool spindle_on_during_change{false};  ///< [EMCIO]TOOL_CHANGE_WITH_SPINDLE_ON
  bool is_task{false};                   ///< value of #<_task>
  bool scripts{
      true};  ///< false: Environment::scripts() belongs to another interpreter, beside which this one reads
  double orient_offset_deg{0};       ///< ORIENT_OFFSET
  double arc_tolerance_mm{0.00127};  ///< a smaller radius is none
  double arc_tolerance_inch{0.00005};
  double arc_error_mm{
      0.0127};  ///< radii of one arc may differ by this: CENTER_ARC_RADIUS_TOLERANCE_MM
  double arc_error_inch{0.0005};  ///< CENTER_ARC_RADIUS_TOLERANCE_INCH
  std::array<double, rtapi::kAxes>
      axis_max_per_s{};  ///< [AXIS_L]MAX_VELOCITY in mm (degrees) a second; 0: not known
  std::array<double, 8> spindle_max_rpm{};  ///< [SPINDLE_N]MAX_FORWARD_VELOCITY; 0: not known
  bool disable_g92_persistence{false};
  bool disable_auto_g54{false};  ///< M2/M30 keep the work offset
  bool retain_g43{false};  ///< a tool change re-applies the new tool's offset while G43 is active
  double g64_default_tolerance_mm{0};
  double g64_default_naivecam_mm{0};
  int smooth_planner{1};       ///< [TRAJ]SMOOTH_PLANNER: what G64 R chooses; 0 refuses R
  double g73_clearance_mm{0};  ///< 0 = the documented default (1 mm, .050 in)
  double g83_clearance_mm{0};
  int compensation_look_ahead{
      0};                   ///< moves that cutter compensation looks at for gouges; 0: neighbours
  bool ini_vars{true};      ///< INI_VARS: #<_ini[section]key> may be read
  bool hal_pin_vars{true};  ///< HAL_PIN_VARS: #<_hal[name]> may be read
  bool oword_nargs{false};  ///< OWORD_NARGS: a called sub has #<n_args>
  bool no_downcase_oword{false};          ///< NO_DOWNCASE_OWORD: names in comments keep their case
  bool oword_warnonly{false};             ///< OWORD_WARNONLY: errors around O-words only warn
  bool disable_fanuc_style_sub{false};    ///< DISABLE_FANUC_STYLE_SUB: no M98, M99 and O-numbers
  Compat compat{Compat::newest};          ///< COMPAT
  std::string dialect{"linuxcnc"};        ///< DIALECT
  LogLevel log_level{LogLevel::nothing};  ///< LOG_LEVEL
  std::string log_file;                   ///< LOG_FILE; "": standard error
  std::vector<Remap> remaps;              ///< REMAP
  int debug_mask{0};                      ///< [EMC]DEBUG, for scripts
};

/// Outcome of a look-up of a user M-code.
struct UserMcode {
  std::string path;   ///< program to run; empty when there is none
  std::string cause;  ///< when none: why, for the message ("M101: /x/M101 is not executable")
};

/// Implemented by task (real machine), by `rs274` and by tests. Calls come from execute_next() only, must return soon,
/// and must not call the interpreter. Defaults describe a bare machine: no tools, no files, no HAL.
class Environment {
 public:
  virtual ~Environment() = default;

  /// Row of the tool table by tool number (T word).
  [[nodiscard]] virtual std::optional<Tool> find_tool(int number) {
    (void)number;
    return std::nullopt;
  }
  /// Row of the tool table by pocket (random changers; G10 L1 P is a tool number otherwise).
  [[nodiscard]] virtual std::optional<Tool> find_pocket(int pocket) {
    (void)pocket;
    return std::nullopt;
  }
  /// Full path of the file that defines sub `name` ("name.ngc" searched by the documented path), or "".
  [[nodiscard]] virtual std::string find_sub(std::string_view name) {
    (void)name;
    return {};
  }
  /// M100-M199.
  [[nodiscard]] virtual UserMcode find_user_mcode(int number) {
    (void)number;
    return {};
  }
  /// Something that the program should not do and that is no error (OWORD_WARNONLY).
  virtual void warning(std::string_view text) { (void)text; }
  /// A line of the log that LOG_LEVEL asks for.
  virtual void log(std::string_view line) { (void)line; }
  /// Functions in Python, when the machine has them ([PYTHON]TOPLEVEL); must outlive the interpreter.
  [[nodiscard]] virtual ScriptHost* scripts() { return nullptr; }
  /// #<_hal[name]>: pin, signal or parameter; nullopt: no such name.
  [[nodiscard]] virtual std::optional<double> hal_value(std::string_view name) {
    (void)name;
    return std::nullopt;
  }
  /// #<_ini[section]key>: both upper case; nullopt: missing or not a number.
  [[nodiscard]] virtual std::optional<double> ini_value(std::string_view section,
                                                        std::string_view key) {
    (void)section;
    (void)key;
    return std::nullopt;
  }
};

}  // namespace kerf::interp
