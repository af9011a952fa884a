#include "launcher/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::launcher {

namespace {
constexpr double kRedrawEveryS = 0.1;
constexpr int kStepPercent = 10;

std::string times(const ProgressState& state) {
  std::string out = clock_text(state.elapsed_s);
  if (const auto left = estimate_left_s(state)) out += ", about " + clock_text(*left) + " left";
  return out;
}

std::string place(const ProgressState& state) {
  if (state.line <= 0) return {};
  return state.lines > 0 ? fmt::format("line {} of {}", state.line, state.lines)
                         : fmt::format("line {}", state.line);
}
}  // namespace

std::optional<double> estimate_left_s(const ProgressState& state) {
  const double done = std::min(state.fraction, 1.0) - state.from_fraction;
  if (done < 0.01 || state.elapsed_s < 0.5) return std::nullopt;
  return state.elapsed_s * (1 - state.from_fraction - done) / done;
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::floor(std::max(0.0, seconds)));
  if (whole >= 3600)
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string progress_line(const ProgressState& state, int width) {
  const double done = std::clamp(state.fraction, 0.0, 1.0);
  std::string text =
      fmt::format(" {:3.0f} %  {}  {}", std::floor(done * 100), place(state), times(state));
  if (!state.waiting.empty()) text += "  waits for " + state.waiting;
  const int room = width - static_cast<int>(text.size()) - 3;
  std::string line;
  if (room >= 8) {
    const int cells = std::min(room, 40);
    const auto full = static_cast<std::size_t>(std::floor(done * cells));
    line = "[" + std::string(full, '#') + std::string(static_cast<std::size_t>(cells) - full, ' ') +
           "]";
  }
  line += text;
  // A line that wraps cannot be drawn over.
  if (static_cast<int>(line.size()) >= width)
    line.resize(static_cast<std::size_t>(std::max(width - 1, 0)));
  return line;
}

std::string ProgressPrinter::update(const ProgressState& state, double now_s) {
  if (terminal_) {
    const bool due = now_s - drawn_at_s_ >= kRedrawEveryS || now_s < drawn_at_s_;
    if (!due && state.fraction < 1) return {};
    drawn_ = true;
    drawn_at_s_ = now_s;
    return "\r\x1b[K" + progress_line(state, width_);
  }
  std::string out;
  if (state.waiting != waiting_) {
    waiting_ = state.waiting;
    if (!waiting_.empty()) out = "kerf: the program waits for " + waiting_ + "\n";
  }
  const int percent = static_cast<int>(std::floor(state.fraction * 100 + 1e-9));
  if (percent >= next_percent_) {
    next_percent_ = percent / kStepPercent * kStepPercent + kStepPercent;
    const std::string where = place(state);
    out += fmt::format("kerf: {:3} %  {}{}{}\n", percent, where, where.empty() ? "" : "  ",
                       times(state));
  }
  return out;
}

std::string ProgressPrinter::clear() {
  if (!drawn_) return {};
  drawn_ = false;
  drawn_at_s_ = -1e9;
  return "\r\x1b[K";
}

}  // namespace kerf::launcher
