// IoControl: the user component iocontrol.0: estop chain, coolant, tool changer (manual: "Tool IO", iocontrol(1)).
//
// Handshakes, each ended by an abort:
//   T n   tool-prep-index, -number, -pocket are set, then tool-prepare; HAL answers tool-prepared; tool-prepare goes off.
//   M6    tool-change is set; HAL answers tool-changed; tool-change goes off, tool-number is the new tool, tool-from-pocket its
//         pocket, the tool-prep pins return to 0. The tool that is in the spindle already is not changed, and stays prepared. A tool
//         whose T was aborted is asked for again first.
// A question stands, and is off before the next one, for two servo periods at least: what reads it in a realtime thread sees each
// edge, also when its answer is looped back.
// Random changers swap pockets with the spindle (pocket 0) and save the tool table.
//
// With [EMCIO]EMCIO = iov2 (manual: "I/O Control V2") the changer and Kerf can also tell each other what went wrong:
//   abort   emc-abort with emc-reason; no question is asked before emc-abort-ack.
//   fault   toolchanger-fault is taken at any time (toolchanger-fault-ack, -faulted), ends a question at once and the M6 in progress, or the
//           next one: with toolchanger-reason above 0 the program goes on (#5600, #5601), else it ends. toolchanger-clear-fault forgets it.
//   M6      start-change before anything else of it, until start-change-ack, where the INI file says so.
#pragma once

#include <optional>
#include <string>

#include "io/io_link.hpp"
#include "io/io_pins.hpp"
#include "io/tool_store.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::io {

struct IoOptions {
  bool random_changer{false};
  bool v2{false};                                  ///< iov2 with PROTOCOL_VERSION 2
  bool start_change{false};                        ///< -support-start-change
  std::string fault_text{"toolchanger error %d"};  ///< [TASK]IO_ERROR; %d: the reason
  rtapi::Nanos servo_period{rtapi::kMillisecond};
};

class IoControl final : public rtapi::Participant {
 public:
  /// All references must outlive it.
  IoControl(IoLink& link, rtapi::Cell& to_io, IoPins& pins, ToolStore& tools, IoOptions options);

  [[nodiscard]] const char* name() const noexcept override { return "iocontrol"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::io; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

  [[nodiscard]] const IoOutputs& outputs() const noexcept { return out_; }

 private:
  /// How often pins are looked at: in a handshake, and else.
  static constexpr rtapi::Nanos kBusyPeriod = rtapi::kMillisecond;
  static constexpr rtapi::Nanos kIdlePeriod = 10 * rtapi::kMillisecond;
  static constexpr rtapi::Nanos kRequestTime = rtapi::kSecond;

  void estop_chain(const IoInputs& in, const IoWishes& wishes, rtapi::Nanos now);
  void tool_orders(const IoInputs& in, const IoWishes& wishes, rtapi::Nanos now);
  /// True when the order has ended.
  bool carry_out(const ToolOrder& order, const IoInputs& in);
  bool prepare(const ToolOrder& order, const IoInputs& in);
  bool change(const ToolOrder& order, const IoInputs& in);
  bool start_change(const IoInputs& in);
  void watch_changer(const IoInputs& in);
  /// Ends the M6 as the fault wants it.
  void fail_change();
  void signal_abort(std::int32_t reason);
  /// Sets the question's pins; false: there is no such tool, and the order has failed.
  bool ask_for(int tool);
  void take_prepared(int tool);
  void set_number(int tool);
  void put_into_spindle(int tool);
  void drop_handshake();
  void read_spindle();

  IoLink& link_;
  rtapi::Cell& to_io_;
  IoPins& pins_;
  ToolStore& tools_;
  IoOptions options_;
  IoOutputs out_;
  IoState state_;
  std::uint32_t resets_seen_{0};
  std::uint32_t abort_seen_{0};
  std::uint32_t confirmations_seen_{0};
  rtapi::Nanos request_end_{0};
  bool started_{false};  ///< the order in progress has set its pins
  bool faulted_{false};  ///< the changer has reported a fault that nobody has cleared
  std::int32_t reason_{0};
  rtapi::Nanos settled_{0};  ///< before this HAL may not have seen the last edge of a question
  bool confirmed_{false};    ///< the operator has answered the question in progress
};

}  // namespace kerf::io
