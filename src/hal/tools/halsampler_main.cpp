// halsampler: prints what a sampler recorded.
#include <getopt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "hal/client/session.hpp"
#include "hal/client/user_component.hpp"
#include "hal/tools/sample_reader.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace {

using kerf::rtapi::Result;

constexpr const char* kUsage =
    "usage: halsampler [-c CHAN] [-n COUNT] [-t] [-N NAME] [FILENAME]\n"
    "Prints the samples of FIFO CHAN (default 0) of the realtime component sampler.\n"
    "  -n COUNT  end after COUNT samples      -t  number of the sample in the first column\n"
    "  -N NAME   name as a HAL component      FILENAME  write there instead of to stdout\n";

struct Options {
  std::int64_t channel{0};
  std::string component{"halsampler" + std::to_string(getpid())};
  std::string file;
  kerf::hal::SampleReader::Options reader;
};

// The one clock of this program, for the signal handler.
kerf::rtapi::WaitClock* signal_clock = nullptr;
volatile std::sig_atomic_t signal_seen = 0;

extern "C" void on_signal(int /*number*/) {
  signal_seen = 1;
  if (signal_clock != nullptr) signal_clock->stop();
}

int complain(const std::string& text) {
  std::fprintf(stderr, "halsampler: %s\n", text.c_str());
  return 1;
}

bool parse_number(std::string_view text, std::int64_t lowest, std::int64_t& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() && out >= lowest;
}

/// 0, or the exit code.
int parse_options(int argc, char** argv, Options& options) {
  opterr = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  for (int c = 0; (c = getopt_long(argc, argv, ":c:n:tN:h", long_options, nullptr)) != -1;) {
    switch (c) {
      case 'c':
        if (!parse_number(optarg, 0, options.channel)) {
          return complain("-c takes the number of a FIFO, from 0, not '" + std::string(optarg) +
                          "'");
        }
        break;
      case 'n':
        if (!parse_number(optarg, 1, options.reader.count)) {
          return complain("-n takes a number of samples above 0, not '" + std::string(optarg) +
                          "'");
        }
        break;
      case 't': options.reader.tagged = true; break;
      case 'N': options.component = optarg; break;
      case 'h': std::fputs(kUsage, stdout); std::exit(0);
      case ':':
        return complain(std::string("option -") + static_cast<char>(optopt) + " needs a value");
      default:
        (void)complain(std::string("unknown option '") + static_cast<char>(optopt) + "'");
        std::fputs(kUsage, stderr);
        return 1;
    }
  }
  if (optind < argc) options.file = argv[optind++];
  if (optind < argc)
    return complain("one FILENAME only; what is '" + std::string(argv[optind]) + "'?");
  return 0;
}

Result<kerf::hal::Stream> find_stream(kerf::rtapi::Segment& segment, std::int64_t channel) {
  const auto name = kerf::hal::stream_block_name("sampler", static_cast<std::size_t>(channel));
  auto block = segment.find_block(name.c_str(), kerf::hal::kStreamAbi);
  kerf::hal::Stream stream;
  if (block.ok()) stream = kerf::hal::Stream::attach(*block, segment.block_size(name.c_str()));
  if (!stream.valid()) {
    return kerf::rtapi::fail(kerf::rtapi::Errc::not_found,
                             "there is no FIFO " + std::to_string(channel) +
                                 ": `loadrt sampler depth=... cfg=...` makes it");
  }
  return stream;
}

/// True when the realtime host closed its end: it never sends unasked.
bool host_is_gone(int fd) {
  char byte = 0;
  const ssize_t n = recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
}

int run(const Options& options, std::FILE* out) {
  auto segment = kerf::rtapi::Segment::attach(kerf::rtapi::default_instance());
  if (!segment.ok()) return complain(segment.error().message());
  auto stream = find_stream(**segment, options.channel);
  if (!stream.ok()) return complain(stream.error().message());
  auto clock =
      kerf::rtapi::join_clock(**segment, kerf::rtapi::Role::user_component, options.component);
  if (!clock.ok()) return complain(clock.error().message());
  signal_clock = clock->get();
  if (signal_seen != 0) signal_clock->stop();

  auto session = kerf::hal::SocketSession::connect(**segment);
  if (!session.ok()) return complain(session.error().message());
  (*session)->use_clock(clock->get());
  kerf::hal::UserComponent component(**session, options.component);
  if (auto status = component.ready(); !status.ok()) return complain(status.error().message());

  kerf::hal::SampleReader reader(*stream, options.reader, out);
  while (!(*clock)->stopped() && !reader.done()) {
    kerf::rtapi::WaitSpec spec;
    reader.step((*clock)->now(), spec);
    if (reader.done()) break;
    if (host_is_gone((*session)->fd())) return complain("the realtime host has ended");
    spec.watch_fd((*session)->fd());
    (*clock)->wait(spec);
  }
  signal_clock = nullptr;
  if (!reader.error().empty()) return complain(reader.error());
  return reader.done() ? 0 : 1;  // stopped by a signal is a failure: the count was not reached
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  Options options;
  if (const int code = parse_options(argc, argv, options); code != 0) return code;
  if (options.file.empty()) return run(options, stdout);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(options.file.c_str(), "w"),
                                                             std::fclose);
  if (!file) return complain("cannot write " + options.file + ": " + std::strerror(errno));
  return run(options, file.get());
}
