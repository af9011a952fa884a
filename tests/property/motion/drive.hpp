// Drive: a program on the reference machine, a cycle at a time, with every cycle looked at.
#pragma once

#include <cstddef>

#include "bench/motion/machines.hpp"
#include "property/motion/random_program.hpp"

namespace kerf::motion::test {

struct Drive {
  explicit Drive(const bench::Program& moves, double jerk, bool laws = true)
      : Drive(moves, jerk, laws, bench::moved_by(moves.machine)) {}
  Drive(const bench::Program& moves, double jerk, bool laws, const RigKinematics& moved_by)
      : program(moves), rig(moved_by) {
    bench::set_limits(rig.config, moves.machine, jerk);
    rig.config.time_laws = laws;
    rig.apply_config();
    rig.ready();
  }
  void cycle() {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    rig.cycle();
    oracle.watch(rig);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) cycle();
  }
  [[nodiscard]] bool done() const {
    return next == program.items.size() && rig.status().executed_seq == rig.seq &&
           rig.status().path_empty;
  }
  [[nodiscard]] double speed() const { return rig.status().vel_mm_s; }

  const bench::Program& program;
  Rig rig;
  Oracle oracle;
  std::size_t next{0};
};

}  // namespace kerf::motion::test
