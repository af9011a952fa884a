// planner_bench [--seed N] [--quick]
//
// Runs generated programs through planner and servo cycle without HAL, one millisecond a cycle, and prints for each: its time, the mean
// feed, the largest share of a joint limit that any cycle used (by differences of the commanded positions), and what planner
// and servo cost; then the same with a feed override that changes at random all along. Exit 1 when a limit was passed.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>

#include "bench/motion/families.hpp"
#include "unit/motion/rig.hpp"

namespace kerf {
namespace {

using motion::test::Rig;

/// The machine of the jerk-limited runs [mm/s3, deg/s3].
constexpr double kJerk = 50000;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Result {
  double seconds{0}, length{0}, vel{0}, acc{0}, jerk{0}, planner_s{0}, servo_s{0};
  std::size_t moves{0}, cycles{0}, faults{0};
};

/// jerk 0: limited in acceleration only.
Result run(const bench::Program& program, bool replan, double jerk, std::uint64_t seed) {
  Rig rig({0, 1, 2, 3});
  bench::reference_machine(rig.config);
  for (auto& j : rig.config.joint) j.max_jerk = jerk;
  rig.config.max_feed_override = 2;
  rig.apply_config();
  rig.ready();
  Result out;
  std::mt19937_64 random(seed);
  std::size_t next = 0;
  double p1[4]{}, p2[4]{}, p3[4]{};
  const auto limit = [&](std::size_t j) -> const motion::JointConfig& {
    return rig.config.joint[j];
  };
  motion::Pose before = rig.status().pos_cmd;
  const double start = static_cast<double>(rig.now_ns);
  while (true) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    if (replan && random() % 200 == 0)
      rig.intent.feed_override = 0.05 + static_cast<double>(random() % 1000) / 512.0;
    const double t0 = seconds_now();
    while (rig.planner.run(*rig.path, rig.controller->view(), 1, rig.now_ns) ==
           motion::Planner::Waits::turn) {
    }
    const double t1 = seconds_now();
    rig.cycle();
    out.planner_s += t1 - t0;
    out.servo_s += seconds_now() - t1;
    const auto& s = rig.status();
    for (std::size_t j = 0; j < 4; ++j) {
      const double p = s.joint[j].pos_cmd;
      if (out.cycles > 1) {
        out.vel = std::max(out.vel, std::abs(p - p1[j]) / Rig::kPeriod / limit(j).max_vel);
        out.acc = std::max(out.acc, std::abs(p - 2 * p1[j] + p2[j]) /
                                        (Rig::kPeriod * Rig::kPeriod) / limit(j).max_acc);
      }
      if (out.cycles > 2 && jerk > 0)
        out.jerk = std::max(out.jerk, std::abs(p - 3 * p1[j] + 3 * p2[j] - p3[j]) /
                                          (Rig::kPeriod * Rig::kPeriod * Rig::kPeriod) / jerk);
      p3[j] = p2[j];
      p2[j] = p1[j];
      p1[j] = p;
    }
    out.length +=
        std::hypot(s.pos_cmd.x - before.x, s.pos_cmd.y - before.y, s.pos_cmd.z - before.z);
    before = s.pos_cmd;
    ++out.cycles;
    if (next == program.items.size() && s.executed_seq == rig.seq && s.path_empty) break;
    if (out.cycles > 3'000'000 || !rig.faults.empty()) break;
  }
  out.seconds = (static_cast<double>(rig.now_ns) - start) * 1e-9;
  out.moves = program.items.size() - 1;
  out.faults = rig.faults.size();
  return out;
}

void print(const bench::Program& program, const Result& r, double other_s) {
  std::printf("%-26s %6zu %9.3f %7.1f %8.5f %8.5f %8.5f", program.name.c_str(), r.moves, r.seconds,
              r.length / r.seconds, r.vel, r.acc, r.jerk);
  if (other_s > 0)
    std::printf(" %7.3f", r.seconds / other_s);
  else
    std::printf(" %7s", "");
  std::printf(" %8.2f %8.2f%s\n", r.planner_s * 1e6 / static_cast<double>(r.moves),
              r.servo_s * 1e6 / static_cast<double>(r.cycles), r.faults > 0 ? "  FAULT" : "");
}

int main_of(int argc, char** argv) {
  std::uint64_t seed = 1;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else {
      std::puts(
          "Usage: planner_bench [--seed N] [--quick]\n"
          "Times of generated programs, the share of the joint limits they use, and what planning "
          "costs.");
      return std::strcmp(argv[i], "--help") == 0 ? 0 : 2;
    }
  }
  std::vector<bench::Program> programs;
  programs.push_back(bench::freeform(quick ? 2000 : 20000, 0.01, 100, seed));
  for (const double p : {0.01, 0.1, 1.0}) programs.push_back(bench::arc_spiral(p, 80));
  for (const double p : {0.01, 0.1}) programs.push_back(bench::helical_arcs(p, 80));
  for (const double p : {0.05, 0.0}) programs.push_back(bench::zigzag(p, 100));
  programs.push_back(bench::fractal(quick ? 4 : 6, 0.5, 0.05, 100));
  programs.push_back(bench::four_axis(quick ? 100 : 1000, 0.02, 100, false, seed));
  programs.push_back(bench::four_axis(quick ? 100 : 1000, 0.02, 100, true, seed));
  for (std::uint64_t i = 0; i < (quick ? 2 : 12); ++i)
    programs.push_back(bench::mixture(400, seed + i));
  int bad = 0;
  std::vector<double> seconds(programs.size());
  for (const double jerk : {0.0, kJerk}) {
    for (const bool replan : {false, true}) {
      std::printf("\n%s, %s\n%-26s %6s %9s %7s %8s %8s %8s %7s %8s %8s\n",
                  jerk > 0 ? "limited in jerk" : "limited in acceleration",
                  replan ? "feed override 5..200 %, changed at random" : "feed override 100 %",
                  "program", "moves", "time s", "mm/s", "v share", "a share", "j share", "ratio",
                  "us/move", "us/cycle");
      for (std::size_t i = 0; i < programs.size(); ++i) {
        const Result r = run(programs[i], replan, jerk, seed);
        if (jerk <= 0 && !replan) seconds[i] = r.seconds;
        print(programs[i], r, jerk > 0 && !replan ? seconds[i] : 0);
        std::fflush(stdout);
        if (r.faults > 0 || r.vel > 1.0001 || r.acc > 1.001 || r.jerk > 1.01) ++bad;
      }
    }
  }
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) { return kerf::main_of(argc, argv); }
