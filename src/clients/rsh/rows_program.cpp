// Rows about programs and MDI.
#include <cmath>

#include "clients/rsh/rows.hpp"

namespace kerf::rsh {
namespace {

using enum ArgumentType;

constexpr Argument kMdi[]{{"line", rest}};
constexpr Argument kFile[]{{"file", rest}};
constexpr Argument kLine[]{{"line", integer, false}};
constexpr Argument kPrompt[]{{"prompt", integer, false}};

/// "G1 G17 G40 ... F600 S0"
std::string codes(const clients::Stat& now) {
  std::string out;
  // The first number is the line's. The newest LinuxCNC does not say that no G92 is in force.
  constexpr int kNoG92 = 922;
  for (std::size_t n = 1; n < now.gcodes.size(); ++n) {
    const int code = now.gcodes[n];
    if (code < 0 || code == kNoG92) continue;
    out += "G" + std::to_string(code / 10);
    if (code % 10 != 0) out += "." + std::to_string(code % 10);
    out += " ";
  }
  char text[80];
  std::snprintf(text, sizeof text, "F%.0f S%.0f", now.settings[1], std::fabs(now.settings[2]));
  return out + text;
}

Done abort(Session& s, const Values&) { return s.task({"abort"}); }

constexpr Subcommand kRows[]{
    {.name = "mdi",
     .help = "Executes a line of G-code.",
     .set_arguments = kMdi,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"mdi", v.text[0]});
         }},
    {.name = "task_plan_init",
     .help = "Starts the interpreter afresh (idle machine).",
     .set = [](Session& s, const Values&) { return s.task({"reset-interpreter"}); }},
    {.name = "open",
     .help = "Opens a program.",
     .set_arguments = kFile,
     .set =
         [](Session& s, const Values& v) {
           const auto path = s.machine().find_program(v.text[0]);
           if (!path)
             return Done{.kind = Done::Kind::failed,
                         .why = "File '" + shown(v.text[0]) + "' not found"};
           return s.task({"open", *path});
         }},
    {.name = "run",
     .help = "Runs the open program, from a line on if one is named.",
     .set_arguments = kLine,
     .set =
         [](Session& s, const Values& v) {
           return s.task({"run", v.has(0) ? std::to_string(v.index(0)) : "0"});
         }},
    {.name = "pause",
     .help = "Stands still on the path.",
     .set = [](Session& s, const Values&) { return s.task({"pause"}); },
     .at_once = true},
    {.name = "resume",
     .help = "Goes on after PAUSE, STEP, M0 and M1.",
     .set = [](Session& s, const Values&) { return s.task({"resume"}); },
     .at_once = true},
    {.name = "prompt",
     .help = "What the program asks the operator: number, kind and text, or NONE.",
     .get = [](Session& s, const Values&) -> std::string {
       const task::Prompt& p = s.stat().prompt;
       if (p.kind == task::PromptKind::none) return "NONE";
       return std::to_string(p.number) + " " + task::to_string(p.kind) + " " +
              std::string(p.text.view());
     }},
    {.name = "waiting",
     .help = "What the program waits for, with its pin and net, or NONE.",
     .get = [](Session& s, const Values&) -> std::string {
       const std::string text = task::wait_text(s.stat().waiting_for);
       return text.empty() ? "NONE" : text;
     }},
    {.name = "answer",
     .help = "Yes to what PROMPT asks; with its number, to that question only.",
     .set_arguments = kPrompt,
     .set =
         [](Session& s, const Values& v) {
           return v.has(0) ? s.task({"answer", std::to_string(v.index(0))}) : s.task({"answer"});
         },
     .at_once = true},
    {.name = "step",
     .help = "Executes one block of the program.",
     .set = [](Session& s, const Values&) { return s.task({"step"}); },
     .at_once = true},
    {.name = "abort",
     .help = "Ends the program or MDI line that runs, and stops the spindles.",
     .set = abort,
     .at_once = true},
    {.name = "program",
     .help = "The open program, or NONE.",
     .get = [](Session& s, const Values&) -> std::string {
       return s.stat().file.empty() ? "NONE" : s.stat().file;
     }},
    {.name = "program_line",
     .help = "The line in execution; 0: none.",
     .get =
         [](Session& s, const Values&) {
           const clients::Stat& now = s.stat();
           if (now.interp_state == 1) return std::string("0");
           return std::to_string(now.motion_line > 0 ? now.motion_line : now.current_line);
         }},
    {.name = "program_status",
     .help = "IDLE, RUNNING or PAUSED.",
     .get = [](Session& s, const Values&) -> std::string {
       const clients::Stat& now = s.stat();
       return now.interp_state == 1                      ? "IDLE"
              : now.interp_state == 3 || now.task_paused ? "PAUSED"
                                                         : "RUNNING";
     }},
    {.name = "program_codes",
     .help = "The codes in force.",
     .get = [](Session& s, const Values&) { return codes(s.stat()); }},
    {.name = "program_units",
     .help = "INCH or MM.",
     .get = [](Session& s, const Values&) { return program_units_name(s.stat().program_units); }},
    {.name = "program_linear_units",
     .help = "The same as PROGRAM_UNITS.",
     .get = [](Session& s, const Values&) { return program_units_name(s.stat().program_units); }},
    {.name = "program_angular_units",
     .help = "The unit of angles in programs.",
     .get = [](Session&, const Values&) -> std::string { return "DEG"; }},
};

}  // namespace

std::span<const Subcommand> program_rows() { return kRows; }

}  // namespace kerf::rsh
