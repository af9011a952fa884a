// Protocol between task and its clients: one JSON object a SOCK_SEQPACKET packet, service "task".
//
//   -> {"id":7,"cmd":"mdi","text":"G0 X10"}
//   <- {"id":7,"state":"received"}
//   <- {"id":7,"state":"running"}
//   <- {"id":7,"state":"done"}                  or "error" or "aborted", then with "text"
//
// Ids are the client's own and must grow on a connection; two connections may use the same ones. Every request gets exactly one
// terminal reply: done, error or aborted. Requests that are carried out at once get that reply alone. A packet that
// cannot be read is answered with id 0. When the connection ends, its jogs stop; everything else goes on.
//
// Commands are declared once, in the table behind commands(): parser, help texts and docs/protocol.md are made from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::task {

enum class CommandId : std::uint8_t {
  state,
  mode,
  home,
  unhome,
  jog,
  jog_stop,
  jog_keep,
  teleop,
  open,
  run,
  pause,
  resume,
  direction,
  away,
  back,
  exchange_tool,
  step,
  abort,
  mdi,
  feed_override,
  rapid_override,
  spindle_override,
  max_velocity,
  spindle,
  flood,
  mist,
  optional_stop,
  block_delete,
  override_limits,
  tool_table,
  tool_changed,
  answer,
  digital_out,
  analog_out,
  brake,
  feed_override_enable,
  adaptive_feed,
  feed_hold,
  spindle_override_enable,
  joint_limit,
  motion_mode,
  tool_offset,
  reset_interpreter,
  synch,
  debug,
  wait,
  errors,
  message,
  help,
};

enum class ArgumentType : std::uint8_t { text, number, integer, flag };

struct ArgumentInfo {
  const char* name;
  ArgumentType type{ArgumentType::text};
  bool required{false};
  const char* values{nullptr};  ///< "a|b|c": the texts that are allowed; null: any
  const char* help{""};         ///< with unit and default
};

struct CommandInfo {
  CommandId id;
  const char* name;
  const char* help;
  std::span<const ArgumentInfo> arguments;
};

/// The table, in the order of CommandId.
[[nodiscard]] std::span<const CommandInfo> commands() noexcept;
/// By name; null when there is none.
[[nodiscard]] const CommandInfo* find_command(std::string_view name) noexcept;
/// "mdi TEXT\n    help\n ..." of one command, or of all.
[[nodiscard]] std::string help_text(const CommandInfo& command);
[[nodiscard]] std::string help_text();
/// The same as a page of Markdown.
[[nodiscard]] std::string protocol_markdown();

struct ArgumentValue {
  bool present{false};
  std::string text;
  double number{0};  ///< flag: 0 or 1
};

/// One request, checked against the table: required arguments are there, types and allowed texts are right.
struct Request {
  std::uint64_t id{0};
  const CommandInfo* command{nullptr};
  std::vector<ArgumentValue> arguments;  ///< one a table row, in its order

  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::string_view name) const;  ///< "" when absent
  [[nodiscard]] double number(std::string_view name, double fallback = 0) const;
  [[nodiscard]] int integer(std::string_view name, int fallback = 0) const;
  [[nodiscard]] bool flag(std::string_view name, bool fallback = false) const;
};

/// Why a request was refused, with its id as far as that could be read.
struct RequestError {
  std::uint64_t id{0};
  std::string text;
};

/// From JSON. The error names what was expected and the nearest valid name.
[[nodiscard]] rtapi::Result<Request, RequestError> parse_request(std::string_view json);
/// JSON of a request from words as a person types them: {"jog", "x", "10"}; arguments by position or as name=value. An mdi
/// command takes all words behind it as its line, up to flags at the end (and-back=on).
[[nodiscard]] rtapi::Result<std::string> request_from_words(std::uint64_t id,
                                                            const std::vector<std::string>& words);
/// JSON of `{"id":id,"cmd":cmd}` with one text argument, the commonest case.
[[nodiscard]] std::string request_json(std::uint64_t id, std::string_view cmd);
[[nodiscard]] std::string request_json(std::uint64_t id, std::string_view cmd,
                                       std::string_view argument, std::string_view text);
/// A line for the operator (the command `message`).
[[nodiscard]] std::string message_json(std::uint64_t id, std::string_view text,
                                       std::string_view kind = "text");

enum class CommandState : std::uint8_t { received, running, done, error, aborted };
[[nodiscard]] const char* to_string(CommandState state) noexcept;
constexpr bool is_terminal(CommandState s) noexcept { return s >= CommandState::done; }

struct Reply {
  std::uint64_t id{0};
  CommandState state{CommandState::received};
  std::string text;  ///< why (error, aborted), or the answer of a question
};

[[nodiscard]] std::string format_reply(const Reply& reply);
[[nodiscard]] rtapi::Result<Reply> parse_reply(std::string_view json);

}  // namespace kerf::task
