// Goals: a look-up among 50 000 pins below 1 us; a function call with its thread's share below 20 ns on the virtual clock.
#include <benchmark/benchmark.h>

#include "hal/core/registry.hpp"
#include "hal/core/test_builder.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "unit/hal/test_components.hpp"

namespace kerf::hal {
namespace {

constexpr int kPins = 50'000;

struct ManyPins {
  std::unique_ptr<rtapi::Segment> segment = rtapi::Segment::in_memory();
  std::unique_ptr<Registry> registry = std::move(Registry::create(*segment)).value();
  ManyPins() {
    auto* comp = *registry->add_component("c", ComponentKind::realtime);
    for (int i = 0; i < kPins; ++i) {
      (void)registry->add_pin(*comp, "component." + std::to_string(i) + ".pin", Type::floating,
                              Dir::in, 0);
    }
  }
};

void find_pin_of_50000(benchmark::State& state) {
  const ManyPins many;
  unsigned i = 0;
  for (auto _ : state) {
    const auto name = rtapi::format_fixed<40>("component.%u.pin", i = (i + 7919) % kPins);
    benchmark::DoNotOptimize(many.registry->find_pin(name));
  }
}
BENCHMARK(find_pin_of_50000);

void view_pin_of_50000(benchmark::State& state) {
  const ManyPins many;
  const View view(*many.segment);
  for (auto _ : state) benchmark::DoNotOptimize(view.find_pin("component.31234.pin"));
}
BENCHMARK(view_pin_of_50000);

void link_and_unlink(benchmark::State& state) {
  const ManyPins many;
  const std::string pins[] = {"component.1.pin", "component.49999.pin"};
  for (auto _ : state) {
    (void)many.registry->net("s", pins);
    (void)many.registry->unlink(pins[0]);
    (void)many.registry->unlink(pins[1]);
  }
}
BENCHMARK(link_and_unlink);

void cycle_of_100_functions(benchmark::State& state) {
  static const Module adder = test::module_of<test::Adder>();
  static const Module threads = test::module_of<test::TestThreads>();
  static const StaticModule table[] = {{"adder", &adder}, {"test_threads", &threads}};
  auto segment = rtapi::Segment::in_memory();
  ManualClock clock;
  StaticSource modules{table};
  auto host = std::move(Host::create(*segment, clock, modules)).value();
  (void)host->command({"loadrt", "test-threads", "name1=t", "period1=1000000"});
  (void)host->command({"loadrt", "adder", "count=100"});
  for (int i = 0; i < 100; ++i) (void)host->command({"addf", "adder." + std::to_string(i), "t"});
  (void)host->command({"start"});
  auto* thread = host->threads().at(0);
  for (auto _ : state) thread->run_cycle(0, 0);
  state.SetItemsProcessed(state.iterations() * 100);
}
BENCHMARK(cycle_of_100_functions);

}  // namespace
}  // namespace kerf::hal

BENCHMARK_MAIN();
