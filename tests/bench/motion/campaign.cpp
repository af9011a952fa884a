#include "bench/motion/campaign.hpp"

#include <cstdio>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

#include "bench/motion/machines.hpp"
#include "property/motion/random_program.hpp"

namespace kerf::bench {
namespace {

using motion::test::Rig;

/// A program that takes longer has come to a halt somewhere.
constexpr std::uint64_t kMostCycles = 400'000;

Program random_program(std::uint64_t seed) {
  switch (seed % 8) {
    case 0:
      // Half of them longer than what the planner looks at together.
      switch (seed / 8 % 5) {
        case 0: return freeform(600, 0.01, 100, seed);
        case 1: return dense_lines(60, 0.02, 0.01, 100, seed % 64 < 32, seed % 128 < 64);
        case 2: return relief(2000, seed % 64 < 32 ? 0.01 : 0.05, 100, false, seed, 0.6);
        case 3: return wander(3000, seed);
        default: return freeform(600, 0.05, 180, seed, false);
      }
    case 1:
      return seed % 16 < 8 ? arc_spiral(0.1, 80)
                           : tangent_moves(60, seed % 32 < 16, seed % 64 < 32, seed);
    case 2: {
      // Half of them wind within the tolerance.
      constexpr double kP[] = {0.15, 0.25, 0.5, 1};
      return fractal(4, 0.5, seed % 16 < 8 ? 0.05 : kP[seed / 16 % 4], 100);
    }
    case 3: return four_axis(60, 0.02, 100, seed % 16 < 8, seed);
    case 4: return helical_arcs(0.01, 80);
    case 5:
      return seed % 16 < 8 ? contour(60, seed % 32 < 16 ? 0.05 : 0.5, 150, seed)
                           : zigzag(seed % 32 < 16 ? 0.05 : 0.0, 150);
    case 6: return swarf(300, seed % 16 < 8 ? 0.02 : 0.1, seed % 32 < 16 ? 50 : 150, seed);
    default: return mixture(100, seed);
  }
}

/// In a third of the programs P changes, here and there or all the time; also to an exact path and back.
Program with_changes_of_p(Program program, std::uint64_t seed) {
  if (seed / 8 % 3 != 0) return program;
  std::mt19937_64 random(seed);
  const std::uint64_t each = random() % 2 == 0 ? 200 : 6;
  std::vector<motion::PathItems::Variant> items;
  for (const auto& item : program.items) {
    if (random() % each == 0 && !items.empty()) {
      constexpr double kShare[] = {1, 0.3, 0.1, 3, 10};
      motion::PathControl control = std::get<motion::PathControl>(program.items.front());
      control.tolerance_mm *= kShare[random() % std::size(kShare)];
      control.naive_cam_tolerance_mm = random() % 2 == 0 ? control.tolerance_mm : 0;
      if (random() % 8 == 0) control.mode = motion::PathControl::Mode::exact_path;
      items.emplace_back(control);
    }
    items.push_back(item);
  }
  program.items = std::move(items);
  return program;
}

double jerk_of(std::uint64_t seed) {
  constexpr double kJerks[] = {0, 50000, 0, 5000, 0, 1e6};
  return kJerks[(seed / 8) % 6];
}

/// Half of those that are limited in jerk are so along the path too.
double path_jerk_of(std::uint64_t seed) { return (seed / 48) % 2 == 0 ? 0 : jerk_of(seed); }

void run_one(std::uint64_t seed, CampaignResult& total) {
  const Program program = with_changes_of_p(random_program(seed), seed);
  Rig rig(moved_by(program.machine));
  set_limits(rig.config, program.machine, jerk_of(seed), path_jerk_of(seed));
  rig.apply_config();
  rig.ready();
  motion::test::Oracle oracle;
  std::mt19937_64 random(seed);
  std::size_t next = 0;
  bool aborting = false;
  std::uint64_t cycle = 0;
  for (; cycle < kMostCycles && rig.faults.empty(); ++cycle) {
    while (!aborting && next < program.items.size() && rig.push(program.items[next])) ++next;
    if (random() % 150 == 0) {
      rig.intent.feed_override = 0.03 + static_cast<double>(random() % 1000) / 512.0;
      ++total.overrides;
    }
    if (random() % 200 == 0)
      rig.intent.rapid_override = 0.05 + static_cast<double>(random() % 900) / 1000.0;
    if (random() % (rig.orders.hold ? 60 : 700) == 0) {
      rig.orders.hold = !rig.orders.hold;
      if (rig.orders.hold) ++total.holds;
    }
    if (!aborting && random() % 4000 == 0) {
      rig.abort();
      aborting = true;
      ++total.aborts;
    }
    rig.cycle();
    oracle.watch(rig);
    // After an abort the rest of the program starts from where the machine stands.
    if (aborting && rig.status().vel_mm_s == 0 && rig.path->empty() && rig.status().path_empty &&
        random() % 20 == 0)
      aborting = false;
    if (!aborting && next == program.items.size() && rig.status().path_empty && rig.path->empty())
      break;
  }
  const bool bad = !rig.faults.empty() || cycle >= kMostCycles || oracle.vel > 1.0001 ||
                   oracle.acc > 1.001 || oracle.jerk > 1.01;
  if (bad && total.exceptions++ == 0) total.bad_seed = seed;
  total.cycles += cycle;
  ++total.programs;
  total.vel = std::max(total.vel, oracle.vel);
  total.acc = std::max(total.acc, oracle.acc);
  total.jerk = std::max(total.jerk, oracle.jerk);
}

}  // namespace

CampaignResult campaign(std::uint64_t cycles, std::uint64_t seed) {
  CampaignResult total;
  for (std::uint64_t n = seed; total.cycles < cycles; ++n) run_one(n, total);
  return total;
}

void print(const CampaignResult& r) {
  std::printf(
      "%llu cycles, %llu programs, %llu overrides, %llu holds, %llu aborts\n"
      "largest shares of a joint limit: velocity %.6f acceleration %.6f jerk %.6f\n"
      "exceptions: %llu",
      static_cast<unsigned long long>(r.cycles), static_cast<unsigned long long>(r.programs),
      static_cast<unsigned long long>(r.overrides), static_cast<unsigned long long>(r.holds),
      static_cast<unsigned long long>(r.aborts), r.vel, r.acc, r.jerk,
      static_cast<unsigned long long>(r.exceptions));
  if (r.exceptions > 0)
    std::printf(" (first: --seed %llu --count 1)", static_cast<unsigned long long>(r.bad_seed));
  std::printf("\n");
}

}  // namespace kerf::bench
