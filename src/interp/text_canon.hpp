// TextCanon: prints canonical calls one a line, in the format of the peer's rs274.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>

#include "interp/canon.hpp"
#include "interp/fixed_text.hpp"
#include "interp/modal.hpp"

namespace kerf::interp {

/// Lengths are printed in the program's units (G20: inches). Calls that the format does not have print nothing.
class TextCanon final : public Canon {
 public:
  /// `out` stays open; the caller flushes it. Rows of the tool table are printed in machine units.
  explicit TextCanon(std::FILE* out, double machine_unit_mm = 1.0)
      : out_(out), machine_unit_mm_(machine_unit_mm) {
    no_label();
  }

  /// Where the peer's listing takes the machine to be when it asks after a tool change: it does not see that a tool offset moves the
  /// program's zero. The tool offset at the end of the last motion, when another one is on; asking forgets it.
  [[nodiscard]] std::optional<Pose> take_offset_of_last_motion() {
    if (!offset_changed_) return std::nullopt;
    offset_changed_ = false;
    return offset_of_last_motion_;
  }

  void next_block(const SourceLine& source) override;
  void use_length_units(Units units) override;
  void select_plane(Plane plane) override;
  void set_g5x_offset(int system, const Pose& offset) override;
  void set_g92_offset(const Pose& offset) override;
  void set_xy_rotation(double degrees) override;
  void use_tool_length_offset(const Pose& offset) override;
  void set_feed_rate(double linear_mm_min, double angular_deg_min) override;
  void set_feed_mode(int spindle, FeedMode mode) override;
  void set_feed_reference() override;
  void set_motion_control_mode(PathMode mode, double tolerance_mm) override;
  void set_naivecam_tolerance(double tolerance_mm) override;
  void set_planner_mode(int type, double corner_factor) override;
  void start_speed_feed_sync(int spindle, double mm_per_revolution, bool velocity_mode) override;
  void stop_speed_feed_sync() override;
  void straight_traverse(const Pose& end) override;
  void straight_feed(const Pose& end) override;
  void arc_feed(const Arc& arc) override;
  void nurbs_feed(std::span<const SplinePoint> points, int order) override;
  void straight_probe(const Pose& end, ProbeKind kind) override;
  void turn_probe_on() override;
  void turn_probe_off() override;
  void rigid_tap(const Pose& end, double return_scale) override;
  void dwell(double seconds) override;
  void set_spindle_speed(int spindle, double speed) override;
  void set_spindle_mode(int spindle, double css_max_rpm) override;
  void start_spindle(int spindle, SpindleDirection direction) override;
  void stop_spindle(int spindle) override;
  void orient_spindle(int spindle, double angle_deg, int mode) override;
  void wait_orient_complete(int spindle, double timeout_s) override;
  void select_tool(int number) override;
  void start_change() override {}
  void change_tool() override;
  void change_tool_number(int number) override;
  void set_tool_table_entry(const Tool& tool) override;
  void reload_tooldata() override;
  void set_mist(bool on) override;
  void set_flood(bool on) override;
  void set_motion_output_bit(int index, bool on) override;
  void set_motion_output_value(int index, double value) override;
  void set_aux_output_bit(int index, bool on) override;
  void set_aux_output_value(int index, double value) override;
  void wait_input(int, bool, WaitMode, double) override {}
  void enable_feed_override(bool on) override;
  void enable_speed_override(int spindle, bool on) override;
  void enable_adaptive_feed(bool on) override;
  void enable_feed_hold(bool on) override;
  void program_stop() override;
  void optional_program_stop() override;
  void pallet_shuttle() override;
  void program_end() override;
  void finish() override;
  /// For whoever makes a listing: a program was opened, or is done with.
  void on_reset();
  void user_mcode(int number, std::string_view path, double p, double q) override;
  void comment(std::string_view text) override;
  void message(std::string_view text) override;
  void print(std::string_view text) override;
  void log_open(std::string_view path, bool append) override;
  void log(std::string_view text) override;
  void log_close() override;
  void probe_log_open(std::string_view) override {}
  void probe_log_close() override {}

 private:
  /// A value of the calls that come by the million, with its text: most words of a move are those of the move before.
  struct Word {
    double value{0};
    std::uint32_t length{6};
    char text[28]{"0.0000"};
  };

  /// One whole line. For calls that are seldom.
  void line(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void pose(std::string_view name, const Pose& p, std::string_view before = "");
  void text(std::string_view name, std::string_view s);
  /// Counter, line number and the beginning of a call, into line_; returns the end.
  char* begin(std::string_view name);
  /// "%.4f" of the value; `word` remembers it.
  static char* put(char* to, Word& word, double value) {
    // Bits are compared: zero and minus zero are two texts.
    if (std::bit_cast<std::uint64_t>(word.value) != std::bit_cast<std::uint64_t>(value)) {
      char* const end = write_fixed<4>(to, value);
      const auto length = static_cast<std::size_t>(end - to);
      if (length <= sizeof word.text) {
        word.value = value;
        word.length = static_cast<std::uint32_t>(length);
        std::memcpy(word.text, to, sizeof word.text);
      }
      return end;
    }
    std::memcpy(to, word.text, sizeof word.text);
    return to + word.length;
  }
  static char* put(char* to, std::string_view s) {
    std::memcpy(to, s.data(), s.size());
    return to + s.size();
  }
  void no_label();
  void end(const char* to);
  [[nodiscard]] double length(double mm) const { return in_units(mm, unit_mm_); }

  std::FILE* out_;
  double unit_mm_{1};
  char label_[24];  ///< of the block: " N10    ", " N..... "
  std::size_t label_size_{0};
  std::uint32_t counter_{0};
  std::array<bool, kMaxSpindles> css_{};
  double machine_unit_mm_;
  int selected_tool_{0}, spindle_tool_{-1};
  bool offset_changed_{false};
  Pose tool_offset_, offset_of_last_motion_;
  std::array<Word, 6> pose_words_;
  std::array<Word, 8> arc_words_;
  char line_[16 * kLongestFixed]{};  ///< the line being made
};

}  // namespace kerf::interp
