#include "launcher/task_check.hpp"

#include <cstdio>

namespace kerf::launcher {

namespace {

std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + '\'';
}

}  // namespace

TaskCheck check_task(const std::string& program, const std::string& ini) {
  TaskCheck out;
  const std::string command = quoted(program) + " --check --ini " + quoted(ini) + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {false, {"error: " + program + " cannot be started"}};
  std::string text;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    text.append(buffer, got);
  out.ok = pclose(pipe) == 0;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = text.find('\n', at);
    out.lines.push_back(text.substr(at, end == std::string::npos ? end : end - at));
    at = end == std::string::npos ? text.size() : end + 1;
  }
  return out;
}

}  // namespace kerf::launcher
