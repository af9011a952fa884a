// [TRAJ], [KINS], [AXIS_L], [JOINT_n], [SPINDLE_n] (LinuxCNC manual, the sections of these names, "Homing Configuration",
// "Updating to 2.8" for the old names).
#include "ini/keys/rows.hpp"

namespace kerf::ini::keys {
namespace {

constexpr std::string_view kBlends =
    "without effect: corners are rounded within G64 P and Q, and the planner looks ahead as far as "
    "it takes";

constexpr Key kTrajRows[] = {
    text("COORDINATES", "the axes there are, of XYZABCUVW").required().read_by(By::task),
    make_key("LINEAR_UNITS", Kind::linear_unit, "what a length in this file is meant in")
        .otherwise("mm")
        .read_by(By::task),
    make_key("ANGULAR_UNITS", Kind::angular_unit, "what an angle in this file is meant in")
        .otherwise("degree")
        .read_by(By::task),
    integer("SPINDLES", "how many spindles").from(1).to(8).otherwise("1"),
    real("DEFAULT_LINEAR_VELOCITY", "jog speed at first; told to clients")
        .unit(kPerSecond)
        .from(0)
        .otherwise("0")
        .read_by(By::task),
    real("DEFAULT_ANGULAR_VELOCITY", "jog speed of rotary axes at first")
        .unit(kPerSecond)
        .from(0)
        .read_by(By::screen),
    real("MIN_LINEAR_VELOCITY", "lowest jog speed").unit(kPerSecond).from(0).read_by(By::screen),
    real("MIN_ANGULAR_VELOCITY", "lowest jog speed of rotary axes")
        .unit(kPerSecond)
        .from(0)
        .read_by(By::screen),
    real("MIN_VELOCITY", "lowest jog speed").unit(kPerSecond).from(0).read_by(By::screen),
    real("DEFAULT_LINEAR_ACCELERATION", "acceleration of jogs along axes; told to clients")
        .unit(kPerSecond2)
        .from(0)
        .otherwise("0")
        .idle("without effect: jogs along axes use [AXIS_L]MAX_ACCELERATION"),
    real("DEFAULT_ANGULAR_ACCELERATION", "acceleration of jogs about axes")
        .unit(kPerSecond2)
        .idle("without effect: jogs along axes use [AXIS_L]MAX_ACCELERATION"),
    real("MAX_LINEAR_VELOCITY", "bound along the path, on top of those of axes and joints")
        .unit(kPerSecond)
        .above(0)
        .otherwise_as("none"),
    real("MAX_ANGULAR_VELOCITY", "the same for moves of rotary axes alone")
        .unit(kPerSecond)
        .above(0)
        .otherwise_as("none"),
    real("MAX_LINEAR_ACCELERATION", "bound along the path, on top of those of axes and joints")
        .unit(kPerSecond2)
        .above(0)
        .otherwise_as("none"),
    real("MAX_ANGULAR_ACCELERATION", "the same for moves of rotary axes alone")
        .unit(kPerSecond2)
        .idle("without effect: [AXIS_L] and [JOINT_n]MAX_ACCELERATION bound rotary axes"),
    real("MAX_LINEAR_JERK",
         "bound of the jerk along straights, arcs and what leads on like them, and of linear "
         "joints and axes without MAX_JERK; 0 none")
        .unit(kPerSecond3)
        .from(0)
        .otherwise("0"),
    choice(
        "PLANNER_TYPE", "0 1",
        "0 limits acceleration only, 1 jerk too; without it jerk limits count where they are given")
        .otherwise_as("1"),
    real("ROTARY_TOLERANCE", "how far G64 may leave the programmed place of a rotary axis")
        .unit("degrees")
        .from(0)
        .otherwise_as("as many degrees as P has mm"),
    real("SCURVE_PEAK_SCALE", "part of the jerk that S-curves use")
        .from(0.1)
        .to(1)
        .idle("without effect: the whole of the jerk limit may be used"),
    real("MAX_LINEAR_ACCEL", "").no("no key of LinuxCNC: MAX_LINEAR_ACCELERATION is meant"),
    real("DEFAULT_LINEAR_ACCEL", "").no("no key of LinuxCNC: DEFAULT_LINEAR_ACCELERATION is meant"),
    integer("SMOOTH_PLANNER", "0 refuses R of G64")
        .from(0)
        .to(1)
        .otherwise("1")
        .read_by(By::interpreter),
    boolean("ARC_BLEND_ENABLE", "round corners by arcs").idle(kBlends),
    boolean("ARC_BLEND_FALLBACK_ENABLE", "round them by parabolas where that is faster")
        .idle(kBlends),
    integer("ARC_BLEND_OPTIMIZATION_DEPTH", "how many segments to look ahead").idle(kBlends),
    real("ARC_BLEND_GAP_CYCLES", "how short a line between two arcs may be").idle(kBlends),
    real("ARC_BLEND_RAMP_FREQ", "when to accelerate over a whole segment").unit("Hz").idle(kBlends),
    real("ARC_BLEND_KINK_RATIO", "what is no corner yet").idle(kBlends),
    boolean("NO_FORCE_HOMING", "programs and MDI before homing").otherwise("0"),
    boolean("NO_PROBE_JOG_ERROR", "a probe that trips is no error while jogging").otherwise("0"),
    boolean("NO_PROBE_HOME_ERROR", "a probe that trips is no error while homing").otherwise("0"),
    text("POSITION_FILE",
         "joint positions are kept here when the machine ends and taken at the next start; joints "
         "are not homed by it")
        .read_by(By::task),
    reals("HOME", "", "where the tool is after homing, for kinematics that need it")
        .idle("without effect: kinematics begin at the joints' own positions"),
    text("TPMOD", "trajectory planner to load")
        .otherwise("tpmod")
        .read_by(By::kerf)
        .differs("only tpmod: the planner is a part of motmod, and any other name is an error"),
    integer("AXES", "how many axes, before LinuxCNC 2.8")
        .no("from before LinuxCNC 2.8: [KINS]JOINTS and [TRAJ]COORDINATES say it"),
    text("UNITS", "units, before LinuxCNC 2.8")
        .no("from before LinuxCNC 2.8: write LINEAR_UNITS and ANGULAR_UNITS"),
    real("DEFAULT_VELOCITY", "")
        .no("from before LinuxCNC 2.8: its name is DEFAULT_LINEAR_VELOCITY"),
    real("DEFAULT_ACCELERATION", "")
        .no("from before LinuxCNC 2.8: its name is DEFAULT_LINEAR_ACCELERATION"),
    real("MAX_VELOCITY", "").no("from before LinuxCNC 2.8: its name is MAX_LINEAR_VELOCITY"),
    real("MAX_ACCELERATION", "")
        .no("from before LinuxCNC 2.8: its name is MAX_LINEAR_ACCELERATION"),
    real("CYCLE_TIME", "").idle("without effect: the servo thread's period is motmod's"),
};

constexpr Key kKinsRows[] = {
    text("KINEMATICS",
         "component and its parameters, e.g. `trivkins coordinates=XYZ`; HAL files "
         "load it")
        .required(),
    integer("JOINTS", "how many joints").from(1).to(16).required(),
};

constexpr Key kAxisRows[] = {
    real("MAX_VELOCITY", "fastest speed of the axis; a warning without it")
        .unit(kPerSecond)
        .above(0)
        .otherwise("1.0"),
    real("MAX_ACCELERATION", "highest acceleration of the axis; a warning without it")
        .unit(kPerSecond2)
        .above(0)
        .otherwise("1.0"),
    real("MAX_JERK", "highest jerk of the axis, 0 none").unit(kPerSecond3).from(0).otherwise("0"),
    real("MIN_LIMIT", "soft limit").unit(kUnits).otherwise_as("none"),
    real("MAX_LIMIT", "soft limit").unit(kUnits).otherwise_as("none"),
    boolean("WRAPPED_ROTARY", "the axis goes the way that the sign of the word says, 0 to 360")
        .no("not yet: wrapped rotary axes"),
    integer("LOCKING_INDEXER_JOINT", "the joint that unlocks before it turns")
        .from(0)
        .to(15)
        .otherwise_as("none"),
    real("OFFSET_AV_RATIO",
         "external offsets: their share of the axis' velocity and acceleration, 0 none")
        .from(0)
        .to(0.9)
        .otherwise("0"),
    real("HOME", "where the axis is after homing").idle("without effect: [JOINT_n]HOME says it"),
    text("TYPE", "").no("from before LinuxCNC 2.8: TYPE stands in [JOINT_n]"),
};

constexpr Key kJointRows[] = {
    choice("TYPE", "LINEAR ANGULAR", "whether lengths or angles").otherwise("LINEAR"),
    text("UNITS", "unit of this joint alone: mm, inch, degree ...")
        .otherwise_as("as [TRAJ]")
        .read_by(By::task),
    real("MAX_VELOCITY", "fastest speed; a warning without it")
        .unit(kPerSecond)
        .above(0)
        .otherwise("1.0"),
    real("MAX_ACCELERATION", "highest acceleration; a warning without it")
        .unit(kPerSecond2)
        .above(0)
        .otherwise("1.0"),
    real("MAX_JERK", "highest jerk, 0 none").unit(kPerSecond3).from(0).otherwise("0"),
    real("MIN_LIMIT", "soft limit; with trivkins a joint must reach all that its axis may")
        .unit(kUnits)
        .otherwise_as("none"),
    real("MAX_LIMIT", "soft limit").unit(kUnits).otherwise_as("none"),
    real("MIN_FERROR", "allowed following error at rest")
        .unit(kUnits)
        .from(0)
        .otherwise_as("FERROR"),
    real("FERROR", "allowed following error at full speed")
        .unit(kUnits)
        .from(0)
        .otherwise_as("none"),
    real("BACKLASH",
         "play of the drive, made good when it turns round, at half of MAX_VELOCITY and "
         "MAX_ACCELERATION, which the drive must have in reserve")
        .unit(kUnits)
        .from(0)
        .otherwise("0"),
    text("COMP_FILE",
         "table of the screw's errors, in place of BACKLASH: lines of position, value going up, "
         "value "
         "going down, at most 256; in force once the joint is homed")
        .read_by(By::task),
    choice("COMP_FILE_TYPE", "0 1",
           "its values: 0 where the joint truly is, 1 how much farther the motor has to be")
        .otherwise("0"),
    boolean(
        "LOCKING_INDEXER",
        "unlocked while it homes, by joint.N.unlock and is-unlocked (motmod unlock_joints_mask)")
        .otherwise("NO"),
    real("HOME", "where the joint goes at last when homing").unit(kUnits).otherwise("0"),
    real("HOME_OFFSET", "joint position of switch or index").unit(kUnits).otherwise("0"),
    real("HOME_SEARCH_VEL", "speed and direction of the search for the switch, 0: no switch")
        .unit(kPerSecond)
        .otherwise("0"),
    real("HOME_LATCH_VEL", "speed and direction of finding the edge or index")
        .unit(kPerSecond)
        .otherwise("0"),
    real("HOME_FINAL_VEL", "speed of the last move")
        .unit(kPerSecond)
        .otherwise("0")
        .otherwise_as("MAX_VELOCITY"),
    real("HOME_SEARCH_DIST",
         "the search ends with an error after this way, 0: after the whole "
         "travel")
        .unit(kUnits)
        .from(0)
        .otherwise("0")
        .own(),
    real("HOME_LATCH_DIST", "the same for the edge").unit(kUnits).from(0).otherwise("0").own(),
    boolean("HOME_USE_INDEX", "homes to the encoder's index").otherwise("NO"),
    boolean("HOME_INDEX_NO_ENCODER_RESET", "the encoder does not count from 0 at the index")
        .otherwise("NO"),
    boolean("HOME_IGNORE_LIMITS", "its limit switch is its home switch").otherwise("NO"),
    boolean("HOME_IS_SHARED", "no homing while the switch of several joints is closed")
        .otherwise("NO"),
    integer("HOME_ABSOLUTE_ENCODER", "1: knows where it is; 2: and makes no last move")
        .from(0)
        .to(2)
        .otherwise("0"),
    integer("HOME_SEQUENCE",
            "joints of one number home together, numbers in order from 0 or 1; negative: legs of "
            "an axis "
            "keep together, last moves together")
        .from(-100)
        .to(100)
        .otherwise_as("not with the others"),
    boolean("VOLATILE_HOME", "not homed any more when the machine goes off").otherwise("NO"),
    // Custom keys of LinuxCNC's sample configurations and wizards, for HAL files.
    real("P", "gain of a PID loop").read_by(By::hal),
    real("I", "gain of a PID loop").read_by(By::hal),
    real("D", "gain of a PID loop").read_by(By::hal),
    real("FF0", "feed forward of the position").read_by(By::hal),
    real("FF1", "feed forward of the speed").read_by(By::hal),
    real("FF2", "feed forward of the acceleration").read_by(By::hal),
    real("FF3", "feed forward of the jerk").read_by(By::hal),
    real("BIAS", "added to a PID loop's output").read_by(By::hal),
    real("DEADBAND", "error that a PID loop takes for none").unit(kUnits).read_by(By::hal),
    real("MAX_ERROR", "most that a PID loop takes for an error").read_by(By::hal),
    real("MAX_OUTPUT", "most that a PID loop gives out").read_by(By::hal),
    real("MIN_OUTPUT", "least that is given out").read_by(By::hal),
    text("SCALE", "steps or counts a unit").read_by(By::hal),
    text("STEP_SCALE", "steps a unit").read_by(By::hal),
    text("INPUT_SCALE", "counts a unit").read_by(By::hal),
    text("ENCODER_SCALE", "counts a unit").read_by(By::hal),
    text("OUTPUT_SCALE", "of the drive's signal").read_by(By::hal),
    real("OUTPUT_OFFSET", "of the drive's signal").read_by(By::hal),
    real("OUTPUT_MIN_LIMIT", "of the drive's signal").read_by(By::hal),
    real("OUTPUT_MAX_LIMIT", "of the drive's signal").read_by(By::hal),
    real("STEPGEN_MAXVEL", "fastest speed of the step generator").unit(kPerSecond).read_by(By::hal),
    real("STEPGEN_MAXACCEL", "highest acceleration of the step generator")
        .unit(kPerSecond2)
        .read_by(By::hal),
    real("STEPGEN_MAX_VEL", "fastest speed of the step generator")
        .unit(kPerSecond)
        .read_by(By::hal),
    real("STEPGEN_MAX_ACC", "highest acceleration of the step generator")
        .unit(kPerSecond2)
        .read_by(By::hal),
    text("AXIS", "letter of its axis").read_by(By::hal),
    text("NAME", "its name").read_by(By::hal),
    real("PGAIN", "gain of a PID loop").read_by(By::hal),
    real("IGAIN", "gain of a PID loop").read_by(By::hal),
    real("DGAIN", "gain of a PID loop").read_by(By::hal),
    real("DIRSETUP", "time between direction and step").unit(kNanoseconds).read_by(By::hal),
    real("DIRHOLD", "time between step and direction").unit(kNanoseconds).read_by(By::hal),
    real("STEPLEN", "length of a step").unit(kNanoseconds).read_by(By::hal),
    real("STEPSPACE", "time between steps").unit(kNanoseconds).read_by(By::hal),
};

constexpr Key kSpindleRows[] = {
    real("MAX_FORWARD_VELOCITY", "fastest speed").unit(kRpm).from(0).otherwise_as("none"),
    real("MIN_FORWARD_VELOCITY", "lowest speed; slower ones are raised to it")
        .unit(kRpm)
        .from(0)
        .otherwise("0"),
    real("MAX_REVERSE_VELOCITY", "fastest speed backwards, 0: never backwards")
        .unit(kRpm)
        .from(0)
        .otherwise_as("MAX_FORWARD_VELOCITY"),
    real("MIN_REVERSE_VELOCITY", "lowest speed backwards")
        .unit(kRpm)
        .from(0)
        .otherwise_as("MIN_FORWARD_VELOCITY"),
    real("INCREMENT", "step of the commands for more and less speed")
        .unit(kRpm)
        .from(0)
        .otherwise("100")
        .read_by(By::task),
    real("HOME_SEARCH_VELOCITY", "")
        .unit(kRpm)
        .idle("without effect: spindles are not homed, by LinuxCNC neither"),
    integer("HOME_SEQUENCE", "")
        .idle("without effect: spindles are not homed, by LinuxCNC neither"),
    real("MAX_VELOCITY", "").no("LinuxCNC 2.10 does not read it: write MAX_FORWARD_VELOCITY"),
    real("MIN_VELOCITY", "").no("LinuxCNC 2.10 does not read it: write MIN_FORWARD_VELOCITY"),
    real("P", "gain of a PID loop").read_by(By::hal),
    real("I", "gain of a PID loop").read_by(By::hal),
    real("D", "gain of a PID loop").read_by(By::hal),
    real("FF0", "feed forward").read_by(By::hal),
    real("FF1", "feed forward").read_by(By::hal),
    real("FF2", "feed forward").read_by(By::hal),
    real("BIAS", "added to a PID loop's output").read_by(By::hal),
    real("DEADBAND", "error that a PID loop takes for none").read_by(By::hal),
    real("MAX_OUTPUT", "most that a PID loop gives out").read_by(By::hal),
    real("MAX_ERROR", "most that a PID loop takes for an error").read_by(By::hal),
    text("ENCODER_SCALE", "counts a revolution").read_by(By::hal),
    text("OUTPUT_SCALE", "of the drive's signal").read_by(By::hal),
    real("OUTPUT_MIN_LIMIT", "of the drive's signal").read_by(By::hal),
    real("OUTPUT_MAX_LIMIT", "of the drive's signal").read_by(By::hal),
};

}  // namespace

const std::span<const Key> traj_keys{kTrajRows};
const std::span<const Key> kins_keys{kKinsRows};
const std::span<const Key> axis_keys{kAxisRows};
const std::span<const Key> joint_keys{kJointRows};
const std::span<const Key> spindle_keys{kSpindleRows};

}  // namespace kerf::ini::keys
