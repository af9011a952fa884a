// [RS274NGC] (LinuxCNC manual, "[RS274NGC] Section" and "Remap Extending G-code").
#include "ini/keys/rows.hpp"

namespace kerf::ini::keys {
namespace {

constexpr Key kRows[] = {
    text("PARAMETER_FILE", "parameters that outlive the power; made when absent"),
    text("SUBROUTINE_PATH",
         "folders of O-word files, separated by colons, searched after [DISPLAY]PROGRAM_PREFIX"),
    text("USER_M_PATH",
         "folders of M100 to M199, separated by colons, searched after [DISPLAY]PROGRAM_PREFIX"),
    text("RS274NGC_STARTUP_CODE", "G-code that is executed when the interpreter starts"),
    real("ORIENT_OFFSET", "added to R of M19").unit(kDegrees).from(-360).to(360).otherwise("0"),
    real("CENTER_ARC_RADIUS_TOLERANCE_MM",
         "how far the radii of an arc's ends may always differ; 0.1 % of the radius besides")
        .unit("mm")
        .from(0)
        .otherwise("0.0127"),
    real("CENTER_ARC_RADIUS_TOLERANCE_INCH", "the same for programs in inches")
        .unit("inch")
        .from(0)
        .otherwise("0.0005"),
    real("G64_DEFAULT_TOLERANCE", "P of a G64 without words").unit(kUnits).from(0).otherwise("0"),
    real("G64_DEFAULT_NAIVETOLERANCE", "Q of a G64 without words")
        .unit(kUnits)
        .from(0)
        .otherwise("0"),
    real("G73_PECK_CLEARANCE", "how far G73 backs off")
        .unit(kUnits)
        .from(0)
        .otherwise_as("1 mm, .050 inch"),
    real("G83_PECK_CLEARANCE", "where G83 slows down above the hole's bottom")
        .unit(kUnits)
        .from(0)
        .otherwise_as("1 mm, .050 inch"),
    integer("COMPENSATION_LOOK_AHEAD",
            "moves that cutter compensation holds against each other for gouges before the first "
            "of them begins; 0: neighbours only, as LinuxCNC")
        .from(0)
        .to(1000)
        .otherwise("0")
        .own(),
    boolean("INI_VARS", "programs may read #<_ini[section]key>").otherwise("1"),
    boolean("HAL_PIN_VARS", "programs may read #<_hal[name]>").otherwise("1"),
    boolean("RETAIN_G43", "G43 stays over tool changes, until no tool is loaded").otherwise("0"),
    boolean("OWORD_NARGS", "#<n_args> in subs").otherwise("0"),
    boolean("NO_DOWNCASE_OWORD", "names in comments keep their case").otherwise("0"),
    boolean("OWORD_WARNONLY", "mistakes with labels only warn").otherwise("0"),
    boolean("DISABLE_G92_PERSISTENCE", "G92 offsets are cleared at start").otherwise("0"),
    boolean("DISABLE_AUTO_G54", "M2 and M30 keep the work offset").otherwise("0"),
    boolean("DISABLE_FANUC_STYLE_SUB", "no M98, M99 and numbered programs").otherwise("0"),
    integer("FEATURES", "bits for RETAIN_G43 to OWORD_WARNONLY, from LinuxCNC 2.7")
        .from(0)
        .to(0x3F)
        .otherwise("0")
        .differs("still read, with a warning that names the keys to write instead"),
    integer(
        "LOG_LEVEL",
        "what is logged: -1 nothing, 0 blocks in error, 1 also programs, MDI lines and calls of "
        "subs, 2 also each block; shown to scripts as loglevel")
        .from(-1)
        .to(1000)
        .otherwise("-1"),
    text("LOG_FILE", "where to, appended; without it on standard error"),
    text("REMAP",
         "a new code, or a new body for T, S, F, M0, M1, M6, M60, M61, M62-M68; see Remapped codes")
        .repeated(),
    text("ON_ABORT_COMMAND",
         "an O-word call that runs after an abort with the reason as #1: 1 a block could not be "
         "carried out, 2 external estop, 3 motion fault, 4 machine off, 6 estop, 8 abort, 9 error "
         "in the program, 10 error in MDI. It sets modes and outputs, never moves and never "
         "waits"),
    integer("USER_DEFINED_FUNCTION_MAX_DIRS", "most folders of USER_M_PATH")
        .idle("without effect: there is no limit"),
    choice("COMPAT", "2.7 2.8 2.9 2.10", "whose manual rules where they differ")
        .otherwise("2.10")
        .own(),
    choice("DIALECT", "linuxcnc", "language of programs").otherwise("linuxcnc").own(),
};

}  // namespace

const std::span<const Key> rs274ngc_keys{kRows};

}  // namespace kerf::ini::keys
