// halsampler: prints what a sampler recorded.
#include <getopt.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "hal/tools/sample_reader.hpp"
#include "hal/tools/stream_program.hpp"

namespace {

using kerf::hal::SampleReader;
using kerf::hal::Stream;
using kerf::hal::StreamTask;

constexpr const char* kName = "halsampler";
constexpr const char* kUsage =
    "usage: halsampler [-c CHAN] [-n COUNT] [-t] [-N NAME] [FILENAME]\n"
    "Prints the samples of FIFO CHAN (default 0) of the realtime component sampler.\n"
    "  -n COUNT  end after COUNT samples      -t  number of the sample in the first column\n"
    "  -N NAME   name as a HAL component      FILENAME  write there instead of to stdout\n";

struct Options {
  kerf::hal::StreamProgram program{kName, "sampler", kerf::hal::kSamplerKey};
  std::string file;
  SampleReader::Options reader;
};

int complain(const std::string& text) { return kerf::hal::complain(kName, text); }

/// 0, or the exit code.
int parse_options(int argc, char** argv, Options& options) {
  opterr = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  for (int c = 0; (c = getopt_long(argc, argv, ":c:n:tN:h", long_options, nullptr)) != -1;) {
    switch (c) {
      case 'c':
        if (!kerf::hal::parse_number(optarg, 0, options.program.channel)) {
          return complain("-c takes the number of a FIFO, from 0, not '" + std::string(optarg) +
                          "'");
        }
        break;
      case 'n':
        if (!kerf::hal::parse_number(optarg, 1, options.reader.count)) {
          return complain("-n takes a number of samples above 0, not '" + std::string(optarg) +
                          "'");
        }
        break;
      case 't': options.reader.tagged = true; break;
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

int run(const Options& options, std::FILE* out) {
  return kerf::hal::run_stream_program(options.program, [&](Stream stream) {
    return std::unique_ptr<StreamTask>(std::make_unique<SampleReader>(stream, options.reader, out));
  });
}

}  // namespace

int main(int argc, char** argv) {
  kerf::hal::catch_stream_signals();
  Options options;
  if (const int code = parse_options(argc, argv, options); code != 0) return code;
  if (options.file.empty()) return run(options, stdout);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(options.file.c_str(), "w"),
                                                             std::fclose);
  if (!file) return complain("cannot write " + options.file + ": " + std::strerror(errno));
  return run(options, file.get());
}
