// [EMC] [FILTER] [EMCMOT] [TASK] [HAL] [HALUI] [APPLICATIONS] [EMCIO] [PYTHON] [WIZARD] [MTCONNECT] and our own [KERF] and [SAFE_STATE].
#include "ini/keys/rows.hpp"

namespace kerf::ini::keys {
namespace {

constexpr std::string_view kNml = "there is no NML: clients connect to milltask (docs/protocol.md)";
constexpr std::string_view kMtconnectLater = "not yet: MTConnect";

constexpr Key kEmcRows[] = {
    text("VERSION", "format of the file; 1.1 is today's")
        .otherwise("1.1")
        .differs("files of another version are not rewritten; LinuxCNC's update_ini does that for "
                 "those from before 2.8"),
    text("MACHINE", "name shown to operators"),
    text("DEBUG", "bits of what to log, as 0x7FFFFFFF; seen by scripts and programs")
        .otherwise("0")
        .differs("shown to programs and scripts; Kerf's own messages do not depend on it"),
    text("NML_FILE", "").no(kNml),
    text("RCS_DEBUG", "").no(kNml),
    text("RCS_DEBUG_DEST", "").no(kNml),
    text("RCS_MAX_ERR", "").no(kNml),
};

constexpr Key kFilterRows[] = {
    text("PROGRAM_EXTENSION",
         "endings of files, separated by commas, and what they are; EXT = PROGRAM names the "
         "program that makes G-code of them")
        .repeated(),
};

constexpr Key kEmcmotRows[] = {
    text("EMCMOT", "the motion component; HAL files load it").otherwise("motmod"),
    integer("BASE_PERIOD", "period of the base thread").unit(kNanoseconds).from(0),
    integer("SERVO_PERIOD", "period of the servo thread").unit(kNanoseconds).from(0),
    integer("TRAJ_PERIOD", "accepted by motmod, without effect").unit(kNanoseconds).from(0),
    real("COMM_TIMEOUT", "how long task waits for motion")
        .unit(kSeconds)
        .idle("without effect: [KERF]HEARTBEAT_TIMEOUT watches the connection"),
    real("COMM_WAIT", "").idle("without effect: from long ago"),
    text("HOMEMOD",
         "homing module to load, with its parameters, in place of motmod's own homing "
         "(docs/writing-c-components.md)")
        .otherwise("homemod")
        .read_by(By::kerf),
};

constexpr Key kTaskRows[] = {
    text("TASK", "program that runs the machine").otherwise("milltask").read_by(By::kerf),
    real("CYCLE_TIME", "how often task looks for work")
        .unit(kSeconds)
        .otherwise("0.010")
        .idle("without effect but in what clients are told: task wakes when there is something to "
              "do"),
    integer("MDI_QUEUED_COMMANDS", "MDI lines that may wait").from(1).to(1000).otherwise("10"),
    integer("INTERP_MAX_LEN", "lines read ahead of motion")
        .idle("without effect: as many as the queue to motion has room for, 1024 moves"),
    text("IO_ERROR", "what a fault of the tool changer is called, %d: its reason (iov2)")
        .otherwise("toolchanger error %d"),
    text("INTERPRETER", "").no("interpreters cannot be exchanged"),
};

constexpr Key kHalRows[] = {
    text("HALFILE", "HAL files in order, .hal, or .tcl with arguments; see HAL files").repeated(),
    text("HALCMD", "single HAL commands after the files").repeated(),
    text("POSTGUI_HALFILE", "HAL files that are done after the screen has started").repeated(),
    text("POSTGUI_HALCMD", "single HAL commands after these").repeated(),
    text("SHUTDOWN", "HAL file at the end").repeated(),
    text("TWOPASS", "any text: the HALFILEs are done in two passes; see Two passes"),
    text("HALUI", "program with pins for operator's buttons; started before the HAL files"),
};

constexpr Key kHaluiRows[] = {
    text("MDI_COMMAND", "what halui.mdi-command-00, -01 ... execute").repeated(),
};

constexpr Key kApplicationsRows[] = {
    text("APP", "programs to start with the machine").repeated(),
    real("DELAY", "time to wait before starting them").unit(kSeconds).from(0).otherwise("0"),
};

constexpr Key kEmcioRows[] = {
    text("TOOL_TABLE", "the tool table"),
    text("DB_PROGRAM", "program that keeps the tools, with its arguments, instead of TOOL_TABLE"),
    boolean("RANDOM_TOOLCHANGER", "a tool keeps no pocket of its own").otherwise("0"),
    reals("TOOL_CHANGE_POSITION", "3 6 9", "machine coordinates to go to before a change")
        .unit(kUnits),
    boolean("TOOL_CHANGE_QUILL_UP", "Z to machine zero before a change").otherwise("0"),
    boolean("TOOL_CHANGE_AT_G30", "to the place of G30 before a change").otherwise("0"),
    boolean("TOOL_CHANGE_WITH_SPINDLE_ON", "the spindle goes on turning").otherwise("0"),
    text("EMCIO", "iov2 [-support-start-change]: pins for aborts and faults of the tool changer")
        .otherwise("io"),
    real("CYCLE_TIME", "how often io looks at its pins")
        .unit(kSeconds)
        .idle("without effect: io is a part of task and acts at once"),
    integer("PROTOCOL_VERSION", "iov2: 1 leaves its pins without effect")
        .from(1)
        .to(2)
        .otherwise("2"),
    boolean("RANDOM_TOOL_CHANGER", "").no("its name is RANDOM_TOOLCHANGER"),
};

constexpr Key kPythonRows[] = {
    text("TOPLEVEL", "script that imports remap, oword, namedparams; see Remapped codes"),
    text("PATH_PREPEND", "folders of modules").repeated(),
    text("PATH_APPEND", "folders of modules").repeated(),
    boolean("RELOAD_ON_CHANGE", "the script and its modules anew when one of them changed")
        .otherwise("0"),
    integer("LOG_LEVEL", "how much is logged of Python's part").from(-1).to(1000).otherwise("0"),
    boolean("PYTHON_TASK", "a task in Python").otherwise("0").no("milltask cannot be exchanged"),
};

constexpr Key kWizardRows[] = {
    text("WIZARD_ROOT", "folder of O-word files, searched last"),
};

constexpr Key kMtconnectRows[] = {
    boolean("ENABLE", "").no(kMtconnectLater),     text("DEVICE_NAME", "").no(kMtconnectLater),
    text("UUID", "").no(kMtconnectLater),          text("TRANSPORT", "").no(kMtconnectLater),
    text("HTTP_BIND", "").no(kMtconnectLater),     integer("HTTP_PORT", "").no(kMtconnectLater),
    real("SAMPLE_HZ", "").no(kMtconnectLater),     text("MQTT_BROKER", "").no(kMtconnectLater),
    integer("MQTT_PORT", "").no(kMtconnectLater),  text("MQTT_PREFIX", "").no(kMtconnectLater),
    text("MQTT_USERNAME", "").no(kMtconnectLater), text("MQTT_PASSWORD", "").no(kMtconnectLater),
};

constexpr Key kSafeStateRows[] = {
    text("PIN",
         "NAME VALUE: what a pin, parameter or signal is set to when the machine goes off, at the "
         "end and when a process dies (docs/safety.md)")
        .repeated()
        .own(),
    text("COMMAND",
         "program with arguments that kerf runs when the realtime process dies: a way to the "
         "hardware that needs no HAL")
        .repeated()
        .own(),
};

constexpr Key kKerfRows[] = {
    choice("CLOCK", "real virtual", "which time the machine runs on").otherwise("real").own(),
    real("HEARTBEAT_TIMEOUT", "silence of task before motion stops and drives go off")
        .unit(kSeconds)
        .from(0.01)
        .to(10)
        .otherwise("0.1")
        .read_by(By::task)
        .own(),
    choice("HEARTBEAT_REACTION", "stop off",
           "what motion does then: a controlled stop on the path and drives off, or drives off at "
           "once")
        .otherwise("stop")
        .read_by(By::task)
        .own(),
    choice("SINGLE_STEP", "blocks moves",
           "where a step ends: behind each executed block, or behind the next that moves the "
           "machine; M0 and the like stop it in both")
        .otherwise("blocks")
        .read_by(By::task)
        .own(),
    choice(
        "OVERRUN", "warn hold estop",
        "what a servo cycle that comes too late does while the machine is on: a line in the log, "
        "a pause, or estop")
        .otherwise("warn")
        .read_by(By::task)
        .own(),
    real("OVERRUN_PERIODS", "servo periods behind the cycle before after which OVERRUN acts")
        .from(1.5)
        .to(1000)
        .otherwise("3")
        .read_by(By::task)
        .own(),
    boolean(
        "CHECK_LIMITS",
        "when a program is opened, and all joints are homed, all of it is read and held against "
        "the soft limits of the axes; each move is, in any case, before it begins")
        .otherwise("1")
        .read_by(By::task)
        .own(),
    integer("STALE_FEEDBACK_CYCLES",
            "cycles with joint.N.fb-stale, of the last STALE_FEEDBACK_WINDOW, in which the joint's "
            "position is extrapolated; one more, and the machine stops and is off")
        .from(0)
        .to(8192)
        .otherwise("5")
        .read_by(By::task)
        .own(),
    integer("STALE_FEEDBACK_WINDOW", "servo cycles in which STALE_FEEDBACK_CYCLES are counted")
        .from(1)
        .to(8192)
        .otherwise("1000")
        .read_by(By::task)
        .own(),
    boolean("PATH_CHECK", "every servo cycle checks that the path is within G64 P of the program")
        .otherwise("0")
        .read_by(By::task)
        .own(),
    boolean("TIME_LAWS",
            "with jerk limits the planner works out the speed along the path ahead of the servo; "
            "no: the servo looks ahead itself, slower on curves")
        .otherwise("1")
        .read_by(By::task)
        .own(),
    text("JOURNAL",
         "file of what was executed last, for `kerf resume` after a loss of power "
         "(docs/journal.md); "
         "off: none")
        .otherwise_as("in ~/.local/state/kerf")
        .read_by(By::task)
        .own(),
    text("RT_CPUS",
         "processors of the realtime threads, the fastest thread first, e.g. 2,3 or 2-3; threads "
         "that are left run on the last")
        .otherwise_as("any")
        .own(),
    choice("FUNCTION_TIMING", "sampled every off",
           "HAL functions are timed in every 16th cycle, in every one or never (docs/timing.md)")
        .otherwise("sampled")
        .own(),
    text("RECORD_DIR", "folder of flight records (docs/flight-record.md)")
        .otherwise_as("~/.local/state/kerf/flight-records")
        .own(),
    integer("RECORD_KEEP", "flight records kept in it; 0: none are written")
        .from(0)
        .to(10000)
        .otherwise("20")
        .own(),
    text("RECORD_PIN",
         "a pin, parameter or signal that the flight record holds too; 16 of them at most")
        .repeated()
        .own(),
    integer("SEGMENT_MB", "size of the shared memory")
        .unit("MiB")
        .from(16)
        .to(2047)
        .otherwise("64")
        .own(),
};

}  // namespace

const std::span<const Key> emc_keys{kEmcRows};
const std::span<const Key> filter_keys{kFilterRows};
const std::span<const Key> emcmot_keys{kEmcmotRows};
const std::span<const Key> task_keys{kTaskRows};
const std::span<const Key> hal_keys{kHalRows};
const std::span<const Key> halui_keys{kHaluiRows};
const std::span<const Key> applications_keys{kApplicationsRows};
const std::span<const Key> emcio_keys{kEmcioRows};
const std::span<const Key> python_keys{kPythonRows};
const std::span<const Key> wizard_keys{kWizardRows};
const std::span<const Key> mtconnect_keys{kMtconnectRows};
const std::span<const Key> kerf_keys{kKerfRows};
const std::span<const Key> safe_state_keys{kSafeStateRows};

}  // namespace kerf::ini::keys
