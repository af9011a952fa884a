// scripts/bench stepgen: a hundred million base periods of 50 us under the eyes of a watch; none may break a time or lose a step.
#include <cstdio>
#include <cstdlib>

#include "harness/step_machine.hpp"

extern "C" const kerf::hal::Module kerf_hal_module_stepgen;

int main(int argc, char** argv) {
  using kerf::components::StepMachine;
  const double cycles = argc > 1 ? std::atof(argv[1]) : 1e8;
  if (cycles < 1.0) {
    std::fprintf(stderr, "usage: stepgen_bench [BASE PERIODS]\n");
    return 2;
  }
  constexpr double kScale = 100.0;
  StepMachine m(kerf_hal_module_stepgen, {60'000, 50'000, 200'000, 100'000});
  m.hal().set("stepgen.0.position-scale", kScale);
  m.hal().set("stepgen.0.maxaccel", 2000.0);
  double phase_s = 0.0, worst = 0.0, done = 0.0;
  while (done < cycles && m.watch().wrong().empty()) {
    worst = std::max(worst, m.follow_sines(5.0, kScale, 50'000, phase_s));
    done += 50'000.0 * kerf::components::kBasePerServo;
  }
  std::printf(
      "%.0f base periods of 50 us: %s; farthest from the command half a period back: %.3f steps\n",
      done, m.watch().wrong().empty() ? "no time broken" : m.watch().wrong().c_str(), worst);
  return m.watch().wrong().empty() && worst < 1.0 ? 0 : 1;
}
