#include "rtapi/shm/process.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace kerf::rtapi {

namespace {

/// State letter and start time of /proc/PID/stat; false when the process is gone.
bool read_stat(std::int64_t pid, char& state, std::uint64_t& start) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // The name stands in parentheses and may hold anything, so count from the last one.
  const auto close = text.rfind(')');
  if (close == std::string::npos) return false;
  std::istringstream rest(text.substr(close + 1));
  std::string word;
  if (!(rest >> word)) return false;
  state = word[0];
  for (int field = 4; field <= 22; ++field)
    if (!(rest >> word)) return false;
  start = std::strtoull(word.c_str(), nullptr, 10);
  return true;
}

}  // namespace

std::uint64_t process_start_time(std::int64_t pid) {
  char state = 0;
  std::uint64_t start = 0;
  return pid > 0 && read_stat(pid, state, start) ? start : 0;
}

bool process_lives(std::int64_t pid, std::uint64_t start) {
  char state = 0;
  std::uint64_t found = 0;
  if (pid <= 0 || !read_stat(pid, state, found)) return false;
  if (state == 'Z' || state == 'X') return false;
  return start == 0 || start == found;
}

std::string process_name(std::int64_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
  std::string name;
  return std::getline(file, name) ? name : std::string("gone");
}

}  // namespace kerf::rtapi
