// iocontrol.0: estop chain, coolant, handshakes of the tool changer. Manual: "Tool IO".
#include "io/iocontrol.hpp"

#include <gtest/gtest.h>

#include "rtapi/clock/local_scheduler.hpp"

namespace kerf::io {
namespace {

class Pins final : public IoPins {
 public:
  IoInputs read() override { return in; }
  void write(const IoOutputs& outputs) override { out = outputs; }
  IoInputs in;
  IoOutputs out;
};

struct Bench {
  explicit Bench(bool random = false) : Bench(IoOptions{random, false, false, {}}) {}
  explicit Bench(const IoOptions& options)
      : link(to_io, to_command, to_interpreter), tools("", 1.0) {
    for (const auto& [n, p] : {std::pair{1, 11}, {2, 12}, {30, options.random_changer ? 0 : 13}})
      (void)tools.put({n, p, {}, 0, 0, 0, 0, ""});
    control = std::make_unique<IoControl>(link, to_io, pins, tools, options);
    scheduler.add(*control);
    run(0.02);
  }
  void run(double s) { scheduler.run_until(scheduler.now() + rtapi::seconds(s)); }
  bool ended(std::uint64_t order) const { return link.state().finished_order >= order; }
  std::uint64_t order(ToolOrder::Kind kind, int tool = -1) {
    const auto n = link.order(kind, tool, 1);
    run(0.02);
    return n;
  }
  void prepare(int tool) {
    order(ToolOrder::Kind::prepare, tool);
    pins.in.tool_prepared = true;
    run(0.02);
    pins.in.tool_prepared = false;
    run(0.02);
  }
  void change() {
    order(ToolOrder::Kind::change);
    pins.in.tool_changed = true;
    run(0.02);
    pins.in.tool_changed = false;
    run(0.02);
  }
  rtapi::Cell to_io, to_command, to_interpreter;
  IoLink link;
  ToolStore tools;
  Pins pins;
  rtapi::LocalScheduler scheduler;
  std::unique_ptr<IoControl> control;
};

using Kind = ToolOrder::Kind;

TEST(IoControl, estop_chain) {
  Bench b;
  EXPECT_FALSE(b.pins.out.user_enable_out);
  b.link.request_reset();
  b.run(0.005);
  EXPECT_TRUE(b.pins.out.user_enable_out);
  EXPECT_TRUE(b.pins.out.user_request_enable);
  EXPECT_FALSE(b.link.state().emc_enable_in);
  b.pins.in.emc_enable_in = true;
  b.run(0.02);
  EXPECT_FALSE(b.pins.out.user_request_enable);
  EXPECT_TRUE(b.link.state().emc_enable_in);
  b.link.set_estop(true);
  b.run(0.001);
  EXPECT_FALSE(b.pins.out.user_enable_out);
}

TEST(IoControl, request_ends_when_nobody_answers) {
  Bench b;
  b.link.request_reset();
  b.run(1.1);
  EXPECT_TRUE(b.pins.out.user_enable_out);
  EXPECT_FALSE(b.pins.out.user_request_enable);
}

TEST(IoControl, prepare_and_change) {
  Bench b;
  const auto t = b.order(Kind::prepare, 2);
  EXPECT_TRUE(b.pins.out.tool_prepare);
  EXPECT_EQ(b.pins.out.tool_prep_number, 2);
  EXPECT_EQ(b.pins.out.tool_prep_pocket, 12);
  EXPECT_EQ(b.pins.out.tool_prep_index, 2);
  EXPECT_FALSE(b.ended(t));
  EXPECT_TRUE(b.link.state().waiting_prepared);
  b.pins.in.tool_prepared = true;
  b.run(0.01);
  EXPECT_FALSE(b.pins.out.tool_prepare);
  EXPECT_TRUE(b.ended(t));
  b.pins.in.tool_prepared = false;
  const auto m6 = b.order(Kind::change);
  EXPECT_TRUE(b.pins.out.tool_change);
  EXPECT_EQ(b.pins.out.tool_number, 0);
  b.pins.in.tool_changed = true;
  b.run(0.01);
  EXPECT_TRUE(b.ended(m6));
  EXPECT_FALSE(b.pins.out.tool_change);
  EXPECT_EQ(b.pins.out.tool_number, 2);
  EXPECT_EQ(b.pins.out.tool_from_pocket, 12);
  EXPECT_EQ(b.pins.out.tool_prep_index, 0);
  EXPECT_EQ(b.pins.out.tool_prep_number, 0);
  EXPECT_EQ(b.link.state().tool_in_spindle, 2);
}

TEST(IoControl, tool_zero_empties_the_spindle) {
  Bench b;
  b.prepare(1);
  b.change();
  EXPECT_EQ(b.pins.out.tool_number, 1);
  b.prepare(0);
  b.change();
  EXPECT_EQ(b.pins.out.tool_number, 0);
  EXPECT_EQ(b.pins.out.tool_from_pocket, 0);
}

TEST(IoControl, tool_in_the_spindle_is_not_changed_again) {
  Bench b;
  b.prepare(1);
  b.change();
  b.prepare(1);
  const auto n = b.order(Kind::change);
  EXPECT_TRUE(b.ended(n));
  EXPECT_FALSE(b.pins.out.tool_change);
}

TEST(IoControl, missing_tool_fails_and_the_next_order_goes_on) {
  Bench b;
  const auto n = b.order(Kind::prepare, 77);
  EXPECT_TRUE(b.ended(n));
  EXPECT_FALSE(b.link.state().finished_well);
  EXPECT_EQ(b.link.state().failure.view(), "tool 77 is not in the tool table");
  b.prepare(1);
  EXPECT_TRUE(b.link.state().finished_well);
}

TEST(IoControl, abort_ends_the_handshake_and_turns_coolant_off) {
  Bench b;
  b.link.set_coolant(1, true, true);
  b.prepare(1);
  const auto n = b.order(Kind::change);
  EXPECT_TRUE(b.pins.out.tool_change);
  EXPECT_TRUE(b.pins.out.coolant_flood && b.pins.out.coolant_mist);
  b.link.abort(2);
  b.run(0.001);
  EXPECT_FALSE(b.pins.out.tool_change);
  EXPECT_FALSE(b.pins.out.coolant_flood || b.pins.out.coolant_mist);
  EXPECT_TRUE(b.ended(n));
  EXPECT_EQ(b.pins.out.tool_number, 0) << "the change did not happen";
  b.link.set_coolant(1, true, {});
  b.run(0.01);
  EXPECT_FALSE(b.pins.out.coolant_flood) << "the aborted program has no say any more";
  EXPECT_EQ(b.link.order(Kind::prepare, 1, 1), 0u);
}

TEST(IoControl, operator_s_word_counts_as_the_pin_and_only_once) {
  Bench b;
  b.link.confirm();
  b.run(0.02);
  const auto t = b.order(Kind::prepare, 1);
  EXPECT_FALSE(b.ended(t)) << "a word that came before the question is no answer";
  b.link.confirm();
  b.run(0.02);
  EXPECT_TRUE(b.ended(t));
  const auto m6 = b.order(Kind::change);
  EXPECT_FALSE(b.ended(m6));
  b.link.confirm();
  b.run(0.02);
  EXPECT_TRUE(b.ended(m6));
  EXPECT_EQ(b.pins.out.tool_number, 1);
}

TEST(IoControl, change_asks_again_for_a_tool_whose_preparation_was_aborted) {
  Bench b;
  b.prepare(1);
  b.change();
  b.order(Kind::prepare, 2);
  b.link.abort(1);
  b.link.abort(2);
  b.run(0.02);
  const auto n = b.link.order(Kind::change, 2, 2);
  b.run(0.02);
  EXPECT_TRUE(b.pins.out.tool_prepare);
  EXPECT_FALSE(b.pins.out.tool_change);
  EXPECT_EQ(b.pins.out.tool_prep_number, 2);
  b.pins.in.tool_prepared = true;
  b.run(0.02);
  EXPECT_FALSE(b.pins.out.tool_prepare);
  EXPECT_TRUE(b.pins.out.tool_change);
  EXPECT_FALSE(b.ended(n));
  b.pins.in.tool_changed = true;
  b.run(0.02);
  EXPECT_TRUE(b.ended(n));
  EXPECT_EQ(b.pins.out.tool_number, 2);
  EXPECT_EQ(b.pins.out.tool_from_pocket, 12);
  EXPECT_EQ(b.pins.out.tool_prep_number, 0);
}

TEST(IoControl, change_to_an_unknown_tool_fails) {
  Bench b;
  const auto n = b.order(Kind::change, 77);
  EXPECT_TRUE(b.ended(n));
  EXPECT_FALSE(b.link.state().finished_well);
  EXPECT_FALSE(b.pins.out.tool_change || b.pins.out.tool_prepare);
}

TEST(IoControl, m61_only_renames) {
  Bench b;
  b.order(Kind::set_number, 30);
  EXPECT_EQ(b.pins.out.tool_number, 30);
  EXPECT_EQ(b.pins.out.tool_from_pocket, 0);
  EXPECT_FALSE(b.pins.out.tool_change || b.pins.out.tool_prepare);
}

TEST(IoControl, random_changer_swaps_pockets) {
  Bench b(true);
  EXPECT_EQ(b.pins.out.tool_number, 30) << "pocket 0 is the spindle";
  b.order(Kind::prepare, 2);
  EXPECT_EQ(b.pins.out.tool_prep_index, 12) << "the index is the pocket";
  b.pins.in.tool_prepared = true;
  b.run(0.02);
  b.pins.in.tool_prepared = false;
  b.change();
  EXPECT_EQ(b.tools.table()->find(2)->pocket, 0);
  EXPECT_EQ(b.tools.table()->find(30)->pocket, 12);
  EXPECT_EQ(b.pins.out.tool_number, 2);
}

struct V2Bench : Bench {
  explicit V2Bench(bool start = false) : Bench(IoOptions{false, true, start, "oops %d!"}) {}
  void fault(int reason) {
    pins.in.toolchanger_reason = reason;
    pins.in.toolchanger_fault = true;
    run(0.02);
  }
  /// The changer takes emc-abort.
  void acknowledge() {
    pins.in.emc_abort_ack = true;
    run(0.02);
    pins.in.emc_abort_ack = false;
    run(0.02);
  }
};

TEST(IoControlV2, an_abort_is_answered_before_the_next_question) {
  V2Bench b;
  b.order(Kind::prepare, 1);
  EXPECT_EQ(b.pins.out.state, 1);
  b.link.abort(2, 8);
  b.run(0.02);
  EXPECT_FALSE(b.pins.out.tool_prepare);
  EXPECT_TRUE(b.pins.out.emc_abort);
  EXPECT_EQ(b.pins.out.emc_reason, 8);
  const auto n = b.link.order(Kind::prepare, 2, 2);
  b.run(5);
  EXPECT_FALSE(b.pins.out.tool_prepare) << "the changer has not heard of the abort";
  EXPECT_TRUE(b.link.state().waiting_abort_ack);
  b.acknowledge();
  EXPECT_FALSE(b.pins.out.emc_abort);
  EXPECT_TRUE(b.pins.out.tool_prepare);
  b.pins.in.tool_prepared = true;
  b.run(0.02);
  EXPECT_TRUE(b.ended(n));
}

TEST(IoControlV2, a_fault_ends_the_change_in_progress_with_its_reason) {
  for (const int reason : {0, -7, 3}) {
    V2Bench b;
    b.prepare(1);
    const auto n = b.order(Kind::change);
    EXPECT_TRUE(b.pins.out.tool_change);
    b.fault(reason);
    EXPECT_TRUE(b.ended(n));
    EXPECT_EQ(b.link.state().finished_well, reason > 0);
    EXPECT_TRUE(b.link.state().changer_fault);
    EXPECT_EQ(b.link.state().changer_reason, reason);
    const std::string text(b.link.state().failure.view());
    EXPECT_EQ(text.find("oops -7!") != std::string::npos, reason < 0) << text;
    EXPECT_FALSE(b.pins.out.tool_change);
    EXPECT_EQ(b.pins.out.tool_number, 0);
    EXPECT_TRUE(b.pins.out.toolchanger_faulted && b.pins.out.toolchanger_fault_ack);
    EXPECT_TRUE(b.pins.out.emc_abort);
    EXPECT_EQ(b.pins.out.emc_reason, 101);
    b.acknowledge();
    b.pins.in.toolchanger_clear_fault = true;
    b.run(0.02);
    EXPECT_TRUE(b.pins.out.toolchanger_faulted) << "the changer still says so";
    b.pins.in.toolchanger_fault = false;
    b.run(0.02);
    EXPECT_FALSE(b.pins.out.toolchanger_faulted || b.pins.out.toolchanger_fault_ack);
    b.prepare(2);
    b.change();
    EXPECT_EQ(b.pins.out.tool_number, 2);
    EXPECT_FALSE(b.link.state().changer_fault);
  }
}

TEST(IoControlV2, a_fault_while_preparing_fails_the_next_m6) {
  V2Bench b;
  const auto t = b.order(Kind::prepare, 1);
  b.fault(-2);
  EXPECT_TRUE(b.ended(t) && b.link.state().finished_well);
  EXPECT_FALSE(b.pins.out.tool_prepare);
  b.pins.in.toolchanger_fault = false;
  b.run(0.02);
  EXPECT_FALSE(b.pins.out.toolchanger_fault_ack);
  EXPECT_TRUE(b.pins.out.toolchanger_faulted);
  const auto n = b.link.order(Kind::change, 1, 1);
  b.run(0.02);
  EXPECT_TRUE(b.ended(n));
  EXPECT_FALSE(b.link.state().finished_well);
}

TEST(IoControlV2, m6_begins_when_the_changer_says_so) {
  for (const bool start : {true, false}) {
    V2Bench b(start);
    const auto n = b.order(Kind::start);
    EXPECT_EQ(b.pins.out.start_change, start);
    EXPECT_EQ(b.ended(n), !start);
    b.pins.in.start_change_ack = true;
    b.run(0.02);
    EXPECT_FALSE(b.pins.out.start_change);
    EXPECT_TRUE(b.ended(n));
  }
}

TEST(IoControlV2, without_it_nothing_of_it_counts) {
  Bench b;
  b.pins.in.toolchanger_fault = true;
  b.link.abort(1, 8);
  b.prepare(1);
  b.change();
  EXPECT_EQ(b.pins.out.tool_number, 1);
  EXPECT_FALSE(b.pins.out.emc_abort || b.pins.out.toolchanger_faulted);
}

}  // namespace
}  // namespace kerf::io
