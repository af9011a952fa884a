// halstreamer: plays rows of text into a streamer.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
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

}  // namespace

int main(int argc, char** argv) {
  kerf::hal::catch_stream_signals();
  kerf::hal::StreamProgram program{kName, "streamer", kerf::hal::kStreamerKey, kUsage};
  if (const auto code = kerf::hal::read_stream_options(argc, argv, program)) return *code;
  int in = STDIN_FILENO;
  if (!program.file.empty()) in = ::open(program.file.c_str(), O_RDONLY | O_CLOEXEC);
  if (in < 0)
    return kerf::hal::complain(kName, "cannot read " + program.file + ": " + std::strerror(errno));
  return kerf::hal::run_stream_program(program, [&](Stream stream) {
    return std::unique_ptr<StreamTask>(std::make_unique<RowWriter>(stream, in, stderr));
  });
}
