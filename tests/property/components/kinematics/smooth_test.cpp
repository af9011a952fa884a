// Random programs on each of the machines: corners are passed smoothly, and every joint keeps its limits in every cycle.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "machines.hpp"
#include "property/motion/random_program.hpp"

namespace kerf::motion::test {
namespace {

/// What all programs came to.
struct Sum {
  double vel{0}, acc{0}, off{0}, seconds{0}, stopping{0};
  int machines{0}, programs{0}, moves{0};
} sum;

class SmoothCorners : public testing::TestWithParam<Machine> {
 public:
  static void TearDownTestSuite() {
    std::printf(
        "result: %d programs of %d moves on %d machines that mix axes: joint velocity at most %.5f "
        "and "
        "acceleration %.5f of the limits, %.0f %% of the time that stops at the corners take\n",
        sum.programs, sum.moves, sum.machines, sum.vel, sum.acc, 100 * sum.seconds / sum.stopping);
  }
};

bool mixes(const Kinematics& k) {
  for (std::int32_t j = 0; j < k.joints(); ++j)
    if (k.axis_of_joint(j) < 0) return true;
  return false;
}

struct Start {
  JointVector joint{};
  Pose pose;
};

void set_up(Rig& rig, const Machine& m, const Start& start, Random& r) {
  const double vel = m.size_mm * r.log(0.05, 0.5), acc = vel * r.log(2, 30);
  for (std::size_t j = 0; j < rig.controller->joints(); ++j) {
    JointConfig& c = rig.config.joint[j];
    c.max_vel = vel * r.log(0.5, 2);
    c.max_acc = acc * r.log(0.5, 2);
    c.min_limit = -1e6;
    c.max_limit = 1e6;
    c.ferror = c.min_ferror = 1e9;
    c.home = c.home_offset = c.start = start.joint[j];
    c.has_start = true;
  }
  for (AxisConfig& a : rig.config.axis) {
    a.min_limit = -1e6;
    a.max_limit = 1e6;
    a.max_vel = 2 * vel;
    a.max_acc = 2 * acc;
  }
  rig.config.max_feed_override = 1.5;
  rig.apply_config();
  for (std::size_t j = 0; j < rig.controller->joints(); ++j)
    rig.in.joint[j].motor_pos_fb = start.joint[j];
  rig.ready();
}

struct Program {
  std::vector<PathItems::Variant> move;
  std::vector<Pose> start;
};

/// Around the start, so that the machine reaches it. Lines, arcs, streams of short lines.
Program program_of(const Machine& m, const Kinematics& k, const Pose& from, Random& r) {
  const double size = m.size_mm * 0.02, speed = m.size_mm * r.log(0.02, 2);
  Program out;
  Pose at = from;
  const bool short_lines = r.chance(0.3);
  for (int n = r.integer(4, 14); n > 0; --n) {
    Pose end = from;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if ((k.axis_mask() >> i & 1U) == 0 || (i > 2 && r.chance(0.6))) {
        end[i] = at[i];
        continue;
      }
      const double most = rtapi::is_rotary(i) ? 4.0 : size;
      end[i] = (short_lines ? at[i] : from[i]) + r.uniform(-most, most) * (short_lines ? 0.1 : 1);
    }
    // The same way back: all rates pass through zero at once. Or one axis alone.
    if (!out.start.empty() && r.chance(0.2)) {
      end = out.start.back();
    } else if (r.chance(0.2)) {
      const double z = end.z;
      end = at;
      end.z = z;
    }
    out.start.push_back(at);
    if (!short_lines && r.chance(0.25)) {
      ArcMove arc;
      const double radius = size * r.log(0.1, 0.5), angle = r.uniform(0.5, 6);
      arc.normal[0] = arc.normal[1] = 0;
      arc.normal[2] = 1;
      arc.centre[0] = at.x - radius;
      arc.centre[1] = at.y;
      arc.centre[2] = at.z;
      arc.turns = 1;
      end = at;
      end.x = arc.centre[0] + radius * std::cos(angle);
      end.y = arc.centre[1] + radius * std::sin(angle);
      arc.end = end;
      arc.vel_mm_s = speed;
      out.move.push_back(arc);
    } else {
      LinearMove line;
      line.end = end;
      line.kind = r.chance(0.2) ? MotionKind::traverse : MotionKind::feed;
      line.vel_mm_s = line.kind == MotionKind::traverse ? 0 : speed;
      out.move.push_back(line);
    }
    at = end;
  }
  return out;
}

/// Seconds it took; below 0: the machine does not reach all of it.
double drive(const Machine& m, const Kinematics& k, const Start& start, unsigned seed, bool blends,
             Oracle& oracle, double& off, int& moves) {
  Random r(seed);
  Rig rig{RigKinematics(k)};
  set_up(rig, m, start, r);
  EXPECT_EQ(rig.status().mode, MotionMode::coordinated);
  const Program program = program_of(m, k, rig.status().pos_cmd, r);
  moves = static_cast<int>(program.move.size());
  PathControl control;
  control.mode = blends ? PathControl::Mode::continuous : PathControl::Mode::exact_stop;
  control.tolerance_mm = m.size_mm * r.log(1e-4, 3e-3);
  EXPECT_TRUE(rig.push(control));
  const std::uint64_t first = rig.seq + 1;
  for (const auto& move : program.move) EXPECT_TRUE(rig.push(move));
  const bool meddle = blends && r.chance(0.4);
  oracle.watch(rig);
  for (int cycle = 0; cycle < 60'000; ++cycle) {
    if (meddle && r.chance(0.01)) rig.intent.feed_override = r.uniform(0.2, 1.5);
    if (meddle && r.chance(0.005)) rig.orders.hold = !rig.orders.hold;
    if (cycle == 5000) {
      rig.orders.hold = false;
      rig.intent.feed_override = 1;
    }
    if (cycle > 5000) rig.orders.hold = false;
    rig.cycle();
    oracle.watch(rig);
    const MotionStatus& s = rig.status();
    for (const FaultRecord& f : rig.faults)
      if (f.fault == Fault::no_inverse) return -1;
    EXPECT_TRUE(rig.faults.empty())
        << static_cast<int>(rig.faults[0].fault) << " joint " << rig.faults[0].index << ": "
        << rig.faults[0].value << " of " << rig.faults[0].limit;
    if (!rig.faults.empty()) return 1;
    if (rig.controller->executor().move() != nullptr && cycle % 40 == 0) {
      double best = 1e9;
      const std::size_t at = s.current_seq - first;
      for (std::size_t i = at < 3 ? 0 : at - 3; i < program.move.size() && i <= at + 3; ++i)
        best = std::min(best, distance(program.move[i], program.start[i], s.pos_cmd));
      off = std::max(off, best / control.tolerance_mm);
    }
    if (s.executed_seq == rig.seq && s.path_empty) return meddle ? 0 : cycle * Rig::kPeriod;
  }
  const MotionStatus& s = rig.status();
  ADD_FAILURE() << "the end was not reached: item " << s.executed_seq << " of " << rig.seq
                << ", speed " << s.vel_mm_s << ", waits " << static_cast<int>(s.waiting_for)
                << ", to go " << s.distance_to_go << ", spans " << rig.spans->size();
  return 1;
}

TEST_P(SmoothCorners, KeepTheLimitsOfEveryJoint) {
  const Machine& m = GetParam();
  const Loaded kinematics(m);
  if (!mixes(*kinematics)) GTEST_SKIP() << "each joint is an axis";
  ++sum.machines;
  std::mt19937_64 random(seed);
  const int count = property_count(4);
  int driven = 0;
  for (int n = 0; n < 4 * count && driven < count && !HasFailure(); ++n) {
    SCOPED_TRACE("program " + std::to_string(n));
    Start start;
    ASSERT_TRUE(random_pose(m, *kinematics, random, start.joint, start.pose));
    JointVector again = start.joint;
    Pose pose = start.pose;
    // The solution in which the machine stands.
    ASSERT_TRUE(kinematics->forward(start.joint, pose));
    ASSERT_TRUE(kinematics->inverse(pose, again));
    Oracle blended, stopped;
    double off = 0, none = 0;
    int moves = 0;
    const unsigned number = seed + static_cast<unsigned>(n);
    const double seconds = drive(m, *kinematics, start, number, true, blended, off, moves);
    if (seconds < 0) continue;
    ++driven;
    EXPECT_LE(blended.vel, 1.0001);
    EXPECT_LE(blended.acc, 1.001);
    EXPECT_LE(off, 1 + 1e-6);
    sum.vel = std::max(sum.vel, blended.vel);
    sum.acc = std::max(sum.acc, blended.acc);
    sum.moves += moves;
    ++sum.programs;
    if (seconds == 0) continue;
    const double with_stops = drive(m, *kinematics, start, number, false, stopped, none, moves);
    EXPECT_LE(stopped.acc, 1.001);
    EXPECT_LT(seconds, with_stops * 1.02 + 0.05);
    sum.seconds += seconds;
    sum.stopping += with_stops;
  }
  EXPECT_GE(driven, count / 2);
}

std::string name_of(const testing::TestParamInfo<Machine>& info) {
  std::string name = "k_" + info.param.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, SmoothCorners, testing::ValuesIn(machines()), name_of);

}  // namespace
}  // namespace kerf::motion::test
