#include "clients/motion_logger/command_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <type_traits>

namespace kerf::motion_logger {

using namespace motion;

namespace {

std::string text(double value) {
  if (!std::isfinite(value)) return value > 0 ? "inf" : std::isnan(value) ? "nan" : "-inf";
  if (std::fabs(value) >= 1e15) return value > 0 ? "none" : "-none";  // limits that are not there
  char out[64];
  std::snprintf(out, sizeof out, "%.6f", std::fabs(value) < 0.5e-6 ? 0.0 : value);
  std::string number(out);
  number.erase(number.find_last_not_of('0') + 1);
  if (number.back() == '.') number.pop_back();
  return number;
}

std::string text(const Pose& pose) {
  std::string out;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) out += (a == 0 ? "" : ",") + text(pose[a]);
  return out;
}

std::string text(MotionKind kind) {
  switch (kind) {
    case MotionKind::none: return "none";
    case MotionKind::traverse: return "traverse";
    case MotionKind::feed: return "feed";
    case MotionKind::arc: return "arc";
    case MotionKind::tool_change: return "tool-change";
    case MotionKind::probing: return "probing";
    case MotionKind::index_rotary: return "index-rotary";
  }
  return "?";
}

std::string text(SpindleChange::Action action) {
  switch (action) {
    case SpindleChange::Action::set_speed: return "set-speed";
    case SpindleChange::Action::forward: return "forward";
    case SpindleChange::Action::reverse: return "reverse";
    case SpindleChange::Action::stop: return "stop";
    case SpindleChange::Action::orient: return "orient";
  }
  return "?";
}

std::string text(PathControl::Mode mode) {
  return mode == PathControl::Mode::exact_path   ? "exact-path"
         : mode == PathControl::Mode::exact_stop ? "exact-stop"
                                                 : "continuous";
}

std::string text(MotionMode mode) {
  return mode == MotionMode::free          ? "free"
         : mode == MotionMode::coordinated ? "coordinated"
                                           : "teleop";
}

std::string text(JogIntent::Kind kind) {
  return kind == JogIntent::Kind::continuous    ? "continuous"
         : kind == JogIntent::Kind::incremental ? "incremental"
         : kind == JogIntent::Kind::absolute    ? "absolute"
                                                : "none";
}

template <class T>
requires std::is_integral_v<T> std::string text(T value) {
  if constexpr (std::is_same_v<T, bool>)
    return value ? "1" : "0";
  else
    return std::to_string(value);
}

template <class T, std::size_t N>
std::string text(const T (&values)[N]) {
  std::string out;
  for (std::size_t n = 0; n < N; ++n) out += (n == 0 ? "" : ",") + text(values[n]);
  return out;
}

/// Builds a line.
class Line {
 public:
  explicit Line(const char* name) : line_(name) {}
  template <class T>
  Line&& with(const char* name, const T& value) && {
    line_ += std::string(" ") + name + "=" + text(value);
    return std::move(*this);
  }
  operator std::string() && {
    return std::move(line_);
  }  // NOLINT(google-explicit-constructor): a line is its text

 private:
  std::string line_;
};

template <class Item>
std::string body_text(const Item& item, int line) {
  std::string out = std::string(Item::kName) + " line=" + std::to_string(line);
  Item::fields([&](const char* name, auto member, const char*) {
    out += std::string(" ") + name + "=" + text(item.*member);
  });
  return out;
}

using Lines = std::vector<std::string>;

void jog_change(Lines& out, const char* what, const std::string& which, const JogIntent& before,
                const JogIntent& now) {
  if (before.seq == now.seq) return;
  if (now.kind == JogIntent::Kind::none) {
    out.push_back(std::string("jog-stop ") + what + "=" + which);
    return;
  }
  out.push_back(std::string("jog ") + what + "=" + which + " kind=" + text(now.kind) +
                " vel=" + text(now.vel) + " target=" + text(now.target));
}

/// One wish of a kind that is carried out once.
template <class T>
void once_change(Lines& out, const std::string& name, const char* field, const Once<T>& before,
                 const Once<T>& now) {
  if (before.seq != now.seq) out.push_back(name + " " + field + "=" + text(now.value));
}

std::string letter(std::size_t axis) { return std::string(1, rtapi::kAxisLetters[axis]); }

std::string joint_text(int number, const JointConfig& j) {
  return Line("joint")
      .with("number", number)
      .with("min-limit", j.min_limit)
      .with("max-limit", j.max_limit)
      .with("max-vel", j.max_vel)
      .with("max-acc", j.max_acc)
      .with("max-jerk", j.max_jerk)
      .with("ferror", j.ferror)
      .with("min-ferror", j.min_ferror)
      .with("backlash", j.backlash)
      .with("home", j.home)
      .with("home-offset", j.home_offset)
      .with("home-search-vel", j.home_search_vel)
      .with("home-latch-vel", j.home_latch_vel)
      .with("home-final-vel", j.home_final_vel)
      .with("home-sequence", j.home_sequence)
      .with("home-flags", j.home_flags)
      .with("volatile-home", j.volatile_home)
      .with("rotary", j.rotary);
}

std::string axis_text(std::size_t axis, const AxisConfig& a) {
  return "axis letter=" + letter(axis) +
         std::string(Line("")
                         .with("min-limit", a.min_limit)
                         .with("max-limit", a.max_limit)
                         .with("max-vel", a.max_vel)
                         .with("max-acc", a.max_acc)
                         .with("max-jerk", a.max_jerk));
}

std::string spindle_text(int number, const SpindleConfig& s) {
  return Line("spindle")
      .with("number", number)
      .with("max-forward", s.max_forward_rpm)
      .with("min-forward", s.min_forward_rpm)
      .with("max-reverse", s.max_reverse_rpm)
      .with("min-reverse", s.min_reverse_rpm);
}

std::string machine_text(const MachineConfig& m) {
  return Line("machine")
      .with("joints", m.joints)
      .with("spindles", m.spindles)
      .with("max-vel", m.traj_max_vel_mm_s)
      .with("max-ang-vel", m.traj_max_ang_vel_deg_s)
      .with("max-acc", m.traj_max_acc_mm_s2)
      .with("max-feed-override", m.max_feed_override)
      .with("no-force-homing", m.no_force_homing);
}

/// "linear-move line=3 end= (mm|deg) vel= (mm/s) kind="
template <class Item>
std::string form() {
  std::string out = std::string(Item::kName) + " line=";
  Item::fields([&out](const char* name, auto, const char* unit) {
    out += std::string(" ") + name + "=";
    if (*unit != '\0') out += std::string("(") + unit + ")";
  });
  return out;
}

template <class... M>
std::string forms(const MessageSet<M...>&) {
  std::string out;
  ((out += form<M>() + "\n"), ...);
  return out;
}

}  // namespace

std::string text_of(const PathItem& item) {
  return std::visit([&item](const auto& body) { return body_text(body, item.tag.line); },
                    item.body);
}

Lines changes(const IntentWords& before, const IntentWords& now) {
  Lines out;
  for (std::uint32_t epoch = before.abort_epoch; epoch != now.abort_epoch; ++epoch)
    out.emplace_back("abort");
  if (before.enable != now.enable) out.push_back(Line("enable").with("on", now.enable));
  if (before.hold != now.hold) out.push_back(Line("hold").with("on", now.hold));
  return out;
}

Lines changes(const Intent& before, const Intent& now, std::int32_t spindles) {
  const auto count = std::min(static_cast<std::size_t>(std::max(0, spindles)), kMaxSpindles);
  Lines out;
  if (before.mode != now.mode) out.push_back(Line("mode").with("mode", now.mode));
  if (before.feed_override != now.feed_override)
    out.push_back(Line("feed-override").with("value", now.feed_override));
  if (before.rapid_override != now.rapid_override)
    out.push_back(Line("rapid-override").with("value", now.rapid_override));
  for (std::size_t s = 0; s < count; ++s)
    if (before.spindle_override[s] != now.spindle_override[s])
      out.push_back(
          Line("spindle-override").with("spindle", s).with("value", now.spindle_override[s]));
  if (before.max_vel_mm_s != now.max_vel_mm_s)
    out.push_back(Line("max-velocity").with("value", now.max_vel_mm_s));
  for (std::size_t j = 0; j < kMaxJoints; ++j)
    jog_change(out, "joint", std::to_string(j), before.joint_jog[j], now.joint_jog[j]);
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    jog_change(out, "axis", letter(a), before.axis_jog[a], now.axis_jog[a]);
  if (before.home_seq != now.home_seq) out.push_back(Line("home").with("joint", now.home_joint));
  if (before.unhome_seq != now.unhome_seq)
    out.push_back(Line("unhome").with("joint", now.unhome_joint));
  if (before.override_limits != now.override_limits)
    out.push_back(Line("override-limits").with("on", now.override_limits));
  if (before.single_step != now.single_step)
    out.push_back(Line("single-step").with("on", now.single_step));
  for (std::size_t s = 0; s < count; ++s)
    if (before.spindle_stop_seq[s] != now.spindle_stop_seq[s])
      out.push_back(Line("spindle-stop").with("spindle", s));
  for (std::size_t n = 0; n < kMaxDigital; ++n)
    once_change(out, "digital-out index=" + std::to_string(n), "on", before.digital_out[n],
                now.digital_out[n]);
  for (std::size_t n = 0; n < kMaxAnalog; ++n)
    once_change(out, "analog-out index=" + std::to_string(n), "value", before.analog_out[n],
                now.analog_out[n]);
  once_change(out, "feed-override-enable", "on", before.feed_override_enable,
              now.feed_override_enable);
  once_change(out, "adaptive-feed-enable", "on", before.adaptive_feed_enable,
              now.adaptive_feed_enable);
  once_change(out, "feed-hold-enable", "on", before.feed_hold_enable, now.feed_hold_enable);
  for (std::size_t s = 0; s < count; ++s) {
    const std::string which = " spindle=" + std::to_string(s);
    once_change(out, "spindle-override-enable" + which, "on", before.spindle_override_enable[s],
                now.spindle_override_enable[s]);
    once_change(out, "brake" + which, "on", before.brake[s], now.brake[s]);
  }
  return out;
}

Lines changes(const MachineConfig& before, const MachineConfig& now) {
  Lines out;
  const bool first = before.joints == 0;
  const auto add = [&out, first](const std::string& old_text, std::string text) {
    if (first || old_text != text) out.push_back(std::move(text));
  };
  add(machine_text(before), machine_text(now));
  for (std::int32_t j = 0; j < now.joints; ++j)
    add(joint_text(j, before.joint[j]), joint_text(j, now.joint[j]));
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    if ((now.axis_mask & (1U << a)) != 0)
      add(axis_text(a, before.axis[a]), axis_text(a, now.axis[a]));
  for (std::int32_t s = 0; s < now.spindles; ++s)
    add(spindle_text(s, before.spindle[s]), spindle_text(s, now.spindle[s]));
  return out;
}

std::string manual_list() {
  // Each line of text that can be made, from the same code that makes them.
  std::string out = forms(PathItems{});
  IntentWords words{2, true, true};
  Intent wishes;
  wishes.mode = MotionMode::coordinated;
  wishes.feed_override = wishes.rapid_override = wishes.spindle_override[0] = 0.5;
  wishes.max_vel_mm_s = 100;
  wishes.joint_jog[0] = {1, JogIntent::Kind::continuous, 10, 0};
  wishes.axis_jog[0] = {1, JogIntent::Kind::incremental, 10, 1};
  wishes.axis_jog[1] = {1, JogIntent::Kind::none, 0, 0};
  wishes.home_seq = wishes.unhome_seq = wishes.spindle_stop_seq[0] = 1;
  wishes.override_limits = wishes.single_step = true;
  wishes.digital_out[0].wish(true);
  wishes.analog_out[0].wish(1.5);
  wishes.feed_override_enable.wish(true);
  wishes.adaptive_feed_enable.wish(true);
  wishes.feed_hold_enable.wish(true);
  wishes.spindle_override_enable[0].wish(true);
  wishes.brake[0].wish(true);
  MachineConfig machine;
  machine.joints = 1;
  machine.axis_mask = 1;
  for (const auto& lines : {changes(IntentWords{}, words), changes(Intent{}, wishes, 1),
                            changes(MachineConfig{}, machine)})
    for (const auto& line : lines) out += line + "\n";
  std::string roff;
  for (const char c : out) roff += c == '-' ? "\\-" : std::string(1, c);
  return roff;
}

}  // namespace kerf::motion_logger
