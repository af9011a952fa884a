// Machine: all that the remote shell knows of the machine, so that a session can be tested without one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/common/stat.hpp"
#include "rtapi/base/result.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"

namespace kerf::rsh {

/// One a session: when it goes away, the jogs that it began stop.
class Machine {
 public:
  virtual ~Machine() = default;

  /// As of the last refresh().
  [[nodiscard]] virtual const clients::Stat& stat() const = 0;
  virtual void refresh() = 0;
  /// A command of task in words ({"mdi", "G0 X1"}); gives its id.
  virtual rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words) = 0;
  /// The newest reply to it, or nothing yet.
  [[nodiscard]] virtual std::optional<task::Reply> outcome(std::uint64_t id) = 0;
  virtual void forget(std::uint64_t id) = 0;
  /// What the operator was told since the last call; of several machines of one instance each sees every message.
  [[nodiscard]] virtual std::vector<task::OperatorMessage> new_messages() = 0;
  /// A value of the machine's INI file.
  [[nodiscard]] virtual std::optional<std::string> ini(const std::string& section,
                                                       const std::string& key) const = 0;
  /// The INI file's name as it was given.
  [[nodiscard]] virtual std::string ini_name() const = 0;
  /// Where a program stands: nothing when there is no such file.
  [[nodiscard]] virtual std::optional<std::string> find_program(const std::string& name) const = 0;
  /// Seconds since 1970.
  [[nodiscard]] virtual double wall_time_s() const = 0;
};

}  // namespace kerf::rsh
