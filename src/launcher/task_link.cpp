#include "launcher/task_link.hpp"

#include <algorithm>
#include <utility>

namespace kerf::launcher {

using rtapi::Errc;

namespace {
constexpr rtapi::Nanos kMessageEvery = 100 * rtapi::kMillisecond;
}

rtapi::Status TaskLink::connect(rtapi::Segment& segment) {
  KERF_TRY(client_, task::Client::connect(segment));
  return {};
}

rtapi::Status TaskLink::send(const std::vector<std::string>& words) {
  if (client_ == nullptr) return rtapi::fail(Errc::dead, "not connected to milltask");
  KERF_TRY(const std::uint64_t id, client_->send(words));
  (void)id;
  return {};
}

rtapi::Status TaskLink::perform(const std::vector<std::string>& words,
                                const std::function<void()>& while_waiting, rtapi::Nanos every) {
  if (client_ == nullptr) return rtapi::fail(Errc::dead, "not connected to milltask");
  shown_.clear();
  last_error_.clear();
  KERF_TRY(const std::uint64_t id, client_->send(words));
  for (;;) {
    rtapi::WaitSpec spec;
    // What is looked at now and then need not be looked at with every line of a program.
    if (every == rtapi::kForever)
      client_->add_to(spec);
    else
      client_->add_replies_to(spec);
    const auto polled = client_->poll();
    show_messages();
    if (while_waiting) while_waiting();
    if (!polled.ok()) return polled;
    if (client_->finished(id)) break;
    if (clock_.stopped()) return rtapi::fail(Errc::cancelled, "interrupted");
    if (every != rtapi::kForever) spec.wake_at((clock_.now() / every + 1) * every);
    clock_.wait(spec);
  }
  show_messages();
  const task::Reply reply = *client_->outcome(id);
  client_->forget(id);
  if (reply.state == task::CommandState::done) return {};
  std::string text = reply.text.empty() ? std::string(to_string(reply.state)) : reply.text;
  // "aborted" says less than the error that led to it.
  if (reply.state == task::CommandState::aborted && !last_error_.empty()) text = last_error_;
  return rtapi::fail(
      reply.state == task::CommandState::aborted ? Errc::cancelled : Errc::bad_argument, text);
}

bool TaskLink::was_shown(const std::string& text) const {
  return std::any_of(shown_.begin(), shown_.end(), [&](const std::string& shown) {
    return shown.size() >= text.size() &&
           shown.compare(shown.size() - text.size(), text.size(), text) == 0;
  });
}

void TaskLink::add_to(rtapi::WaitSpec& spec) const {
  if (clock_.is_virtual()) return client_->add_to(spec);
  // Cells are looked at every millisecond in real time; messages for people can wait longer.
  spec.watch_fd(client_->fd());
  spec.wake_at(clock_.now() + kMessageEvery);
}

void TaskLink::show_messages() {
  if (client_ == nullptr) return;
  std::uint64_t lost = 0;
  for (const task::OperatorMessage& message : client_->new_messages(&lost)) {
    const std::string text(message.text.view());
    if (message.kind == task::MessageKind::error) {
      shown_.insert(text);
      last_error_ = text;
      console_.error(text);
    } else {
      console_.say(text);
    }
  }
  if (lost > 0) console_.say(std::to_string(lost) + " messages were lost");
}

}  // namespace kerf::launcher
