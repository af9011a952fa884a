// HaluiParticipant: halui on a running instance: finds task when it is there, and looks at pins and machine in turn.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>

#include "clients/common/machine_view.hpp"
#include "clients/halui/hal_pins.hpp"
#include "clients/halui/halui.hpp"
#include "rtapi/clock/clock.hpp"
#include "task/api/client.hpp"

namespace kerf::clients::halui {

/// A Port over a connection to task, which tells the operator itself of what it refuses.
class TaskPort final : public Port {
 public:
  explicit TaskPort(std::unique_ptr<task::Client> client) : client_(std::move(client)) {}
  std::uint64_t send(const std::vector<std::string>& words) override;
  std::optional<task::Reply> outcome(std::uint64_t id) override;
  void complain(const std::string& text) override;
  /// Takes in replies. False: the connection has ended.
  bool poll();
  void add_to(rtapi::WaitSpec& spec) const { client_->add_to(spec); }

 private:
  std::unique_ptr<task::Client> client_;
  std::set<std::uint64_t> open_;
};

/// Without a task, commands go nowhere.
class LatePort final : public Port {
 public:
  std::uint64_t send(const std::vector<std::string>& words) override {
    return port ? port->send(words) : 0;
  }
  std::optional<task::Reply> outcome(std::uint64_t id) override {
    return port ? port->outcome(id)
                : task::Reply{.id = id, .state = task::CommandState::error, .text = ""};
  }
  void complain(const std::string& text) override {
    if (port) port->complain(text);
  }
  std::unique_ptr<TaskPort> port;
};

class HaluiParticipant final : public rtapi::Participant {
 public:
  /// How often pins are looked at: a button that is released stops its jog no later.
  static constexpr rtapi::Nanos kPeriod = 10 * rtapi::kMillisecond;

  /// Makes the pins; status() tells how that went. Both must outlive it.
  HaluiParticipant(rtapi::Segment& segment, hal::Session& session, const Layout& layout);
  [[nodiscard]] const rtapi::Status& status() const { return pins_.status(); }
  /// Called when task is gone or does not suit: halui ends.
  void on_end(std::function<void(const rtapi::Error&)> f) { on_end_ = std::move(f); }

  [[nodiscard]] const char* name() const noexcept override { return "halui"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::user_component; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  /// False: not yet.
  bool connect();
  void end(const rtapi::Error& why);

  rtapi::Segment& segment_;
  LatePort port_;
  Halui halui_;
  HalPins pins_;
  std::unique_ptr<MachineView> view_;
  std::function<void(const rtapi::Error&)> on_end_;
  bool ended_{false};
};

}  // namespace kerf::clients::halui
