// Goals: a look-up among 50 000 pins below 1 us; a function call with its thread's share below 20 ns on the virtual clock.
#include <benchmark/benchmark.h>

#include "hal/core/registry.hpp"
#include "hal/core/test_builder.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/module_source.hpp"
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

/// As components/logic/and2.cpp, which this module of the build does not know.
class And2 final : public Component<And2> {
 public:
  static constexpr Info kInfo{.name = "and2", .summary = "Two-input AND gate"};
  using Component::Component;

 private:
  In<bool> in0_{pin<In<bool>>("in0", "First input")};
  In<bool> in1_{pin<In<bool>>("in1", "Second input")};
  Out<bool> out_{pin<Out<bool>>("out", "True while both inputs are true")};
  void update(const Period&) noexcept { out_ = in0_ && in1_; }
  Function update_{function<&And2::update>("", "Computes out from the inputs")};
};

/// One cycle of a thread with `range(0)` times and2 in the timing mode `range(1)`. `range(2)`: other work of so many KiB comes between
/// two cycles, as on a machine that does something else too.
void cycle_of_and2(benchmark::State& state) {
  const auto count = state.range(0);
  auto segment = rtapi::Segment::in_memory();
  ManualClock clock;
  static const Module and2 = test::module_of<And2>();
  static const Module threads = test::module_of<test::TestThreads>();
  static const StaticModule table[] = {{"and2", &and2}, {"test_threads", &threads}};
  StaticSource modules{table};
  auto host = std::move(Host::create(*segment, clock, modules)).value();
  const auto counter = rtapi::CycleCounter::calibrated();
  host->set_cycle_counter(counter);
  host->set_timing_mode(static_cast<TimingMode>(state.range(1)));
  (void)host->command({"loadrt", "test-threads", "name1=t", "period1=100000000"});
  (void)host->command({"loadrt", "and2", "count=" + std::to_string(count)});
  for (int i = 0; i < count; ++i) (void)host->command({"addf", "and2." + std::to_string(i), "t"});
  (void)host->command({"start"});
  auto* thread = host->threads().at(0);
  std::vector<std::uint64_t> other(static_cast<std::size_t>(state.range(2)) * 128);
  for (auto _ : state) {
    for (std::size_t i = 0; i < other.size(); i += 8) ++other[i];
    const auto begin = counter.ticks();
    thread->run_cycle(0, 0);
    state.SetIterationTime(static_cast<double>(counter.ns(counter.ticks() - begin)) * 1e-9);
  }
  state.SetLabel(timing_mode_name(static_cast<TimingMode>(state.range(1))));
  state.counters["ns/function"] = benchmark::Counter(
      static_cast<double>(count) * 1e-9 * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(cycle_of_and2)->ArgsProduct({{20, 1000}, {0, 1, 2}, {0, 4096}})->UseManualTime();

}  // namespace
}  // namespace kerf::hal

BENCHMARK_MAIN();
