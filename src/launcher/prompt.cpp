#include "launcher/prompt.hpp"

#include <editline/readline.h>
#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <deque>
#include <memory>

#include "launcher/plan.hpp"

namespace kerf::launcher {

namespace {

/// Lines that libedit has finished; its callback has no argument to hand an object through.
struct Typed {
  std::deque<std::string> lines;
  bool ended{false};
};
Typed* g_typed = nullptr;

void on_line(char* text) {
  const std::unique_ptr<char, void (*)(void*)> owner(text, std::free);
  if (g_typed == nullptr) return;
  if (text == nullptr) {
    g_typed->ended = true;
    return;
  }
  if (*text != '\0') add_history(text);
  g_typed->lines.emplace_back(text);
}

class LineEditor {
 public:
  explicit LineEditor(Typed& typed) {
    g_typed = &typed;
    begin();
  }
  ~LineEditor() {
    end();
    g_typed = nullptr;
  }
  LineEditor(const LineEditor&) = delete;
  LineEditor& operator=(const LineEditor&) = delete;
  void begin() { rl_callback_handler_install("mdi> ", on_line); }
  void end() { rl_callback_handler_remove(); }
};

std::string trim(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

void carry_out(const std::string& line, TaskLink& task, Console& console) {
  const std::vector<std::string> words = words_of_line(line);
  if (words.empty()) return;
  if (words.front() == "help") {
    const task::CommandInfo* one = words.size() > 1 ? task::find_command(words[1]) : nullptr;
    if (one != nullptr) return console.print(task::help_text(*one));
    return console.print(task::help_text() + "quit\n    Ends the machine.\n");
  }
  const rtapi::Status done = task.perform(words);
  if (!done.ok() && !task.was_shown(done.error().message())) console.error(done.error().message());
}

}  // namespace

std::vector<std::string> words_of_line(const std::string& line) {
  const std::string text = trim(line);
  if (text.empty()) return {};
  std::vector<std::string> words = split_words(text);
  // Names of commands are no G-code: none begins with a letter and a number.
  if (!words.empty() && task::find_command(words.front()) != nullptr) return words;
  return {"mdi", text};
}

rtapi::Status run_prompt(SupervisedClock& clock, TaskLink& task, Console& console) {
  Typed typed;
  LineEditor editor(typed);
  while (!clock.stopped() && !typed.ended) {
    rtapi::WaitSpec spec;
    task.add_to(spec);
    if (const auto polled = task.client().poll(); !polled.ok()) return polled;
    task.show_messages();
    spec.watch_fd(STDIN_FILENO);
    clock.wait(spec);
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) > 0) rl_callback_read_char();
    while (!typed.lines.empty()) {
      const std::string line = trim(typed.lines.front());
      typed.lines.pop_front();
      if (line == "quit" || line == "exit") return {};
      editor.end();
      carry_out(line, task, console);
      if (!clock.stopped()) editor.begin();
    }
  }
  console.print("\n");
  return {};
}

}  // namespace kerf::launcher
