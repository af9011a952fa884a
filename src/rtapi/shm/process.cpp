#include "rtapi/shm/process.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
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
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
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
  std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
  std::string name;
  return std::getline(file, name) ? name : std::string("gone");
}

}  // namespace kerf::rtapi
