#include "clients/halui/participant.hpp"

namespace kerf::clients::halui {

std::uint64_t TaskPort::send(const std::vector<std::string>& words) {
  const auto id = client_->send(words);
  if (!id.ok()) return 0;
  open_.insert(*id);
  return *id;
}

std::optional<task::Reply> TaskPort::outcome(std::uint64_t id) {
  if (!client_->finished(id)) return std::nullopt;
  return client_->outcome(id);
}

void TaskPort::complain(const std::string& text) {
  (void)client_->send_json(task::message_json(client_->next_id(), text, "error"));
}

bool TaskPort::poll() {
  if (!client_->poll().ok()) return false;
  std::erase_if(open_, [this](std::uint64_t id) { return client_->finished(id); });
  return client_->connected();
}

HaluiParticipant::HaluiParticipant(rtapi::Segment& segment, hal::Session& session,
                                   const Layout& layout)
    : segment_(segment), halui_(layout, port_), pins_(session, halui_.board()) {}

void HaluiParticipant::end(const rtapi::Error& why) {
  ended_ = true;
  port_.port.reset();
  if (on_end_) on_end_(why);
}

bool HaluiParticipant::connect() {
  auto view = MachineView::over(segment_);
  if (view.ok()) {
    auto client = task::Client::connect(segment_);
    if (client.ok()) {
      view_ = std::move(*view);
      port_.port = std::make_unique<TaskPort>(std::move(*client));
      return true;
    }
    if (client.error().code != rtapi::Errc::not_found) end(client.error());
  } else if (view.error().code != rtapi::Errc::not_found) {
    end(view.error());
  }
  return false;
}

void HaluiParticipant::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  if (ended_) return;
  next.wake_at((now / kPeriod + 1) * kPeriod);
  if (!port_.port && !connect()) return;
  port_.port->add_to(next);
  if (!port_.port->poll()) {
    end({rtapi::Errc::dead, "task has ended"});
    return;
  }
  if (!view_->poll()) return;
  pins_.read_inputs();
  halui_.update(view_->stat(), now);
  pins_.write_outputs();
}

}  // namespace kerf::clients::halui
