#include "soak/panel.hpp"

#include <gtest/gtest.h>

#include <array>

#include "harness/halui.hpp"

namespace kerf::soak {
namespace {

/// Valid from wherever the machine stands; one that is wrong, and one beyond the limits.
constexpr std::array kLines{"G21 G90 G53 G0 X50 Y60 Z-20",
                            "G21 G90 G94 G53 G1 X240 Y150 Z-30 F5000",
                            "G21 G90 G53 G0 Z-6",
                            "S700 M3",
                            "M5 M9",
                            "G4 P0.2",
                            "M62 P2",
                            "T3 M6",
                            "G21 G91 G94 G1 X0.3 Y-0.3 F900",
                            "G0 X",
                            "G21 G90 G53 G0 X999"};
constexpr std::array kButtons{"program.pause",
                              "program.pause",
                              "program.resume",
                              "program.resume",
                              "program.step",
                              "program.run",
                              "abort",
                              "mode.manual",
                              "mode.auto",
                              "mode.mdi",
                              "mode.teleop",
                              "spindle.0.stop",
                              "spindle.0.start",
                              "flood.on",
                              "feed-override.increase",
                              "feed-override.decrease"};

}  // namespace

std::string Panel::ini_text() {
  std::string text = "\n[HALUI]\n";
  for (const char* line : kLines) text.append("MDI_COMMAND = ").append(line).append("\n");
  return text;
}

Panel::Panel(harness::Machine& machine) : m_(machine), halui_(harness::add_halui(machine)) {}

Panel::~Panel() {
  if (halui_ != nullptr) m_.remove(*halui_);
}

void Panel::set(const std::string& button, bool on) {
  EXPECT_TRUE(m_.hal("setp halui." + button + (on ? " 1" : " 0"))) << button;
}

std::string Panel::press_mdi(Dice& dice) {
  let_go();
  const int n = dice.below(static_cast<int>(kLines.size()));
  held_ = std::string("mdi-command-") + (n < 10 ? "0" : "") + std::to_string(n);
  set(held_, true);
  m_.run_for(dice.one_in(4) ? dice.between(0.001, 0.02) : dice.between(0.02, 0.3));
  return held_;
}

std::string Panel::press_other(Dice& dice) {
  let_go();
  held_ = kButtons[static_cast<std::size_t>(dice.below(static_cast<int>(kButtons.size())))];
  set(held_, true);
  m_.run_for(dice.between(0.005, 0.1));
  return held_;
}

void Panel::let_go() {
  if (held_.empty()) return;
  set(held_, false);
  held_.clear();
  // halui has looked at the pins, and task at what it has sent.
  m_.run_for(3 * static_cast<double>(clients::halui::HaluiParticipant::kPeriod) * 1e-9);
}

}  // namespace kerf::soak
