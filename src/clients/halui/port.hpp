// Port: where halui's commands go.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "task/api/protocol.hpp"

namespace kerf::clients::halui {

class Port {
 public:
  virtual ~Port() = default;
  /// Sends a command given as words ({"jog", "x", "10"}); gives its id, 0 when it could not be sent.
  virtual std::uint64_t send(const std::vector<std::string>& words) = 0;
  /// How it ended; nothing while it has not.
  virtual std::optional<task::Reply> outcome(std::uint64_t id) = 0;
  /// A line for the operator: a button was pressed that can do nothing now.
  virtual void complain(const std::string& text) = 0;
};

/// A number as a word of a command.
[[nodiscard]] std::string word(double value);

}  // namespace kerf::clients::halui
