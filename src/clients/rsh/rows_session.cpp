// Rows about the connection itself.
#include "clients/rsh/rows.hpp"

namespace kerf::rsh {
namespace {

using enum ArgumentType;

constexpr Argument kEnable[]{{"password or off", word}};
constexpr Argument kTimestamp[]{{"replies", choice, true, "on,off"},
                                {"echo", choice, false, "on,off"}};
constexpr Argument kWait[]{{"received or done", choice, true, "received,done"}};
constexpr Argument kTimeout[]{{"seconds", number}};
constexpr Argument kUpdate[]{{"none or auto", choice, true, "none,auto"}};
constexpr Argument kVersion[]{{"version", word, false}};
constexpr Argument kIni[]{{"variable", word}, {"section", word}};
constexpr Argument kDebug[]{{"level", integer}};

std::string or_ok(const std::string& text) { return text.empty() ? "OK" : text; }

constexpr Subcommand kRows[]{
    {.name = "echo",
     .help = "Whether lines are sent back as they came. On at first; needs a HELLO to take effect.",
     .get = [](Session& s, const Values&) { return on_off(s.settings.echo); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           s.settings.echo = v.is(0, "on");
           return Done{};
         },
     .free = true},
    {.name = "verbose",
     .help = "Whether a SET that went well is answered too. Off at first.",
     .get = [](Session& s, const Values&) { return on_off(s.settings.verbose); },
     .set_arguments = kOnOff,
     .set =
         [](Session& s, const Values& v) {
           s.settings.verbose = v.is(0, "on");
           return Done{};
         },
     .free = true},
    {.name = "timestamp",
     .help = "Whether replies, and echoed lines, begin with the time as GET TIME shows it.",
     .get =
         [](Session& s, const Values&) {
           return on_off(s.settings.timestamp) + " " + on_off(s.settings.timestamp_echo);
         },
     .set_arguments = kTimestamp,
     .set =
         [](Session& s, const Values& v) {
           s.settings.timestamp = v.is(0, "on");
           if (v.has(1)) s.settings.timestamp_echo = v.is(1, "on");
           return Done{};
         },
     .free = true},
    {.name = "enable",
     .help = "Whether this connection may command the machine; OFF gives that up.",
     .get = [](Session& s, const Values&) { return on_off(s.enabled); },
     .set_arguments = kEnable,
     .set =
         [](Session& s, const Values& v) {
           const bool off = lower(v.text[0]) == "off";
           if (!off && v.text[0] != s.shell().enable_password)
             return Done{.kind = Done::Kind::failed, .why = {}};
           s.enabled = !off;
           return Done{};
         },
     .free = true},
    {.name = "disable",
     .help = "This connection commands the machine no more.",
     .set =
         [](Session& s, const Values&) {
           s.enabled = false;
           return Done{};
         },
     .free = true},
    {.name = "clients",
     .help = "All connections: number, name, LINKED after a good HELLO, ENABLED for commands.",
     .get =
         [](Session& s, const Values&) {
           std::string out;
           for (const Session* one : s.shell().sessions)
             out += (out.empty() ? "" : "\n") + std::to_string(one->number()) + " '" +
                    shown(one->client) + "' " + (one->linked ? "LINKED" : "UNLINKED") + " " +
                    (one->enabled ? "ENABLED" : "DISABLED");
           return out;
         }},
    {.name = "wait_mode",
     .help = "Whether a SET waits until the command was DONE (at first) or only RECEIVED.",
     .get = [](Session& s, const Values&) -> std::string {
       return s.settings.wait_done ? "DONE" : "RECEIVED";
     },
     .set_arguments = kWait,
     .set =
         [](Session& s, const Values& v) {
           s.settings.wait_done = v.is(0, "done");
           return Done{};
         },
     .free = true},
    {.name = "wait",
     .help = "Waits until the command before it was received or done.",
     .set_arguments = kWait,
     .set = [](Session& s, const Values& v) { return s.wait_for_last(v.is(0, "done")); }},
    {.name = "wait_heartbeat",
     .help = "Waits until task has run once more.",
     .set =
         [](Session& s, const Values&) {
           const auto before = s.machine().stat().heartbeat;
           return Done{
               .kind = Done::Kind::until, .why = {}, .holds = [before](const clients::Stat& now) {
                 return now.heartbeat != before;
               }};
         },
     .free = true},
    {.name = "timeout",
     .help = "Seconds that a SET waits; 0 (at first) or less: for ever.",
     .get = [](Session& s, const Values&) { return fixed(s.settings.timeout_s); },
     .set_arguments = kTimeout,
     .set =
         [](Session& s, const Values& v) {
           s.settings.timeout_s = v.number[0] > 0 ? v.number[0] : 0;
           return Done{};
         },
     .free = true},
    {.name = "update",
     .help =
         "Whether GET answers with what is true now (AUTO, at first) or as of SET UPDATE_STATUS.",
     .get = [](Session& s, const Values&) -> std::string {
       return s.settings.update ? "AUTO" : "NONE";
     },
     .set_arguments = kUpdate,
     .set =
         [](Session& s, const Values& v) {
           s.settings.update = v.is(0, "auto");
           s.freeze();
           return Done{};
         },
     .free = true},
    {.name = "update_status",
     .help = "Takes what GET answers with when UPDATE is NONE.",
     .set =
         [](Session& s, const Values&) {
           s.freeze();
           return Done{};
         },
     .free = true},
    {.name = "error",
     .help = "The oldest error that this connection has not asked for yet, or OK.",
     .get = [](Session& s,
               const Values&) { return or_ok(s.take_message(Session::Messages::error)); }},
    {.name = "operator_text",
     .help = "The oldest text for the operator that was not asked for yet, or OK.",
     .get = [](Session& s,
               const Values&) { return or_ok(s.take_message(Session::Messages::text)); }},
    {.name = "operator_display",
     .help = "The oldest display line for the operator that was not asked for yet, or OK.",
     .get = [](Session& s,
               const Values&) { return or_ok(s.take_message(Session::Messages::display)); }},
    {.name = "time",
     .help = "Seconds since 1970.",
     .get = [](Session& s, const Values&) { return fixed(s.machine().wall_time_s()); }},
    {.name = "plat",
     .help = "The platform.",
     .get = [](Session&, const Values&) -> std::string { return "Linux"; }},
    {.name = "comm_prot",
     .help = "The version of this protocol.",
     .get = [](Session&, const Values&) -> std::string { return "1.1"; },
     .set_arguments = kVersion,
     .set = [](Session&, const Values&) { return Done{}; },
     .free = true,
     .deprecated = true},
    {.name = "inifile",
     .help = "The machine's INI file.",
     .get = [](Session& s, const Values&) { return s.machine().ini_name(); }},
    {.name = "ini",
     .help = "A value of the machine's INI file.",
     .get_arguments = kIni,
     .get =
         [](Session& s, const Values& v) {
           const std::string entry = "[" + shown(v.text[1]) + "]" + shown(v.text[0]);
           const auto value = s.machine().ini(v.text[1], v.text[0]);
           return value ? entry + "=" + *value : "!INI file entry '" + entry + "' not found";
         }},
    {.name = "debug",
     .help = "The debug level, as [EMC]DEBUG.",
     .get =
         [](Session& s, const Values&) {
           char text[20];
           std::snprintf(text, sizeof text, "0x%08x", static_cast<unsigned>(s.stat().debug));
           return std::string(text);
         },
     .set_arguments = kDebug,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"debug", std::to_string(static_cast<int>(static_cast<std::uint32_t>(
                                       static_cast<long>(v.number[0]))))});
         }},
};

}  // namespace

std::span<const Subcommand> session_rows() { return kRows; }

}  // namespace kerf::rsh
