// Blocks a second into a canon that drops everything; the peer's rs274 does 0.24 M G1 lines and 0.45 M loop lines.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "bench/interp/null_canon.hpp"
#include "interp/interpreter.hpp"

namespace kerf::interp {
namespace {

void run_all(Interpreter& interp, std::int64_t& blocks) {
  for (;;) {
    const Outcome o = interp.execute_next();
    if (o != Outcome::ok) return;
    ++blocks;
  }
}

void straight_lines(benchmark::State& state) {
  const std::string path = "/tmp/kerf_interp_bench_" + std::to_string(::getpid()) + ".ngc";
  std::FILE* f = std::fopen(path.c_str(), "w");
  std::fputs("F1000\n", f);
  for (int i = 0; i < 300000; ++i)
    std::fprintf(f, "G1 X%d.%03d Y%d.%03d Z-%d.5\n", i % 200, i % 1000, i % 150, (i * 7) % 1000,
                 i % 5);
  std::fputs("M2\n", f);
  std::fclose(f);
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  std::int64_t blocks = 0;
  for (auto _ : state) {
    if (!interp.open(path).ok()) state.SkipWithError("cannot open the program");
    run_all(interp, blocks);
  }
  ::unlink(path.c_str());
  state.counters["lines"] =
      benchmark::Counter(static_cast<double>(blocks), benchmark::Counter::kIsRate);
}
BENCHMARK(straight_lines)->Unit(benchmark::kMillisecond);

void loop_with_trigonometry(benchmark::State& state) {
  const std::string program =
      "F1000\n#1=0\no1 while [#1 lt 20000]\n#2=[cos[#1]*10]\n#3=[sin[#1]*10]\nG1 X#2 "
      "Y#3\n#1=[#1+1]\no1 endwhile\nM2\n";
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  std::int64_t blocks = 0;
  for (auto _ : state) {
    if (!interp.open_text("loop", program).ok()) state.SkipWithError("cannot open the program");
    run_all(interp, blocks);
  }
  state.counters["lines"] =
      benchmark::Counter(static_cast<double>(blocks), benchmark::Counter::kIsRate);
}
BENCHMARK(loop_with_trigonometry)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kerf::interp

BENCHMARK_MAIN();
