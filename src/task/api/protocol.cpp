#include "task/api/protocol.hpp"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "rtapi/base/suggest.hpp"
#include "task/api/message_reader.hpp"

namespace kerf::task {
namespace {

using nlohmann::json;
using enum ArgumentType;

constexpr const char* kOnOff = "on|off";

constexpr ArgumentInfo kStateArgs[]{
    {"state", text, true, "estop|estop-reset|off|on", "the machine state wanted"}};
constexpr ArgumentInfo kModeArgs[]{
    {"mode", text, true, "manual|auto|mdi", "needs an idle machine"}};
constexpr ArgumentInfo kJointArgs[]{
    {"joint", integer, false, nullptr, "joint number; -1 (default): all, by HOME_SEQUENCE"}};
constexpr ArgumentInfo kUnhomeArgs[]{
    {"joint", integer, false, nullptr,
     "joint number; -1 (default): all, -2: those with VOLATILE_HOME"}};
constexpr ArgumentInfo kJogArgs[]{
    {"what", text, true, nullptr, "axis letter or joint number"},
    {"speed", number, true, nullptr, "machine units a second; its sign is the direction"},
    {"distance", number, false, nullptr,
     "machine units; absent: until jog-stop or the end of the connection"},
    {"lease", number, false, nullptr,
     "seconds, at least 0.05, of a jog without distance: it also stops when this connection says "
     "nothing, at least jog-keep, for so long"},
    {"in-mode", flag, false, kOnOff,
     "on: only in manual mode, an axis in teleop mode and a joint in joint mode; off (default): "
     "goes "
     "there"}};
constexpr ArgumentInfo kJogStopArgs[]{
    {"what", text, false, nullptr, "axis letter or joint number; absent: all"}};
constexpr ArgumentInfo kTeleopArgs[]{
    {"on", flag, true, kOnOff, "on: jog along axes (all joints homed); off: jog joints"}};
constexpr ArgumentInfo kFileArgs[]{
    {"file", text, true, nullptr,
     "G-code file; a relative name is searched in [DISPLAY]PROGRAM_PREFIX"}};
constexpr ArgumentInfo kRunArgs[]{
    {"line", integer, false, "",
     "0 (default): from the start; else the program is read to this line without moving, and the "
     "machine brought to the state that the line needs"},
    {"then", text, false, "run|hold|check",
     "at the line: go on (default); wait for resume; or only tell what differs"}};
constexpr ArgumentInfo kMdiArgs[]{
    {"text", text, true, nullptr, "one line of G-code"},
    {"in-mode", flag, false, kOnOff, "on: only in MDI mode; off (default): goes there from manual"},
    {"and-back", flag, false, kOnOff,
     "on: runs in MDI mode, and when nothing runs any more the mode "
     "that was there before comes back"}};
constexpr ArgumentInfo kScaleArgs[]{{"value", number, true, nullptr, "1 = as programmed"}};
constexpr ArgumentInfo kSpindleScaleArgs[]{
    {"value", number, true, nullptr, "1 = as programmed"},
    {"spindle", integer, false, nullptr, "0 (default) and up"}};
constexpr ArgumentInfo kVelocityArgs[]{{"value", number, true, nullptr, "machine units a second"}};
constexpr ArgumentInfo kSpindleArgs[]{
    {"action", text, true, "forward|reverse|off|increase|decrease|constant",
     "increase and decrease step by [SPINDLE_n]INCREMENT; constant keeps the speed"},
    {"speed", number, false, nullptr, "rpm; absent: the last S"},
    {"spindle", integer, false, nullptr, "0 (default) and up"}};
constexpr ArgumentInfo kSwitchArgs[]{{"on", flag, true, kOnOff, ""}};
constexpr ArgumentInfo kAnswerArgs[]{
    {"prompt", integer, false, nullptr, "number of the question; absent: whichever is asked"}};
constexpr ArgumentInfo kDirectionArgs[]{{"way", text, true, "forward|reverse", ""}};
constexpr ArgumentInfo kExchangeArgs[]{
    {"tool", integer, false, nullptr,
     "its number in the tool table; absent: the number stays, and the table has its new length"}};
constexpr ArgumentInfo kOutputArgs[]{
    {"index", integer, true, nullptr, "number of motion.digital-out-NN"},
    {"on", flag, true, kOnOff, ""}};
constexpr ArgumentInfo kAnalogArgs[]{
    {"index", integer, true, nullptr, "number of motion.analog-out-NN"},
    {"value", number, true, nullptr, ""}};
constexpr ArgumentInfo kSpindleSwitchArgs[]{
    {"on", flag, true, kOnOff, ""}, {"spindle", integer, false, nullptr, "0 (default) and up"}};
constexpr ArgumentInfo kLimitArgs[]{
    {"joint", integer, true, nullptr, "joint number"},
    {"min", number, false, nullptr, "machine units; absent: as it is"},
    {"max", number, false, nullptr, "machine units; absent: as it is"}};
constexpr ArgumentInfo kMotionModeArgs[]{
    {"mode", text, true, "free|coordinated|teleop", "joints, the path, or axes"}};
constexpr ArgumentInfo kToolOffsetArgs[]{
    {"tool", integer, true, nullptr, "its number; a new one is added"},
    {"z", number, true, nullptr, "Z offset in machine units"},
    {"x", number, true, nullptr, "X offset in machine units"},
    {"diameter", number, true, nullptr, "machine units"},
    {"front", number, true, nullptr, "front angle in degrees"},
    {"back", number, true, nullptr, "back angle in degrees"},
    {"orientation", integer, true, nullptr, "0 to 9"}};
constexpr ArgumentInfo kDebugArgs[]{
    {"level", integer, true, nullptr, "bits as in [EMC]DEBUG; shown in the status, nothing else"}};
constexpr ArgumentInfo kErrorsArgs[]{
    {"since", integer, false, nullptr,
     "number of the last message that is known; 0 (default): all that are kept"}};
constexpr ArgumentInfo kMessageArgs[]{
    {"text", text, true, nullptr, "a line for the operator"},
    {"kind", text, false, "error|text|display", "text by default"}};

constexpr CommandInfo kCommands[]{
    {CommandId::state, "state",
     "Estop, estop reset, drives off, drives on. estop works always and at once.", kStateArgs},
    {CommandId::mode, "mode", "Changes the operating mode.", kModeArgs},
    {CommandId::home, "home", "Homes one joint or all. Done when homed.", kJointArgs},
    {CommandId::unhome, "unhome", "Forgets that joints are homed. Needs joint mode, or drives off.",
     kUnhomeArgs},
    {CommandId::jog, "jog",
     "Jogs. A jog without distance ends with the connection that asked for it.", kJogArgs},
    {CommandId::jog_stop, "jog-stop", "Stops jogs. Works always.", kJogStopArgs},
    {CommandId::jog_keep,
     "jog-keep",
     "Nothing but a sign of life: the jogs of this connection that have a lease go on.",
     {}},
    {CommandId::teleop, "teleop", "Changes between jogging joints and jogging axes (manual mode).",
     kTeleopArgs},
    {CommandId::open, "open", "Opens a program.", kFileArgs},
    {CommandId::run, "run", "Runs the open program. Done when it has ended.", kRunArgs},
    {CommandId::pause, "pause", "Stops motion on the path; resume goes on.", {}},
    {CommandId::resume, "resume", "Goes on after pause, step, M0, M1 and M60.", {}},
    {CommandId::direction, "direction",
     "Which way resume runs the path of the held program: back over what motion remembers of it, "
     "to "
     "where that begins, or forwards again. Forwards at the start of each program.",
     kDirectionArgs},
    {CommandId::away,
     "away",
     "Pauses and frees the axes for jogs beside the path. Done when they may be jogged; return "
     "leads "
     "back.",
     {}},
    {CommandId::back,
     "return",
     "Back to where away left the path: along the tool axis out, across, and in again. Done there; "
     "resume goes on.",
     {}},
    {CommandId::exchange_tool, "exchange-tool",
     "While away: another tool stands in the spindle. The tool table is read again, and return and "
     "resume lead its tip along the rest of the path, whatever its length is.",
     kExchangeArgs},
    {CommandId::step, "step", "Executes one block of the program and pauses.", {}},
    {CommandId::abort,
     "abort",
     "Stops motion, spindles and coolant and ends whatever runs. Done at rest.",
     {}},
    {CommandId::mdi, "mdi", "Executes a line of G-code. Done when all it asked for is done.",
     kMdiArgs},
    {CommandId::feed_override, "feed-override",
     "Feed override, at most [DISPLAY]MAX_FEED_OVERRIDE.", kScaleArgs},
    {CommandId::rapid_override, "rapid-override", "Override of rapid moves, at most 1.",
     kScaleArgs},
    {CommandId::spindle_override, "spindle-override",
     "Spindle speed override, within [DISPLAY]MIN_/MAX_SPINDLE_OVERRIDE.", kSpindleScaleArgs},
    {CommandId::max_velocity, "max-velocity", "The operator's limit of the path velocity.",
     kVelocityArgs},
    {CommandId::spindle, "spindle",
     "Turns or stops a spindle by hand (idle machine; off works always).", kSpindleArgs},
    {CommandId::flood, "flood", "Flood coolant by hand.", kSwitchArgs},
    {CommandId::mist, "mist", "Mist coolant by hand.", kSwitchArgs},
    {CommandId::optional_stop, "optional-stop",
     "Whether M1 pauses (on at the start); looked at when M1 is reached.", kSwitchArgs},
    {CommandId::block_delete, "block-delete",
     "Whether lines that begin with / are skipped (on at the start); for lines not read yet.",
     kSwitchArgs},
    {CommandId::override_limits, "override-limits",
     "Allows jogging off a hard limit switch until the next jog ends.", kSwitchArgs},
    {CommandId::tool_table, "tool-table", "Reads the tool table file again (idle machine).", {}},
    {CommandId::tool_changed,
     "tool-changed",
     "The operator has changed (or prepared) the tool that is waited for: as "
     "iocontrol.0.tool-changed does.",
     {}},
    {CommandId::answer, "answer",
     "The operator's yes to the question of status: M0, M1 and M60 go on, the tool of M6 is there.",
     kAnswerArgs},
    {CommandId::digital_out, "digital-out", "Sets a motion.digital-out-NN at once.", kOutputArgs},
    {CommandId::analog_out, "analog-out", "Sets a motion.analog-out-NN at once.", kAnalogArgs},
    {CommandId::brake, "brake",
     "Engages a spindle's brake, which stops the spindle, or releases it until the next order.",
     kSpindleSwitchArgs},
    {CommandId::feed_override_enable, "feed-override-enable",
     "Whether the feed override counts, as M50.", kSwitchArgs},
    {CommandId::adaptive_feed, "adaptive-feed", "Whether motion.adaptive-feed counts, as M52.",
     kSwitchArgs},
    {CommandId::feed_hold, "feed-hold", "Whether motion.feed-hold counts, as M53.", kSwitchArgs},
    {CommandId::spindle_override_enable, "spindle-override-enable",
     "Whether the spindle speed override counts, as M51.", kSpindleSwitchArgs},
    {CommandId::joint_limit, "joint-limit",
     "Changes a joint's soft limits until the machine is started anew. In force at rest.",
     kLimitArgs},
    {CommandId::motion_mode, "motion-mode", "Changes how motion is asked for, as teleop does.",
     kMotionModeArgs},
    {CommandId::tool_offset, "tool-offset", "Writes one tool into the tool table and saves it.",
     kToolOffsetArgs},
    {CommandId::reset_interpreter,
     "reset-interpreter",
     "Forgets the interpreter's modal state (idle machine).",
     {}},
    {CommandId::synch,
     "synch",
     "The interpreter looks anew where the machine stands (idle machine).",
     {}},
    {CommandId::debug, "debug", "Sets the debug level that the status shows.", kDebugArgs},
    {CommandId::wait, "wait", "Done when nothing runs any more and the machine is at rest.", {}},
    {CommandId::errors, "errors", "Gives the operator messages behind a cursor, as JSON text.",
     kErrorsArgs},
    {CommandId::message, "message", "Shows a line to the operator.", kMessageArgs},
    {CommandId::help, "help", "Gives this table as text.", {}},
};

bool allowed(const char* values, std::string_view value) {
  if (values == nullptr || *values == '\0') return true;
  std::string_view rest(values);
  for (;;) {
    const auto bar = rest.find('|');
    if (rest.substr(0, bar) == value) return true;
    if (bar == std::string_view::npos) return false;
    rest.remove_prefix(bar + 1);
  }
}

std::vector<std::string_view> split(const char* values) {
  std::vector<std::string_view> out;
  std::string_view rest(values == nullptr ? "" : values);
  while (!rest.empty()) {
    const auto bar = rest.find('|');
    out.push_back(rest.substr(0, bar));
    if (bar == std::string_view::npos) break;
    rest.remove_prefix(bar + 1);
  }
  return out;
}

const char* type_name(ArgumentType type) {
  switch (type) {
    case text: return "a text";
    case number: return "a number";
    case integer: return "a whole number";
    case flag: return "true or false";
  }
  return "";
}

/// Fills `out` from JSON; "" or what is wrong.
std::string take_argument(const CommandInfo& command, const ArgumentInfo& info, const json& value,
                          ArgumentValue& out) {
  out.present = true;
  const auto wrong = [&] {
    return std::string(command.name) + ": " + info.name + " = " + value.dump() + ": expected " +
           type_name(info.type);
  };
  switch (info.type) {
    case text: {
      if (value.is_number_integer())
        out.text = value.dump();  // a joint number as "what"
      else if (value.is_string())
        out.text = value.get<std::string>();
      else
        return wrong();
      if (!allowed(info.values, out.text))
        return std::string(command.name) + ": " + info.name + " = '" + out.text + "': expected " +
               info.values + rtapi::did_you_mean(out.text, split(info.values));
      return {};
    }
    case number:
    case integer:
      if (!value.is_number()) return wrong();
      out.number = value.get<double>();
      if (!std::isfinite(out.number)) return wrong();
      if (info.type == integer &&
          (out.number != std::floor(out.number) || std::fabs(out.number) > 2e9))
        return wrong();
      return {};
    case flag:
      if (value.is_boolean())
        out.number = value.get<bool>() ? 1 : 0;
      else if (value.is_number_integer())
        out.number = value.get<int>() != 0 ? 1 : 0;
      else if (value == "on")
        out.number = 1;
      else if (value == "off")
        out.number = 0;
      else
        return wrong();
      return {};
  }
  return {};
}

std::vector<std::string_view> command_names() {
  std::vector<std::string_view> names;
  for (const auto& c : kCommands) names.emplace_back(c.name);
  return names;
}

std::string unknown_command(std::string_view name) {
  return "unknown command '" + std::string(name) + "'" + rtapi::did_you_mean(name, command_names());
}

const ArgumentValue* find_value(const Request& request, std::string_view name) {
  for (std::size_t i = 0; i < request.command->arguments.size(); ++i)
    if (name == request.command->arguments[i].name) return &request.arguments[i];
  return nullptr;
}

/// A word that a person typed, as the JSON value of an argument.
json word_value(const ArgumentInfo& info, const std::string& word) {
  if (info.type == text) return word;
  if (info.type == flag) {
    if (word == "on" || word == "1" || word == "true") return true;
    if (word == "off" || word == "0" || word == "false") return false;
    return word;
  }
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (end == word.c_str() || *end != '\0') return word;  // the parser's message names it
  return value;
}

std::string dump(const json& j) { return j.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

std::span<const CommandInfo> commands() noexcept { return kCommands; }

const CommandInfo* find_command(std::string_view name) noexcept {
  for (const auto& c : kCommands)
    if (name == c.name) return &c;
  return nullptr;
}

std::string help_text(const CommandInfo& command) {
  std::string head = command.name;
  std::string rows;
  for (const auto& a : command.arguments) {
    const std::string shown =
        a.values != nullptr && *a.values != '\0' ? std::string(a.values) : std::string(a.name);
    head += a.required ? " " + shown : " [" + shown + "]";
    if (*a.help != '\0') rows += std::string("      ") + a.name + ": " + a.help + "\n";
  }
  return head + "\n    " + command.help + "\n" + rows;
}

std::string help_text() {
  std::string out;
  for (const auto& c : kCommands) out += help_text(c);
  return out;
}

std::string protocol_markdown() {
  std::string out =
      "# Commands of task\n\nMade from the table in `src/task/api/protocol.cpp`.\n\n| command | "
      "arguments | effect |\n|---|---|---|\n";
  for (const auto& c : kCommands) {
    out += std::string("| `") + c.name + "` | ";
    for (const auto& a : c.arguments) {
      out += std::string("`") + a.name + "` (" + type_name(a.type) +
             (a.required ? "" : ", optional") + ")";
      if (a.values != nullptr && *a.values != '\0') {
        std::string values(a.values);
        for (std::size_t at = 0; (at = values.find('|', at)) != std::string::npos; at += 2)
          values.replace(at, 1, ", ");
        out += " " + values;
      }
      if (*a.help != '\0') out += std::string(": ") + a.help;
      out += "<br>";
    }
    out += std::string(" | ") + c.help + " |\n";
  }
  return out;
}

bool Request::has(std::string_view name) const {
  const auto* v = find_value(*this, name);
  return v != nullptr && v->present;
}
const std::string& Request::text(std::string_view name) const {
  static const std::string none;
  const auto* v = find_value(*this, name);
  return v != nullptr ? v->text : none;
}
double Request::number(std::string_view name, double fallback) const {
  const auto* v = find_value(*this, name);
  return v != nullptr && v->present ? v->number : fallback;
}
int Request::integer(std::string_view name, int fallback) const {
  return static_cast<int>(number(name, fallback));
}
bool Request::flag(std::string_view name, bool fallback) const {
  return number(name, fallback ? 1 : 0) != 0;
}

rtapi::Result<Request, RequestError> parse_request(std::string_view packet) {
  const json j = json::parse(packet, nullptr, false);
  if (!j.is_object())
    return rtapi::Failure<RequestError>{
        {0, "not a JSON object: expected {\"id\":1,\"cmd\":\"...\"}"}};
  Request request;
  const auto refuse = [&](std::string why) {
    return rtapi::Failure<RequestError>{{request.id, std::move(why)}};
  };
  if (const auto id = j.find("id"); id != j.end() && id->is_number_unsigned())
    request.id = id->get<std::uint64_t>();
  if (request.id == 0) return refuse("no id: expected a whole number above 0");
  const auto cmd = j.find("cmd");
  if (cmd == j.end() || !cmd->is_string()) return refuse("no cmd: expected the name of a command");
  const auto name = cmd->get<std::string>();
  request.command = find_command(name);
  if (request.command == nullptr) return refuse(unknown_command(name));
  const auto table = request.command->arguments;
  request.arguments.resize(table.size());
  for (const auto& [key, value] : j.items()) {
    if (key == "id" || key == "cmd") continue;
    std::size_t at = 0;
    while (at < table.size() && key != table[at].name) ++at;
    if (at == table.size()) {
      std::vector<std::string_view> names;
      for (const auto& a : table) names.emplace_back(a.name);
      return refuse(std::string(name)
                        .append(": unknown argument '")
                        .append(key)
                        .append("'")
                        .append(rtapi::did_you_mean(key, names)));
    }
    if (auto complaint = take_argument(*request.command, table[at], value, request.arguments[at]);
        !complaint.empty())
      return refuse(std::move(complaint));
  }
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].required && !request.arguments[i].present)
      return refuse(name + ": " + table[i].name + " is missing: expected " +
                    type_name(table[i].type) +
                    (table[i].values != nullptr && *table[i].values != '\0'
                         ? std::string(", one of ") + table[i].values
                         : std::string()));
  return request;
}

rtapi::Result<std::string> request_from_words(std::uint64_t id,
                                              const std::vector<std::string>& words) {
  using rtapi::Errc;
  if (words.empty() || words[0].empty()) return rtapi::fail(Errc::bad_argument, "no command");
  const CommandInfo* command = find_command(words[0]);
  if (command == nullptr) return rtapi::fail(Errc::bad_argument, unknown_command(words[0]));
  json j{{"id", id}, {"cmd", words[0]}};
  if (command->id == CommandId::mdi || command->id == CommandId::message) {
    // Behind the text, words that name another argument: G-code has none such.
    std::size_t end = words.size();
    for (; end > 2; --end) {
      const auto equal = words[end - 1].find('=');
      const ArgumentInfo* info = nullptr;
      for (const auto& a : command->arguments)
        if (a.type == ArgumentType::flag && words[end - 1].substr(0, equal) == a.name) info = &a;
      if (info == nullptr || equal == std::string::npos) break;
      j[info->name] = word_value(*info, words[end - 1].substr(equal + 1));
    }
    std::string all;
    for (std::size_t i = 1; i < end; ++i) all += (i > 1 ? " " : "") + words[i];
    if (words.size() > 1) j["text"] = all;
  } else {
    std::size_t position = 0;
    for (std::size_t i = 1; i < words.size(); ++i) {
      std::string name, value = words[i];
      if (const auto equal = words[i].find('='); equal != std::string::npos) {
        for (const auto& a : command->arguments)
          if (words[i].substr(0, equal) == a.name)
            name = a.name, value = words[i].substr(equal + 1);
      }
      const ArgumentInfo* info = nullptr;
      for (const auto& a : command->arguments)
        if (name == a.name) info = &a;
      if (info == nullptr && position < command->arguments.size())
        info = &command->arguments[position++];
      if (info == nullptr)
        return rtapi::fail(Errc::bad_argument, words[0] + ": too many arguments at '" + words[i] +
                                                   "'; expected: " + help_text(*command));
      j[info->name] = word_value(*info, value);
    }
  }
  std::string out = dump(j);
  if (auto checked = parse_request(out); !checked.ok())
    return rtapi::fail(Errc::bad_argument, checked.error().text);
  return out;
}

std::string request_json(std::uint64_t id, std::string_view cmd) {
  return dump(json{{"id", id}, {"cmd", cmd}});
}

std::string request_json(std::uint64_t id, std::string_view cmd, std::string_view argument,
                         std::string_view value) {
  json j{{"id", id}, {"cmd", cmd}};
  j[std::string(argument)] = value;
  return dump(j);
}

std::string message_json(std::uint64_t id, std::string_view text, std::string_view kind) {
  return dump(json{{"id", id}, {"cmd", "message"}, {"text", text}, {"kind", kind}});
}

const char* to_string(CommandState state) noexcept {
  switch (state) {
    case CommandState::received: return "received";
    case CommandState::running: return "running";
    case CommandState::done: return "done";
    case CommandState::error: return "error";
    case CommandState::aborted: return "aborted";
  }
  return "error";
}

std::string format_reply(const Reply& reply) {
  json j{{"id", reply.id}, {"state", to_string(reply.state)}};
  if (!reply.text.empty()) j["text"] = reply.text;
  return dump(j);
}

rtapi::Result<Reply> parse_reply(std::string_view packet) {
  const json j = json::parse(packet, nullptr, false);
  Reply reply;
  if (!j.is_object() || !j.contains("id") || !j["id"].is_number_unsigned() ||
      !j.contains("state") || !j["state"].is_string())
    return rtapi::fail(rtapi::Errc::protocol, "task sent something that is no reply");
  reply.id = j["id"].get<std::uint64_t>();
  const auto state = j["state"].get<std::string>();
  for (const auto s : {CommandState::received, CommandState::running, CommandState::done,
                       CommandState::error, CommandState::aborted}) {
    if (state != to_string(s)) continue;
    reply.state = s;
    if (const auto at = j.find("text"); at != j.end() && at->is_string())
      reply.text = at->get<std::string>();
    return reply;
  }
  return rtapi::fail(rtapi::Errc::protocol, "task sent an unknown state '" + state + "'");
}

std::string format_messages(const std::vector<OperatorMessage>& messages) {
  json out = json::array();
  for (const auto& m : messages)
    out.push_back({{"number", m.number},
                   {"kind", static_cast<int>(m.kind)},
                   {"text", m.text.view()},
                   {"file", m.file.view()},
                   {"line", m.line},
                   {"time_ns", m.time_ns}});
  return dump(out);
}

}  // namespace kerf::task
