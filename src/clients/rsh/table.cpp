#include "clients/rsh/table.hpp"

#include <algorithm>

#include "clients/rsh/text.hpp"

namespace kerf::rsh {

namespace {

constexpr Command kCommands[]{
    {"hello", "Hello <password> <client name> <protocol version>",
     "Begins the dialogue. The password is that of option --connectpw. The answer is HELLO ACK "
     "with\n"
     "the server's name and version, or HELLO NAK."},
    {"get", "Get <subcommand> [arguments]", "Asks for a value."},
    {"set", "Set <subcommand> [arguments]", "Commands something; needs a HELLO."},
    {"shutdown", "Shutdown", "Ends the machine and all connections; needs SET ENABLE."},
    {"quit", "Quit", "Ends this connection."},
    {"help", "Help [command [subcommand]]", "Shows this list, or what is known of one name."},
};

/// Option-like: choices and names, required or not.
std::string form_of(std::span<const Argument> arguments) {
  std::string out;
  for (const Argument& a : arguments) {
    std::string inner = a.type == ArgumentType::choice ? a.choices : a.name;
    std::replace(inner.begin(), inner.end(), ',', '|');
    out += a.required ? " <" + inner + ">" : " [" + inner + "]";
  }
  return out;
}

std::string capitalised(std::string_view name) {
  std::string out(name);
  if (!out.empty()) out[0] = upper(out.substr(0, 1))[0];
  return out;
}

std::string list(bool set, bool free) {
  std::string out;
  for (const Subcommand& row : subcommands()) {
    if (set ? row.set == nullptr || row.free != free : row.get == nullptr) continue;
    out += "\n    " + form(row, set);
  }
  return out;
}

const std::vector<Subcommand>& all_rows() {
  static const std::vector<Subcommand> rows = [] {
    std::vector<Subcommand> all;
    for (const auto part : {session_rows(), machine_rows(), motion_rows(), program_rows()})
      all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end(), [](const Subcommand& a, const Subcommand& b) {
      return std::string_view(a.name) < b.name;
    });
    return all;
  }();
  return rows;
}

}  // namespace

std::span<const Subcommand> subcommands() { return all_rows(); }

const Subcommand* find_subcommand(std::string_view name) {
  const std::string wanted = lower(name);
  const auto& rows = all_rows();
  const auto at = std::lower_bound(
      rows.begin(), rows.end(), wanted,
      [](const Subcommand& row, const std::string& text) { return row.name < text; });
  return at != rows.end() && at->name == wanted ? &*at : nullptr;
}

std::span<const Command> commands() { return kCommands; }

std::string form(const Subcommand& row, bool set) {
  return capitalised(row.name) + form_of(set ? row.set_arguments : row.get_arguments);
}

std::string help_text(std::string_view topic) {
  std::string_view words = topic;
  const std::string first = lower(take_word(words));
  const std::string second = lower(take_word(words));
  if (first.empty()) {
    std::string out = "Available commands:";
    for (const Command& c : kCommands) out += std::string("\n  ") + c.form;
    return out;
  }
  if (second.empty()) {
    if (first == "get")
      return "Usage: Get <subcommand> [arguments]\n  Subcommands:" + list(false, false);
    if (first == "set")
      return "Usage: Set <subcommand> [arguments]\n  After HELLO:" + list(true, true) +
             "\n  After SET ENABLE:" + list(true, false);
    for (const Command& c : kCommands)
      if (first == c.name) return std::string("Usage: ") + c.form + "\n" + c.help;
  }
  const bool get = second.empty() || first == "get", set = second.empty() || first == "set";
  const Subcommand* row = find_subcommand(second.empty() ? first : second);
  if (row == nullptr || !(get || set)) return {};
  std::string out;
  if (get && row->get != nullptr) out += "Get " + form(*row, false) + "\n";
  if (set && row->set != nullptr) out += "Set " + form(*row, true) + "\n";
  return out.empty() ? out : "Usage: " + out + "  " + row->help;
}

std::string manual_list() {
  std::string out;
  for (const Subcommand& row : subcommands()) {
    out += ".TP\n";
    std::string heads;
    if (row.get != nullptr) heads += "get " + lower(row.name) + form_of(row.get_arguments);
    if (row.set != nullptr)
      heads += (heads.empty() ? "set " : "; set ") + lower(row.name) + form_of(row.set_arguments);
    // A minus sign in roff is a hyphen otherwise.
    std::string help = row.help;
    for (std::size_t at = 0; (at = help.find('-', at)) != std::string::npos; at += 2)
      help.insert(at, "\\");
    out += ".B ";
    out += heads;
    out += '\n';
    out += help;
    out += '\n';
  }
  return out;
}

}  // namespace kerf::rsh
