// watchdog: watches that inputs keep changing.
#include "hal/component.hpp"

namespace kerf::components {

class Watchdog final : public hal::Component<Watchdog> {
 public:
  static constexpr hal::Info kInfo{
      .name = "watchdog",
      .summary = "Watches that inputs keep changing",
      .notes =
          "num_inputs= is the number of inputs, 1 to 32. ok-out is true while enable-in is true "
          "and no input has stood still for its timeout. After a timeout enable-in must become "
          "false and true again.",
      .singleton = true,
      .example = "num_inputs=2"};

  explicit Watchdog(hal::Builder& b) noexcept : Component(b) {
    const std::int64_t inputs = int_arg("num_inputs", 0, "Number of inputs, 1 to 32");
    if (inputs < 1 || inputs > 32) {
      b.fail("num_inputs= must be from 1 to 32");
      return;
    }
    inputs_ = hal::make_array<Input>(b, static_cast<std::size_t>(inputs));
  }

 private:
  struct Input {
    Input(hal::Builder& b, std::size_t index) noexcept {
      pin.declare(b, b.full_name(hal::numbered("input-#", index)), "Input that must keep changing");
      timeout_s.declare(b, b.full_name(hal::numbered("timeout-#", index)),
                        "Longest time without a change [s]");
    }
    hal::In<bool> pin;
    hal::Param<double> timeout_s;
    std::int64_t timeout_ns{0}, left_ns{0};
    bool before{false};
  };
  bool watching_{false}, bitten_{false};

  hal::In<bool> enable_in_{
      pin<hal::In<bool>>("enable-in", "True watches; a rising edge starts anew", false)};
  hal::Out<bool> ok_out_{
      pin<hal::Out<bool>>("ok-out", "True while all inputs keep changing", false)};
  hal::Array<Input> inputs_;

  void process(const hal::Period& period) noexcept {
    if (!watching_ || bitten_) {  // what the inputs do meanwhile is not looked at
      ok_out_ = false;
      return;
    }
    bool late = false;
    for (Input& i : inputs_) {
      const bool now = i.pin;
      if (now != i.before) {
        i.before = now;
        i.left_ns = i.timeout_ns;
      } else if (i.left_ns >= 0) {
        i.left_ns -= period.nominal_ns;
      }
      late = late || i.left_ns < 0;
    }
    bitten_ = late;
    ok_out_ = enable_in_ && !late;
  }
  hal::Function process_{function<&Watchdog::process>("process", "Looks at the inputs")};

  void set_timeouts(const hal::Period&) noexcept {
    for (Input& i : inputs_) {
      const double ns = i.timeout_s * 1e9;
      i.timeout_ns = ns > 0.0 ? (ns < 9e18 ? static_cast<std::int64_t>(ns) : INT64_MAX) : 0;
    }
    const bool enable = enable_in_;
    if (enable && !watching_) {
      for (Input& i : inputs_) i.left_ns = i.timeout_ns;
      bitten_ = false;
      bool possible = true;
      for (const Input& i : inputs_) possible = possible && i.timeout_ns > 0;
      ok_out_ = possible;
      bitten_ = !possible;
    }
    watching_ = enable;
    if (!enable) ok_out_ = false;
  }
  hal::Function set_timeouts_{
      function<&Watchdog::set_timeouts>("set-timeouts", "Reads the timeouts and enable-in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Watchdog)
