// halstreamer: plays rows of text into a streamer.
#include <fcntl.h>
#include <getopt.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "hal/tools/row_writer.hpp"
#include "hal/tools/stream_program.hpp"

namespace {

using kerf::hal::RowWriter;
using kerf::hal::Stream;
using kerf::hal::StreamTask;

constexpr const char* kName = "halstreamer";
constexpr const char* kUsage =
    "usage: halstreamer [-c CHAN] [-N NAME] [FILENAME]\n"
    "Puts rows of text into FIFO CHAN (default 0) of the realtime component streamer: a line a "
    "row,\n"
    "a field a column. Lines that begin with # are skipped. Ends with the input.\n"
    "  -N NAME   name as a HAL component      FILENAME  read it instead of stdin\n";

struct Options {
  kerf::hal::StreamProgram program{kName, "streamer", kerf::hal::kStreamerKey};
  std::string file;
};

int complain(const std::string& text) { return kerf::hal::complain(kName, text); }

/// 0, or the exit code.
int parse_options(int argc, char** argv, Options& options) {
  opterr = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  for (int c = 0; (c = getopt_long(argc, argv, ":c:N:h", long_options, nullptr)) != -1;) {
    switch (c) {
      case 'c':
        if (!kerf::hal::parse_number(optarg, 0, options.program.channel)) {
          return complain("-c takes the number of a FIFO, from 0, not '" + std::string(optarg) +
                          "'");
        }
        break;
      case 'N': options.program.component_name = optarg; break;
      case 'h': std::fputs(kUsage, stdout); std::exit(0);
      default:
        (void)complain(kerf::hal::bad_option(c, optopt));
        if (c != ':') std::fputs(kUsage, stderr);
        return 1;
    }
  }
  if (optind < argc) options.file = argv[optind++];
  if (optind < argc)
    return complain("one FILENAME only; what is '" + std::string(argv[optind]) + "'?");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  kerf::hal::catch_stream_signals();
  Options options;
  if (const int code = parse_options(argc, argv, options); code != 0) return code;
  int in = STDIN_FILENO;
  if (!options.file.empty()) in = ::open(options.file.c_str(), O_RDONLY | O_CLOEXEC);
  if (in < 0) return complain("cannot read " + options.file + ": " + std::strerror(errno));
  return kerf::hal::run_stream_program(options.program, [&](Stream stream) {
    return std::unique_ptr<StreamTask>(std::make_unique<RowWriter>(stream, in, stderr));
  });
}
