#include "launcher/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "ini/keys.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

namespace {

constexpr const char* kVersion = "kerf 0.1.0";

constexpr const char* kAbout =
    "Starts the machine that an INI file describes, and watches over it.\n"
    "  kerf INI          start; at a terminal type G-code, end with Ctrl-D or Ctrl-C\n"
    "  kerf check INI    read the files and report what is wrong, without starting\n"
    "  kerf resume INI   tell what was running when the power went; --run goes on with it\n"
    "  kerf record dump FILE | show FILE; kerf replay FILE\n"
    "                    the last minute before a fault: docs/flight-record.md\n"
    "  kerf keys [WORD]  explain the INI keys that contain all words; --tsv prints the whole table";

constexpr const char* kFooter =
    "With --program the machine is switched on and homed, and the program runs at once; a summary\n"
    "and a drawing of the tool path (toolpath.svg) follow. --once then ends the machine.\n"
    "\n"
    "Exit codes\n"
    "  0  ended as asked: --once ran its program to the end; else by the operator or a signal\n"
    "  1  the files have errors, the start or the program failed, a part of the machine died, or\n"
    "     --once was interrupted\n"
    "  2  wrong use of the command line";

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

/// A module by its name and parameters; "" or why it cannot be had. Planner and homing are part of Kerf's motion controller.
std::string check_planner(const std::string& words) {
  const std::string name = words.substr(0, words.find(' '));
  if (name == "tpmod") return {};
  return "'" + name +
         "': Kerf's planner is part of its motion controller and cannot be exchanged for a module; "
         "only 'tpmod', its own, is accepted";
}

/// "-t MODULE a=b c=d" as "-t" and "MODULE a=b c=d": parameters of a module are words of their own.
void join_module_words(std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (arguments[i] != "-t" && arguments[i] != "-m") continue;
    std::string& module = arguments[++i];
    while (i + 1 < arguments.size() && arguments[i + 1].front() != '-' &&
           arguments[i + 1].find('=') != std::string::npos) {
      module += ' ' + arguments[i + 1];
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }
}

void declare(CLI::App& app, Options& o) {
  app.add_option("INI", o.ini, "INI file of the machine")->type_name("");
  app.add_flag("-l", o.last_used, "Start the INI file of the last start again");
  app.add_option("-t", "Planner module and its parameters; only tpmod, the own one")
      ->type_name("TPMOD")
      ->check(check_planner);
  app.add_option(
         "-m", o.homing_module,
         "Homing module and its parameters, instead of [EMCMOT]HOMEMOD; homemod is the own one")
      ->type_name("HOMEMOD");
  app.add_option("--program", o.program, "G-code file to run")->type_name("FILE");
  app.add_flag("--once", o.once,
               "Run the program (default: [DISPLAY]OPEN_FILE), print the summary and end");
  app.add_flag("--virtual", o.virtual_time,
               "Virtual time: as fast as the processor allows, the same motion every time");
  app.add_option("--speed", o.speed, "Virtual time, at most X seconds of it in a real one")
      ->type_name("X")
      ->check(CLI::PositiveNumber);
  app.add_flag("--run", o.resume_run,
               "With kerf resume: the running machine goes on with the program, by run from line");
  app.add_option("--instance", o.instance, "Name, so that several machines run on one PC")
      ->type_name("NAME");
  app.add_option("--log-joints", o.log_joints, "Write each servo cycle's joint positions")
      ->type_name("FILE");
  app.add_option("--svg", o.svg, "Where the drawing goes (default: toolpath.svg)")
      ->type_name("FILE");
  app.add_option(
         "-H", o.hal_dirs,
         "Folder to search for HAL files first; may be repeated, the last one is searched first")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_flag("-k", o.ignore_hal_errors, "Go on when a HAL file has errors");
  app.add_flag("-v,-d,--verbose", o.verbose, "Say what is being done");
  // Known to scripts that start the machine by the name linuxcnc; output is never redirected here.
  app.add_flag_callback(
      "-r", [] {}, "Accepted, without effect");
  app.set_version_flag("--version", kVersion);
}

ParseEnd explain_keys(const std::vector<std::string>& words) {
  const ini::KeyTable& table = ini::machine_keys();
  if (words.size() == 1 && words.front() == "--tsv") return {kExitOk, ini::keys_as_tsv(table)};
  for (const std::string& word : words)
    if (word.rfind('-', 0) == 0)
      return {word == "--help" || word == "-h" ? kExitOk : kExitUsage,
              "usage: kerf keys [--tsv | WORD ...]\n"};
  const std::string text = ini::keys_as_text(table, words);
  if (text.empty()) return {kExitFailure, "kerf: no INI key contains all of these words\n"};
  return {kExitOk, text};
}

}  // namespace

std::string last_ini_file() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::string(state) + "/kerf/last-ini";
  const char* home = std::getenv("HOME");
  return std::string(home == nullptr ? "" : home) + "/.local/state/kerf/last-ini";
}

void remember_ini(const std::string& ini) {
  const std::filesystem::path file = last_ini_file();
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream(file) << ini << '\n';
}

rtapi::Result<Options, ParseEnd> parse_options(std::vector<std::string> arguments) {
  Options o;
  if (!arguments.empty() && arguments.front() == "keys") {
    arguments.erase(arguments.begin());
    return rtapi::Failure{explain_keys(arguments)};
  }
  if (!arguments.empty() && arguments.front() == "check") {
    o.check_only = true;
    arguments.erase(arguments.begin());
  }
  if (!arguments.empty() && arguments.front() == "resume") {
    o.resume = true;
    arguments.erase(arguments.begin());
  }
  join_module_words(arguments);
  CLI::App app(kAbout, "kerf");
  app.set_help_flag("-h,-?,--help", "Print this help and end");
  app.footer(kFooter);
  declare(app, o);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    return rtapi::Failure{ParseEnd{kExitOk, app.help()}};
  } catch (const CLI::CallForVersion&) {
    return rtapi::Failure{ParseEnd{kExitOk, std::string(kVersion) + "\n"}};
  } catch (const CLI::ParseError& e) {
    return rtapi::Failure{
        ParseEnd{kExitUsage, std::string("kerf: ") + e.what() + "; see kerf --help\n"}};
  }
  if (o.last_used && o.ini.empty()) {
    std::ifstream last(last_ini_file());
    if (!std::getline(last, o.ini) || o.ini.empty())
      return rtapi::Failure{
          ParseEnd{kExitUsage, "kerf: -l: no machine was started yet (" + last_ini_file() + ")\n"}};
  }
  if (o.ini.empty())
    return rtapi::Failure{ParseEnd{kExitUsage, "kerf: INI is required; see kerf --help\n"}};
  if (o.resume_run && !o.resume)
    return rtapi::Failure{
        ParseEnd{kExitUsage, "kerf: --run belongs to kerf resume; a program runs by --program\n"}};
  if (o.speed > 0) o.virtual_time = true;
  if (!o.instance.empty() && !rtapi::valid_instance_name(o.instance)) {
    return rtapi::Failure{
        ParseEnd{kExitUsage, "kerf: --instance " + o.instance +
                                 ": use letters, digits, '-', '_' and '.', at most 40 of them\n"}};
  }
  for (std::string* path : {&o.ini, &o.program, &o.log_joints, &o.svg}) *path = absolute(*path);
  for (std::string& dir : o.hal_dirs) dir = absolute(dir);
  std::reverse(o.hal_dirs.begin(), o.hal_dirs.end());  // each is put before those so far
  if (o.svg.empty()) o.svg = absolute("toolpath.svg");
  return o;
}

}  // namespace kerf::launcher
