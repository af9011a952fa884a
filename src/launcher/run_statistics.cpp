#include "launcher/run_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::launcher {

namespace {
/// Without the sign of a zero that rounding makes.
double plain(double v) { return std::fabs(v) < 0.005 ? 0.0 : v; }
}  // namespace

void RunStatistics::add(const motion::JointSample& sample) {
  const double period_s = static_cast<double>(sample.period_ns) * 1e-9;
  if (cycles_ > 0) {
    if (sample.cycle <= before_.cycle) return;
    const std::uint64_t step = sample.cycle - before_.cycle;
    seconds_ += static_cast<double>(step) * period_s;
    missing_ += step - 1;
    if (step != 1) in_row_ = 0;
  }
  ++cycles_;
  add_joints(sample);
  if (in_row_ > 0) add_path(sample);
  in_row_ = std::min(in_row_ + 1, 2);
  before_ = sample;
}

void RunStatistics::add_joints(const motion::JointSample& sample) {
  const auto n = static_cast<std::size_t>(
      std::clamp<std::int32_t>(sample.joints, 0, static_cast<std::int32_t>(motion::kMaxJoints)));
  if (joints_.size() < n) joints_.resize(n);
  const double period_s = static_cast<double>(sample.period_ns) * 1e-9;
  for (std::size_t i = 0; i < n; ++i) {
    Joint& joint = joints_[i];
    joint.min = std::min(joint.min, sample.joint[i]);
    joint.max = std::max(joint.max, sample.joint[i]);
    if (in_row_ == 0 || period_s <= 0) continue;
    const double vel = (sample.joint[i] - before_.joint[i]) / period_s;
    joint.peak_vel = std::max(joint.peak_vel, std::fabs(vel));
    if (in_row_ > 1)
      joint.peak_acc = std::max(joint.peak_acc, std::fabs(vel - velocity_[i]) / period_s);
    velocity_[i] = vel;
  }
}

void RunStatistics::add_path(const motion::JointSample& sample) {
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = sample.position[i] - before_.position[i];
    square += d * d;
  }
  const double length = std::sqrt(square);
  if (length < 1e-12) return;
  using motion::MotionKind;
  const bool feed = sample.kind == MotionKind::feed || sample.kind == MotionKind::arc ||
                    sample.kind == MotionKind::probing;
  (feed ? feed_mm_ : rapid_mm_) += length;
  if (!block_counted_ || sample.block != last_block_) ++moving_blocks_;
  block_counted_ = true;
  last_block_ = sample.block;
}

std::string format_duration(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 3599.95) {
    const double minutes = std::floor((seconds + 0.05) / 60);
    return fmt::format("{:.0f} min {:04.1f} s", minutes, std::max(0.0, seconds - minutes * 60));
  }
  const auto whole = static_cast<long long>(std::llround(seconds));
  return fmt::format("{} h {:02} min {:02} s", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string format_summary(const RunStatistics& run, const SummaryInput& input) {
  std::string out = fmt::format("\n{}\n", input.program);
  out += fmt::format("  lines         {} of {} executed, {} blocks moved the machine\n",
                     input.lines_executed, input.program_lines, run.moving_blocks());
  out += fmt::format("  path          {:.1f} mm at feed, {:.1f} mm at rapid, {:.1f} mm in all\n",
                     run.feed_length_mm(), run.rapid_length_mm(),
                     run.feed_length_mm() + run.rapid_length_mm());
  out += fmt::format("  machine time  {}\n", format_duration(run.seconds()));
  if (run.joints().empty()) return out;
  out += fmt::format("  {:<7}{:>22}{:>30}{:>27}\n", "joint", "travel", "peak velocity / limit",
                     "peak acceleration / limit");
  for (std::size_t i = 0; i < run.joints().size(); ++i) {
    const RunStatistics::Joint& joint = run.joints()[i];
    const JointLimits limit = i < input.limits.size() ? input.limits[i] : JointLimits{};
    const char* unit = limit.rotary ? "deg" : "mm";
    const auto part = [](double peak, double max) {
      return max > 0 ? fmt::format("{:4.0f} %", 100 * peak / max) : std::string("     -");
    };
    out += fmt::format("  {:<7}{:>22}{:>30}{:>27}\n", i,
                       fmt::format("{:.2f} to {:.2f} {}", plain(joint.min), plain(joint.max), unit),
                       fmt::format("{:.1f} / {:.0f} {}/s {}", joint.peak_vel, limit.max_vel, unit,
                                   part(joint.peak_vel, limit.max_vel)),
                       fmt::format("{:.0f} / {:.0f} {}/s2 {}", joint.peak_acc, limit.max_acc, unit,
                                   part(joint.peak_acc, limit.max_acc)));
  }
  if (run.missing_cycles() > 0)
    out += fmt::format("  {} cycles were not recorded ({} found no room)\n", run.missing_cycles(),
                       input.dropped);
  return out;
}

}  // namespace kerf::launcher
