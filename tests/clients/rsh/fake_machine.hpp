// A machine for tests of the remote shell: it keeps what it was told, and answers as the test says.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "clients/rsh/machine.hpp"
#include "clients/rsh/session.hpp"

namespace kerf::rsh::test {

class FakeMachine final : public Machine {
 public:
  FakeMachine() {
    now.joints = 3;
    now.spindles = 1;
    now.axis_mask = 7;
    for (auto& joint : now.joint) joint.joint_type = 1, joint.units = 1;
    now.gcodes.fill(-1);
  }
  [[nodiscard]] const clients::Stat& stat() const override { return shown_; }
  void refresh() override { shown_ = now; }
  rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words) override {
    std::string line;
    for (const auto& w : words) line += (line.empty() ? "" : " ") + w;
    sent.push_back(line);
    const std::uint64_t id = ++last_id;
    if (answer) replies[id] = answer(words, id);
    return id;
  }
  [[nodiscard]] std::optional<task::Reply> outcome(std::uint64_t id) override {
    const auto at = replies.find(id);
    if (at == replies.end()) return std::nullopt;
    return at->second;
  }
  void forget(std::uint64_t id) override { replies.erase(id); }
  [[nodiscard]] std::vector<task::OperatorMessage> new_messages() override {
    return std::exchange(messages, {});
  }
  [[nodiscard]] std::optional<std::string> ini(const std::string& section,
                                               const std::string& key) const override {
    if (section == "EMC" && key == "MACHINE") return "m";
    return std::nullopt;
  }
  [[nodiscard]] std::string ini_name() const override { return "m.ini"; }
  [[nodiscard]] std::optional<std::string> find_program(const std::string& name) const override {
    if (name == "part.ngc") return "/nc/part.ngc";
    return std::nullopt;
  }
  [[nodiscard]] double wall_time_s() const override { return 1795259679.5; }

  void reply(std::uint64_t id, task::CommandState state, const std::string& text = {}) {
    replies[id] = task::Reply{id, state, text};
  }
  void tell(task::MessageKind kind, const std::string& text) {
    task::OperatorMessage m;
    m.kind = kind;
    m.text = std::string_view(text);
    messages.push_back(m);
  }
  /// Every command is done at once.
  static task::Reply done(const std::vector<std::string>&, std::uint64_t id) {
    return {id, task::CommandState::done, {}};
  }

  clients::Stat now;
  std::vector<std::string> sent;
  std::uint64_t last_id{0};
  std::map<std::uint64_t, task::Reply> replies;
  std::vector<task::OperatorMessage> messages;
  std::function<task::Reply(const std::vector<std::string>&, std::uint64_t)> answer{&done};

 private:
  clients::Stat shown_;
};

}  // namespace kerf::rsh::test
