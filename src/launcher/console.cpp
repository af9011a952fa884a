#include "launcher/console.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace kerf::launcher {

int terminal_width() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

Console::Console(bool verbose)
    : verbose_(verbose), printer_(isatty(STDERR_FILENO) == 1, terminal_width()) {}

void Console::say(const std::string& text) {
  end_progress();
  std::fprintf(stderr, "kerf: %s\n", text.c_str());
}

void Console::line(const std::string& text) {
  end_progress();
  std::fprintf(stderr, "%s\n", text.c_str());
}

void Console::print(const std::string& text) {
  end_progress();
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

void Console::progress(const ProgressState& state, double now_s) {
  const std::string text = printer_.update(state, now_s);
  if (!text.empty()) std::fputs(text.c_str(), stderr);
}

void Console::end_progress() {
  const std::string text = printer_.clear();
  if (!text.empty()) std::fputs(text.c_str(), stderr);
}

}  // namespace kerf::launcher
