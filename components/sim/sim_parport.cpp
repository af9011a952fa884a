// sim_parport: stands in for a parallel port.
#include <array>

#include "hal/component.hpp"

namespace kerf::components {

class SimParport final : public hal::Component<SimParport> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-parport",
      .summary = "Stands in for a parallel port",
      .notes =
          "Name it as the port would be: names=parport.0. What the machine writes to pin-NN-out "
          "shows at pin-NN-out-fake, what is written to pin-NN-in-fake the machine reads at "
          "pin-NN-in."};

  explicit SimParport(hal::Builder& b) noexcept : Component(b) {
    constexpr std::size_t kOutputs[]{1, 2, 3, 4, 5, 6, 7, 8, 9, 14, 16, 17};
    constexpr std::size_t kInputs[]{2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 15};
    const auto name = [&](const char* pattern, std::size_t pin) {
      return b.full_name(hal::numbered(pattern, pin));
    };
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      Output& o = outputs_[i];
      o.out.declare(b, name("pin-##-out", kOutputs[i]),
                    "What the machine writes to this pin of the port");
      o.fake.declare(b, name("pin-##-out-fake", kOutputs[i]), "What the port's pin would show");
      o.invert.declare(b, name("pin-##-out-invert", kOutputs[i]),
                       "True: the port's pin shows the opposite");
      o.reset.declare(b, name("pin-##-out-reset", kOutputs[i]),
                      "Accepted for the files that set it; there is nothing to reset");
    }
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      Input& in = inputs_[i];
      in.in.declare(b, name("pin-##-in", kInputs[i]),
                    "What the machine reads from this pin of the port");
      in.in_not.declare(b, name("pin-##-in-not", kInputs[i]), "The opposite of pin-NN-in");
      in.fake.declare(b, name("pin-##-in-fake", kInputs[i]),
                      "What the outside gives to the port's pin");
    }
  }

 private:
  struct Output {
    hal::In<bool> out;
    hal::Out<bool> fake;
    hal::Param<bool> invert, reset;
  };
  struct Input {
    hal::Out<bool> in, in_not;
    hal::In<bool> fake;
  };

  std::array<Output, 12> outputs_{};
  std::array<Input, 13> inputs_{};
  hal::In<double> reset_time_{pin<hal::In<double>>(
      "reset-time", "Accepted for the files that set it; there is nothing to reset")};

  void read(const hal::Period&) noexcept {
    for (Input& i : inputs_) {
      const bool value = i.fake;
      i.in = value;
      i.in_not = !value;
    }
  }
  hal::Function read_{function<&SimParport::read>("read", "Copies the -fake inputs to the inputs")};

  void write(const hal::Period&) noexcept {
    for (Output& o : outputs_) o.fake = o.out != o.invert;
  }
  hal::Function write_{
      function<&SimParport::write>("write", "Copies the outputs to the -fake outputs")};

  void reset(const hal::Period&) noexcept {}
  hal::Function reset_{
      function<&SimParport::reset>("reset", "Does nothing: there is no port to reset")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimParport)
