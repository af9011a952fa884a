#include "hal/tools/stream_program.hpp"

#include <getopt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <utility>

#include "hal/client/find_stream.hpp"
#include "hal/client/session.hpp"
#include "hal/client/user_component.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {
namespace {

// The one clock of this program, for the signal handler.
rtapi::WaitClock* signal_clock = nullptr;
volatile std::sig_atomic_t signal_seen = 0;

extern "C" void on_signal(int /*number*/) {
  signal_seen = 1;
  if (signal_clock != nullptr) signal_clock->stop();
}

/// True when the realtime host closed its end: it never sends unasked.
bool host_is_gone(int fd) {
  char byte = 0;
  const ssize_t n = recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
}

}  // namespace

void StreamTask::finish(std::string error) {
  done_ = true;
  error_ = std::move(error);
}

void catch_stream_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

int complain(const char* program, const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", program, text.c_str());
  return 1;
}

bool parse_number(std::string_view text, std::int64_t lowest, std::int64_t& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() && out >= lowest;
}

std::optional<int> read_stream_options(int argc, char** argv, StreamProgram& program,
                                       const std::string& more,
                                       const std::function<std::string(int, const char*)>& take) {
  const auto fail = [&](const std::string& text) { return complain(program.name, text); };
  opterr = 0;
  const std::string letters = ":c:N:h" + more;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  for (int c = 0; (c = getopt_long(argc, argv, letters.c_str(), long_options, nullptr)) != -1;) {
    switch (c) {
      case 'c':
        if (!parse_number(optarg, 0, program.channel)) {
          return fail("-c takes the number of a FIFO, from 0, not '" + std::string(optarg) + "'");
        }
        break;
      case 'N': program.component_name = optarg; break;
      case 'h': std::fputs(program.usage, stdout); return 0;
      case ':': return fail(std::string("option -") + static_cast<char>(optopt) + " needs a value");
      case '?':
        (void)fail(std::string("unknown option '") + static_cast<char>(optopt) + "'");
        std::fputs(program.usage, stderr);
        return 1;
      default:
        if (const std::string wrong = take(c, optarg); !wrong.empty()) return fail(wrong);
    }
  }
  if (optind < argc) program.file = argv[optind++];
  if (optind < argc) return fail("one FILENAME only; what is '" + std::string(argv[optind]) + "'?");
  return std::nullopt;
}

int run_stream_program(const StreamProgram& program,
                       const std::function<std::unique_ptr<StreamTask>(Stream)>& make) {
  const auto fail = [&](const std::string& text) { return complain(program.name, text); };
  auto segment = rtapi::Segment::attach(rtapi::default_instance());
  if (!segment.ok()) return fail(segment.error().message());
  const std::string component_name = program.component_name.empty()
                                         ? program.name + std::to_string(getpid())
                                         : program.component_name;
  auto stream =
      program.channel < 256
          ? find_stream(**segment, program.key + static_cast<std::uint32_t>(program.channel))
          : rtapi::Result<Stream>(rtapi::fail(rtapi::Errc::not_found, ""));
  if (!stream.ok()) {
    return fail("there is no FIFO " + std::to_string(program.channel) + ": `loadrt " +
                program.component + " depth=... cfg=...` makes it");
  }
  auto clock = rtapi::join_clock(**segment, rtapi::Role::user_component, component_name);
  if (!clock.ok()) return fail(clock.error().message());
  signal_clock = clock->get();
  if (signal_seen != 0) signal_clock->stop();

  auto session = SocketSession::connect(**segment);
  if (!session.ok()) return fail(session.error().message());
  (*session)->use_clock(clock->get());
  UserComponent component(**session, component_name);
  if (auto status = component.ready(); !status.ok()) return fail(status.error().message());

  const std::unique_ptr<StreamTask> task = make(*stream);
  while (!(*clock)->stopped() && !task->done()) {
    rtapi::WaitSpec spec;
    task->step((*clock)->now(), spec);
    if (task->done()) break;
    if (host_is_gone((*session)->fd())) return fail("the realtime host has ended");
    spec.watch_fd((*session)->fd());
    (*clock)->wait(spec);
  }
  signal_clock = nullptr;
  if (!task->error().empty()) return fail(task->error());
  return task->done() ? 0 : 1;  // stopped by a signal before its end is a failure
}

}  // namespace kerf::hal
