#include "clients/halui/halui.hpp"

#include <cmath>
#include <cstdio>

#include "clients/halui/modes.hpp"

namespace kerf::clients::halui {
namespace {
constexpr std::int64_t kKeepEvery = 200'000'000;  ///< a fifth of the jogs' lease

std::vector<JogGroup::Item> joint_items(const Layout& layout) {
  std::vector<JogGroup::Item> items;
  items.reserve(static_cast<std::size_t>(layout.joints));
  for (int j = 0; j < layout.joints; ++j) items.push_back({j, std::to_string(j)});
  return items;
}

std::vector<JogGroup::Item> axis_items(const Layout& layout) {
  std::vector<JogGroup::Item> items;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    if ((layout.axis_mask >> a & 1U) != 0)
      items.push_back({static_cast<int>(a),
                       std::string(1, static_cast<char>(rtapi::kAxisLetters[a] + ('a' - 'A')))});
  return items;
}

}  // namespace

std::string word(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

Halui::Halui(const Layout& layout, Port& port)
    : layout_(layout),
      port_(port),
      mdi_(board_, layout.mdi_commands),
      jogs_{{board_, "joint.", joint_items(layout), kMotionFree},
            {board_, "axis.", axis_items(layout), kMotionTeleop}} {
  while (selected_axis_ < static_cast<int>(rtapi::kAxes) - 1 &&
         (layout_.axis_mask >> static_cast<unsigned>(selected_axis_) & 1U) == 0)
    ++selected_axis_;
  make_pins();
}

void Halui::update(const Stat& stat, std::int64_t now) {
  stat_ = &stat;
  if (!looked_) board_.remember();
  looked_ = true;
  for (const Button& button : buttons_)
    if (board_.rose(button.pin)) (this->*button.press)(button.index);
  for (Knob& knob : knobs_) knob.look(board_, stat, port_);
  mdi_.look(board_, stat, port_);
  jogs_.joints.look(board_, stat, port_, selected_joint_);
  jogs_.axes.look(board_, stat, port_, selected_axis_);
  const bool runs = jogs_.joints.runs() || jogs_.axes.runs();
  if (runs && now >= keep_at_) (void)port_.send({"jog-keep"});
  if (!runs || now >= keep_at_) keep_at_ = now + kKeepEvery;
  const Scene scene{stat, *this};
  for (const State& state : states_) board_.set(state.pin, state.value(scene, state.index));
  for (const Knob& knob : knobs_) knob.show(board_, stat);
  mdi_.show(board_);
  board_.remember();
}

bool Halui::on() const noexcept { return stat_->task_state == kStateOn; }

void Halui::abort(int) { port_.send({"abort"}); }
void Halui::estop_activate(int) { port_.send({"state", "estop"}); }
void Halui::estop_reset(int) {
  // On a machine that is on, task would take the drives away.
  if (stat_->task_state == kStateEstop) port_.send({"state", "estop-reset"});
}
void Halui::machine_on(int) { port_.send({"state", "on"}); }
void Halui::machine_off(int) { port_.send({"state", "off"}); }
void Halui::flood_on(int) { port_.send({"flood", "on"}); }
void Halui::flood_off(int) { port_.send({"flood", "off"}); }
void Halui::mist_on(int) { port_.send({"mist", "on"}); }
void Halui::mist_off(int) { port_.send({"mist", "off"}); }

void Halui::mode_manual(int) { port_.send({"mode", "manual"}); }
void Halui::mode_auto(int) { port_.send({"mode", "auto"}); }
void Halui::mode_mdi(int) { port_.send({"mode", "mdi"}); }
void Halui::go_manual(bool teleop) {
  if (stat_->task_mode != kModeManual) port_.send({"mode", "manual"});
  port_.send({"teleop", teleop ? "on" : "off"});
}
void Halui::mode_joint(int) { go_manual(false); }
void Halui::mode_teleop(int) { go_manual(true); }

void Halui::program_run(int) {
  if (stat_->interp_state != kInterpIdle) return;
  if (stat_->file.empty()) return port_.complain("halui.program.run: no program is open");
  port_.send({"run"});
}
void Halui::program_pause(int) {
  if (stat_->interp_state != kInterpIdle) port_.send({"pause"});
}
void Halui::program_resume(int) {
  if (stat_->interp_state != kInterpIdle) port_.send({"resume"});
}
void Halui::program_step(int) {
  if (stat_->file.empty()) return port_.complain("halui.program.step: no program is open");
  port_.send({"step"});
}
void Halui::block_delete_on(int) { port_.send({"block-delete", "on"}); }
void Halui::block_delete_off(int) { port_.send({"block-delete", "off"}); }
void Halui::optional_stop_on(int) { port_.send({"optional-stop", "on"}); }
void Halui::optional_stop_off(int) { port_.send({"optional-stop", "off"}); }

/// Only to the question that the pins show: the next one is not yet read by anybody.
void Halui::prompt_ok(int) {
  const task::Prompt& prompt = stat_->prompt;
  if (prompt.kind != task::PromptKind::none) port_.send({"answer", std::to_string(prompt.number)});
}

void Halui::home_all(int) { port_.send({"home"}); }
void Halui::joint_home(int index) { port_.send({"home", std::to_string(joint(index))}); }
void Halui::joint_unhome(int index) { port_.send({"unhome", std::to_string(joint(index))}); }
void Halui::joint_select(int index) { selected_joint_ = index; }
void Halui::axis_select(int index) { selected_axis_ = index; }

/// Without an S word before, at 1 rpm: that the spindle turns shall be seen.
void Halui::turn_spindle(int spindle, const char* way) {
  std::vector<std::string> words{"spindle", way, "spindle=" + std::to_string(spindle)};
  constexpr std::size_t kS = 2;
  if (spindle == 0 && stat_->settings[kS] == 0) words.emplace_back("speed=1");
  port_.send(words);
}
void Halui::spindle_start(int spindle) { turn_spindle(spindle, "forward"); }
void Halui::spindle_forward(int spindle) { turn_spindle(spindle, "forward"); }
void Halui::spindle_reverse(int spindle) { turn_spindle(spindle, "reverse"); }
void Halui::spindle_stop(int spindle) {
  port_.send({"spindle", "off", "spindle=" + std::to_string(spindle)});
}
void Halui::spindle_increase(int spindle) {
  port_.send({"spindle", "increase", "spindle=" + std::to_string(spindle)});
}
void Halui::spindle_decrease(int spindle) {
  port_.send({"spindle", "decrease", "spindle=" + std::to_string(spindle)});
}
void Halui::brake_on(int spindle) { port_.send({"brake", "on", std::to_string(spindle)}); }
void Halui::brake_off(int spindle) { port_.send({"brake", "off", std::to_string(spindle)}); }

}  // namespace kerf::clients::halui
