// The commands of the remote shell, declared once: parser, checks of arguments, HELP and the manual page's list are made from
// these rows.
//
// To add one: a row in rows_*.cpp. What it answers or does stands in the row.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/common/stat.hpp"

namespace kerf::rsh {

class Session;

enum class ArgumentType : std::uint8_t {
  choice,         ///< one of `choices`, in any case
  integer,        ///< also 0x1f
  number,         ///< a finite number
  joint,          ///< of this machine, or -1: all
  axis,           ///< a letter or 0 to 8, or -1: all
  spindle,        ///< of this machine, or -1: all
  joint_or_axis,  ///< a joint's number or an axis letter
  word,           ///< any text without blanks
  rest,           ///< all of the line that is left, as it was typed
};

struct Argument {
  const char* name;
  ArgumentType type{ArgumentType::word};
  bool required{true};
  const char* choices{""};  ///< "on,off"
};

/// What stood behind a subcommand, checked: value n belongs to argument n of the row.
struct Values {
  std::vector<std::string>
      text;  ///< as typed; of a choice in lower case; of an axis its upper-case letter
  std::vector<double> number;  ///< of numbers, joints, spindles, axes (0 to 8, -1 all)

  [[nodiscard]] bool has(std::size_t n) const { return n < text.size(); }
  [[nodiscard]] bool is(std::size_t n, std::string_view word) const {
    return has(n) && text[n] == word;
  }
  /// Joint, axis, spindle or integer; -1 when absent.
  [[nodiscard]] int index(std::size_t n) const {
    return n < number.size() ? static_cast<int>(number[n]) : -1;
  }
};

/// What became of a SET.
struct Done {
  enum class Kind : std::uint8_t {
    done,
    failed,    ///< `why` is shown behind "error: " when it is not empty
    sent,      ///< to task; the session waits as its wait mode says
    received,  ///< to task; nothing to wait for, whatever the mode
    until,     ///< `holds` becomes true
  };
  Kind kind{Kind::done};
  std::string why;
  std::uint64_t id{0};
  bool to_its_end{false};  ///< sent: wait for the end, whatever the mode
  std::function<bool(const clients::Stat&)> holds{};
};

struct Subcommand {
  const char* name;  ///< lower case
  const char* help;  ///< one sentence
  std::span<const Argument> get_arguments{};
  /// The answer behind the name, several lines separated by '\n'. Begins with '!': an error instead. null: no GET.
  std::string (*get)(Session&, const Values&){nullptr};
  std::span<const Argument> set_arguments{};
  Done (*set)(Session&, const Values&){nullptr};  ///< null: no SET
  bool free{false};                               ///< SET needs no ENABLE
  bool at_once{false};     ///< is carried out although the session waits for a command before it
  bool deprecated{false};  ///< answers with a warning
};

struct Command {
  const char* name;
  const char* form;  ///< as HELP shows it
  const char* help;
};

/// In order of their names.
[[nodiscard]] std::span<const Subcommand> subcommands();
/// By name in any case; null when there is none.
[[nodiscard]] const Subcommand* find_subcommand(std::string_view name);
[[nodiscard]] std::span<const Command> commands();
/// "Feed_override <percent>".
[[nodiscard]] std::string form(const Subcommand& row, bool set);
/// What HELP answers, lines separated by '\n'; "" when there is no such topic.
[[nodiscard]] std::string help_text(std::string_view topic);
/// The list of commands as it stands in the manual page (roff).
[[nodiscard]] std::string manual_list();

/// The rows by what they are about; see rows_*.cpp.
[[nodiscard]] std::span<const Subcommand> session_rows();
[[nodiscard]] std::span<const Subcommand> machine_rows();
[[nodiscard]] std::span<const Subcommand> motion_rows();
[[nodiscard]] std::span<const Subcommand> program_rows();

}  // namespace kerf::rsh
