#include "launcher/hal_link.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "hal/client/session.hpp"
#include "hal/cmd/commander.hpp"

namespace kerf::launcher {

struct HalLink::Parts {
  Parts(std::unique_ptr<hal::SocketSession> s, const ini::IniFile& ini)
      : session(std::move(s)), ini_path(ini.name()), commander(*session, hal::ini_lookup(ini)) {}
  std::unique_ptr<hal::SocketSession> session;
  std::string ini_path;
  hal::Commander commander;
};

rtapi::Result<std::unique_ptr<HalLink>> HalLink::connect(rtapi::Segment& segment,
                                                         SupervisedClock& clock,
                                                         const ini::IniFile& ini) {
  KERF_TRY(auto session, hal::SocketSession::connect(segment));
  session->use_clock(&clock);
  std::unique_ptr<HalLink> link(new HalLink());
  link->parts_ = std::make_unique<Parts>(std::move(session), ini);
  link->parts_->commander.set_clock(&clock);
  return link;
}

HalLink::~HalLink() = default;

void HalLink::set_keep_going(bool on) { parts_->commander.set_keep_going(on); }

bool HalLink::run(const HalStep& step) {
  if (step.is_tcl()) {
    std::vector<std::string> words{step.text};
    words.insert(words.end(), step.arguments.begin(), step.arguments.end());
    return run_haltcl(words, step.at);
  }
  if (step.is_file) return parts_->commander.run_file(step.text);
  return parts_->commander.run_line(step.text, step.at.file, step.at.line);
}

bool HalLink::run_two_pass(std::span<const HalStep> steps, const std::string& options) {
  std::vector<std::string> words{"--twopass", options};
  for (const HalStep& step : steps) {
    if (words.size() > 2) words.emplace_back(";");
    words.push_back(step.text);
    words.insert(words.end(), step.arguments.begin(), step.arguments.end());
  }
  return run_haltcl(words, steps.front().at);
}

bool HalLink::run_haltcl(const std::vector<std::string>& words, const ini::Position& at) {
  std::vector<std::string> line{"loadusr", "-w", "haltcl", "-i", parts_->ini_path};
  line.insert(line.end(), words.begin(), words.end());
  hal::Commander& halcmd = parts_->commander;
  // haltcl says itself what is wrong with a file; that it failed is no news then.
  halcmd.set_level(hal::Commander::Level::silent);
  const bool good = halcmd.run_exact(line, at.file, at.line);
  halcmd.set_level(hal::Commander::Level::errors);
  if (!good && halcmd.last_error().find("returned") == std::string::npos)
    std::fprintf(stderr, "%s: %s\n", at.text().c_str(), halcmd.last_error().c_str());
  return good;
}

rtapi::Status HalLink::command(const std::vector<std::string>& words) {
  KERF_TRY(const hal::Reply reply, parts_->session->request(words));
  if (!reply.ok()) return rtapi::fail(static_cast<rtapi::Errc>(reply.status), reply.text);
  return {};
}

bool HalLink::is_ready(const std::string& component) const {
  const auto found = parts_->commander.view().find_component(component);
  return found && found->ready;
}

std::map<pid_t, std::string> HalLink::user_components() const {
  std::map<pid_t, std::string> out;
  for (const auto& component : parts_->commander.view().components()) {
    if (component.type != hal::ComponentKind::user || component.pid <= 1) continue;
    std::string& names = out[static_cast<pid_t>(component.pid)];
    names += (names.empty() ? "" : " ") + std::string(component.name);
  }
  return out;
}

std::string HalLink::thread_of(const std::string& function) const {
  for (const hal::ThreadInfo& thread : parts_->commander.view().threads())
    if (std::find(thread.functions.begin(), thread.functions.end(), function) !=
        thread.functions.end())
      return thread.name;
  return {};
}

}  // namespace kerf::launcher
