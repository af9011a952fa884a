#include "launcher/hal_link.hpp"

#include <algorithm>
#include <utility>

#include "hal/client/session.hpp"
#include "hal/cmd/commander.hpp"

namespace kerf::launcher {

struct HalLink::Parts {
  Parts(std::unique_ptr<hal::SocketSession> s, const ini::IniFile& ini)
      : session(std::move(s)), commander(*session, hal::ini_lookup(ini)) {}
  std::unique_ptr<hal::SocketSession> session;
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
  if (step.is_file) return parts_->commander.run_file(step.text);
  return parts_->commander.run_line(step.text, step.at.file, step.at.line);
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

std::string HalLink::thread_of(const std::string& function) const {
  for (const hal::ThreadInfo& thread : parts_->commander.view().threads())
    if (std::find(thread.functions.begin(), thread.functions.end(), function) !=
        thread.functions.end())
      return thread.name;
  return {};
}

}  // namespace kerf::launcher
