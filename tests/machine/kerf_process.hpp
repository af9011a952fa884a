// A running kerf with all its true processes, for tests: a copy of the sample machine in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "launcher/process.hpp"
#include "rtapi/shm/process.hpp"

namespace kerf::launcher::test {

namespace fs = std::filesystem;

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void replace(std::string& text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// A sample machine in a new folder, so that what it writes does not meet other tests.
class Mill {
 public:
  explicit Mill(const std::string& name, const std::string& config = "mill",
                std::string ini = "mill.ini")
      : dir_(testing::TempDir() + "kerf_" + name + "_" + std::to_string(getpid())),
        ini_name_(std::move(ini)) {
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    for (const auto& entry :
         fs::directory_iterator(std::string(KERF_SOURCE_DIR) + "/configs/sim/" + config)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".var") continue;
      std::string text = read_file(entry.path().string());
      if (extension == ".ini" || extension == ".inc")
        replace(text, "../../../nc_files", std::string(KERF_SOURCE_DIR) + "/nc_files");
      write(entry.path().filename().string(), text);
    }
    ini_ = read_file(this->ini());
  }
  ~Mill() { fs::remove_all(dir_); }
  Mill(const Mill&) = delete;
  Mill& operator=(const Mill&) = delete;

  /// For runs on the real clock that have to go on while a busy computer lets task wait: its silence would end them, rightly.
  void take_silence() { change("HEARTBEAT_TIMEOUT = 1\n", "HEARTBEAT_TIMEOUT = 10\n"); }
  /// Replaces text of the INI file.
  void change(const std::string& from, const std::string& to) {
    if (!from.empty()) {
      EXPECT_NE(ini_.find(from), std::string::npos) << from;
      replace(ini_, from, to);
    }
    write(ini_name_, ini_);
  }
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(dir_ + "/" + name) << text;
    return dir_ + "/" + name;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return dir_ + "/" + name; }
  [[nodiscard]] std::string ini() const { return dir_ + "/" + ini_name_; }
  /// Line of the INI file that begins with this text.
  [[nodiscard]] int line_of(const std::string& begin) const {
    int line = 1;
    for (std::size_t at = 0; at != std::string::npos && at < ini_.size(); ++line) {
      if (ini_.compare(at, begin.size(), begin) == 0) return line;
      at = ini_.find('\n', at);
      if (at != std::string::npos) ++at;
    }
    return 0;
  }

 private:
  std::string dir_;
  std::string ini_name_;
  std::string ini_;
};

class Kerf {
 public:
  static constexpr int kLimitMs = 60'000;

  Kerf(const Mill& mill, const std::string& instance, std::vector<std::string> arguments)
      : instance_(instance + std::to_string(getpid())), output_(mill.path(instance + ".out")) {
    std::vector<std::string> words{std::string(KERF_BUILD_DIR) + "/bin/kerf",
                                   mill.ini(),
                                   "--instance",
                                   instance_,
                                   "--svg",
                                   mill.path(instance + ".svg")};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      setenv("XDG_STATE_HOME", mill.path("state").c_str(), 1);
      if (std::freopen(output_.c_str(), "w", stdout) == nullptr) _exit(126);
      dup2(STDOUT_FILENO, STDERR_FILENO);
      if (std::freopen("/dev/null", "r", stdin) == nullptr) _exit(126);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Kerf() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  Kerf(const Kerf&) = delete;
  Kerf& operator=(const Kerf&) = delete;

  /// Exit code, 128 + signal, or -1 when it does not end.
  int wait_exit() {
    int status = 0;
    for (int waited = 0; waited < kLimitMs; waited += 5) {
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = -1;
        return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
      }
      pause_ms(5);
    }
    return -1;
  }
  bool wait_output(const std::string& text) {
    for (int waited = 0; waited < kLimitMs; waited += 5) {
      if (output().find(text) != std::string::npos) return true;
      pause_ms(5);
    }
    return false;
  }
  void signal(int number) const { kill(pid_, number); }
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] const std::string& instance() const { return instance_; }
  [[nodiscard]] std::string output() const { return read_file(output_); }

  /// Processes of the instance by name, without kerf itself.
  [[nodiscard]] std::vector<pid_t> parts(const std::string& name = {}) const {
    std::vector<pid_t> out;
    const std::string wanted =
        std::string("\0KERF_INSTANCE=", 15) + instance_ + std::string(1, '\0');
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string number = entry.path().filename().string();
      if (number.find_first_not_of("0123456789") != std::string::npos) continue;
      const pid_t pid = std::stoi(number);
      if (!rtapi::process_lives(pid, 0)) continue;
      const std::string environment =
          std::string(1, '\0') + rtapi::read_process_file(std::stoll(number), "environ");
      if (environment.find(wanted) == std::string::npos) continue;
      if (name.empty() || rtapi::process_name(pid) == name) out.push_back(pid);
    }
    return out;
  }
  /// What is left of the instance, in words; "" when nothing is. Gives it two seconds.
  [[nodiscard]] std::string leftovers() const {
    std::string left;
    for (int i = 0; i < 100; ++i) {
      left.clear();
      for (const pid_t pid : parts()) left += rtapi::process_name(pid) + " ";
      if (access(("/dev/shm/kerf-" + instance_).c_str(), F_OK) == 0) left += "segment ";
      if (read_file("/proc/net/unix").find("@kerf-" + instance_ + "-") != std::string::npos)
        left += "socket ";
      if (left.empty()) break;
      pause_ms(20);
    }
    return left;
  }

 private:
  std::string instance_;
  std::string output_;
  pid_t pid_{-1};
};

}  // namespace kerf::launcher::test
