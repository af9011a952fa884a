// planner_bench [--help | option...]
//
// Runs generated programs through planner and servo cycle without HAL, one millisecond a cycle, limited in acceleration and in jerk, and
// prints beside the goals: time, offline optimum and feed floor; the largest share of a joint limit in any cycle (by differences of the
// commanded positions) and the distance from the programmed path; corner speeds; exact stops; what planning, the servo cycle and the whole stack cost; whether
// runs repeat bit by bit. Then the same programs under an override that changes at random all along. --count drives random programs with
// overrides, holds, aborts and resumes for that many cycles instead. --gcode writes the quick programs
// there and prints name, time and length of each (compare_with_peer reads that). --pictures draws those of docs/planner.md. Exit 1 when a limit was passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "bench/motion/campaign.hpp"
#include "bench/motion/pictures.hpp"
#include "bench/motion/runs.hpp"
#include "bench/motion/stops.hpp"
#include "bench/motion/whole_stack.hpp"

namespace kerf {
namespace {

/// The machine of the jerk-limited runs [mm/s3, deg/s3].
constexpr double kJerk = 50000;
constexpr double kAcc = 1750;  ///< of XYZ of the reference machine [mm/s2]

struct Entry {
  bench::Program program;
  double seconds{0};  ///< limited in acceleration
};

std::vector<Entry> families(bool quick, std::uint64_t seed) {
  std::vector<Entry> out;
  const auto add = [&](bench::Program p) { out.push_back({std::move(p)}); };
  add(bench::freeform(quick ? 2000 : 20000, 0.01, 100, seed));
  if (!quick) add(bench::freeform(150000, 0.01, 100, seed + 1));
  struct Relief {
    double detail, slope;
  };
  for (const auto& [detail, slope] : {Relief{4, 0.25}, {0.6, 0.25}, {1.4, 0.9}})
    for (const bool merges : {true, false})
      add(bench::relief(quick ? 2000 : 20000, 0.01, 100, merges, seed, detail, slope));
  for (const double p : {0.01, 0.1, 1.0}) add(bench::arc_wave(p, 80, 0.3));
  for (const double p : {0.01, 0.1, 1.0}) add(bench::short_arcs(p, 80));
  for (const double p : {0.01, 0.1, 1.0}) add(bench::arc_spiral(p, 80));
  for (const double p : {0.01, 0.1}) add(bench::helix(p, 80));
  for (const double p : {0.01, 0.1}) add(bench::helical_arcs(p, 80));
  for (const double leg : {13.0, 6.5})
    for (const double p : {0.05, 0.0}) add(bench::zigzag(p, 100, leg));
  add(bench::fractal(quick ? 4 : 6, 0.5, 0.05, 100));
  add(bench::four_axis(quick ? 100 : 1000, 0.02, 100, false, seed));
  add(bench::four_axis(quick ? 100 : 1000, 0.02, 100, true, seed));
  add(bench::inverse_time(quick ? 200 : 2000, 0.02, seed));
  for (const double feed : {50.0, 150.0}) add(bench::swarf(quick ? 400 : 4000, 0.02, feed));
  add(bench::threading(quick ? 4 : 20, 1.5, 600));
  for (std::uint64_t i = 0; i < (quick ? 2 : 12); ++i) add(bench::mixture(400, seed + i));
  return out;
}

/// The jerk of what follows a spindle is the spindle's.
bool within(const bench::RunResult& r, const bench::Program& program) {
  return r.faults == 0 && r.vel <= 1.0001 && r.acc <= 1.001 &&
         (r.jerk <= 1.01 || program.machine == bench::Machine::lathe) &&
         r.deviation <= program.p_mm + 1e-6;
}

double servo_us(const bench::RunResult& r) {
  return r.servo_s * 1e6 / static_cast<double>(std::max<std::size_t>(r.timed, 1));
}

int acceleration_limited(std::vector<Entry>& entries, std::uint64_t seed) {
  int bad = 0;
  double worst = 0;
  std::printf(
      "Limited in acceleration. Goal: time at most 1.03 of the optimum (same curve, grid 8 times "
      "finer, limits at nodes only).\n"
      "%-30s %6s %8s %6s %8s %6s %8s %8s %8s %9s\n",
      "program", "moves", "time s", "mm/s", "optimum", "ratio", "/ floor", "v share", "a share",
      "off mm");
  for (Entry& e : entries) {
    const bench::RunResult r = bench::run(e.program, {0, false, seed, true});
    e.seconds = r.seconds;
    const double best = bench::optimum(e.program), floor = bench::feed_floor(e.program);
    const bool ok = within(r, e.program);
    // On the lathe the spindle is the bound, not the curve.
    const double ratio = best > 0 ? r.seconds / best : 0;
    worst = std::max(worst, ratio);
    std::printf("%-30s %6zu %8.3f %6.1f %8.3f %6.3f %8.3f %8.5f %8.5f %9.6f%s\n",
                e.program.name.c_str(), r.moves, r.seconds, r.length / r.seconds, best, ratio,
                r.seconds / floor, r.vel, r.acc, r.deviation, ok ? "" : "  PASSED A LIMIT");
    std::fflush(stdout);
    bad += ok ? 0 : 1;
  }
  std::printf("worst ratio to the optimum %.3f\n", worst);
  return bad;
}

int jerk_limited(const std::vector<Entry>& entries, std::uint64_t seed) {
  int bad = 0;
  std::printf(
      "\nLimited in jerk, %g mm/s3. Goal: at most 1.45 of the time above.\n"
      "%-30s %6s %8s %6s %6s %8s %8s %8s %9s\n",
      kJerk, "program", "moves", "time s", "mm/s", "ratio", "v share", "a share", "j share",
      "off mm");
  for (const Entry& e : entries) {
    const bench::RunResult r = bench::run(e.program, {kJerk, false, seed, true});
    const bool ok = within(r, e.program);
    std::printf("%-30s %6zu %8.3f %6.1f %6.3f %8.5f %8.5f %8.5f %9.6f%s\n", e.program.name.c_str(),
                r.moves, r.seconds, r.length / r.seconds, r.seconds / e.seconds, r.vel, r.acc,
                r.jerk, r.deviation, ok ? "" : "  PASSED A LIMIT");
    std::fflush(stdout);
    bad += ok ? 0 : 1;
  }
  return bad;
}

/// How near to what jerk limits allow at all on these curves; and how much longer that takes than without jerk limits, which no plan can change.
void jerk_optima(const std::vector<Entry>& entries, const char* only, std::uint64_t seed) {
  std::printf(
      "\nLimited in jerk, beside the least time on the same curve (interior-point method on a fine "
      "grid). Goal: at most 1.03.\n"
      "Of the least time: as a ratio to ours limited in acceleration; by samples of its positions, "
      "the largest shares of limits and the part of the time in which one is used up.\n"
      "%-26s %8s %8s %6s %8s %8s %8s %8s\n",
      "program", "time s", "optimum", "ratio", "opt/acc", "a share", "j share", "used up");
  for (const Entry& e : entries) {
    if (e.program.machine == bench::Machine::lathe) continue;
    if (only != nullptr && e.program.name.find(only) == std::string::npos) continue;
    const double without = bench::run(e.program, {}).seconds;
    const double ours = bench::run(e.program, {kJerk, false, seed}).seconds;
    const bench::LeastTime best = bench::least_time(e.program, kJerk);
    std::printf("%-26s %8.3f %8.3f %6.3f %8.3f %8.4f %8.4f %7.1f%%%s\n", e.program.name.c_str(),
                ours, best.seconds, ours / best.seconds, best.seconds / without, best.acc,
                best.jerk,
                100.0 * static_cast<double>(best.saturated) /
                    static_cast<double>(std::max<std::size_t>(best.samples, 1)),
                best.gap_s > 0.003 * best.seconds ? "  NOT SETTLED" : "");
    std::fflush(stdout);
  }
  const bench::Program stops = bench::zigzag(0, 100);
  std::printf("Check on exact stops: %.3f s, closed form %.3f s\n",
              bench::least_time(stops, kJerk).seconds, bench::stops_closed_form(stops, kJerk));
}

int overridden(const std::vector<Entry>& entries, std::uint64_t seed) {
  int bad = 0;
  for (const double jerk : {0.0, kJerk}) {
    bench::RunResult worst;
    for (const Entry& e : entries) {
      const bench::RunResult r = bench::run(e.program, {jerk, true, seed, true});
      worst.vel = std::max(worst.vel, r.vel);
      worst.acc = std::max(worst.acc, r.acc);
      if (e.program.machine != bench::Machine::lathe) worst.jerk = std::max(worst.jerk, r.jerk);
      worst.cycles += r.cycles;
      if (!within(r, e.program)) {
        ++bad;
        std::printf("%s: v %.5f a %.5f j %.5f, off %.6f, faults %zu  PASSED A LIMIT\n",
                    e.program.name.c_str(), r.vel, r.acc, r.jerk, r.deviation, r.faults);
      }
    }
    std::printf(
        "\nFeed override 5 to 200 %% at random, limited in %s: %zu cycles, largest shares v %.5f a "
        "%.5f j %.5f\n",
        jerk > 0 ? "jerk" : "acceleration", worst.cycles, worst.vel, worst.acc, worst.jerk);
    std::fflush(stdout);
  }
  return bad;
}

/// The least speed in a corner against that of a parabola that stays within P and uses the whole of the joint limits.
void corners() {
  constexpr double kP = 0.05, kLeg = 40, kFeed = 190;
  std::printf(
      "\nCorners, P%g. Goal: at least 0.95 of a parabola within P at the joint limits.\n%8s %10s "
      "%10s %7s %12s\n",
      kP, "degrees", "ours mm/s", "parabola", "ratio", "with jerk");
  for (const double degrees : {30.0, 60.0, 90.0, 120.0, 150.0}) {
    const bench::Program program = bench::corner(degrees, kLeg, kP, kFeed);
    const double turn = degrees * std::numbers::pi / 180;
    const double dx = std::abs(std::cos(turn) - 1), dy = std::sin(turn), kink = std::hypot(dx, dy);
    // q'' = kink / 2l over [-l, l]: off by kink l / 4 at the corner, where |q'| is cos(turn / 2).
    const double l = 4 * kP / kink;
    const double parabola = std::sqrt(2 * l * kAcc / std::max(dx, dy)) * std::cos(turn / 2);
    const double ours = bench::run(program, {}).slowest;
    const double jerk = bench::run(program, {kJerk}).slowest;
    std::printf("%8.0f %10.2f %10.2f %7.3f %12.2f\n", degrees, ours, parabola, ours / parabola,
                jerk);
  }
}

void exact_stops() {
  const bench::Program program = bench::zigzag(0, 100);
  std::printf("\nExact stops. Goal: at most 1.03 of the closed form.\n");
  for (const double jerk : {0.0, kJerk}) {
    const double ours = bench::run(program, {jerk}).seconds,
                 form = bench::stops_closed_form(program, jerk);
    std::printf("limited in %-12s %8.3f s, closed form %8.3f s, ratio %.4f\n",
                jerk > 0 ? "jerk" : "acceleration", ours, form, ours / form);
  }
}

int repeats(std::uint64_t seed) {
  int bad = 0;
  for (const double jerk : {0.0, kJerk}) {
    const bench::Program program = bench::mixture(400, seed);
    const std::uint64_t first = bench::run(program, {jerk, true, seed}).hash;
    for (int i = 2; i <= 5; ++i)
      bad += bench::run(program, {jerk, true, seed}).hash == first ? 0 : 1;
  }
  std::printf("\nFive runs of one program are %s\n", bad == 0 ? "equal bit for bit" : "NOT EQUAL");
  return bad;
}

/// Most of a program, then backwards as far as the machine remembers.
int retraces(std::uint64_t seed) {
  constexpr double kSame = 1e-9;
  int bad = 0;
  for (const double jerk : {0.0, kJerk}) {
    bench::RetraceResult worst;
    for (const bench::Program& program :
         {bench::mixture(200, seed), bench::arc_spiral(0.1, 80), bench::fractal(4, 0.5, 0.05, 100),
          bench::four_axis(60, 0.02, 100, false, seed), bench::swarf(300, 0.05, 150)}) {
      const bench::RetraceResult r = bench::retrace(program, jerk);
      worst.off = std::max(worst.off, r.off);
      worst.length += r.length;
      worst.faults += r.faults;
    }
    bad += worst.off <= kSame && worst.faults == 0 ? 0 : 1;
    std::printf("%sackwards, limited in %s: %.0f mm, at most %.1e from the curve driven forwards\n",
                jerk > 0 ? "B" : "\nB", jerk > 0 ? "jerk" : "acceleration", worst.length,
                worst.off);
  }
  return bad;
}

/// Holds and aborts limited in jerk.
void stop_times(const std::vector<Entry>& entries, const char* only, std::size_t most) {
  std::printf(
      "\nStops limited in jerk, beside the soonest that is known. Goal: at most 1.1.\n"
      "%-26s %8s %8s %8s %8s %8s\n",
      "program", "moments", "mean", "worst", "> 1.1", "solver");
  std::size_t all = 0, over = 0;
  for (const Entry& e : entries) {
    if (e.program.machine != bench::Machine::mill) continue;
    if (only != nullptr && e.program.name.find(only) == std::string::npos) continue;
    const bench::StopsResult r = bench::stops(e.program, kJerk, most);
    const double percent = 100 / static_cast<double>(std::max<std::size_t>(r.moments, 1));
    std::printf("%-26s %8zu %8.4f %8.3f %7.2f%% %7.2f%%\n", e.program.name.c_str(), r.moments,
                r.mean, r.worst, percent * static_cast<double>(r.over),
                percent * static_cast<double>(r.searched));
    std::fflush(stdout);
    all += r.moments;
    over += r.over;
  }
  std::printf("%zu of %zu take more than 1.1 of the soonest\n", over, all);
}

/// Every family of short lines, and the arcs on which a servo cycle takes longest.
std::vector<bench::Program> short_lines(bool quick, std::uint64_t seed) {
  const int lines = quick ? 2000 : 10000;
  std::vector<bench::Program> out;
  for (const bool merges : {true, false})
    out.push_back(bench::freeform(lines, 0.01, 100, seed, merges));
  for (const double detail : {4.0, 0.6})
    for (const bool merges : {true, false})
      out.push_back(bench::relief(lines, 0.01, 100, merges, seed, detail));
  out.push_back(bench::fractal(quick ? 4 : 6, 0.5, 0.05, 100));
  for (const bool reversing : {false, true})
    out.push_back(bench::four_axis(lines / 20, 0.02, 100, reversing, seed));
  out.push_back(bench::inverse_time(lines / 10, 0.02, seed));
  for (const double feed : {50.0, 150.0}) out.push_back(bench::swarf(lines / 5, 0.02, feed));
  out.push_back(bench::helix(0.1, 80));
  return out;
}

void throughput(bool quick, const char* only, std::uint64_t seed) {
  std::printf(
      "\nPlanning of short segments, and planner and executor in a servo cycle. Goals: 20 000 "
      "segments a second, at most 1.5 us a cycle.\n");
  for (const bench::Program& program : short_lines(quick, seed))
    for (const double jerk : {0.0, kJerk}) {
      if (only != nullptr && program.name.find(only) == std::string::npos) continue;
      const bench::RunResult r = bench::run(program, {jerk});
      // Stops are made so many times a second, however short the lines are.
      const double stops = r.stops_s / r.seconds,
                   most = (1 - stops) * static_cast<double>(r.moves) / (r.planner_s - r.stops_s);
      std::printf(
          "%-32s limited in %-12s %8.0f segments/s, %.3f s for a second of motion, of it %.3f s "
          "for stops; keeps up with %.0f segments/s; %.2f us a cycle\n",
          program.name.c_str(), jerk > 0 ? "jerk" : "acceleration",
          static_cast<double>(r.moves) / r.planner_s, r.planner_s / r.seconds, stops, most,
          servo_us(r));
      const bench::RunResult swinging = bench::run(program, {.jerk = jerk, .swings = true});
      std::printf(
          "  under a feed that changes in every cycle: %.3f s for a second of motion, %d of %d "
          "laws "
          "not found\n",
          swinging.planner_s / swinging.seconds, static_cast<int>(swinging.laws.children.failed),
          static_cast<int>(swinging.laws.children.all));
      if (!(jerk > 0)) continue;
      for (const auto& [what, n] :
           {std::pair{"from rest", r.laws.rests}, std::pair{"children", r.laws.children},
            std::pair{"stops", r.laws.stops}}) {
        const auto all = static_cast<double>(std::max<std::uint64_t>(n.all, 1));
        std::printf(
            "  %-10s %6.1f a second of motion, %d searched, %d not found: %6.0f intervals, %5.1f "
            "iterations; %8.0f intervals x iterations a second of motion\n",
            what, static_cast<double>(n.all) / r.seconds, static_cast<int>(n.searched),
            static_cast<int>(n.failed), static_cast<double>(n.intervals) / all,
            static_cast<double>(n.iterations) / all, static_cast<double>(n.work) / r.seconds);
      }
    }
}

/// Smooth curves in short lines, at a feed that they have room for: what jerk limits cost there.
int dense(bool quick, const char* only) {
  constexpr double kFeed = 100, kP = 0.01;
  int bad = 0;
  std::printf(
      "\nDense lines along smooth curves, F%g mm/s. Goal: at feed all along, with jerk limits "
      "too.\n"
      "%-34s %8s %8s %8s %8s %8s %9s %8s\n",
      kFeed, "program", "acc s", "slowest", "jerk s", "slowest", "ratio", "off mm", "core");
  for (const bool circle : {true, false})
    for (const double step : {0.02, 0.05, 0.1})
      for (const bool merges : {true, false}) {
        const bench::Program program =
            bench::dense_lines(quick ? 200 : 800, step, kP, kFeed, merges, circle);
        if (only != nullptr && program.name.find(only) == std::string::npos) continue;
        const bench::RunResult acc = bench::run(program, {}),
                               jerk = bench::run(program, {kJerk, false, 1, true});
        const bool ok = within(acc, program) && within(jerk, program);
        std::printf("%-34s %8.3f %8.4f %8.3f %8.4f %8.4f %9.6f %8.3f%s\n", program.name.c_str(),
                    acc.seconds, acc.slowest / kFeed, jerk.seconds, jerk.slowest / kFeed,
                    jerk.seconds / acc.seconds, jerk.deviation, jerk.planner_s / jerk.seconds,
                    ok ? "" : "  PASSED A LIMIT");
        std::fflush(stdout);
        bad += ok ? 0 : 1;
      }
  return bad;
}

/// Programs as files: all that runs on one core, in virtual time.
int whole_stack(bool quick, std::uint64_t seed) {
  int bad = 0;
  const int lines = quick ? 5000 : 20000;
  std::printf(
      "\nThe whole stack, from %d freeform lines in a file to the last servo cycle. Goal: at least "
      "20 000 lines a second of one core.\n"
      "%-26s %12s %16s %20s\n",
      lines, "limited in", "in one thread", "with processes", "of it for the clock");
  for (const double jerk : {0.0, kJerk})
    for (const bool merges : {true, false}) {
      const bench::StackProgram program = bench::freeform_lines(lines, merges, seed);
      const bench::StackResult one = bench::run_in_harness(program, jerk),
                               all = bench::run_in_processes(program, jerk);
      const auto rate = [&](double s) { return static_cast<double>(program.lines) / s; };
      std::printf("%-12s %-13s %12.0f %16.0f %19.2f s %s%s\n", jerk > 0 ? "jerk" : "acceleration",
                  merges ? "" : "Q0", rate(one.processor_s), rate(all.processor_s),
                  all.processor_s - one.processor_s, one.error.c_str(), all.error.c_str());
      std::fflush(stdout);
      bad += one.error.empty() && all.error.empty() ? 0 : 1;
    }
  std::printf(
      "5000 lines a second of motion (0.02 mm at 100 mm/s): share of the feed in the slowest cycle "
      "between the first and the last at the feed; time over that at the feed; share of a core\n");
  for (const double jerk : {0.0, kJerk})
    for (const bool merges : {true, false}) {
      const bench::StackProgram program = bench::dense_lines(lines * 2, merges);
      const bench::StackResult r = bench::run_in_harness(program, jerk);
      std::printf("%-12s %-13s %12.4f %16.3f %20.3f %s\n", jerk > 0 ? "jerk" : "acceleration",
                  merges ? "" : "Q0", r.slowest,
                  r.seconds * 5000 / static_cast<double>(program.lines), r.processor_s / r.seconds,
                  r.error.c_str());
      std::fflush(stdout);
      bad += r.error.empty() ? 0 : 1;
    }
  return bad;
}

/// What the servo thread spends on motion, as integrators see it in motion-controller.time.
int servo_functions(bool quick, const char* only, std::uint64_t seed) {
  int bad = 0;
  std::printf(
      "\nThe HAL function motion-controller in a machine of three joints, with its pins, status "
      "and "
      "flight record. Goal: at most 1.5 us.\n%-14s %-14s %10s %9s %9s %9s\n",
      "limited in", "", "cycles", "mean us", "median", "99 %");
  struct Case {
    const char* what;
    bench::StackProgram program;
    bool sweeps;
  };
  const int lines = quick ? 3000 : 20000;
  const bench::StackProgram freeform = bench::freeform_lines(lines, true, seed);
  for (const double jerk : {0.0, kJerk})
    for (const Case& c : {Case{"freeform", freeform, false}, Case{"standing", {}, false},
                          Case{"caches swept", freeform, true}}) {
      if (only != nullptr && std::strcmp(only, c.what) != 0) continue;
      const bench::ServoCost r = bench::servo_function(c.program, jerk, c.sweeps);
      std::printf("%-14s %-14s %10zu %9.2f %9.2f %9.2f %s\n", jerk > 0 ? "jerk" : "acceleration",
                  c.what, r.cycles, r.mean_us, r.p50_us, r.p99_us, r.error.c_str());
      std::fflush(stdout);
      bad += r.error.empty() ? 0 : 1;
    }
  return bad;
}

int write_programs(const char* folder, std::uint64_t seed) {
  for (const Entry& e : families(true, seed)) {
    std::string name = e.program.name;
    for (char& c : name)
      if (c == ' ' || c == ',') c = '_';
    if (!bench::write_gcode(e.program, std::string(folder) + "/" + name + ".ngc")) {
      std::fprintf(stderr, "planner_bench: cannot write to %s\n", folder);
      return 2;
    }
    const bench::RunResult r = bench::run(e.program, {0, false, seed, true});
    std::printf("%s\t%s\t%g\t%.3f\t%.3f\t%.5f\t%.6f\t%.3f\n", name.c_str(),
                e.program.machine == bench::Machine::table ? "table" : "mill", e.program.p_mm,
                r.seconds, r.length, r.acc, r.deviation, bench::feed_floor(e.program));
  }
  return 0;
}

int main_of(int argc, char** argv) {
  std::uint64_t seed = 1, count = 0;
  bool quick = false, optima = false, cost = false, stops = false, stack = false, servo = false,
       streams = false;
  const char *gcode = nullptr, *pictures = nullptr, *only = nullptr;
  for (int i = 1; i < argc; ++i) {
    const bool value = i + 1 < argc;
    if (std::strcmp(argv[i], "--seed") == 0 && value) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--count") == 0 && value) {
      count = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--gcode") == 0 && value) {
      gcode = argv[++i];
    } else if (std::strcmp(argv[i], "--optima") == 0) {
      optima = true;
    } else if (std::strcmp(argv[i], "--cost") == 0) {
      cost = true;
    } else if (std::strcmp(argv[i], "--servo") == 0) {
      servo = true;
    } else if (std::strcmp(argv[i], "--dense") == 0) {
      streams = true;
    } else if (std::strcmp(argv[i], "--stack") == 0) {
      stack = true;
    } else if (std::strcmp(argv[i], "--stops") == 0) {
      stops = true;
    } else if (std::strcmp(argv[i], "--pictures") == 0 && value) {
      pictures = argv[++i];
    } else if (std::strcmp(argv[i], "--only") == 0 && value) {
      only = argv[++i];
    } else if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else {
      std::puts(
          "Usage: planner_bench [--seed N] [--quick] [--only NAME]\n"
          "                     [--optima | --cost | --servo | --dense | --stack | --stops]\n"
          "                     [--count CYCLES] [--gcode FOLDER] [--pictures FOLDER]\n"
          "Times of generated programs beside their optima, the shares of the joint limits they "
          "use, and what planning costs.\n"
          "--optima   only the jerk-limited times beside their optima\n"
          "--cost     only what planning and the servo function cost\n"
          "--servo    only what the servo function costs\n"
          "--dense    only whether dense lines keep their feed\n"
          "--stack    only what the whole machine costs from the file on; its programs have to be "
          "built\n"
          "--stops    only stops limited in jerk beside the soonest known\n"
          "--only     programs with NAME in their names, with --optima, --cost, --servo, --dense "
          "and "
          "--stops\n"
          "--count    random programs with overrides, holds, aborts and resumes for that many "
          "servo cycles\n"
          "--gcode    writes the quick programs there\n"
          "--pictures draws those of docs/planner.md there");
      return std::strcmp(argv[i], "--help") == 0 ? 0 : 2;
    }
  }
  if (gcode != nullptr) return write_programs(gcode, seed);
  if (pictures != nullptr) {
    if (bench::draw_pictures(pictures)) return 0;
    std::fprintf(stderr, "planner_bench: cannot write to %s\n", pictures);
    return 2;
  }
  if (count > 0) {
    const bench::CampaignResult r = bench::campaign(count, seed);
    bench::print(r);
    return r.exceptions == 0 ? 0 : 1;
  }
  if (cost) {
    throughput(quick, only, seed);
    return servo_functions(quick, nullptr, seed) == 0 ? 0 : 1;
  }
  if (servo) return servo_functions(quick, only, seed) == 0 ? 0 : 1;
  if (streams) return dense(quick, only) == 0 ? 0 : 1;
  if (stack) return whole_stack(quick, seed) == 0 ? 0 : 1;
  if (stops) {
    stop_times(families(true, seed), only, quick ? 400 : 2000);
    return 0;
  }
  if (optima) {
    jerk_optima(families(true, seed), only, seed);
    return 0;
  }
  std::vector<Entry> entries = families(quick, seed);
  int bad = acceleration_limited(entries, seed);
  bad += jerk_limited(entries, seed);
  jerk_optima(families(true, seed), nullptr, seed);
  stop_times(families(true, seed), nullptr, 200);
  corners();
  exact_stops();
  throughput(quick, only, seed);
  bad += dense(quick, nullptr);
  bad += whole_stack(quick, seed);
  bad += servo_functions(quick, nullptr, seed);
  bad += repeats(seed);
  bad += retraces(seed);
  bad += overridden(entries, seed);
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) { return kerf::main_of(argc, argv); }
