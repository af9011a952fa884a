#include "launcher/options.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

namespace {

constexpr const char* kVersion = "kerf 0.1.0";

constexpr const char* kAbout =
    "Starts the machine that an INI file describes, and watches over it.\n"
    "  kerf INI          start; at a terminal type G-code, end with Ctrl-D or Ctrl-C\n"
    "  kerf check INI    read the files and report what is wrong, without starting";

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

void declare(CLI::App& app, Options& o) {
  app.add_option("INI", o.ini, "INI file of the machine")->required()->type_name("");
  app.add_option("--program", o.program, "G-code file to run")->type_name("FILE");
  app.add_flag("--once", o.once,
               "Run the program (default: [DISPLAY]OPEN_FILE), print the summary and end");
  app.add_flag("--virtual", o.virtual_time,
               "Virtual time: as fast as the processor allows, the same motion every time");
  app.add_option("--speed", o.speed, "Virtual time, at most X seconds of it in a real one")
      ->type_name("X")
      ->check(CLI::PositiveNumber);
  app.add_option("--instance", o.instance, "Name, so that several machines run on one PC")
      ->type_name("NAME");
  app.add_option("--log-joints", o.log_joints, "Write each servo cycle's joint positions")
      ->type_name("FILE");
  app.add_option("--svg", o.svg, "Where the drawing goes (default: toolpath.svg)")
      ->type_name("FILE");
  app.add_option("-H", o.hal_dirs, "Folder to search for HAL files first; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_flag("-k", o.ignore_hal_errors, "Go on when a HAL file has errors");
  app.add_flag("-v,-d,--verbose", o.verbose, "Say what is being done");
  // Known to scripts that start the machine by the name linuxcnc; output is never redirected here.
  app.add_flag_callback(
      "-r", [] {}, "Accepted, without effect");
  app.set_version_flag("--version", kVersion);
}

}  // namespace

rtapi::Result<Options, ParseEnd> parse_options(std::vector<std::string> arguments) {
  Options o;
  if (!arguments.empty() && arguments.front() == "check") {
    o.check_only = true;
    arguments.erase(arguments.begin());
  }
  CLI::App app(kAbout, "kerf");
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
  if (o.speed > 0) o.virtual_time = true;
  if (!o.instance.empty() && !rtapi::valid_instance_name(o.instance)) {
    return rtapi::Failure{
        ParseEnd{kExitUsage, "kerf: --instance " + o.instance +
                                 ": use letters, digits, '-', '_' and '.', at most 40 of them\n"}};
  }
  for (std::string* path : {&o.ini, &o.program, &o.log_joints, &o.svg}) *path = absolute(*path);
  for (std::string& dir : o.hal_dirs) dir = absolute(dir);
  if (o.svg.empty()) o.svg = absolute("toolpath.svg");
  return o;
}

}  // namespace kerf::launcher
