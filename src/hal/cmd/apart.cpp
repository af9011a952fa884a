#include "hal/cmd/apart.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

namespace kerf::hal {

namespace {

constexpr int kPatienceMs = 20000;

bool write_all(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(pipe, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

/// Lines "@component", then "=" and the text. False: nothing came for too long.
bool read_all(int pipe, std::string& all) {
  std::array<char, 4096> piece{};
  for (;;) {
    pollfd wanted{pipe, POLLIN, 0};
    const int ready = ::poll(&wanted, 1, kPatienceMs);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return false;
    const ssize_t got = ::read(pipe, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return true;
    all.append(piece.data(), static_cast<std::size_t>(got));
  }
}

std::string how_it_ended(bool came_to_end, int status) {
  if (!came_to_end)
    return "its code does not return from being made: it was ended after " +
           std::to_string(kPatienceMs / 1000) + " s";
  if (WIFSIGNALED(status))
    return "its code crashed while the component was made: signal " +
           std::to_string(WTERMSIG(status)) + " (" + ::strsignal(WTERMSIG(status)) + ")";
  return "its code ended the program while the component was made, status " +
         std::to_string(WEXITSTATUS(status));
}

}  // namespace

Apart do_apart(const std::function<std::string(const Tell&)>& work) {
  Apart done;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    done.why = std::string("pipe: ") + std::strerror(errno);
    return done;
  }
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {
    done.why = std::string("fork: ") + std::strerror(errno);
    ::close(ends[0]);
    ::close(ends[1]);
    return done;
  }
  if (child == 0) {
    ::close(ends[0]);
    const std::string text = work([&](std::string_view component) {
      (void)write_all(ends[1], "@" + std::string(component) + "\n");
    });
    const bool whole = write_all(ends[1], "=" + text);
    std::fflush(nullptr);
    ::_exit(whole ? 0 : 1);
  }
  ::close(ends[1]);
  std::string all;
  const bool came_to_end = read_all(ends[0], all);
  ::close(ends[0]);
  if (!came_to_end) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::size_t at = 0;
  while (at < all.size() && all[at] == '@') {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    done.at = all.substr(at + 1, end - at - 1);
    at = end + 1;
  }
  if (came_to_end && status == 0 && at < all.size() && all[at] == '=')
    done.text = all.substr(at + 1);
  else
    done.why = how_it_ended(came_to_end, status);
  return done;
}

rtapi::Result<const Module*> ToldModules::open(std::string_view name) {
  if (const auto it = refused_.find(name); it != refused_.end())
    return rtapi::fail(rtapi::Errc::system, it->first + ": " + it->second);
  tell_(name);
  return modules_.open(name);
}

std::string do_apart_without_broken(const std::function<std::string(ModuleSource& modules)>& work) {
  ToldModules::Refused refused;
  for (;;) {
    auto done = do_apart([&](const Tell& tell) {
      DlopenSource own;
      ToldModules modules(own, tell, refused);
      return work(modules);
    });
    if (done.text) return *std::move(done.text);
    const bool known = !refused.emplace(done.at, done.why).second;
    if (done.at.empty() || known) {
      // Not at a component that could be left out.
      std::fprintf(stderr, "%s%s%s\n", done.at.c_str(), done.at.empty() ? "" : ": ",
                   done.why.c_str());
      return {};
    }
  }
}

}  // namespace kerf::hal
