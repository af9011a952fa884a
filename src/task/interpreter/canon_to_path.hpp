// CanonToPath: turns canonical calls into task items: program to machine coordinates, feeds per minute to mm/s, arcs to centre
// and normal. No clock, no queue limits, no motion: the list it fills is drained by InterpreterParticipant.
#pragma once

#include <array>
#include <deque>
#include <string>
#include <utility>

#include "interp/canon.hpp"
#include "interp/canon_frame.hpp"
#include "interp/interpreter.hpp"
#include "motion/api/config.hpp"
#include "motion/api/path_items.hpp"
#include "task/interpreter/task_items.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

/// What the canon remembers between calls. Plain copyable: a copy is kept for each block and given back after an abort.
struct CanonState {
  interp::CanonFrame frame;
  motion::Pose position;  ///< machine coordinates of the path's end
  double linear_mm_min{0}, angular_deg_min{0};
  interp::FeedMode feed_mode{interp::FeedMode::per_minute};
  int feed_spindle{0};
  int sync_spindle{-1};       ///< feed moves follow it (G33, G76); -1: none
  double sync_per_rev_mm{0};  ///< way in one revolution
  motion::PathControl path;
  motion::OverrideEnable overrides;
  std::array<double, motion::kMaxSpindles> speed{};  ///< rpm; mm/min of surface in G96
  std::array<double, motion::kMaxSpindles> css_max_rpm{};
  std::array<double, motion::kMaxSpindles>
      surface_unit{};       ///< mm/min of one unit of S, of the last S in G96
  double surface_mm{1000};  ///< the same for the next S: m/min, in inches feet/min
  std::array<std::int8_t, motion::kMaxSpindles> direction{};  ///< -1 0 1
  int g5x_index{1};
  std::uint32_t pending_outputs{0};  ///< synchronised output changes since the last move
  int selected_tool{-1};             ///< what M6 brings
  bool tool_awaits_change{false};    ///< T without M6 yet
};

/// A block whose calls came while a later one was executed (cutter compensation holds them back).
struct DeliveredBlock {
  motion::SourceTag tag;
  std::size_t first_item{0};  ///< in the list
  interp::ModalState modal;   ///< after the block
  CanonState canon;
};

class CanonToPath final : public interp::Canon {
 public:
  CanonToPath(std::deque<TaskItem>& list, const ToolConfig& tools) : list_(list), tools_(tools) {}

  [[nodiscard]] const CanonState& state() const noexcept { return state_; }
  void restore(const CanonState& state) { state_ = state; }
  void set_position(const motion::Pose& machine) { state_.position = machine; }
  /// Axes with a locking joint, a bit each: rapids turn them in a move of their own.
  void set_indexers(std::uint32_t axes) noexcept { indexers_ = axes; }
  /// A rapid between two places; locking indexers turn first, each alone. Does not tell where the path leads.
  void add_rapid(const motion::Pose& from, const motion::Pose& end, motion::MotionKind kind);
  /// The tool has another length than it had.
  void replace_tool_offset(const motion::Pose& offset);
  /// After an abort: what stops with it.
  void forget_outputs();
  /// How many outputs motmod has (num_dio, num_aio).
  void set_output_counts(int digital, int analog) noexcept {
    digital_count_ = digital;
    analog_count_ = analog;
  }
  /// Queues path control, override switches and tool offset again, as they are now.
  void announce(std::uint64_t tag_id);

  /// How feeds are meant as things are now (G95).
  [[nodiscard]] motion::FeedPerRev feed_per_rev() const;

  /// The tag of the block in delivery; ids come from `next_tag_id`.
  [[nodiscard]] const motion::SourceTag& tag() const noexcept { return tag_; }
  /// A new id, for a block that is about to be executed.
  std::uint64_t new_tag() { return tag_.id = ++last_id_; }
  /// Until end_delivery() each next_block() is a block of its own, with a new id and the state that `interpreter` shows.
  void begin_delivery(const interp::Interpreter& interpreter) {
    interpreter_ = &interpreter;
    delivered_.clear();
  }
  [[nodiscard]] const std::vector<DeliveredBlock>& end_delivery();
  /// Ids go on behind `id`.
  void start_tags_after(std::uint64_t id) { last_id_ = id; }
  /// Where the machine stands for G30 with TOOL_CHANGE_AT_G30, asked of the owner at each tool change (machine coordinates).
  void set_g30(const motion::Pose& machine) { g30_ = machine; }
  /// G10 L1 and its like, since the last call: to be put into the tool table.
  std::vector<interp::Tool> take_tool_changes() { return std::exchange(tool_changes_, {}); }
  [[nodiscard]] bool take_reload() { return std::exchange(reload_, false); }

  // --- Canon ---
  void next_block(const interp::SourceLine& source) override;
  void use_length_units(interp::Units units) override;
  void select_plane(interp::Plane) override {}
  void set_g5x_offset(int system, const interp::Pose& offset) override;
  void set_g92_offset(const interp::Pose& offset) override;
  void set_xy_rotation(double degrees) override;
  void use_tool_length_offset(const interp::Pose& offset) override;
  void set_feed_rate(double linear_mm_min, double angular_deg_min) override;
  void set_feed_mode(int spindle, interp::FeedMode mode) override;
  void set_feed_reference() override {}
  void set_motion_control_mode(interp::PathMode mode, double tolerance_mm) override;
  void set_naivecam_tolerance(double tolerance_mm) override;
  void set_planner_mode(int type, double corner_factor) override;
  void start_speed_feed_sync(int spindle, double mm_per_revolution, bool velocity_mode) override;
  void stop_speed_feed_sync() override;
  void straight_traverse(const interp::Pose& end) override;
  void straight_feed(const interp::Pose& end) override;
  void arc_feed(const interp::Arc& arc) override;
  void nurbs_feed(std::span<const interp::SplinePoint> points, int order) override;
  void straight_probe(const interp::Pose& end, interp::ProbeKind kind) override;
  void turn_probe_on() override {}
  void turn_probe_off() override {}
  void rigid_tap(const interp::Pose& end, double return_scale) override;
  void dwell(double seconds) override;
  void set_spindle_speed(int spindle, double rpm) override;
  void set_spindle_mode(int spindle, double css_max_rpm) override;
  void start_spindle(int spindle, interp::SpindleDirection direction) override;
  void stop_spindle(int spindle) override;
  void orient_spindle(int spindle, double angle_deg, int mode) override;
  void wait_orient_complete(int spindle, double timeout_s) override;
  void select_tool(int number) override;
  void start_change() override;
  void change_tool() override;
  void change_tool_number(int number) override;
  void set_tool_table_entry(const interp::Tool& tool) override { tool_changes_.push_back(tool); }
  void reload_tooldata() override { reload_ = true; }
  void set_mist(bool on) override { add(SetCoolant{-1, on ? 1 : 0}); }
  void set_flood(bool on) override { add(SetCoolant{on ? 1 : 0, -1}); }
  void set_motion_output_bit(int index, bool on) override {
    output(index, false, true, on ? 1 : 0);
  }
  void set_motion_output_value(int index, double value) override {
    output(index, true, true, value);
  }
  void set_aux_output_bit(int index, bool on) override { output(index, false, false, on ? 1 : 0); }
  void set_aux_output_value(int index, double value) override { output(index, true, false, value); }
  void wait_input(int index, bool analog, interp::WaitMode mode, double timeout_s) override;
  void enable_feed_override(bool on) override;
  void enable_speed_override(int spindle, bool on) override;
  void enable_adaptive_feed(bool on) override;
  void enable_feed_hold(bool on) override;
  void program_stop() override { add(ProgramPause{false, std::exchange(pallet_, false)}); }
  void optional_program_stop() override { add(ProgramPause{true}); }
  void pallet_shuttle() override { pallet_ = true; }
  void program_end() override;
  void user_mcode(int number, std::string_view path, double p, double q) override;
  void comment(std::string_view) override {}
  void message(std::string_view text) override {
    add(ShowMessage{std::string(text), MessageKind::display});
  }
  void print(std::string_view text) override { add(PrintText{std::string(text)}); }
  void log_open(std::string_view path, bool append) override;
  void log(std::string_view text) override { add(LogText{LogText::Kind::text, std::string(text)}); }
  void log_close() override { add(LogText{LogText::Kind::close, {}}); }
  void probe_log_open(std::string_view path) override {
    add(LogText{LogText::Kind::probe_open, std::string(path)});
  }
  void probe_log_close() override { add(LogText{LogText::Kind::probe_close, {}}); }

 private:
  template <class Body>
  void add(Body body) {
    list_.push_back(TaskItem{tag_, TaskItemBody(std::move(body))});
  }
  void add_path(const PathBody& body) { list_.push_back(TaskItem{tag_, TaskItemBody(body)}); }
  void traverse_machine(const motion::Pose& end, motion::MotionKind kind);
  /// One that motion does not have fails in its place, behind what was programmed before it.
  void output(int index, bool analog, bool synchronised, double value);
  void frame_changed();
  [[nodiscard]] double feed_mm_s(const motion::Pose& end) const;
  [[nodiscard]] double linear_mm_s() const;
  [[nodiscard]] double nominal_rpm() const;
  [[nodiscard]] motion::SpindleChange spindle_change(int spindle,
                                                     motion::SpindleChange::Action action) const;

  std::deque<TaskItem>& list_;
  const ToolConfig& tools_;
  bool pallet_{false};  ///< M60: the stop that follows is for the pallets
  CanonState state_;
  motion::SourceTag tag_;
  std::uint64_t last_id_{0};
  std::string file_;
  motion::Pose g30_{};
  const interp::Interpreter* interpreter_{nullptr};
  std::vector<DeliveredBlock> delivered_;
  std::vector<interp::Tool> tool_changes_;
  bool reload_{false};
  std::uint32_t indexers_{0};
  int digital_count_{motion::kMaxDigital},
      analog_count_{motion::kMaxAnalog};  ///< until motion says
};

}  // namespace kerf::task
