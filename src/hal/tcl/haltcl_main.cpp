// haltcl: Tcl with HAL's commands, for a file or a person.
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/tcl/connection.hpp"
#include "hal/tcl/prompt.hpp"
#include "hal/tcl/script.hpp"
#include "ini/ini_file.hpp"
#include "rtapi/log/log.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

hal::tcl::Connection* connection = nullptr;  // for the signal handler
hal::tcl::TclHal* hal_words = nullptr;

/// A command that waits ends and makes its script fail; Tcl's own computing has no such place.
void on_signal(int signal) {
  if (hal_words != nullptr && hal_words->busy()) {
    hal_words = nullptr;  // the next signal ends the program
    connection->stop_waiting();
  } else if (signal != SIGINT || !hal::tcl::at_prompt()) {
    ::_exit(128 + signal);
  }
}

void print_help() {
  std::puts(
      "Usage: haltcl [-i INI] [FILE [ARGUMENT ...]]\n"
      "       haltcl [-i INI] --twopass OPTIONS FILE [ARGUMENT ...] [';' FILE ...]\n"
      "\n"
      "Does the Tcl script FILE, in which halcmd's commands are Tcl commands; without FILE, "
      "commands are read\n"
      "interactively. ARGUMENTs are in $argv.\n"
      "\n"
      "  -i INI      makes an array of each section: [JOINT_0]MAX_VELOCITY is "
      "$::JOINT_0(MAX_VELOCITY)\n"
      "  -ini INI    the same\n"
      "  --twopass   does all FILEs, .hal and .tcl, in two passes; OPTIONS is the value of "
      "[HAL]TWOPASS\n"
      "  -h          this text\n"
      "\n"
      "Exit status: that of `exit N`, 1 after an error, else 0.");
}

struct CommandLine {
  std::string ini_path;
  std::optional<std::string> two_pass;
  std::vector<std::string> words;  ///< files and their arguments
};

std::optional<CommandLine> parse(const std::vector<std::string>& args) {
  CommandLine out;
  std::size_t i = 0;
  while (i < args.size()) {
    const bool ini = args[i] == "-i" || args[i] == "-ini" || args[i] == "--ini";
    if (!ini && args[i] != "--twopass") break;
    if (i + 1 == args.size()) {
      rtapi::log_message(rtapi::Level::error, "%s needs a value; see haltcl -h", args[i].c_str());
      return std::nullopt;
    }
    (ini ? out.ini_path : out.two_pass.emplace()) = args[i + 1];
    i += 2;
  }
  out.words.assign(args.begin() + static_cast<std::ptrdiff_t>(i), args.end());
  return out;
}

std::vector<hal::tcl::HalFile> hal_files(const std::vector<std::string>& words) {
  std::vector<hal::tcl::HalFile> files;
  bool first = true;
  for (const auto& word : words) {
    if (word == ";") {
      first = true;
    } else if (first) {
      files.push_back({word, {}});
      first = false;
    } else {
      files.back().arguments.push_back(word);
    }
  }
  return files;
}

/// Programs that scripts start by name are those beside this one.
std::string find_own_path() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const char* path = std::getenv("PATH");
  ::setenv("PATH",
           (self.parent_path().string() + ":" + (path != nullptr ? path : "/usr/bin:/bin")).c_str(),
           1);
  return self.string();
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("haltcl");
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (!args.empty() && (args[0] == "-h" || args[0] == "--help")) {
    print_help();
    return 0;
  }
  const auto line = parse(args);
  if (!line) return 1;
  std::unique_ptr<ini::IniFile> ini;
  if (!line->ini_path.empty()) {
    auto loaded = ini::IniFile::load(line->ini_path);
    for (const auto& d : loaded.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
    if (!loaded.ok) return 1;
    ini = std::make_unique<ini::IniFile>(std::move(loaded.file));
  }
  const std::string program = find_own_path();
  const bool interactive = line->words.empty() && !line->two_pass;

  hal::tcl::Connection own_connection(!interactive);
  hal::tcl::TclHal words([&] { return own_connection.attach(); });
  words.set_after_on_clock(!interactive);
  connection = &own_connection;
  hal_words = &words;
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) ::sigaction(signal, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);

  bool good = false;
  if (interactive) {
    good = hal::tcl::run_prompt(words, ini.get(), program, [&] {
      hal_words = &words;
      words.set_clock(own_connection.fresh_clock());
    });
  } else {
    hal::tcl::ScriptRunner runner(words, ini.get());
    runner.set_program(program);
    const auto files = hal_files(line->words);
    good = line->two_pass
               ? runner.run_two_pass(files, hal::tcl::TwoPassOptions::parse(*line->two_pass))
               : runner.run_file({line->words[0], {line->words.begin() + 1, line->words.end()}});
  }
  hal_words = nullptr;
  return good ? 0 : 1;
}
