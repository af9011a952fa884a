// What halsampler and halstreamer have in common: a program at one end of a realtime component's stream.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hal/stream.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

/// The work of such a program, without its process.
class StreamTask : public rtapi::Participant {
 public:
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::user_component; }
  /// True when nothing is left to do: all was done, or error() says why not.
  [[nodiscard]] bool done() const noexcept { return done_; }
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 protected:
  void finish(std::string error = {});

 private:
  bool done_{false};
  std::string error_;
};

struct StreamProgram {
  const char* name;  ///< in messages, and of the HAL component with the process's number behind it
  const char* component;  ///< realtime component at the other end
  std::uint32_t key;      ///< of its channel 0
  const char* usage;      ///< what --help prints
  std::int64_t channel{0};
  std::string component_name{};  ///< option -N; empty: name and process number
  std::string file{};            ///< FILENAME; empty: standard input or output
};

/// Takes -c, -N, --help and FILENAME from the command line. `more` names the program's own options as getopt wants them; `take` gets
/// each with its value and says what is wrong with it, or "". Gives the exit code when the program is to end.
std::optional<int> read_stream_options(
    int argc, char** argv, StreamProgram& program, const std::string& more = {},
    const std::function<std::string(int option, const char* value)>& take = {});

/// Once, first of all in main(): SIGINT and SIGTERM end run_stream_program().
void catch_stream_signals();
/// Joins the instance, runs what `make` gives until it is done, and gives the program's exit code: 1, with a message, when it
/// was stopped before.
int run_stream_program(const StreamProgram& program,
                       const std::function<std::unique_ptr<StreamTask>(Stream)>& make);

/// Prints "PROGRAM: text" on stderr; 1.
int complain(const char* program, const std::string& text);
/// A whole number of at least `lowest`.
bool parse_number(std::string_view text, std::int64_t lowest, std::int64_t& out);

}  // namespace kerf::hal
