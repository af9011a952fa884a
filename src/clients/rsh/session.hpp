// Session: one connection of the remote shell. Bytes in, text out; no socket, no clock.
//
//   Session session(shell, machine, 1);
//   session.feed("hello EMC me 1.1\r\n", now);
//   send(session.take_output());              // "HELLO ACK EMCNETSVR 1.1\r\n"
//
// A SET that the machine takes time for makes the session wait (WAIT_MODE DONE, the default): lines behind it keep their order.
// What an operator needs for a machine that runs (ABORT, PAUSE, ESTOP ...) does not wait when it comes in later.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "clients/common/stat.hpp"
#include "clients/rsh/machine.hpp"
#include "clients/rsh/table.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::rsh {

class Session;

/// What all sessions share.
struct Shell {
  std::string name{"EMCNETSVR"};
  std::string connect_password{"EMC"};
  std::string enable_password{"EMCTOO"};
  std::string program_folder;  ///< where OPEN looks too; "": nowhere
  std::vector<const Session*> sessions;
  bool shutdown{false};  ///< a session asks for the end of the machine
};

class Session {
 public:
  static constexpr std::size_t kMaxLine = 4096;
  static constexpr std::size_t kMaxWaiting = 65536;  ///< bytes of lines that may wait

  Session(Shell& shell, Machine& machine, int number);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void feed(std::string_view bytes, rtapi::Nanos now);
  /// Looks at what the session waits for, and goes on.
  void step(rtapi::Nanos now);
  [[nodiscard]] std::string take_output();
  /// QUIT, or shutdown: close when the output is sent.
  [[nodiscard]] bool ended() const noexcept { return ended_; }
  /// Nothing is left to be carried out.
  [[nodiscard]] bool idle() const noexcept { return !waits() && waiting_.empty(); }
  /// False: too much waits to be carried out; read no more for the moment.
  [[nodiscard]] bool takes_input() const noexcept { return waiting_bytes_ < kMaxWaiting; }
  [[nodiscard]] bool waits() const noexcept { return wait_.kind != Wait::Kind::none; }
  /// When step() is to be called at the latest.
  [[nodiscard]] rtapi::Nanos wake_at() const noexcept {
    return waits() ? wait_.deadline : rtapi::kForever;
  }

  // --- for the rows of the table ---
  struct Settings {
    bool echo{true}, verbose{false};
    bool timestamp{false}, timestamp_echo{false};
    bool wait_done{true};  ///< WAIT_MODE DONE
    bool update{true};     ///< UPDATE AUTO
    double timeout_s{0};   ///< 0: for ever
    std::string linear_units{"auto"}, angular_units{"auto"};
  };
  Settings settings;
  bool linked{false}, enabled{false};
  bool jogs{false};           ///< has begun a jog that goes on until it is stopped
  bool probe_cleared{false};  ///< PROBE_CLEAR: the last contact is not shown any more
  std::string client;

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] Machine& machine() noexcept { return machine_; }
  [[nodiscard]] Shell& shell() noexcept { return shell_; }
  [[nodiscard]] const clients::Stat& stat() const noexcept {
    return settings.update ? machine_.stat() : frozen_;
  }
  /// UPDATE NONE answers from here on with what is true now.
  void freeze();
  /// Sends to task.
  [[nodiscard]] Done task(const std::vector<std::string>& words);
  /// SET WAIT: waits for the command before it.
  [[nodiscard]] Done wait_for_last(bool done);
  enum class Messages : std::uint8_t { error, text, display };
  /// The oldest that was not shown yet; "" without.
  [[nodiscard]] std::string take_message(Messages kind);

 private:
  struct Wait {
    enum class Kind : std::uint8_t { none, command, condition };
    Kind kind{Kind::none};
    bool until_done{true};
    bool was_paused{false};  ///< the program, when the command was sent
    std::uint64_t id{0};
    std::function<bool(const clients::Stat&)> holds;
    rtapi::Nanos deadline{rtapi::kForever};
    const Subcommand* row{nullptr};
  };

  void line(std::string_view text, rtapi::Nanos now);
  void look_at_wait(rtapi::Nanos now);
  void take_waiting(rtapi::Nanos now);
  [[nodiscard]] bool acts_at_once(std::string_view text) const;
  void hello(std::string_view rest);
  void get(std::string_view rest);
  void set(std::string_view rest, rtapi::Nanos now);
  void help(std::string_view rest);
  void shut_down();
  void conclude(const Subcommand& row, bool good, const std::string& why = {});
  /// An error text, or "" and the values.
  [[nodiscard]] std::string read_values(std::string_view what, std::span<const Argument> arguments,
                                        std::string_view rest, bool set, Values& values) const;
  [[nodiscard]] std::string read_value(const Argument& argument, std::string_view word,
                                       Values& values) const;
  void say(const std::string& text);
  void put(std::string_view text, bool stamp);
  void take_messages();
  void watch_sent();
  void note_failure(const task::Reply& reply);

  Shell& shell_;
  Machine& machine_;
  int number_;
  std::string partial_;        ///< the line that is coming in
  bool line_too_long_{false};  ///< the rest of it is dropped
  std::deque<std::string> waiting_;
  std::size_t waiting_bytes_{0};
  std::string output_;
  bool ended_{false};
  Wait wait_;
  clients::Stat frozen_;
  std::uint64_t last_id_{0};
  bool last_ended_{true}, last_failed_{false};
  std::vector<std::string> recent_errors_;  ///< since the last SET
  std::vector<std::uint64_t> sent_;         ///< commands whose outcome nobody waits for any more
  std::deque<std::string> messages_[3];
};

}  // namespace kerf::rsh
