// halsampler: prints what a sampler recorded.
#include <cerrno>
#include <cstdio>
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

int run(const kerf::hal::StreamProgram& program, SampleReader::Options options, std::FILE* out) {
  return kerf::hal::run_stream_program(program, [&](Stream stream) {
    return std::unique_ptr<StreamTask>(std::make_unique<SampleReader>(stream, options, out));
  });
}

}  // namespace

int main(int argc, char** argv) {
  kerf::hal::catch_stream_signals();
  kerf::hal::StreamProgram program{kName, "sampler", kerf::hal::kSamplerKey, kUsage};
  SampleReader::Options options;
  const auto take = [&](int option, const char* value) -> std::string {
    if (option == 't') options.tagged = true;
    if (option == 'n' && !kerf::hal::parse_number(value, 1, options.count))
      return "-n takes a number of samples above 0, not '" + std::string(value) + "'";
    return {};
  };
  if (const auto code = kerf::hal::read_stream_options(argc, argv, program, "n:t", take))
    return *code;
  if (program.file.empty()) return run(program, options, stdout);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(program.file.c_str(), "w"),
                                                             std::fclose);
  if (!file)
    return kerf::hal::complain(kName, "cannot write " + program.file + ": " + std::strerror(errno));
  return run(program, options, file.get());
}
