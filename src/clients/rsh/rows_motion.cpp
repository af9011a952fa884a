// Rows about axes and joints: positions, homing, jogging, limits.
#include <algorithm>

#include "clients/common/work_position.hpp"
#include "clients/rsh/rows.hpp"

namespace kerf::rsh {
namespace {

using enum ArgumentType;
using clients::Stat;

constexpr Argument kWhat[]{{"joint or axis", joint_or_axis}};
constexpr Argument kJog[]{{"joint or axis", joint_or_axis}, {"speed", number}};
constexpr Argument kJogIncrement[]{
    {"joint or axis", joint_or_axis}, {"speed", number}, {"distance", number}};

std::string jog_name(const Values& v) { return lower(v.text[0]); }

/// Speeds of jogs are in units a minute, as feeds are.
std::string per_second(double per_minute) { return exact(per_minute / 60); }

Done home(Session& s, const Values& v) { return s.task({"home", v.text[0]}); }

constexpr Subcommand kRows[]{
    {.name = "abs_cmd_pos",
     .help = "Commanded position in machine coordinates.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           return per_axis(v, [&s](std::size_t a) { return s.stat().position[a]; });
         }},
    {.name = "abs_act_pos",
     .help = "Actual position in machine coordinates.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           return per_axis(v, [&s](std::size_t a) { return s.stat().actual_position[a]; });
         }},
    {.name = "rel_cmd_pos",
     .help = "Commanded position in work coordinates, with the tool length offset.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           return per_axis(v, [&s](std::size_t a) {
             return clients::work_position(s.stat(), s.stat().position)[a];
           });
         }},
    {.name = "rel_act_pos",
     .help = "Actual position in work coordinates, with the tool length offset.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           return per_axis(v, [&s](std::size_t a) {
             return clients::work_position(s.stat(), s.stat().actual_position)[a];
           });
         }},
    {.name = "axis_velocity",
     .help = "Velocity of axis jogs, units a second.",
     .get_arguments = kOptionalAxis,
     .get =
         [](Session& s, const Values& v) {
           return per_axis(v, [&s](std::size_t a) { return s.stat().axis[a].velocity; });
         }},
    {.name = "joint_pos",
     .help = "Actual position of joints.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(
               s, v, [&s](std::size_t j) { return fixed(s.stat().joint_actual_position[j]); });
         }},
    {.name = "joint_velocity",
     .help = "Velocity of joints, units a second.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v,
                            [&s](std::size_t j) { return fixed(s.stat().joint[j].velocity); });
         }},
    {.name = "joint_limit",
     .help = "OK, MINSOFT, MAXSOFT, MINHARD or MAXHARD.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v, [&s](std::size_t j) -> std::string {
             const clients::JointStat& joint = s.stat().joint[j];
             return joint.min_hard_limit   ? "MINHARD"
                    : joint.max_hard_limit ? "MAXHARD"
                    : joint.min_soft_limit ? "MINSOFT"
                    : joint.max_soft_limit ? "MAXSOFT"
                                           : "OK";
           });
         }},
    {.name = "joint_fault",
     .help = "OK or FAULT, as the amplifier says.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v, [&s](std::size_t j) -> std::string {
             return s.stat().joint[j].fault ? "FAULT" : "OK";
           });
         }},
    {.name = "joint_homed",
     .help = "YES or NO.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v, [&s](std::size_t j) -> std::string {
             return s.stat().homed[j] != 0 ? "YES" : "NO";
           });
         }},
    {.name = "joint_type",
     .help = "LINEAR or ANGULAR.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v, [&s](std::size_t j) -> std::string {
             const int type = s.stat().joint[j].joint_type;
             return type == 1 ? "LINEAR" : type == 2 ? "ANGULAR" : "CUSTOM";
           });
         }},
    {.name = "joint_units",
     .help = "The unit of a joint's position.",
     .get_arguments = kOptionalJoint,
     .get =
         [](Session& s, const Values& v) {
           return per_joint(s, v, [&s](std::size_t j) {
             const clients::JointStat& joint = s.stat().joint[j];
             return joint.joint_type == 2 ? angular_units_name(joint.units)
                                          : linear_units_name(joint.units);
           });
         }},
    {.name = "home",
     .help = "Homes a joint, or all by their sequence (-1).",
     .set_arguments = kJoint,
     .set = home},
    {.name = "joint_home",
     .help = "Homes a joint, or all by their sequence (-1).",
     .set_arguments = kJoint,
     .set = home},
    {.name = "joint_unhome",
     .help = "Forgets that a joint, or all (-1), is homed.",
     .set_arguments = kJoint,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"unhome", v.text[0]});
         }},
    {.name = "joint_wait_homed",
     .help = "Waits until a joint, or all (-1, or none named), is homed.",
     .set_arguments = kOptionalJoint,
     .set =
         [](Session&, const Values& v) {
           const int wanted = v.index(0);
           return Done{.kind = Done::Kind::until, .why = {}, .holds = [wanted](const Stat& now) {
                         if (wanted >= 0) return now.homed[static_cast<std::size_t>(wanted)] != 0;
                         return std::all_of(now.homed.begin(), now.homed.begin() + now.joints,
                                            [](int homed) { return homed != 0; });
                       }};
         }},
    {.name = "jog",
     .help =
         "Jogs at a speed in units a minute, its sign is the direction, until JOG_STOP or the end "
         "of the connection.",
     .set_arguments = kJog,
     .set =
         [](Session& s, const Values& v) {
           Done done = s.task({"jog", jog_name(v), per_second(v.number[1]), "in-mode=on"});
           s.jogs = s.jogs || done.kind == Done::Kind::sent;
           return done;
         }},
    {.name = "jog_incr",
     .help =
         "Jogs a distance at a speed in units a minute; the sign of the speed is the direction.",
     .set_arguments = kJogIncrement,
     .set =
         [](Session& s, const Values& v) {
           return s.task(
               {"jog", jog_name(v), per_second(v.number[1]), exact(v.number[2]), "in-mode=on"});
         }},
    {.name = "jog_stop",
     .help = "Stops a jog.",
     .set_arguments = kWhat,
     .set =
         [](Session& s, const Values& v) {
           s.jogs = false;
           return s.task({"jog-stop", jog_name(v)});
         },
     .at_once = true},
    {.name = "teleop_enable",
     .help = "Whether jogs move axes (ON, all joints homed) or joints.",
     .get = [](Session& s, const Values&) { return on_off(s.stat().motion_mode == 3); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"teleop", v.text[0]});
         }},
    {.name = "override_limits",
     .help = "Allows jogging off a hard limit switch until the next jog ends.",
     .get =
         [](Session& s, const Values&) {
           return on_off(std::any_of(s.stat().joint.begin(), s.stat().joint.end(),
                                     [](const auto& joint) { return joint.override_limits; }));
         },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"override-limits", v.text[0]});
         }},
    {.name = "kinematics_type",
     .help = "1 identity, 2 forward only, 3 inverse only, 4 both.",
     .get = [](Session& s, const Values&) { return std::to_string(s.stat().kinematics_type); }},
};

}  // namespace

std::span<const Subcommand> motion_rows() { return kRows; }

}  // namespace kerf::rsh
