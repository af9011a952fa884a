#include "task/interpreter/program_seek.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "task/api/number_text.hpp"

namespace kerf::task {

using interp::Outcome;
using interp::SyncReason;

namespace {

constexpr double kSamePlace = 1e-6;  ///< mm, degrees

bool same_place(const rtapi::Pose& a, const rtapi::Pose& b) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (std::fabs(a[i] - b[i]) > kSamePlace) return false;
  return true;
}

/// Functions in Python work on the interpreter that runs the program; no other may take them over.
interp::Settings without_scripts(interp::Settings settings) {
  settings.scripts = false;
  return settings;
}

}  // namespace

ProgramSeek::ProgramSeek(const Parts& parts, interp::Interpreter& now, int tool, int pocket,
                         SeekEnd end)
    : p_(parts),
      interp_(p_.environment, p_.canon, without_scripts(p_.setup.interp)),
      end_(end),
      from_canon_(p_.canon.state()),
      from_modal_(now.modal()),
      tool_(tool),
      pocket_(pocket),
      highest_(from_canon_.position) {
  interp_.parameters() = now.parameters();
  interp_.init();
  interp_.parameters() = now.parameters();
  interp_.restore(from_modal_);
  interp_.synchronize({.machine_position = from_canon_.position,
                       .tool_in_spindle = tool,
                       .pocket_in_spindle = pocket});
  p_.canon.restore(from_canon_);
  p_.list.clear();
  p_.environment.note_hal_reads(&hal_read_);
}

ProgramSeek::~ProgramSeek() {
  p_.environment.note_hal_reads(nullptr);
  put_back();
}

void ProgramSeek::put_back() {
  if (kept_) return;
  kept_ = true;
  p_.list.clear();
  (void)p_.canon.take_tool_changes();
  (void)p_.canon.take_reload();
  p_.canon.restore(from_canon_);
}

bool ProgramSeek::refuse(const std::string& why) {
  refusal_ = why;
  return false;
}

bool ProgramSeek::refuse_here(const std::string& why) {
  return refuse("line " + std::to_string(at_) + " " + why);
}

bool ProgramSeek::open_file(const std::string& path) {
  if (p_.environment.scripts() != nullptr)
    return refuse(
        "the machine has functions in Python ([PYTHON]TOPLEVEL), which may ask or change anything "
        "on the way; run the program from its start");
  if (auto opened = interp_.open(path); !opened.ok()) return refuse(opened.error().message());
  file_ = interp_.current_file();
  return true;
}

bool ProgramSeek::open_whole(const std::string& path) {
  whole_ = true;
  place_.line = std::numeric_limits<std::int32_t>::max();
  return open_file(path);
}

bool ProgramSeek::open(const std::string& path, std::int32_t line) {
  auto place = find_line(path, line);
  if (!place.ok()) return refuse(place.error().message());
  place_ = *place;
  if (place_.line == 0)
    return refuse("the program has no code at line " + std::to_string(line) + " or behind it");
  if (!place_.inside.empty())
    return refuse("line " + std::to_string(place_.line) + " is inside the " + place_.inside +
                  ", which may run many times; choose a line outside");
  return open_file(path);
}

/// What the blocks before the line must not have asked for.
bool ProgramSeek::look_at_items() {
  if (!p_.canon.take_tool_changes().empty() || p_.canon.take_reload())
    return refuse_here("changes the tool table (G10 L1, L10, L11), which only a run may do");
  for (const TaskItem& item : p_.list) {
    if (watcher_) watcher_(item);
    if (const auto* path = std::get_if<PathBody>(&item.body)) {
      if (std::holds_alternative<motion::ProbeMove>(*path))
        return refuse_here("probes (G38): what it finds is only known when it runs");
      if (const auto* out = std::get_if<motion::OutputChange>(path)) {
        SeekOutput& output = outputs_[{out->analog, out->index}];
        (out->synchronised ? output.pending : output.value) = out->value;
      }
      const bool moves = std::holds_alternative<motion::LinearMove>(*path) ||
                         std::holds_alternative<motion::ArcMove>(*path) ||
                         std::holds_alternative<motion::CubicMove>(*path);
      for (auto& [which, output] : outputs_)
        if (moves && output.pending) output.value = std::exchange(output.pending, std::nullopt);
    } else if (const auto* error = std::get_if<ProgramError>(&item.body)) {
      return refuse_here("cannot run: " + error->text);
    } else if (const auto* run = std::get_if<UserMcodeRun>(&item.body)) {
      left_out_.push_back("M" + std::to_string(run->number) + " of line " + std::to_string(at_));
    } else if (const auto* log = std::get_if<LogText>(&item.body)) {
      if (log->kind == LogText::Kind::open || log->kind == LogText::Kind::append)
        log_file_ = log->text;
      if (log->kind == LogText::Kind::close) log_file_.clear();
    } else if (const auto* set = std::get_if<SetToolNumber>(&item.body)) {
      tool_ = set->number;
      tool_by_number_ = true;
    } else if (const auto* change = std::get_if<ChangeTool>(&item.body)) {
      if (change->number >= 0) tool_ = change->number;
      tool_by_number_ = false;
    } else if (std::holds_alternative<WaitInput>(item.body)) {
      input_line_ = at_;
    }
  }
  p_.list.clear();
  const rtapi::Pose& at = p_.canon.state().position;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) highest_[a] = std::max(highest_[a], at[a]);
  return true;
}

/// What the machine would have answered.
bool ProgramSeek::answer(SyncReason reason) {
  interp::ExternalState state;
  if (reason == SyncReason::script) return refuse_here("calls a function in Python");
  if (reason == SyncReason::probe)
    return refuse_here("probes (G38): what it finds is only known when it runs");
  if (reason == SyncReason::wait_input) {
    state.input_value = 0;
    (void)interp_.parameters().take_input_read();
  }
  const interp::ModalState& modal = interp_.modal();
  const rtapi::Pose& at = p_.canon.state().position;
  if (!interp_.beside_path() && !same_place(modal.frame.to_machine(modal.position), at))
    state.machine_position = at;
  pocket_ = 0;
  if (const auto tool = p_.environment.find_tool(tool_); tool && !p_.setup.tools.random_changer)
    pocket_ = tool->pocket;
  state.tool_in_spindle = tool_;
  state.pocket_in_spindle = pocket_;
  interp_.synchronize(state);
  return true;
}

/// At the line: may a run begin here?
bool ProgramSeek::may_begin_here() {
  const interp::ModalState& modal = interp_.modal();
  const std::string line = "line " + std::to_string(place_.line);
  if (modal.cutter_comp != 400 || interp_.waiting() || interp_.beside_path())
    return refuse(
        line +
        " is inside cutter compensation (G41, G42); choose a line before it or behind its G40");
  if (modal.nurbs_points > 0) return refuse(line + " is inside a spline (G5.2 to G5.3)");
  if (modal.motion == 330 || modal.motion == 331)
    return refuse(line +
                  " is behind a move in step with the spindle (G33) that may go on here; "
                  "choose a line behind the next G0 or G1");
  if (std::any_of(modal.orienting.begin(), modal.orienting.end(), [](bool o) { return o; }))
    return refuse(line +
                  " has the spindle at an angle (M19); choose a line behind the next M3, M4 or M5");
  return true;
}

ProgramSeek::Step ProgramSeek::step() {
  const bool top =
      interp_.call_level() == 0 && interp_.current_file() == file_ && interp_.at_line_start();
  const std::int32_t next = interp_.next_line();
  if (top && next == place_.line) return may_begin_here() ? Step::found : Step::refused;
  if (top) at_ = next;
  if (p_.setup.tools.at_g30)
    p_.canon.set_g30(interp_.parameters().pose(interp::kG30Home, p_.setup.linear_unit_mm));
  p_.canon.new_tag();
  const Outcome outcome = interp_.execute_next();
  if (outcome == Outcome::error) {
    refuse(interp_.error().message());
    return Step::refused;
  }
  if (hal_read_) {
    refuse_here("reads a HAL pin, whose value of then nobody knows");
    return Step::refused;
  }
  if (input_line_ != 0 && interp_.parameters().take_input_read()) {
    refuse_here("uses #5399, which the M66 of line " + std::to_string(input_line_) +
                " finds only when it runs");
    return Step::refused;
  }
  if (!look_at_items()) return Step::refused;
  if (outcome == Outcome::needs_sync && !answer(interp_.sync_reason())) return Step::refused;
  if (outcome == Outcome::program_end || outcome == Outcome::idle) {
    if (whole_) return Step::found;
    refuse("the program ends at line " + std::to_string(at_) + " and does not come to line " +
           std::to_string(place_.line));
    return Step::refused;
  }
  return Step::more;
}

namespace {

std::string code_name(char letter, std::int32_t tenths) {
  if (tenths < 0) return "none";
  std::string out(1, letter);
  out += std::to_string(tenths / 10);
  if (tenths % 10 != 0) out += '.' + std::to_string(tenths % 10);
  return out;
}

std::string direction_name(int direction, double rpm) {
  if (direction == 0) return "stopped";
  return (direction > 0 ? "forward " : "reverse ") + number(rpm) + " rpm";
}

}  // namespace

std::vector<std::string> seek_differences(const ProgramSeek& seek, const interp::ModalState& wanted,
                                          const CanonState& canon, const MachineNow& now,
                                          int spindles) {
  std::vector<std::string> out;
  const auto differ = [&](const std::string& what, const std::string& from, const std::string& to) {
    if (from != to) out.push_back(what + ": " + from + " -> " + to);
  };
  differ("tool", std::to_string(now.tool), std::to_string(seek.tool()));
  for (int n = 0; n < spindles; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const bool css = canon.css_max_rpm[i] > 0;
    const std::string wants = css && canon.direction[i] != 0
                                  ? std::string(canon.direction[i] > 0 ? "forward" : "reverse") +
                                        " at constant surface speed"
                                  : direction_name(canon.direction[i], canon.speed[i]);
    differ("spindle " + std::to_string(n),
           direction_name(now.spindle_direction[i], std::fabs(now.spindle_rpm[i])), wants);
  }
  const auto on = [](bool v) { return std::string(v ? "on" : "off"); };
  differ("flood", on(now.flood), on(wanted.flood));
  differ("mist", on(now.mist), on(wanted.mist));
  for (const auto& [which, output] : seek.outputs()) {
    const auto index = static_cast<std::size_t>(which.second);
    if (index >= (which.first ? motion::kMaxAnalog : 64)) continue;
    const double has =
        which.first ? now.analog_out[index] : static_cast<double>(now.digital_out >> index & 1U);
    const std::string name =
        std::string(which.first ? "analog" : "digital") + " output " + std::to_string(which.second);
    const double then = output.value.value_or(has);
    differ(name, number(has), number(then));
    if (output.pending) differ(name + " with the next move", number(then), number(*output.pending));
  }
  const auto from = seek.from_modal().active_g_codes(), to = wanted.active_g_codes();
  std::string codes;
  for (std::size_t i = 1; i < to.size(); ++i)
    if (from[i] != to[i])
      codes +=
          (codes.empty() ? "" : ", ") + code_name('G', from[i]) + " -> " + code_name('G', to[i]);
  if (!codes.empty()) out.push_back("codes: " + codes);
  const auto settings_from = seek.from_modal().settings(), settings_to = wanted.settings();
  differ("feed F", number(settings_from[1]), number(settings_to[1]));
  differ("speed S", number(settings_from[2]), number(settings_to[2]));
  const auto pose = [](const rtapi::Pose& p) {
    std::string text;
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if (a < 3 || p[a] != 0)
        text += (text.empty() ? "" : " ") + std::string(1, rtapi::kAxisLetters[a]) + number(p[a]);
    return text;
  };
  differ("work offset", pose(seek.from_modal().frame.g5x() + seek.from_modal().frame.g92()),
         pose(wanted.frame.g5x() + wanted.frame.g92()));
  differ("rotation", number(seek.from_modal().frame.rotation_deg()),
         number(wanted.frame.rotation_deg()));
  differ("tool offset", pose(seek.from_modal().frame.tool()), pose(wanted.frame.tool()));
  differ("machine position", pose(now.position), pose(canon.position));
  for (const std::string& what : seek.left_out()) out.push_back("left out: " + what);
  return out;
}

}  // namespace kerf::task
