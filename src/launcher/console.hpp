// What the launcher writes to the terminal, with a progress line that other lines do not break.
#pragma once

#include <string>

#include "ini/ini_file.hpp"
#include "launcher/progress.hpp"

namespace kerf::launcher {

class Console {
 public:
  explicit Console(bool verbose);
  /// To stderr, with "kerf: " before it.
  void say(const std::string& text);
  void error(const std::string& text) { say("error: " + text); }
  void detail(const std::string& text) {
    if (verbose_) say(text);
  }
  void diagnostic(const ini::Diagnostic& diagnostic) { line(diagnostic.message()); }
  /// To stderr, as it is.
  void line(const std::string& text);
  /// To stdout, as it is.
  void print(const std::string& text);
  void progress(const ProgressState& state, double now_s);
  /// Frees the line that progress() drew.
  void end_progress();

 private:
  bool verbose_;
  ProgressPrinter printer_;
};

/// Columns of the terminal at stderr; 80 when there is none.
int terminal_width();

}  // namespace kerf::launcher
