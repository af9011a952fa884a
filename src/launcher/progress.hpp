// The progress of a program run, as a line that people read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace kerf::launcher {

struct ProgressState {
  double fraction{0};  ///< 0..1, lines done of all lines
  double from_fraction{
      0};  ///< where motion began: lines before it (subroutines, comments) took no time
  double elapsed_s{0};  ///< machine time since the start of the run
  int line{0};          ///< in execution; 0: none
  int lines{0};         ///< of the program; 0: unknown
  std::string waiting;  ///< what the program waits for, or ""
};

/// Machine time that is left, from what the part done since motion began took; nothing below 1 % or 0.5 s.
[[nodiscard]] std::optional<double> estimate_left_s(const ProgressState& state);

/// "[########            ]  40 %  line 23 of 57  0:12  left 0:18". `width` is that of the terminal.
[[nodiscard]] std::string progress_line(const ProgressState& state, int width);

/// "0:07", "12:34", "1:02:03".
[[nodiscard]] std::string clock_text(double seconds);

/// Decides what is printed: at a terminal one line, drawn anew at most ten times a second; else a line every 10 %.
class ProgressPrinter {
 public:
  ProgressPrinter(bool terminal, int width) : terminal_(terminal), width_(width) {}
  /// Text to write to stderr at real time `now_s`, or "".
  [[nodiscard]] std::string update(const ProgressState& state, double now_s);
  /// Text that frees the line for other messages, or "".
  [[nodiscard]] std::string clear();

 private:
  bool terminal_;
  int width_;
  bool drawn_{false};
  double drawn_at_s_{-1e9};
  int next_percent_{10};
  std::string waiting_;
};

}  // namespace kerf::launcher
