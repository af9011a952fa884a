// CommandParticipant: the command thread of task: machine state, intents, heartbeat, clients. It never blocks and never
// touches a disk; whatever may, is an order to the interpreter thread.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/io_link.hpp"
#include "io/tool_store.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/log/log.hpp"
#include "task/api/journal.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"
#include "task/exchange.hpp"
#include "task/ini_pins.hpp"
#include "task/live_config.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

class JournalWriter;

class CommandParticipant final : public rtapi::Participant {
 public:
  struct Parts {
    motion::MotionShared& motion;
    TaskShared& shared;
    Exchange& exchange;
    io::IoLink& io;
    const MachineSetup& setup;
    std::int64_t pid{0};
    const io::ToolStore* tools{nullptr};  ///< shown to clients; null: none
    LiveConfig* live{nullptr};  ///< with `ini_pins`: limits that change while the machine runs
    IniPins* ini_pins{nullptr};
    /// Name of the signal that a pin is linked to, or "".
    std::function<std::string(std::string_view pin)> net_of{};
    JournalWriter* journal{nullptr};  ///< null: none
    /// What realtime functions say to the operator; null: nothing.
    rtapi::LogReader* realtime_log{nullptr};
  };
  explicit CommandParticipant(const Parts& parts);
  ~CommandParticipant() override;

  /// Opens the socket for clients; without it only submit() gives commands.
  rtapi::Status listen(const std::string& address);

  [[nodiscard]] const char* name() const noexcept override { return "command"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::task_command; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

  /// A command of this process itself, taken in the next step. Words as in request_from_words(). Gives its id.
  std::uint64_t submit(const std::vector<std::string>& words);
  /// The same as JSON, which must carry its id.
  void submit_json(std::string json);
  /// The newest reply to a submitted command.
  [[nodiscard]] std::optional<Reply> outcome(std::uint64_t id) const;

  /// Stops everything and takes the drives' enable away; before the process ends.
  void shut_down();

 private:
  static constexpr int kLocal = 0;    ///< client number of submit()
  static constexpr int kNobody = -1;  ///< commands of task itself
  static constexpr rtapi::Nanos kBeat = 20 * rtapi::kMillisecond;
  static constexpr rtapi::Nanos kStateTime = rtapi::kSecond;
  /// Safety relays take their time; a client that waits five seconds hears of it.
  static constexpr rtapi::Nanos kResetTime = 4 * rtapi::kSecond;
  /// What stops a machine may reach its drives before it reaches this thread.
  static constexpr rtapi::Nanos kJustNow = 200 * rtapi::kMillisecond;
  /// So long those that have not run yet may take.
  static constexpr rtapi::Nanos kBusyTime = 5 * rtapi::kSecond;
  /// Motion has had its chance to turn the machine on.
  static constexpr std::uint64_t kCyclesToTurnOn = 50;

  /// What one wait can watch, with room for the rest.
  static constexpr std::size_t kMaxClients = 56;

  struct ClientLink {
    int number{0};
    int fd{-1};
    rtapi::Nanos heard{0};  ///< when its last packet came
    std::deque<std::string> outbox;
    bool dead{false};
  };
  struct Pending {
    int client{kNobody};
    std::uint64_t id{0};
    CommandId command{CommandId::help};
    rtapi::Nanos deadline{rtapi::kForever};
    std::uint64_t from_cycle{0};  ///< motion's cycle when it was asked
    std::uint32_t intent{0};      ///< the Intent that asks motion for it
    std::uint64_t fault_mark{0};
    int joint{-1};
    std::uint32_t epoch{0};
    bool order{false};  ///< the interpreter thread carries it out
    std::string file;   ///< of open, as it was asked for
    bool begun{false};
  };

  // clients.cpp
  void serve_clients();
  [[nodiscard]] bool accepts() const {
    return listener_ >= 0 && clients_.size() < kMaxClients && now_ >= accept_again_;
  }
  void take_packet(int client, const std::string& packet);
  void send_replies();
  void client_gone(ClientLink& client);
  void reply(Ticket ticket, CommandState state, const std::string& text = {});
  void reply_to(int client, const Reply& reply);
  Ticket open_ticket(int client, const Request& request);

  // command_participant.cpp
  void beat();
  void read_ini_pins();
  void take_faults();
  void after_overrun();
  [[nodiscard]] std::string homing_failure(const Pending& pending) const;
  [[nodiscard]] static bool is_program(CommandId command) noexcept {
    return command == CommandId::run || command == CommandId::step;
  }
  void take_reports();
  void update_pending();
  void write_status();
  void show_tools();
  void path_wait(WaitingFor& wait);
  /// As many as fit into one packet.
  [[nodiscard]] std::vector<OperatorMessage> newest_messages(std::uint64_t cursor) const;
  void say(MessageKind kind, const std::string& text, const std::string& file = {},
           std::int32_t line = 0);
  /// Gives its serial, for taken().
  std::uint32_t write_intent() {
    ++want_.serial;
    p_.motion.intent.values.write(want_);
    return want_.serial;
  }
  /// Motion has carried out what was written with this serial, and its status shows it. Counted cycles would not do: this thread
  /// may be kept from running for any number of them between its look at the status and its write.
  [[nodiscard]] bool taken(std::uint32_t serial) const {
    return static_cast<std::int32_t>(status_.intent_taken - serial) >= 0;
  }
  [[nodiscard]] bool idle() const;
  /// The interpreter has not yet followed the newest abort.
  [[nodiscard]] bool aborting() const { return view_.settled_epoch != epoch_; }
  /// What was asked for in this very moment shows in no status yet, and counts all the same: two clients may ask at once.
  [[nodiscard]] bool homing(Ticket but = 0) const;
  [[nodiscard]] bool all_homed() const;
  [[nodiscard]] bool jogs() const { return status_.jogging || !taken(jog_intent_); }
  /// A program or MDI line that is there or was just taken.
  [[nodiscard]] bool moving_orders(Ticket but) const;
  [[nodiscard]] bool at_rest() const {
    return status_.path_empty && !status_.jogging && !status_.homing_active &&
           status_.acked_epoch == epoch_;
  }

  // machine.cpp
  void update_machine();
  void note_work();
  /// True when those that wait for a state have waited so long, or nobody does.
  [[nodiscard]] bool state_is_late(rtapi::Nanos after) const;
  /// "" while the machine may still turn on.
  [[nodiscard]] std::string why_not_on() const;
  void end_state_tickets(CommandState how, const std::string& text);
  void abort_all(std::uint32_t reason);
  void stop_jogs(int client);
  void stop_silent_jogs();
  [[nodiscard]] rtapi::Nanos last_heard(int client) const;
  void end_block_step();
  void finish_block_step();
  void begin_block_step();
  void release_block_step();
  void go_estop(const char* why);
  void go_off();
  /// Modes that somebody asks for: what comes back to others ends.
  void choose(TaskMode mode, motion::MotionMode motion_mode);
  void set_mode(TaskMode mode);
  /// To the mode that was there before lines with `and-back`, as soon as nothing runs.
  void go_back();
  bool refuse_unless_on(Ticket ticket, const char* what);
  void do_state(Ticket ticket, const Request& request);
  void do_mode(Ticket ticket, const Request& request);
  void do_home(Ticket ticket, const Request& request);
  void do_unhome(Ticket ticket, const Request& request);
  void do_jog(Ticket ticket, const Request& request, int client);
  void do_jog_stop(Ticket ticket, const Request& request);
  void do_teleop(Ticket ticket, const Request& request);
  motion::JogIntent* find_jog(const std::string& what, bool& axis, std::size_t& index,
                              std::string& why);

  // journal.cpp
  void journal_begin(std::int32_t from_line);
  void journal_end(CommandState state, const std::string& text);
  [[nodiscard]] JournalRecord journal_record() const;
  void write_journal();
  void close_journal();

  // away.cpp
  [[nodiscard]] bool program_held() const;
  void remember_spindles();
  void do_away(Ticket ticket);
  void do_back(Ticket ticket);
  void do_exchange_tool(Ticket ticket, const Request& request);
  void take_shift(const Report& report);
  void update_away();
  void end_away();
  void go(std::size_t axis, double target);
  /// True, with an answer, when the machine is not where the path was left.
  bool refuse_away(Ticket ticket);

  // program.cpp
  void execute(Ticket ticket, const Request& request, int client);
  void do_program(Ticket ticket, const Request& request);
  /// `by_hand`: words that move nothing; they keep the mode, and the machine may be moving by hand.
  void do_mdi(Ticket ticket, const Request& request);
  void do_mdi(Ticket ticket, const std::string& text, bool by_hand, bool and_back);
  void pause();
  void do_step(Ticket ticket);
  void do_direction(Ticket ticket, bool backwards);
  void do_answer(Ticket ticket, const Request& request);
  void do_override(Ticket ticket, const Request& request);
  void do_spindle(Ticket ticket, const Request& request);
  void do_switch(Ticket ticket, const Request& request);
  void do_output(Ticket ticket, const Request& request);
  void do_enable(Ticket ticket, const Request& request);
  void do_joint_limit(Ticket ticket, const Request& request);
  void do_motion_mode(Ticket ticket, const Request& request);
  void do_tool_offset(Ticket ticket, const Request& request);
  /// True, with an answer, when there is no such spindle.
  bool refuse_spindle(Ticket ticket, int spindle);
  void wish() {
    ++want_.wishes;
    write_intent();
  }
  [[nodiscard]] bool other_orders(Ticket ticket) const;
  void post(Order order, Ticket ticket);
  void post(Order::Kind kind, Ticket ticket, const std::string& text, bool by_hand = false);
  bool refuse_unless_homed(Ticket ticket, const char* text);
  Ticket internal_ticket(CommandId command);

  Parts p_;
  motion::Intent want_;
  /// Modes of task and motion to come back to; whoever asks for a mode of his own ends it.
  struct Back {
    TaskMode mode;
    motion::MotionMode motion;
  };
  std::optional<Back> back_to_;
  motion::MachineConfig machine_;  ///< as the INI file says, and as changed since
  std::shared_ptr<const io::ToolTable> tools_shown_;
  std::uint64_t echo_serial_{0};
  std::int32_t debug_{0};
  bool last_failed_{false};
  std::string last_said_;
  motion::MotionStatus status_;
  InterpreterView view_;
  io::IoState io_;
  TaskStatus shown_;
  TaskStatus written_;
  rtapi::Nanos now_{0};
  rtapi::Nanos next_beat_{0};
  std::uint64_t beats_{0};
  std::uint32_t epoch_{1};
  std::uint32_t enable_request_{0};  ///< number of the last one
  std::uint64_t faults_seen_{0};
  std::string last_fault_;
  std::uint64_t messages_{0}, error_messages_{0};
  TaskState state_{TaskState::estop};
  TaskMode mode_{TaskMode::manual};
  bool enabling_{false};   ///< drives asked for, not there yet
  bool resetting_{false};  ///< estop reset asked for
  rtapi::Nanos reset_since_{0};
  bool was_jogging_{false};
  rtapi::Nanos worked_at_{-rtapi::kSecond};  ///< when the machine last did something
  std::uint32_t jog_intent_{0};              ///< asked for the last jog
  /// The way back to the path, in this order.
  enum class Returning : std::uint8_t { no, out, across, in, there };
  Returning returning_{Returning::no};
  std::uint32_t return_intent_{0};  ///< with it, standing is the end of a leg
  /// How the spindles turned when the machine left the held path, or when the first of them was stopped by hand: so they have to turn
  /// again before it goes on.
  std::array<std::int32_t, motion::kMaxSpindles> held_direction_{};
  bool held_spindles_known_{false};
  bool block_step_due_{false};    ///< the next step was asked for as the last one ended
  bool block_step_armed_{false};  ///< it begins as soon as motion knows that it is one
  /// With it, motion has seen: the hold at the end of the last step; that there is to be one; its begin, so that standing is its end.
  std::uint32_t block_step_intent_{0};
  /// The program that the journal tells of.
  struct Journal {
    bool expected{false};  ///< asked for
    bool begun{false};     ///< motion is at its items
    bool ending{false};
    bool told_paused{false};
    RunState end{RunState::ended};
    std::int32_t from_line{0}, line{0}, told_line{0};
    std::uint32_t epoch{0};
    std::uint64_t before_seq{0};
    rtapi::Nanos told_at{-rtapi::kSecond};
    std::string why;
  } journal_;
  CommandCounters counters_;
  std::uint64_t programs_ended_{0};
  int listener_{-1};
  rtapi::Nanos accept_again_{0};
  int last_client_{kLocal};
  std::vector<std::unique_ptr<ClientLink>> clients_;
  std::deque<std::string> local_in_;
  std::map<std::uint64_t, Reply> local_out_;
  std::uint64_t last_local_id_{0};
  Ticket last_ticket_{0};
  std::map<Ticket, Pending> pending_;
  /// By whom a jog without end lives, and how long without a word of its owner.
  struct JogLease {
    int owner{kNobody};
    rtapi::Nanos silence{rtapi::kForever};
  };
  std::array<JogLease, motion::kMaxJoints> joint_lease_{};
  std::array<JogLease, rtapi::kAxes> axis_lease_{};
  rtapi::Nanos heard_local_{0};
  rtapi::FixedString<63> wait_pin_, wait_net_;  ///< looked up once a wait
  WaitingFor last_wait_;                        ///< of motion
};

}  // namespace kerf::task
