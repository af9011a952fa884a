// [DISPLAY] (LinuxCNC manual, "[DISPLAY] Section", and the chapters of the screens). Most of it is the screen's own business:
// the screen program gets the INI file and reads it.
#include "ini/keys/rows.hpp"

namespace kerf::ini::keys {
namespace {

constexpr Key kRows[] = {
    // What Kerf itself reads.
    text("DISPLAY", "screen program to start, with its arguments").read_by(By::kerf),
    text("OPEN_FILE", "program that is opened at start; \"\" none").read_by(By::kerf),
    text("PROGRAM_PREFIX", "folder of programs; also searched first for M100-M199 and O-word files")
        .read_by(By::interpreter)
        .otherwise("nc_files"),
    real("MAX_FEED_OVERRIDE", "highest feed override, 1 = as programmed; bounds adaptive feed too")
        .read_by(By::task)
        .above(0)
        .to(100)
        .otherwise("1.0"),
    real("MIN_SPINDLE_OVERRIDE", "lowest spindle override")
        .read_by(By::task)
        .from(0)
        .to(100)
        .otherwise("0.5"),
    real("MAX_SPINDLE_OVERRIDE", "highest spindle override")
        .read_by(By::task)
        .from(0)
        .to(100)
        .otherwise("1.0"),
    // What screens read.
    real("MAX_RAPID_OVERRIDE", "highest rapid override").from(0),
    text("TITLE", "title of the window"),
    text("ICON", "picture of the window"),
    boolean("CONFIRM_EXIT", "asks before it ends"),
    real("DEFAULT_LINEAR_JOG_VEL", "jog speed at first, before LinuxCNC 2.8"),
    text("MACRO", "an O-word call offered as a button").repeated(),
    choice("POSITION_OFFSET", "RELATIVE MACHINE", "coordinates shown at first"),
    choice("POSITION_FEEDBACK", "COMMANDED ACTUAL", "positions shown at first"),
    text("DRO_FORMAT_MM", "number format of positions in mm"),
    text("DRO_FORMAT_IN", "number format of positions in inches"),
    real("CONE_BASESIZE", "size of the tool's cone"),
    boolean("DISABLE_CONE_SCALING", "the cone keeps its size"),
    real("MIN_SPINDLE_n_OVERRIDE", "the same for one spindle").from(0),
    real("MAX_SPINDLE_n_OVERRIDE", "the same for one spindle").from(0),
    real("DEFAULT_SPINDLE_SPEED", "speed of a spindle that is started by hand").unit(kRpm),
    real("DEFAULT_SPINDLE_n_SPEED", "the same for one spindle").unit(kRpm),
    real("SPINDLE_INCREMENT", "step of the buttons for more and less speed").unit(kRpm),
    real("MIN_SPINDLE_n_SPEED", "lowest speed that can be chosen by hand").unit(kRpm),
    real("MAX_SPINDLE_n_SPEED", "highest speed that can be chosen by hand").unit(kRpm),
    real("MIN_SPINDLE_SPEED", "lowest speed that can be chosen by hand").unit(kRpm),
    real("MAX_SPINDLE_SPEED", "highest speed that can be chosen by hand").unit(kRpm),
    real("MAX_SPINDLE_POWER", "full scale of the power meter").unit("W"),
    text("INTRO_GRAPHIC", "picture shown while starting"),
    real("INTRO_TIME", "how long it is shown").unit(kSeconds).from(0),
    real("CYCLE_TIME", "time between updates, s or ms as the screen has it"),
    real("GRAPHICS_CYCLE_TIME", "time between updates of the drawing").unit("ms"),
    real("HALPIN_CYCLE", "time between updates of HAL pins").unit("ms"),
    real("PREVIEW_TIMEOUT", "longest time for a preview").unit(kSeconds),
    integer("GRAPHICAL_MAX_FILE_SIZE", "largest program that gets a preview").unit("MB"),
    text("EMBED_TAB_NAME", "name of a tab with another program").repeated(),
    text("EMBED_TAB_COMMAND", "program of that tab").repeated(),
    text("EMBED_TAB_LOCATION", "place of that tab").repeated(),
    text("GLADEVCP", "panel made with Glade"),
    text("PYVCP", "panel described by an XML file"),
    choice("PYVCP_POSITION", "BOTTOM RIGHT", "place of that panel"),
    real("DEFAULT_LINEAR_VELOCITY", "jog speed at first").unit(kPerSecond).from(0),
    real("MIN_LINEAR_VELOCITY", "lowest jog speed").unit(kPerSecond).from(0),
    real("MAX_LINEAR_VELOCITY", "highest jog speed").unit(kPerSecond).from(0),
    real("DEFAULT_ANGULAR_VELOCITY", "jog speed of rotary axes at first").unit(kPerSecond).from(0),
    real("MIN_ANGULAR_VELOCITY", "lowest jog speed of rotary axes").unit(kPerSecond).from(0),
    real("MAX_ANGULAR_VELOCITY", "highest jog speed of rotary axes").unit(kPerSecond).from(0),
    real("MIN_VELOCITY", "lowest jog speed").unit(kPerSecond).from(0),
    real("MAX_VELOCITY", "highest jog speed").unit(kPerSecond).from(0),
    text("INCREMENTS", "jog steps: 1 mm, .1 in, 1/16 ..."),
    text("ANGULAR_INCREMENTS", "jog steps of rotary axes"),
    text("GRIDS", "distances of grid lines"),
    text("EDITOR", "editor for programs"),
    text("TOOL_EDITOR", "editor for the tool table"),
    text("LATHE", "any text: a lathe"),
    text("BACK_TOOL_LATHE", "any text: a lathe with the tool behind the spindle"),
    text("FOAM", "any text: a foam cutter"),
    real("FOAM_W", "height of the plane of U and V").unit(kUnits),
    real("FOAM_Z", "height of the plane of X and Y").unit(kUnits),
    real("GCODE_VIEW_TOOL_MIN_DIA", "least diameter of the tool that is drawn"),
    text("GEOMETRY", "how positions become a drawing: letters of axes, right to left"),
    integer("ARCDIVISION", "lines that an arc is drawn with").from(1),
    text("MDI_HISTORY_FILE", "file of MDI lines of before"),
    text("JOG_AXES", "which axes the jog keys move"),
    text("JOG_INVERT", "axes that jog the other way"),
    text("USER_COMMAND_FILE", "Python file of the axis screen"),
    text("USER_CSS_FILE", "style sheet of the gmoccapy screen"),
    text("HELP_FILE", "text that is shown as help"),
    text("HOMING_PROMPT", "asks before homing"),
    text("PREFERENCE_FILE_PATH", "where the screen keeps its settings"),
    text("MACHINE_LOG_PATH", "where the screen logs"),
    text("LOG_FILE", "where the screen logs"),
    text("MESSAGE_TEXT", "message shown when a pin is set").repeated(),
    text("MESSAGE_BOLDTEXT", "its title").repeated(),
    text("MESSAGE_DETAILS", "its explanation").repeated(),
    text("MESSAGE_TYPE", "its kind").repeated(),
    text("MESSAGE_PINNAME", "its pin").repeated(),
    text("MESSAGE_ICON", "its picture").repeated(),
    text("TKPKG", "Tcl package of ngcgui").repeated(),
    text("NGCGUI", "program of a tab with subs"),
    text("NGCGUI_FONT", "font of ngcgui"),
    text("NGCGUI_PREAMBLE", "file that comes before the sub's call"),
    text("NGCGUI_POSTAMBLE", "file that comes after it"),
    text("NGCGUI_SUBFILE", "file with the sub of a tab").repeated(),
    text("NGCGUI_SUBFILE_PATH", "where these files are, before LinuxCNC 2.5"),
    text("NGCGUI_OPTIONS", "options of ngcgui").repeated(),
    text("GCMC_INCLUDE_PATH", "folders of gcmc files"),
    text("TTT", "program that makes G-code of text"),
    text("TTT_PREAMBLE", "file that comes before it"),
    text("NC_FILES", "folder of programs of ngcgui"),
};

}  // namespace

const std::span<const Key> display_keys{kRows};

}  // namespace kerf::ini::keys
