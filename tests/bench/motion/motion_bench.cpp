// Cost of the servo cycle (planner_bench has that of planning). Goals: a cycle of three joints well below 2 us in release.
#include <benchmark/benchmark.h>

#include <memory>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

/// One whole servo cycle of a machine under way on long arcs, without HAL.
void servo_cycle(benchmark::State& state) {
  auto rig = std::make_unique<Rig>();
  rig->ready();
  auto cell = std::make_unique<rtapi::SeqCell<MotionStatus>>();
  double side = 100;
  for (auto _ : state) {
    if (rig->path->size() < 4) {
      ArcMove m;
      m.end = {.x = -side};
      m.normal[2] = 1;
      m.vel_mm_s = 50;
      if (rig->seq == 0) rig->line({.x = side}, 50);
      rig->push(m);
      side = -side;
    }
    rig->cycle();
    if (state.range(0) != 0) cell->write(rig->status());
  }
}
BENCHMARK(servo_cycle)->Arg(0)->Arg(1)->ArgNames({"with-status"});

void servo_cycle_standing(benchmark::State& state) {
  auto rig = std::make_unique<Rig>();
  rig->ready();
  for (auto _ : state) rig->cycle();
}
BENCHMARK(servo_cycle_standing);

}  // namespace
}  // namespace kerf::motion

BENCHMARK_MAIN();
