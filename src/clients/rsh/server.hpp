// Server: the sockets of the remote shell, a session each.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "clients/rsh/machine.hpp"
#include "clients/rsh/session.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::rsh {

/// Sessions have a machine each, and when one ends its machine does: a jog that it began stops.
class Server final : public rtapi::Participant {
 public:
  using MachineMaker = std::function<rtapi::Result<std::unique_ptr<Machine>>()>;

  struct Options {
    std::string address{"127.0.0.1"};  ///< numeric, or "any"
    int port{5007};                    ///< 0: the system picks one
    int max_sessions{-1};              ///< -1: no limit
  };

  /// Sessions settings and passwords come with `shell`.
  Server(Shell& shell, MachineMaker make_machine)
      : shell_(shell), make_machine_(std::move(make_machine)) {}
  ~Server() override;

  /// From here on clients may connect. busy: the port is taken.
  rtapi::Status listen(const Options& options);
  /// "127.0.0.1 port 5007"
  [[nodiscard]] const std::string& place() const noexcept { return place_; }
  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] std::size_t connections() const noexcept { return connections_.size(); }

  /// To be watched while sessions wait for the machine.
  void watch(const rtapi::Cell& status, const rtapi::Cell& replies) {
    status_cell_ = &status;
    reply_cell_ = &replies;
  }

  [[nodiscard]] const char* name() const noexcept override { return "linuxcncrsh"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::user_component; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  struct Connection {
    int fd{-1};
    unsigned watched{0};
    bool input_over{false};  ///< the client sends no more, or is gone
    bool dead{false};
    std::string output;
    std::unique_ptr<Machine> machine;
    std::unique_ptr<Session> session;
  };

  void accept_clients(rtapi::Nanos now);
  void read(Connection& c, rtapi::Nanos now);
  void write(Connection& c);
  /// True: nothing is left to be done for it.
  [[nodiscard]] bool is_over(const Connection& c) const;

  Shell& shell_;
  MachineMaker make_machine_;
  Options options_;
  rtapi::Epoll epoll_;
  int listener_{-1};
  int port_{0};
  std::string place_;
  int last_number_{0};
  rtapi::Nanos accept_again_{0};
  std::map<int, Connection> connections_;  ///< by the session's number
  const rtapi::Cell* status_cell_{nullptr};
  const rtapi::Cell* reply_cell_{nullptr};
};

}  // namespace kerf::rsh
