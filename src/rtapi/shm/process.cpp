#include "rtapi/shm/process.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace kerf::rtapi {

namespace {

struct Stat {
  char state{0};
  std::int64_t parent{0};
  std::uint64_t start{0};
};

/// What /proc/PID/stat says; false when the process is gone.
bool read_stat(std::int64_t pid, Stat& out) {
  const std::string text = read_process_file(pid, "stat");
  // The name stands in parentheses and may hold anything, so count from the last one.
  const auto close = text.rfind(')');
  if (close == std::string::npos) return false;
  std::istringstream rest(text.substr(close + 1));
  std::string word;
  if (!(rest >> word)) return false;
  out.state = word[0];
  for (int field = 4; field <= 22; ++field) {
    if (!(rest >> word)) return false;
    if (field == 4) out.parent = std::strtoll(word.c_str(), nullptr, 10);
  }
  out.start = std::strtoull(word.c_str(), nullptr, 10);
  return true;
}

}  // namespace

std::string read_process_file(std::int64_t pid, const char* file) {
  const std::string path = "/proc/" + std::to_string(pid) + "/" + file;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return {};
  std::string text;
  char piece[4096];
  ssize_t n = 0;
  while ((n = ::read(fd, piece, sizeof piece)) > 0 || (n < 0 && errno == EINTR))
    if (n > 0) text.append(piece, static_cast<std::size_t>(n));
  ::close(fd);
  if (n < 0) text.clear();
  return text;
}

std::uint64_t process_start_time(std::int64_t pid) {
  Stat stat;
  return pid > 0 && read_stat(pid, stat) ? stat.start : 0;
}

bool process_lives(std::int64_t pid, std::uint64_t start) {
  Stat stat;
  if (pid <= 0 || !read_stat(pid, stat)) return false;
  if (stat.state == 'Z' || stat.state == 'X') return false;
  return start == 0 || start == stat.start;
}

std::int64_t parent_of(std::int64_t pid) {
  Stat stat;
  return pid > 0 && read_stat(pid, stat) ? stat.parent : 0;
}

std::string process_name(std::int64_t pid) {
  const std::string name = read_process_file(pid, "comm");
  return name.empty() ? std::string("gone") : name.substr(0, name.find('\n'));
}

}  // namespace kerf::rtapi
