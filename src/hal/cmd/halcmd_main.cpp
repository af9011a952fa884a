// halcmd: HAL from the command line, from a file or interactively.
#include <getopt.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/client/request_all.hpp"
#include "hal/cmd/commander.hpp"
#include "hal/cmd/options.hpp"
#include "hal/cmd/prompt.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/process.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

/// Exit status when the options or a file that they name cannot be used.
constexpr int kBadUse = 255;
void print_help() {
  std::puts(
      "Usage: halcmd [OPTIONS] [COMMAND [ARGUMENT ...]]\n"
      "       halcmd [OPTIONS] -f [FILE]\n"
      "\n"
      "  -f [FILE]   commands from FILE (default: stdin), not from the command line\n"
      "  -i INI      values for [SECTION]KEY in the commands of a file or a session\n"
      "  -k          keep going after a failed command\n"
      "  -q          print errors only (default)\n"
      "  -Q          print nothing\n"
      "  -s          output for scripts: no titles, one line each\n"
      "  -v          print the result of every command\n"
      "  -V          print more\n"
      "  -e          echo commands to stderr\n"
      "  -R          does nothing and ends: there is no mutex to release\n"
      "  --json      show, list, status, getp, gets, ptype and stype print JSON\n"
      "  -h [NAME]   this text, or that of one command\n"
      "\n"
      "Without a command, commands are read interactively. They are:\n");
  std::fputs(hal::Commander::help_text("").c_str(), stdout);
  std::puts(
      "\nWithout a running HAL:\n"
      "  check       Finds what is wrong with HAL files; `halcmd check --help`.\n"
      "  graph       Draws HAL files, or the running HAL; `halcmd graph --help`.");
}

/// Scripts of a known end hold the virtual clock while they run; a person or a pipe must not.
rtapi::Result<std::unique_ptr<rtapi::WaitClock>> choose_clock(rtapi::Segment& segment,
                                                              bool bounded) {
  if (bounded) return rtapi::join_clock(segment, rtapi::Role::user_component, "halcmd");
  return rtapi::make_real_clock();
}

int fail(const rtapi::Error& error) {
  rtapi::log_error(error);
  return 1;
}

/// Connects when it is first asked for something: what only reads needs the segment and no more.
class LateSession final : public hal::Session {
 public:
  explicit LateSession(rtapi::Segment& segment) : segment_(segment) {}
  ~LateSession() override { leave(); }
  LateSession(const LateSession&) = delete;
  LateSession& operator=(const LateSession&) = delete;

  rtapi::Status connect() {
    if (socket_) return {};
    KERF_TRY(socket_, hal::SocketSession::connect(segment_));
    if (clock_ != nullptr) socket_->use_clock(clock_);
    return {};
  }
  void use_clock(rtapi::WaitClock* clock) noexcept override {
    clock_ = clock;
    if (socket_) socket_->use_clock(clock);
  }
  void watch(rtapi::WaitSpec& spec) const noexcept override {
    if (socket_) socket_->watch(spec);
  }
  /// Connects, for only a connection tells of the host's death.
  [[nodiscard]] bool alive() override { return connect().ok() && socket_->alive(); }
  /// As long as it is to be seen: halcmd with its process id, as scripts expect of `show comp`.
  rtapi::Status appear() {
    const std::string name = "halcmd" + std::to_string(::getpid());
    const hal::Command commands[] = {{"comp-new", name}, {"comp-ready", name}};
    KERF_TRY(const auto refused, hal::request_all(*this, commands, false));
    if (!refused.empty())
      return rtapi::fail(static_cast<rtapi::Errc>(refused[0].reply.status), refused[0].reply.text);
    name_ = name;
    return {};
  }
  void leave() {
    if (!name_.empty()) (void)socket_->request({"comp-exit", name_});
    name_.clear();
  }

  using Session::request;
  rtapi::Result<hal::Reply> request(std::span<const std::string> argv) override {
    KERF_CHECK(connect());
    return socket_->request(argv);
  }
  [[nodiscard]] rtapi::Segment& segment() override { return segment_; }
  [[nodiscard]] bool local() const noexcept override { return false; }

 private:
  rtapi::Segment& segment_;
  std::unique_ptr<hal::SocketSession> socket_;
  rtapi::WaitClock* clock_{nullptr};
  std::string name_;
};

int connect_and_run(hal::HalcmdOptions& options, const std::vector<std::string>& words) {
  const std::string instance = rtapi::default_instance();
  auto segment = rtapi::Segment::attach(instance);
  if (!segment.ok()) return fail(segment.error());
  LateSession session(**segment);
  // What a dead host left behind is no HAL to read.
  const auto& header = (*segment)->header();
  if (!rtapi::process_lives(header.owner_pid.get(), header.owner_start)) {
    if (auto connected = session.connect(); !connected.ok()) return fail(connected.error());
  }

  const std::string file = options.from_file ? (words.empty() ? "-" : words[0]) : "";
  const bool interactive = !options.from_file && words.empty();
  struct stat st {};
  const bool bounded = options.from_file
                           ? file != "-" && ::stat(file.c_str(), &st) == 0 && S_ISREG(st.st_mode)
                           : !words.empty();
  auto clock = choose_clock(**segment, bounded);
  if (!clock.ok()) return fail(clock.error());
  const rtapi::StopOnSignal stop(**clock);
  session.use_clock(clock->get());

  const auto appear = [&] {
    if (auto done = session.appear(); !done.ok()) rtapi::log_error(done.error());
  };
  if (interactive) appear();
  hal::Commander commander(session);
  if (!interactive) commander.set_presence(appear);
  commander.set_clock(clock->get());
  options.apply(commander);
  bool good = true;
  if (options.from_file)
    good = commander.run_file(file);
  else if (!interactive)
    good = commander.run_words(words);
  else
    good = hal::run_interactive(commander);
  session.leave();
  return good ? 0 : 1;
}

/// What loads components into a HAL of its own is another program, beside this one.
int become_hal(std::vector<std::string>& words) {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::string program = (self.parent_path() / "hal").string();
  words.insert(words.begin(), "hal");
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  std::fprintf(stderr, "halcmd: %s: %s\n", program.c_str(), std::strerror(errno));
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::catch_stop_signals({SIGTERM, SIGINT});
  rtapi::set_program_name("halcmd");
  hal::HalcmdOptions options;
  int c = 0;
  constexpr int kJson = 256;
  const option long_options[] = {
      {"help", no_argument, nullptr, 'h'}, {"json", no_argument, nullptr, kJson}, {}};
  // '+': the command's own words may begin with '-'.
  while ((c = ::getopt_long(argc, argv, "+efi:kqQRsvVh", long_options, nullptr)) != -1) {
    if (c == 'h') {
      if (optind < argc)
        std::fputs(hal::Commander::help_text(argv[optind]).c_str(), stdout);
      else
        print_help();
      return 0;
    }
    if (c == kJson) {
      options.json = true;
      continue;
    }
    if (!options.take(c, optarg)) return kBadUse;
  }
  std::vector<std::string> words(argv + optind, argv + argc);
  if (!options.from_file && !words.empty() && (words[0] == "check" || words[0] == "graph")) {
    if (!options.ini_path.empty()) words.insert(words.end(), {"-i", options.ini_path});
    if (options.json) words.emplace_back("--json");
    return become_hal(words);
  }
  if (options.release) {
    std::puts("halcmd: HAL has no mutex that a dead program could hold; nothing to release");
    return 0;
  }
  if (!options.from_file && !options.ini_path.empty() && !words.empty()) {
    std::fputs("-i may only be used together with -f; on the command line the shell substitutes\n",
               stderr);
    return 1;
  }
  if (options.from_file && !words.empty() && words[0] != "-" &&
      ::access(words[0].c_str(), R_OK) != 0) {
    std::fprintf(stderr, "Could not open command file '%s': %s\n", words[0].c_str(),
                 std::strerror(errno));
    return kBadUse;
  }
  if (!options.load_ini()) return kBadUse;
  return connect_and_run(options, words);
}
