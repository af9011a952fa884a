// G64 P and Q, G61, G61.1 and [TRAJ]ROTARY_TOLERANCE: how far the travelled path is from the programmed one, whatever the program.
#include <gtest/gtest.h>

#include "property/motion/random_program.hpp"

namespace kerf::motion {
namespace {

using test::Random;
using test::Rig;

struct Allowed {
  double mm{0}, deg{0};
  /// Of a distance: at most 1 is allowed.
  [[nodiscard]] double share(const Pose& d) const {
    constexpr double kRounding = 1e-6;
    return std::max({std::hypot(d.x, d.y, d.z) / (mm + kRounding),
                     std::hypot(d.u, d.v, d.w) / (mm + kRounding),
                     std::max({std::abs(d.a), std::abs(d.b), std::abs(d.c)}) / (deg + kRounding)});
  }
};

struct Programmed {
  PathItems::Variant move;
  Pose start, end;
  /// Where G64 P changes the corner keeps the smaller one. An exact path ends exactly, and may begin with the corner of a G64 before it.
  Allowed ends{}, anywhere{};
  std::uint64_t seq{0};
};

Pose place(const Programmed& p, double share) {
  if (std::holds_alternative<LinearMove>(p.move)) return p.start + (p.end - p.start) * share;
  return test::arc_point_at(std::get<ArcMove>(p.move), p.start, share);
}

/// Least share over the points of `at(0..1)`, at least as far as 1; looks into every valley between `steps` places, since turns of an arc
/// lie beside each other.
template <class F>
double nearest(const Allowed& allowed, const Pose& p, int steps, F&& at) {
  const auto share = [&](double s) { return allowed.share(p - at(s)); };
  double before = 1e99, here = share(0), least = here;
  for (int i = 0; i <= steps && least > 1; ++i) {
    const double next = i < steps ? share((i + 1.0) / steps) : 1e99;
    least = std::min(least, next);
    if (here <= before && here <= next) {
      double low = std::max(0.0, (i - 1.0) / steps), high = std::min(1.0, (i + 1.0) / steps);
      for (int k = 0; k < 60 && least > 1; ++k) {
        const double l = low + (high - low) / 3, h = high - (high - low) / 3;
        const double sl = share(l), sh = share(h);
        least = std::min({least, sl, sh});
        (sl > sh ? low : high) = sl > sh ? l : h;
      }
    }
    before = here;
    here = next;
  }
  return least;
}

double off(const Programmed& move, const Pose& p) {
  const bool line = std::holds_alternative<LinearMove>(move.move);
  return nearest(move.anywhere, p, line ? 1 : 300, [&](double s) { return place(move, s); });
}

struct Words {
  PathControl control;
  Allowed allowed;
};

Words random_words(const Rig& rig, Random& r) {
  Words w;
  const double kind = r.uniform(0, 1);
  if (kind < 0.15) {
    w.control.mode = PathControl::Mode::exact_path;
  } else if (kind < 0.25) {
    w.control.mode = PathControl::Mode::exact_stop;
  } else {
    const bool bare = r.chance(0.1);
    w.control.tolerance_mm = bare ? 0 : r.log(0.001, 0.3);
    w.control.naive_cam_tolerance_mm = r.chance(0.3) ? 0 : r.log(0.002, 0.5);
    // Without P: what docs/planner.md says.
    w.allowed.mm = bare ? 0.1 : w.control.tolerance_mm;
    w.allowed.deg =
        rig.config.rotary_tolerance_deg > 0 ? rig.config.rotary_tolerance_deg : w.allowed.mm;
  }
  return w;
}

/// Writes lines and arcs in XY, each in the direction in which the one before ended unless it is turned.
struct Pen {
  Pose& at;
  std::vector<Programmed>& out;
  double heading, speed;

  void line(double length) {
    LinearMove m;
    m.end = at;
    m.end.x += length * std::cos(heading);
    m.end.y += length * std::sin(heading);
    add(m);
  }
  /// To the left where `turn` is above 0.
  void arc(double radius, double turn, double rise = 0) {
    ArcMove m;
    const double side = turn > 0 ? 1 : -1;
    m.centre[0] = at.x - side * radius * std::sin(heading);
    m.centre[1] = at.y + side * radius * std::cos(heading);
    m.centre[2] = at.z;
    m.normal[2] = side;
    heading += turn;
    m.end = at;
    m.end.x = m.centre[0] + side * radius * std::sin(heading);
    m.end.y = m.centre[1] - side * radius * std::cos(heading);
    m.end.z += rise;
    add(m);
  }

  template <class Move>
  void add(Move m) {
    m.vel_mm_s = speed;
    out.push_back({m, at, m.end});
    at = m.end;
  }
};

/// Lines with fillets and chamfers between them that may be small against P, as contours have.
void random_contour(Random& r, Pose& at, std::vector<Programmed>& out) {
  const double heading = r.uniform(0, 6), size = r.log(0.02, 1), speed = r.log(10, 150);
  Pen pen{at, out, heading, speed};
  const int corners = r.integer(2, 12);
  for (int i = 0; i < corners; ++i) {
    pen.line(r.log(0.3, 8));
    const double turn = r.uniform(0.2, 2.6) * (r.chance(0.5) ? 1 : -1);
    if (r.chance(0.5)) {
      pen.heading += turn / 2;
      pen.line(size * r.uniform(0.5, 1.5));
      pen.heading += turn / 2;
      continue;
    }
    pen.heading += r.chance(0.3) ? r.uniform(-0.05, 0.05) : 0;
    const double radius = size * r.uniform(0.5, 1.5);
    pen.arc(radius, turn, r.chance(0.2) ? r.uniform(-0.5, 0.5) * size : 0);
  }
}

/// Arcs with tiny lines between them that meet nearly in one direction, as CAM fits them to a curve.
void random_fit(Random& r, Pose& at, std::vector<Programmed>& out) {
  const double heading = r.uniform(0, 6), speed = r.log(10, 150);
  Pen pen{at, out, heading, speed};
  const int arcs = r.integer(3, 20);
  for (int i = 0; i < arcs; ++i) {
    const double radius = r.uniform(2, 12), turn = r.uniform(0.05, 0.6);
    pen.arc(radius, r.chance(0.5) ? turn : -turn);
    pen.heading += r.uniform(-0.02, 0.02);
    pen.line(r.log(0.005, 0.5));
    pen.heading += r.uniform(-0.02, 0.02);
  }
}

/// A stream of short lines along a curve with the rounding noise of CAM output, or a move of any kind.
void random_part(const Rig& rig, Random& r, Pose& at, std::vector<Programmed>& out) {
  if (r.chance(0.4)) {
    Pose end;
    const auto move = test::random_move(rig, at, r, end);
    out.push_back({move, at, end});
    at = end;
    return;
  }
  if (r.chance(0.4)) return random_contour(r, at, out);
  if (r.chance(0.3)) return random_fit(r, at, out);
  const bool rotary = r.chance(0.3),
             each = r.chance(0.2);  // each: G93, every block has its own speed
  const double step = r.log(0.05, 1), bend = r.uniform(-0.3, 0.3),
               noise = r.chance(0.5) ? 0.0005 : 0;
  double heading = r.uniform(0, 6), speed = r.log(10, 150);
  const std::uint32_t mask = rig.kinematics.axis_mask();
  const int lines = r.integer(3, 40);
  for (int i = 0; i < lines; ++i) {
    Pose end = at;
    heading += bend * step;
    end.x += step * std::cos(heading) + r.uniform(-noise, noise);
    end.y += step * std::sin(heading) + r.uniform(-noise, noise);
    end.z += 0.1 * step;
    for (std::size_t k = 3; k < rtapi::kAxes; ++k)
      if ((mask >> k & 1U) != 0 && (rotary || k > 5))
        end[k] += step * std::sin(heading + static_cast<double>(k));
    LinearMove m;
    m.end = end;
    m.vel_mm_s = each ? r.log(10, 150) : speed;
    out.push_back({m, at, end});
    at = end;
  }
}

/// Pushes parts under one path control, or each under one of its own.
std::vector<Programmed> random_program(Rig& rig, Random& r, bool changing) {
  std::vector<Programmed> out;
  Pose at = rig.status().pos_cmd;
  Words words = random_words(rig, r);
  rig.push(words.control);
  const int parts = r.integer(2, 6);
  for (int i = 0; i < parts; ++i) {
    std::vector<Programmed> part;
    random_part(rig, r, at, part);
    for (Programmed& p : part) {
      // Also in the middle of a row of lines.
      if (changing && r.chance(&p == part.data() ? 0.7 : 0.05)) {
        words = random_words(rig, r);
        rig.push(words.control);
      }
      rig.push(p.move);
      const Allowed before = out.empty() ? words.allowed : out.back().ends;
      // A move without a length has no corner of its own.
      const bool moves = std::holds_alternative<ArcMove>(p.move) || !(p.end == p.start);
      p.ends = moves ? words.allowed : before;
      p.anywhere = p.ends.mm > 0 ? p.ends : before;
      p.seq = rig.seq;
      out.push_back(p);
    }
  }
  return out;
}

std::size_t index_of(const std::vector<Programmed>& program, std::uint64_t seq) {
  const auto after =
      std::upper_bound(program.begin(), program.end(), seq,
                       [](std::uint64_t s, const Programmed& p) { return s < p.seq; });
  return after == program.begin() ? 0 : static_cast<std::size_t>(after - program.begin()) - 1;
}

void run_program(unsigned seed, bool core_xy, bool changing = false) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random r(seed);
  test::RigKinematics moved_by(test::random_axes(r));
  moved_by.core_xy = core_xy;
  Rig rig(moved_by);
  test::random_limits(rig, r, r.chance(0.4));
  if (r.chance(0.5)) rig.config.rotary_tolerance_deg = r.log(0.01, 2);
  rig.apply_config();
  rig.ready();
  if (r.chance(0.2)) {  // G95
    rig.in.spindle[0].speed_in_rps = 12;
    rig.push(FeedPerRev{.spindle = 0, .rps = 10});
  }
  const std::vector<Programmed> program = random_program(rig, r, changing);
  const Pose at = program.back().end;
  test::Oracle oracle;
  std::vector<Pose> travelled{rig.status().pos_cmd};
  double worst = 0;
  for (int cycle = 0; cycle < 400000; ++cycle) {
    rig.cycle();
    oracle.watch(rig);
    const MotionStatus& s = rig.status();
    if (!(s.pos_cmd == travelled.back())) {
      travelled.push_back(s.pos_cmd);
      const std::size_t here = index_of(program, s.current_seq);
      // Nothing is merged or smoothed farther than this many lines.
      constexpr std::size_t kNear = 100;
      double best = 1e9;
      for (std::size_t k = 0; k <= kNear && best > 1; ++k) {
        if (here + k < program.size()) best = std::min(best, off(program[here + k], s.pos_cmd));
        if (best > 1 && k <= here && here - k < program.size())
          best = std::min(best, off(program[here - k], s.pos_cmd));
      }
      worst = std::max(worst, best);
    }
    if (s.executed_seq == rig.seq && s.path_empty) break;
  }
  EXPECT_EQ(rig.status().executed_seq, rig.seq) << "the end was not reached";
  EXPECT_EQ(rig.status().pos_cmd, at);
  EXPECT_LE(worst, 1.0) << "P of the first move " << program[0].ends.mm << " rotary "
                        << program[0].ends.deg;
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
  EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults[0].fault);
  // And the other way round. Between two cycles the path bends by no more than a dt^2 / 8.
  double acc = 0;
  for (const auto& j : rig.config.joint) acc = std::max(acc, j.max_acc);
  const double bend = 3 * acc * Rig::kPeriod * Rig::kPeriod / 8;
  std::size_t from = 0;
  for (const Programmed& p : program) {
    const Allowed there{p.ends.mm + bend, p.ends.deg + bend};
    double best = 1e9;
    for (std::size_t k = from; k + 1 < travelled.size() && best > 1; ++k) {
      const Pose &a = travelled[k], way = travelled[k + 1] - a;
      best = nearest(there, p.end, 1, [&](double s) { return a + way * s; });
      if (best <= 1) from = k;
    }
    EXPECT_LE(best, 1.0) << "programmed point is too far from the path";
    if (best > 1) break;
  }
}

TEST(ToleranceProperty, ThePathAndItsPointsAreWithinP) {
  const int count = test::property_count(25);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), false);
    if (testing::Test::HasFailure()) break;
  }
}

TEST(ToleranceProperty, AlsoWhereKinematicsMixAxes) {
  const int count = test::property_count(25);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), true);
    if (testing::Test::HasFailure()) break;
  }
}

TEST(ToleranceProperty, AlsoWherePChangesWithinTheProgram) {
  const int count = test::property_count(40);
  for (int i = 1; i <= count; ++i) {
    run_program(static_cast<unsigned>(i), i % 4 == 0, true);
    if (testing::Test::HasFailure()) break;
  }
}

/// Once called out of tolerance where they were not: beside another turn of a helix, and next to the middle of a small arc.
TEST(ToleranceProperty, SeedsThatFailedOnce) {
  run_program(696, false);
  run_program(357, true);
}

/// Ends of the first short lines under a smaller P were off by the P before it.
TEST(ToleranceProperty, SeedsInWhichPChangesThatFailedOnce) {
  run_program(3388, true, true);
  run_program(3698, false, true);
  run_program(5022, false, true);
}

}  // namespace
}  // namespace kerf::motion
