// What halsampler and halstreamer have in common: a program at one end of a realtime component's stream.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
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
  std::int64_t channel{0};
  std::string component_name{};  ///< option -N; empty: name and process number
};

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
/// What is wrong with the option that getopt_long(":...") did not take.
std::string bad_option(int result, int option);

}  // namespace kerf::hal
