// IoLink: what task asks of io and what io says back. Thread-safe; nobody waits in it.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::io {

/// One order about tools. Orders are carried out one at a time, in order.
struct ToolOrder {
  enum class Kind : std::uint8_t {
    prepare,  ///< T
    change,  ///< M6: `tool` into the spindle, prepared first when it is not; -1: whichever is prepared
    set_number,  ///< M61: the tool in the spindle has this number
    start,       ///< iov2: M6 begins
  };
  std::uint64_t number{0};  ///< 1, 2, 3 ...
  std::uint32_t epoch{0};   ///< abort epoch in force; an abort ends the orders of older ones
  Kind kind{Kind::prepare};
  int tool{0};
};

/// How io stands. Tool numbers: 0 none (non-random changers), -1 unknown.
struct IoState {
  bool emc_enable_in{false};
  bool user_enable{false};
  bool flood{false}, mist{false};
  bool waiting_prepared{false},
      waiting_changed{false};  ///< for iocontrol.0.tool-prepared, .tool-changed
  int tool_in_spindle{0};
  int pocket_in_spindle{0};  ///< the pocket that it came from
  int prepared_tool{-1};     ///< -1: none since the last change
  int prepared_index{-1};
  bool changer_fault{false};  ///< iov2: the last M6 was ended by the changer ...
  int changer_reason{0};      ///< ... for this reason
  bool waiting_start_change{false}, waiting_abort_ack{false};
  std::uint64_t finished_order{0};  ///< all orders up to this one have ended
  bool finished_well{true};         ///< the last of them
  rtapi::FixedString<200> failure;  ///< why not
  friend bool operator==(const IoState&, const IoState&) = default;
};

/// What task wants. Coolant has two masters, the program and the operator; an abort voids what older epochs still ask.
struct IoWishes {
  bool estop{true};
  std::uint32_t confirmations{0};   ///< grows with each confirm()
  std::uint32_t reset_requests{0};  ///< grows with each request to clear the estop
  bool flood{false}, mist{false};
  std::uint32_t abort_epoch{0};
  std::int32_t abort_reason{0};  ///< as iocontrol.0.emc-reason
};

class IoLink {
 public:
  IoLink(rtapi::Cell& to_io, rtapi::Cell& to_command, rtapi::Cell& to_interpreter)
      : to_io_(to_io), to_command_(to_command), to_interpreter_(to_interpreter) {}

  // --- task ---
  void set_estop(bool estop);
  void request_reset();
  /// Coolant off, tool orders of older epochs ended. `reason`: for iocontrol.0.emc-reason.
  void abort(std::uint32_t epoch, std::int32_t reason = 0);
  /// Ignored when an abort newer than `epoch` has come.
  void set_coolant(std::uint32_t epoch, std::optional<bool> flood, std::optional<bool> mist);
  /// The operator says that the tool is there: ends the handshake in progress as its pin would.
  void confirm();
  /// Gives the order's number; it has ended when state().finished_order has come to it. 0: voided by an abort.
  std::uint64_t order(ToolOrder::Kind kind, int tool, std::uint32_t epoch);
  [[nodiscard]] IoState state() const;

  // --- io ---
  [[nodiscard]] IoWishes wishes() const;
  /// The oldest order that has not ended; nothing when there is none.
  [[nodiscard]] std::optional<ToolOrder> next_order() const;
  /// Ends the oldest order.
  void finish_order(bool well, std::string_view failure);
  /// Publishes; the order fields are the link's own. Wakes task when something changed.
  void publish(const IoState& state);

 private:
  static constexpr std::size_t kOrders = 8;
  rtapi::Cell& to_io_;
  rtapi::Cell& to_command_;
  rtapi::Cell& to_interpreter_;
  mutable std::mutex mutex_;
  IoWishes wishes_;
  IoState state_;
  ToolOrder orders_[kOrders];  ///< order n stands in n % kOrders
  std::uint64_t last_order_{0};
};

}  // namespace kerf::io
