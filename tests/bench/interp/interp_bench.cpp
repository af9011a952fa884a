// Blocks a second into a canon that drops everything. Beside LinuxCNC, with text: `scripts/bench interp` (compare.py).
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "interp/interpreter.hpp"
#include "interp/null_canon.hpp"

namespace kerf::interp {
namespace {

/// Runs a program again and again; `open` opens it.
template <class Open>
void run_program(benchmark::State& state, Open open) {
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  std::int64_t blocks = 0;
  Outcome last = Outcome::program_end;
  for (auto _ : state) {
    if (!open(interp).ok()) return state.SkipWithError("cannot open the program");
    while ((last = interp.execute_next()) == Outcome::ok) ++blocks;
    if (last != Outcome::program_end) return state.SkipWithError(interp.error().text.c_str());
  }
  state.counters["lines"] =
      benchmark::Counter(static_cast<double>(blocks), benchmark::Counter::kIsRate);
}

void run_text(benchmark::State& state, const std::string& text) {
  run_program(state, [&](Interpreter& interp) { return interp.open_text("bench.ngc", text); });
}

void straight_lines(benchmark::State& state) {
  const std::string path = "/tmp/kerf_interp_bench_" + std::to_string(::getpid()) + ".ngc";
  std::FILE* f = std::fopen(path.c_str(), "w");
  if (f == nullptr) return state.SkipWithError("cannot write the program");
  std::fputs("F1000\n", f);
  for (int i = 0; i < 300000; ++i)
    std::fprintf(f, "G1 X%d.%03d Y%d.%03d Z-%d.5\n", i % 200, i % 1000, i % 150, (i * 7) % 1000,
                 i % 5);
  std::fputs("M2\n", f);
  std::fclose(f);
  run_program(state, [&](Interpreter& interp) { return interp.open(path); });
  ::unlink(path.c_str());
}
BENCHMARK(straight_lines)->Unit(benchmark::kMillisecond);

void arcs(benchmark::State& state) {
  std::string text = "F1000\n";
  for (int i = 0; i < 10000; ++i) {
    const std::string r = std::to_string(5 + i % 50);
    text.append("G2 X").append(r).append(".5 Y0 R").append(r).append("\nG3 X0 Y0 Z1.5 R");
    text.append(r).append(" P2\n");
  }
  run_text(state, text + "M2\n");
}
BENCHMARK(arcs)->Unit(benchmark::kMillisecond);

void loop_with_trigonometry(benchmark::State& state) {
  run_text(state,
           "F1000\n#1=0\no1 while [#1 lt 20000]\n#2=[cos[#1]*10]\n#3=[sin[#1]*10]\nG1 X#2 "
           "Y#3\n#1=[#1+1]\no1 endwhile\nM2\n");
}
BENCHMARK(loop_with_trigonometry)->Unit(benchmark::kMillisecond);

void nested_loops(benchmark::State& state) {
  run_text(state,
           "#1=0\no1 while [#1 lt 50]\n#2=0\no2 while [#2 lt 1000]\n#3=[#1*2.5+#2/4-1]\no3 if [#3 "
           "gt 1000]\no3 elseif [#2 mod 100 eq 50]\n#<s>=#3\no3 endif\n#2=[#2+1]\no2 "
           "endwhile\n#1=[#1+1]\no1 endwhile\nM2\n");
}
BENCHMARK(nested_loops)->Unit(benchmark::kMillisecond);

void sub_calls(benchmark::State& state) {
  run_text(state,
           "o<s> sub\n#4=[#1+#2]\no<s> endsub\no1 repeat [20000]\no<s> call [1] [2.5] "
           "[3]\no1 endrepeat\nM2\n");
}
BENCHMARK(sub_calls)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kerf::interp

BENCHMARK_MAIN();
