// Rows about the machine as a whole: power, mode, coolant, spindles, tools, overrides, units, probe.
#include <cmath>

#include "clients/rsh/rows.hpp"

namespace kerf::rsh {

std::string linear_units_name(double units_per_mm) {
  const auto near = [units_per_mm](double wanted) {
    return std::fabs(units_per_mm / wanted - 1) < 0.01;
  };
  return near(1 / 25.4) ? "INCH" : near(1) ? "MM" : near(0.1) ? "CM" : "CUSTOM";
}

std::string angular_units_name(double units_per_degree) {
  const auto near = [units_per_degree](double wanted) {
    return std::fabs(units_per_degree / wanted - 1) < 0.01;
  };
  return near(1) ? "DEG" : near(M_PI / 180) ? "RAD" : near(100.0 / 90) ? "GRAD" : "CUSTOM";
}

std::string program_units_name(int program_units) {
  return program_units == 1   ? "INCH"
         : program_units == 2 ? "MM"
         : program_units == 3 ? "CM"
                              : "NONE";
}

namespace {

using enum ArgumentType;

constexpr Argument kMode[]{{"mode", choice, true, "manual,auto,mdi"}};
constexpr Argument kSpindle[]{
    {"action", choice, true, "forward,reverse,increase,decrease,constant,off"},
    {"spindle", spindle, false}};
constexpr Argument kBrake[]{{"on or off", choice, true, "on,off"}, {"spindle", spindle, false}};
constexpr Argument kPercent[]{{"percent", number}};
constexpr Argument kSpindlePercent[]{{"spindle", spindle}, {"percent", number}};
constexpr Argument kSwitch[]{{"on or off", choice, true, "on,off,1,0"}};
constexpr Argument kFile[]{{"file", rest, false}};
constexpr Argument kLinear[]{{"unit", choice, true, "inch,mm,cm,auto,custom"}};
constexpr Argument kAngular[]{{"unit", choice, true, "deg,rad,grad,auto,custom"}};
constexpr Argument kProbe[]{{"x", number}, {"y", number}, {"z", number}};

/// The same words to task for one spindle, or for each (-1).
Done each_spindle(Session& s, int wanted, const std::vector<std::string>& words) {
  Done done;
  for (int n = 0; n < s.machine().stat().spindles; ++n) {
    if (wanted >= 0 && n != wanted) continue;
    std::vector<std::string> all = words;
    all.push_back("spindle=" + std::to_string(n));
    done = s.task(all);
    if (done.kind == Done::Kind::failed) break;
  }
  return done;
}

int spindle_or_first(const Values& v, std::size_t n) { return v.has(n) ? v.index(n) : 0; }

std::string linear_display(const Session& s) {
  return s.settings.linear_units == "auto" ? program_units_name(s.stat().program_units)
                                           : upper(s.settings.linear_units);
}

std::string angular_display(const Session& s) {
  return s.settings.angular_units == "auto" ? "DEG" : upper(s.settings.angular_units);
}

/// Display units in one machine unit.
double linear_factor(const Session& s) {
  const std::string unit = linear_display(s);
  const double per_mm = unit == "INCH" ? 1 / 25.4
                        : unit == "MM" ? 1
                        : unit == "CM" ? 0.1
                                       : s.stat().linear_units;
  return per_mm / s.stat().linear_units;
}

constexpr Subcommand kRows[]{
    {.name = "estop",
     .help = "Emergency stop: ON stops everything.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().estop); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"state", v.is(0, "on") ? "estop" : "estop-reset"});
         },
     .at_once = true},
    {.name = "machine",
     .help = "The drives.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().task_state == 4); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"state", v.is(0, "on") ? "on" : "off"});
         },
     .at_once = true},
    {.name = "mode",
     .help = "Jogs (manual), programs (auto) or single lines (mdi).",
     .get = [](Session& s, const Values&) -> std::string {
       const int mode = s.stat().task_mode;
       return mode == 1 ? "MANUAL" : mode == 2 ? "AUTO" : "MDI";
     },
     .set_arguments = kMode,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"mode", v.text[0]});
         }},
    {.name = "mist",
     .help = "Mist coolant.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().mist); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"mist", v.text[0]});
         }},
    {.name = "flood",
     .help = "Flood coolant.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().flood); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"flood", v.text[0]});
         }},
    {.name = "spindle",
     .help = "A spindle by hand: spindle 0 unless it is named, -1 for all.",
     .get_arguments = kOptionalSpindle,
     .get =
         [](Session& s, const Values& v) {
           return per_spindle(s, v, [&s](std::size_t n) -> std::string {
             const int direction = s.stat().spindle[n].direction;
             return direction > 0 ? "FORWARD" : direction < 0 ? "REVERSE" : "OFF";
           });
         },
     .set_arguments = kSpindle,
     .set =
         [](Session& s, const Values& v) {
           return each_spindle(s, spindle_or_first(v, 1), {"spindle", v.text[0]});
         }},
    {.name = "brake",
     .help = "A spindle's brake: spindle 0 unless it is named, -1 for all.",
     .get_arguments = kOptionalSpindle,
     .get =
         [](Session& s, const Values& v) {
           return per_spindle(
               s, v, [&s](std::size_t n) { return on_off(s.stat().spindle[n].brake != 0); });
         },
     .set_arguments = kBrake,
     .set =
         [](Session& s, const Values& v) {
           return each_spindle(s, spindle_or_first(v, 1), {"brake", v.text[0]});
         }},
    {.name = "tool",
     .help = "Number of the tool in the spindle.",
     .get = [](Session& s, const Values&) { return std::to_string(s.stat().tool_in_spindle); }},
    {.name = "tool_offset",
     .help = "The tool length offset in force (Z).",
     .get = [](Session& s, const Values&) { return fixed(s.stat().tool_offset.z); }},
    {.name = "load_tool_table",
     .help = "Reads the machine's tool table file again.",
     .set_arguments = kFile,
     .set =
         [](Session& s, const Values& v) {
           // Task reads the table that the INI file names, and no other.
           const auto table = s.machine().ini("EMCIO", "TOOL_TABLE");
           const auto base = [](const std::string& name) {
             return name.substr(name.find_last_of('/') + 1);
           };
           if (v.has(0) && (!table || base(v.text[0]) != base(*table)))
             return Done{.kind = Done::Kind::failed,
                         .why = "File '" + shown(v.text[0]) + "' is not the machine's tool table " +
                                (table ? "'" + *table + "'" : "([EMCIO]TOOL_TABLE)")};
           return s.task({"tool-table"});
         }},
    {.name = "feed_override",
     .help = "Feed override in percent.",
     .get = [](Session& s, const Values&) { return fixed(s.stat().feedrate * 100); },
     .set_arguments = kPercent,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"feed-override", exact(v.number[0] / 100)});
         }},
    {.name = "spindle_override",
     .help = "Spindle speed override in percent; spindle -1: all.",
     .get_arguments = kOptionalSpindle,
     .get =
         [](Session& s, const Values& v) {
           return per_spindle(s, v, [&s](std::size_t n) {
             char text[40];
             std::snprintf(text, sizeof text, "%g", s.stat().spindle[n].override_ * 100);
             return std::string(text);
           });
         },
     .set_arguments = kSpindlePercent,
     .set =
         [](Session& s, const Values& v) {
           return each_spindle(s, v.index(0), {"spindle-override", exact(v.number[1] / 100)});
         }},
    {.name = "optional_stop",
     .help = "Whether M1 pauses.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().optional_stop); },
     .set_arguments = kSwitch,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"optional-stop", v.is(0, "on") || v.is(0, "1") ? "on" : "off"});
         }},
    {.name = "user_linear_units",
     .help = "The machine's unit of length.",
     .get = [](Session& s, const Values&) { return linear_units_name(s.stat().linear_units); }},
    {.name = "user_angular_units",
     .help = "The machine's unit of angles.",
     .get = [](Session& s, const Values&) { return angular_units_name(s.stat().angular_units); }},
    {.name = "display_linear_units",
     .help = "The unit of length of GET POS_OFFSET; see LINEAR_UNIT_CONVERSION.",
     .get = [](Session& s, const Values&) { return linear_display(s); }},
    {.name = "display_angular_units",
     .help = "The unit of angles; see ANGULAR_UNIT_CONVERSION.",
     .get = [](Session& s, const Values&) { return angular_display(s); }},
    {.name = "linear_unit_conversion",
     .help = "The unit of length of GET POS_OFFSET; AUTO (at first): the program's.",
     .get = [](Session& s, const Values&) { return upper(s.settings.linear_units); },
     .set_arguments = kLinear,
     .set =
         [](Session& s, const Values& v) {
           s.settings.linear_units = v.text[0];
           return Done{};
         }},
    {.name = "angular_unit_conversion",
     .help = "The unit of angles; AUTO (at first): degrees.",
     .get = [](Session& s, const Values&) { return upper(s.settings.angular_units); },
     .set_arguments = kAngular,
     .set =
         [](Session& s, const Values& v) {
           s.settings.angular_units = v.text[0];
           return Done{};
         }},
    {.name = "pos_offset",
     .help = "The offset of the work coordinates, in the unit that is displayed.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           const double factor = linear_factor(s);
           return per_axis(v, [&s, factor](std::size_t a) {
             const double offset = s.stat().g5x_offset[a] + s.stat().g92_offset[a];
             return rtapi::is_rotary(a) ? offset : offset * factor;
           });
         }},
    {.name = "probe_tripped",
     .help = "Whether the probe has met something since SET PROBE_CLEAR.",
     .get = [](Session& s, const Values&) -> std::string {
       if (s.stat().probing) s.probe_cleared = false;
       return s.stat().probe_tripped && !s.probe_cleared ? "YES" : "NO";
     }},
    {.name = "probe_value",
     .help = "The probe input: 1 touches.",
     .get = [](Session& s, const Values&) { return std::to_string(s.stat().probe_val); }},
    {.name = "probe_clear",
     .help = "Forgets, for this connection, that the probe has met something.",
     .set =
         [](Session& s, const Values&) {
           s.probe_cleared = true;
           return Done{};
         }},
    {.name = "probe",
     .help =
         "Moves towards a place until the probe meets something: the MDI line G38.2 at the feed "
         "in force. Meeting nothing is an error.",
     .set_arguments = kProbe,
     .set =
         [](Session& s, const Values& v) {
           s.probe_cleared = false;
           return s.task({"mdi", "G38.2 X" + exact(v.number[0]) + " Y" + exact(v.number[1]) + " Z" +
                                     exact(v.number[2])});
         }},
};

}  // namespace

std::span<const Subcommand> machine_rows() { return kRows; }

}  // namespace kerf::rsh
