// mdi: lines of G-code and commands of task from the command line, a pipe or the keyboard.
#include <histedit.h>
#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "clients/common/machine_view.hpp"
#include "clients/common/work_position.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/client.hpp"

namespace {

using namespace kerf;

constexpr const char* kUsage =
    "usage: mdi [--instance NAME] [--no-wait] [LINE ...]\n"
    "       mdi [--instance NAME] [--no-wait] WORD ...\n"
    "\n"
    "Sends lines of G-code to a running machine and waits for each; prints what the operator is\n"
    "told. WORDs without blanks in them are one line together: mdi G0 X1. Without any it reads\n"
    "standard input; at a terminal it asks for lines and shows where the machine stands.\n"
    "Exit status 1 when a line failed or the machine is not there.\n"
    "\n"
    "  --instance NAME   instance; default: KERF_INSTANCE, else by user id\n"
    "  --protocol        print the commands of task as a page of Markdown\n"
    "  --no-wait         do not wait for the end of a line before sending the next\n"
    "\n"
    "A line that begins with a colon is a command of task, such as :state on, :home, :status;\n"
    ":help lists them all.\n";

struct Options {
  std::string instance{rtapi::default_instance()};
  bool wait{true};
  std::vector<std::string> lines;
};

const char* name_of(task::TaskState s) {
  switch (s) {
    case task::TaskState::estop: return "ESTOP";
    case task::TaskState::estop_reset: return "ESTOP_RESET";
    case task::TaskState::off: return "OFF";
    case task::TaskState::on: return "ON";
  }
  return "?";
}

const char* name_of(task::TaskMode m) {
  return m == task::TaskMode::manual ? "MANUAL" : m == task::TaskMode::automatic ? "AUTO" : "MDI";
}

const char* name_of(task::InterpState i) {
  return i == task::InterpState::idle      ? "IDLE"
         : i == task::InterpState::paused  ? "PAUSED"
         : i == task::InterpState::waiting ? "WAITING"
                                           : "READING";
}

class Console {
 public:
  Console(task::Client& client, rtapi::WaitClock& clock, bool wait)
      : client_(client), clock_(clock), wait_(wait) {}

  /// False: the line failed.
  bool line(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return true;
    if (text[first] != ':') return send({"mdi", text.substr(first)}, wait_);
    std::istringstream in(text.substr(first + 1));
    std::vector<std::string> words;
    for (std::string w; in >> w;) words.push_back(w);
    if (words.empty()) return true;
    if (words[0] == "status") {
      print_status();
      return true;
    }
    return send(words, true);
  }

  /// Waits for what was sent without waiting.
  bool finish() {
    bool good = true;
    for (const auto id : open_) good = report(client_.wait(id, clock_)) && good;
    open_.clear();
    show_messages();
    return good;
  }

  void show_messages() {
    std::uint64_t lost = 0;
    for (const auto& m : client_.new_messages(&lost))
      std::fprintf(stderr, "%s%s\n", m.kind == task::MessageKind::error ? "error: " : "",
                   m.text.c_str());
    if (lost > 0)
      std::fprintf(stderr, "(%llu older messages are lost)\n",
                   static_cast<unsigned long long>(lost));
  }

 private:
  bool send(const std::vector<std::string>& words, bool wait) {
    const auto id = client_.send(words);
    if (!id.ok()) {
      std::fprintf(stderr, "mdi: %s\n", id.error().message().c_str());
      return false;
    }
    if (!wait) {
      open_.push_back(*id);
      return true;
    }
    return report(client_.wait(*id, clock_));
  }

  bool report(const rtapi::Result<task::Reply>& outcome) {
    const std::string said = last_error();
    if (!outcome.ok()) {
      std::fprintf(stderr, "mdi: %s\n", outcome.error().message().c_str());
      return false;
    }
    if (outcome->state == task::CommandState::done) {
      if (!outcome->text.empty()) std::printf("%s\n", outcome->text.c_str());
      return true;
    }
    // The operator's message usually says the same.
    if (outcome->text != said)
      std::fprintf(stderr, "%s: %s\n", task::to_string(outcome->state), outcome->text.c_str());
    return false;
  }

  std::string last_error() {
    std::string last;
    for (const auto& m : client_.new_messages()) {
      std::fprintf(stderr, "%s%s\n", m.kind == task::MessageKind::error ? "error: " : "",
                   m.text.c_str());
      if (m.kind == task::MessageKind::error) last = std::string(m.text.view());
    }
    return last;
  }

  void print_status() {
    task::TaskStatus s;
    if (!client_.status(s)) return;
    std::printf("%s %s %s line %d tool %d flood %s mist %s feed %.0f%%\n", name_of(s.task_state),
                name_of(s.mode), name_of(s.interp_state), s.current_line, s.tool_in_spindle,
                s.flood ? "on" : "off", s.mist ? "on" : "off", s.feed_override * 100);
    if (!s.file.empty())
      std::printf("program %s, %d lines, %.0f%%\n", s.file.c_str(), s.program_lines,
                  s.progress * 100);
    if (!s.waiting_for.object.empty())
      std::printf("waiting for %s\n", task::wait_text(s.waiting_for).c_str());
  }

  task::Client& client_;
  rtapi::WaitClock& clock_;
  bool wait_;
  std::vector<std::uint64_t> open_;
};

/// "X10.0000 Y0.0000 Z5.0000", in work coordinates and machine units.
void print_position(clients::MachineView& view) {
  if (!view.poll()) return;
  const clients::Stat& now = view.stat();
  const rtapi::Pose position = clients::work_position(now, now.actual_position);
  std::string line;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    if ((now.axis_mask & (1U << a)) == 0) continue;
    char text[64];
    // -0 is a zero to people.
    std::snprintf(text, sizeof text, "%s%c%.4f", line.empty() ? "" : " ", rtapi::kAxisLetters[a],
                  std::fabs(position[a]) < 0.00005 ? 0.0 : position[a]);
    line += text;
  }
  std::printf("%s\n", line.c_str());
}

char* prompt(EditLine*) {
  static char text[] = "MDI> ";
  return text;
}

bool interactive(Console& console, clients::MachineView& view) {
  HistEvent event;
  History* history = history_init();
  ::history(history, &event, H_SETSIZE, 500);
  EditLine* edit = el_init("mdi", stdin, stdout, stderr);
  el_set(edit, EL_PROMPT, &prompt);
  el_set(edit, EL_EDITOR, "emacs");
  el_set(edit, EL_HIST, &::history, history);
  bool good = true;
  int count = 0;
  while (const char* line = el_gets(edit, &count)) {
    if (count <= 0) break;
    std::string text(line);
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    if (text == "quit" || text == "exit") break;
    if (!text.empty()) ::history(history, &event, H_ENTER, text.c_str());
    good = console.line(text) && good;
    console.show_messages();
    print_position(view);
  }
  el_end(edit);
  history_end(history);
  return good;
}

/// `mdi G0 X1` is one line, `mdi 'G0 X1' 'G0 X2'` and `mdi :home :run` are two.
void join_words(std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    if (line.empty() || line[0] == ':' || line.find_first_of(" \t") != std::string::npos) return;
  std::string all;
  for (const std::string& word : lines) all += (all.empty() ? "" : " ") + word;
  if (!all.empty()) lines = {all};
}

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& options) {
  int i = 1;
  for (; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 1;
    }
    if (word == "--protocol") {
      std::fputs(task::protocol_markdown().c_str(), stdout);
      return 1;
    }
    if (word == "--no-wait") {
      options.wait = false;
    } else if (word == "--instance" && i + 1 < argc) {
      options.instance = argv[++i];
    } else if (word == "--") {
      ++i;
      break;
    } else if (word.rfind("--", 0) == 0) {
      std::fprintf(stderr, "mdi: unknown option '%s'\n%s", word.c_str(), kUsage);
      return 3;
    } else {
      break;
    }
  }
  for (; i < argc; ++i) options.lines.emplace_back(argv[i]);
  join_words(options.lines);
  return 0;
}

int run(const Options& options) {
  auto segment = rtapi::Segment::attach(options.instance);
  if (!segment.ok()) {
    std::fprintf(stderr, "mdi: %s\n", segment.error().message().c_str());
    return 1;
  }
  auto client = task::Client::connect(**segment);
  if (!client.ok()) {
    std::fprintf(stderr, "mdi: %s\n", client.error().message().c_str());
    return 1;
  }
  // Replies come by the socket; a person's terminal has real time.
  const auto clock = rtapi::make_real_clock();
  Console console(**client, *clock, options.wait);
  bool good = true;
  if (!options.lines.empty()) {
    for (const auto& l : options.lines) good = console.line(l) && good;
  } else if (::isatty(STDIN_FILENO) != 0) {
    auto view = clients::MachineView::over(**segment);
    if (!view.ok()) {
      std::fprintf(stderr, "mdi: %s\n", view.error().message().c_str());
      return 1;
    }
    good = interactive(console, **view);
  } else {
    for (std::string l; std::getline(std::cin, l);) good = console.line(l) && good;
  }
  good = console.finish() && good;
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return run(options);
}
