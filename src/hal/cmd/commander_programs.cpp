// Commander: programs, and waiting for them.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "hal/cmd/commander.hpp"
#include "hal/cmd/processes.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

namespace {

constexpr rtapi::Nanos kReapLimit = 1000 * rtapi::kMillisecond;

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

/// The component that a program is expected to make: "passthrough" of "./passthrough.py".
std::string component_of(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  const auto dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

struct LoadUsrOptions {
  bool wait_ready{false};
  bool wait_exit{false};
  bool ignore_status{false};
  std::string component;
  std::size_t program{0};  ///< index of the program's word
};

/// Letters may stand together, as -wi and -Wn NAME or -WnNAME.
rtapi::Result<LoadUsrOptions> parse_options(std::span<const std::string> w) {
  LoadUsrOptions o;
  std::size_t i = 1;
  for (; i < w.size() && w[i].size() > 1 && w[i][0] == '-'; ++i) {
    if (w[i] == "--") {
      ++i;
      break;
    }
    for (std::size_t k = 1; k < w[i].size(); ++k) {
      const char letter = w[i][k];
      if (letter == 'W') {
        o.wait_ready = true;
      } else if (letter == 'w') {
        o.wait_exit = true;
      } else if (letter == 'i') {
        o.ignore_status = true;
      } else if (letter == 'n') {
        o.component = w[i].substr(k + 1);
        if (o.component.empty() && i + 1 < w.size()) o.component = w[++i];
        if (o.component.empty())
          return fail(Errc::bad_argument, "loadusr: option requires an argument -- 'n'");
        break;
      } else {
        return fail(Errc::bad_argument, std::string("loadusr: invalid option -- '") + letter +
                                            "'; known are -W, -n NAME, -w, -i");
      }
    }
  }
  if (i >= w.size()) {
    return fail(Errc::bad_argument, "execv(): No such file or directory; loadusr needs a program");
  }
  o.program = i;
  if (o.component.empty()) o.component = component_of(w[i]);
  return o;
}

/// Virtual time stands while a program works that knows nothing of it; one that has joined the clock needs time to pass.
void outside_work(const rtapi::Segment& segment, pid_t pid, rtapi::WaitSpec& spec) {
  if (const auto* joins = rtapi::clock_joins(segment); joins != nullptr) spec.watch(*joins);
  spec.holds_time = !rtapi::lives_in_virtual_time(segment, pid);
}

/// The text for a wait that only the host could have ended.
Status host_died(const std::string& component) {
  return fail(Errc::dead,
              "the realtime host died while component " + quoted(component) + " was waited for");
}

}  // namespace

Status Commander::load_user(Words w) {
  KERF_TRY(const LoadUsrOptions o, parse_options(w));
  if (session_.local()) {
    return fail(Errc::busy,
                "loadusr: programs cannot be started here, HAL runs within this process");
  }
  if ((o.wait_ready || o.wait_exit) && clock_ == nullptr)
    return fail(Errc::busy, "loadusr: no clock to wait on");
  const Words program = w.subspan(o.program);
  KERF_TRY(const pid_t pid, start_program(program, session_.segment()));
  say("Program " + quoted(program[0]) + " started");
  if (o.wait_exit) return wait_exit(pid, program[0], o.ignore_status);
  if (o.wait_ready) return wait_ready(pid, o.component, program[0]);
  return {};
}

Status Commander::wait_ready(pid_t pid, const std::string& component, const std::string& program) {
  const int pidfd = rtapi::open_pidfd(pid);
  Status result;
  while (true) {
    rtapi::WaitSpec spec;
    outside_work(session_.segment(), pid, spec);
    if (const auto* changed = view_.changed(); changed != nullptr) spec.watch(*changed);
    if (pidfd >= 0) spec.watch_fd(pidfd);
    const bool host_lives = session_.alive();
    session_.watch(spec);
    const auto found = view_.find_component(component);
    if (found && found->ready) {
      say("Component " + quoted(component) + " ready");
      break;
    }
    if (const int status = child_status(pid); status >= 0) {
      result = fail(Errc::dead, program + " exited without becoming ready (status " +
                                    std::to_string(status) + ", waiting for component " +
                                    quoted(component) + ")");
      break;
    }
    if (!host_lives) {
      result = host_died(component);
      break;
    }
    if (clock_->stopped()) {
      result = fail(Errc::cancelled, "stopped while waiting for component " + quoted(component));
      break;
    }
    clock_->wait(spec);
  }
  if (pidfd >= 0) ::close(pidfd);
  return result;
}

Status Commander::wait_exit(pid_t pid, const std::string& program, bool ignore_status) {
  const int pidfd = rtapi::open_pidfd(pid);
  int status = -1;
  while ((status = child_status(pid)) < 0 && !clock_->stopped()) {
    rtapi::WaitSpec spec;
    outside_work(session_.segment(), pid, spec);
    if (pidfd >= 0)
      spec.watch_fd(pidfd);
    else
      spec.wake_at(clock_->now() + 10 * rtapi::kMillisecond);
    clock_->wait(spec);
  }
  if (pidfd >= 0) ::close(pidfd);
  if (status < 0) {
    ::kill(-pid, SIGTERM);
    return fail(Errc::cancelled, "stopped while " + quoted(program) + " was running");
  }
  if (status != 0 && !ignore_status) {
    return fail(Errc::dead,
                "program " + quoted(program) + " failed, returned " + std::to_string(status));
  }
  wait_reaped(pid);
  say("Program " + quoted(program) + " finished");
  return {};
}

/// The host takes a dead program's components away by itself, a moment later; the next line of a script finds them gone.
void Commander::wait_reaped(pid_t pid) {
  const rtapi::Nanos until = clock_->now() + kReapLimit;
  while (session_.alive() && !clock_->stopped() && clock_->now() < until) {
    rtapi::WaitSpec spec;
    if (const auto* changed = view_.changed(); changed != nullptr) spec.watch(*changed);
    const auto components = view_.components();
    if (std::none_of(components.begin(), components.end(),
                     [pid](const auto& c) { return c.pid == pid; }))
      return;
    spec.wake_at(until);
    session_.watch(spec);
    clock_->wait(spec);
  }
}

Status Commander::wait_user(Words w) {
  if (!view_.find_component(w[1])) return {};
  if (clock_ == nullptr) return fail(Errc::busy, "waitusr: no clock to wait on");
  while (true) {
    rtapi::WaitSpec spec;
    if (const auto* changed = view_.changed(); changed != nullptr) spec.watch(*changed);
    // Asked first: of a dead host's memory nothing can be told.
    if (!session_.alive()) return host_died(w[1]);
    session_.watch(spec);
    if (!view_.find_component(w[1])) break;
    if (clock_->stopped())
      return fail(Errc::cancelled, "stopped while waiting for " + quoted(w[1]));
    clock_->wait(spec);
  }
  say("Component " + quoted(w[1]) + " finished");
  return {};
}

Status Commander::unload_user(Words w) {
  for (const auto& c : view_.components()) {
    if (c.type != ComponentKind::user || c.pid <= 1 || c.pid == ::getpid()) continue;
    if (w[1] != "all" && w[1] != c.name) continue;
    // Other halcmds end by themselves.
    if (w[1] == "all" && c.name.rfind("halcmd", 0) == 0) continue;
    if (::kill(static_cast<pid_t>(c.pid), SIGTERM) != 0 && errno != ESRCH) {
      return fail(Errc::permission, "component " + quoted(c.name) + ": " + std::strerror(errno));
    }
  }
  return {};
}

Status Commander::unload(Words w) {
  const auto found = view_.find_component(w[1]);
  if (w[1] == "all") {
    KERF_CHECK(unload_user(w));
  } else if (found && found->type == ComponentKind::user) {
    KERF_CHECK(unload_user(w));
    return clock_ != nullptr ? wait_user(w) : Status{};
  }
  const std::string words[] = {"unloadrt", w[1]};
  return unload_realtime(words);
}

Status Commander::sleep(Words w) {
  char* end = nullptr;
  const double s = std::strtod(w[1].c_str(), &end);
  if (end == w[1].c_str() || *end != '\0' || !(s >= 0)) {
    return fail(Errc::bad_argument, "sleep: " + quoted(w[1]) + " is not a number of seconds");
  }
  if (clock_ == nullptr) return fail(Errc::busy, "sleep: no clock to wait on");
  const rtapi::Nanos until = clock_->now() + rtapi::seconds(s);
  while (clock_->now() < until && !clock_->stopped()) {
    rtapi::WaitSpec spec;
    spec.wake_at(until);
    clock_->wait(spec);
  }
  if (clock_->now() < until) return fail(Errc::cancelled, "sleep: stopped");
  return {};
}

}  // namespace kerf::hal
