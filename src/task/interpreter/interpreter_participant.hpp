// InterpreterParticipant: the interpreter thread of task. Reads ahead, block by block, into an ordered list; hands path items to
// motion as the ring has room; does the rest itself when its turn has come.
//
// One abort epoch rules all: when it is raised, everything that was read or queued under an older one is void, whatever runs here
// is ended, and when motion has acknowledged, the interpreter is put back to the block at which the machine stopped.
#pragma once

#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "interp/interpreter.hpp"
#include "interp/parameters.hpp"
#include "io/io_link.hpp"
#include "io/tool_store.hpp"
#include "motion/api/shared.hpp"
#include "motion/api/step.hpp"
#include "rtapi/clock/clock.hpp"
#include "task/exchange.hpp"
#include "task/interpreter/block_history.hpp"
#include "task/interpreter/canon_to_path.hpp"
#include "task/interpreter/limit_check.hpp"
#include "task/interpreter/program_seek.hpp"
#include "task/interpreter/task_environment.hpp"
#include "task/interpreter/user_program.hpp"

namespace kerf::task {

class InterpreterParticipant final : public rtapi::Participant {
 public:
  /// What it works with; all must outlive it.
  struct Parts {
    motion::MotionShared& motion;
    TaskShared& shared;
    Exchange& exchange;
    io::IoLink& io;
    io::ToolStore& tools;
    const MachineSetup& setup;
    TaskEnvironment& environment;
    std::string instance;
    const rtapi::Segment& segment;  ///< whose virtual time user programs may live in
  };
  explicit InterpreterParticipant(const Parts& parts);
  ~InterpreterParticipant() override;

  /// Loads the parameter file and runs RS274NGC_STARTUP_CODE; once, before the first step.
  rtapi::Status init();
  /// Back to the block where the machine stands, so that nothing that was only read ahead is saved. After the last step.
  void shut_down();
  /// Saves the parameter file, if the machine has one.
  rtapi::Status save_parameters();

  [[nodiscard]] const char* name() const noexcept override { return "interpreter"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::task_interpreter; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

  /// An abort was raised that is not followed yet.
  [[nodiscard]] bool abort_came() const noexcept {
    return p_.motion.intent.abort_epoch.observe() != epoch_;
  }

  [[nodiscard]] const interp::Interpreter& interpreter() const noexcept { return interp_; }

 private:
  /// What is being carried out.
  struct Run {
    bool active{false};
    bool mdi{false};
    bool by_hand{false};  ///< Order::by_hand
    bool mdi_begun{false};
    bool source_done{false};  ///< nothing more to read
    bool read_error{false};   ///< ... since the interpreter found an error
    bool sync_pending{false};
    bool failed{false};     ///< told the command thread; an abort comes
    bool stepping{false};   ///< Exchange::stepping, as it was looked at last
    motion::Step step;      ///< while stepping: what may begin
    bool in_thread{false};  ///< what was sent last ends in a thread (SyncMove)
    Ticket ticket{0};
    std::string text;
    rtapi::Nanos since{0};
    std::uint64_t blocks{0};
  };
  /// The barrier at the head of the list.
  struct Barrier {
    bool marked{false}, begun{false};
    bool pausing{false};  ///< M0, M1, M60: waits for resume
    bool armed{false};    ///< M66 rise, fall: the other level was seen
    std::uint64_t marker_seq{0};
    std::uint64_t order{0};
    std::uint32_t resumes{0};
    std::uint64_t prompt{0};  ///< number of its question, 0: not asked yet
    rtapi::Nanos since{0};
  };
  struct Aside {
    std::uint64_t after_seq{0};
    TaskItem item;
  };

  // interpreter_participant.cpp
  void follow_abort();
  void resynchronise();
  void work(rtapi::WaitSpec& next);
  bool read_block();
  /// `record`: begun with what the block found.
  void record_delivered();
  void take_outcome(interp::Outcome outcome, std::size_t items_before, BlockRecord record);
  /// True when the block changes the tool table.
  bool queue_tool_changes();
  std::uint64_t prompts_{0};
  void hear_database(rtapi::WaitSpec& next);
  void store_tools(const StoreTools& store);
  rtapi::Status load_tools();
  rtapi::Status put_tool(const io::ToolEntry& tool);
  void reset_state();
  bool synchronise_if_due();
  bool finish_run();
  void note_stepping();
  /// While stepping: whether the item at the head of the list may begin.
  [[nodiscard]] bool step_allows(const TaskItem& item);
  bool step_stop();
  bool next_order();
  void drop_mdi_orders();
  void begin_run(const Order& order);
  rtapi::Status open_program(const std::string& path);
  void sync_position();
  /// Where the machine stands, if that is not where canon and interpreter think.
  [[nodiscard]] std::optional<motion::Pose> moved_position() const;
  /// Tells the interpreter what the machine has done since the last time.
  void tell_interpreter();
  [[nodiscard]] bool executed() const {
    // Kinematics about to be switched change where the machine stands.
    return (pending_seq_ == 0 || status_.executed_seq >= pending_seq_) &&
           !status_.kinematics_pending;
  }
  [[nodiscard]] bool motion_ready() const;
  /// Moves begin where the machine stands once its kinematics have the length of the tool that was told last.
  [[nodiscard]] bool settled() {
    if (status_.executed_seq >= settling_seq_ && !status_.kinematics_pending) settling_seq_ = 0;
    return settling_seq_ == 0;
  }
  bool push(const PathBody& body, const motion::SourceTag& tag);
  void finish_ticket(CommandState state, const std::string& text = {});
  /// The program cannot go on.
  void fail(const std::string& text, const std::string& file, std::int32_t line);
  void fail_here(const std::string& text);
  void fail_at(const motion::SourceTag& tag, const std::string& text);

  // check_limits.cpp
  void check_limits(rtapi::WaitSpec& next);

  // tool_exchange.cpp
  /// Answers who says that another tool stands in the spindle.
  bool exchange_tools();
  /// "" or why not; then `entry` is the new tool.
  [[nodiscard]] std::string why_no_exchange(std::int32_t tool, io::ToolEntry& entry,
                                            motion::Pose& change);
  /// The last block's items, from `from` of the list on, in the coordinates of the path that motion drives.
  void place_items(std::size_t from);
  void note_extent(std::size_t from, std::size_t to, BlockRecord& record) const;
  void ask_shift(Ticket ticket);

  // run_from_line.cpp
  void begin_seek(const Order& order);
  void refuse_seek(const std::string& what);
  void search(rtapi::WaitSpec& next);
  void end_seek(const std::string& what);
  void approach();

  // on_abort.cpp
  void run_on_abort(std::uint32_t reason);

  // barriers.cpp
  bool pump(rtapi::WaitSpec& next);
  bool run_asides();
  bool run_aside(TaskItem& item);
  bool tool_order_ended();
  bool begin_barrier(TaskItem& item);
  bool poll_barrier(TaskItem& item, rtapi::WaitSpec& next);
  bool poll_tool(const char* what);
  bool poll_user_program(const UserMcodeRun& run);
  bool poll_pause(const ProgramPause& pause);
  bool poll_input(const WaitInput& wait, rtapi::WaitSpec& next);
  bool poll_orient(const WaitOrient& wait, rtapi::WaitSpec& next);
  bool start_user_program(const UserMcodeRun& run);
  void log_text(const LogText& log);

  // view.cpp
  void show();
  void fill_waiting(InterpreterView& view) const;
  void fill_prompt(InterpreterView& view);

  Parts p_;
  std::deque<TaskItem> list_;
  CanonToPath canon_;
  interp::Interpreter interp_;
  interp::ParameterFile parameter_file_;
  std::unique_ptr<LimitCheck> check_;  ///< of the open program, while nothing else is to be done
  bool check_due_{false};
  std::unique_ptr<ProgramSeek> seek_;  ///< while the line to begin at is searched
  BlockHistory history_;
  motion::MotionStatus status_;
  rtapi::Nanos now_{0};
  std::uint32_t epoch_{0};
  bool aborting_{false};
  bool announce_{true};
  bool stopped_{false};
  rtapi::Nanos stopped_at_{0};
  std::uint64_t stepped_to_{0};  ///< id of the block behind which the last step ended
  std::uint32_t step_resumes_{0};
  std::uint64_t last_seq_{0};
  std::uint64_t last_tag_{0};      ///< of it
  std::uint64_t pending_seq_{0};   ///< last item queued under this epoch
  std::uint64_t settling_seq_{0};  ///< item that moves wait for (settled()); 0: none
  bool aside_before_next_{false};  ///< task does something before the next item
  bool pushed_{false};
  int silent_blocks_{0};
  bool ring_full_{false};
  Run run_;
  Barrier barrier_;
  std::deque<Aside> asides_;
  std::uint64_t tool_order_{0};  ///< in progress at io
  bool tool_order_is_prepare_{false};
  motion::SourceTag prepare_tag_;
  /// What the interpreter does not know yet. One block may do all of them.
  struct News {
    bool tool{false}, input{false}, probe{false};
  } news_;
  double input_value_{0};
  bool input_timeout_{false};
  bool failed_{false};               ///< the last program or MDI line is in error
  motion::Pose shift_;               ///< Intent::path_shift as it was asked for last
  std::uint64_t exchange_order_{0};  ///< at io: the number of the exchanged tool
  UserProgram user_;
  std::FILE* log_{nullptr};
  std::FILE* probe_log_{nullptr};  ///< (PROBEOPEN)
  std::string file_;               ///< open program
  std::string command_;
  std::int32_t program_lines_{0};
  double progress_{0};
  WaitingFor waiting_for_;
  InterpreterView view_;
  std::vector<Report> reports_;  ///< of this step
};

}  // namespace kerf::task
