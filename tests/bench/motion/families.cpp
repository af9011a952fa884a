#include "bench/motion/families.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace kerf::bench {
namespace {

using motion::Pose;
constexpr double kPi = std::numbers::pi;

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

Pose xyz(double x, double y, double z, double a = 0) { return {.x = x, .y = y, .z = z, .a = a}; }

std::string titled(const char* name, double p) {
  char text[80];
  std::snprintf(text, sizeof text, "%s, P%g", name, p);
  return text;
}

/// The same numbers with every standard library (std::uniform_real_distribution is not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

ProgramWriter::ProgramWriter(std::string name, double p_mm, double feed, bool merges)
    : feed_(feed) {
  program_.name = std::move(name);
  program_.p_mm = p_mm;
  program_.merges = merges;
  motion::PathControl control;
  control.tolerance_mm = p_mm;
  control.naive_cam_tolerance_mm = merges ? p_mm : 0;
  if (p_mm <= 0) control.mode = motion::PathControl::Mode::exact_stop;
  program_.items.push_back(control);
}

void ProgramWriter::line(const Pose& to) {
  motion::LinearMove m;
  m.end = at_ = to;
  m.vel_mm_s = feed_;
  program_.items.push_back(m);
}

void ProgramWriter::rapid(const Pose& to) {
  motion::LinearMove m;
  m.end = at_ = to;
  m.kind = motion::MotionKind::traverse;
  program_.items.push_back(m);
}

void ProgramWriter::arc(double cx, double cy, double sweep, double dz, double da) {
  motion::ArcMove m;
  const double rx = at_.x - cx, ry = at_.y - cy;
  m.centre[0] = cx;
  m.centre[1] = cy;
  m.centre[2] = at_.z;
  m.normal[2] = sweep < 0 ? -1 : 1;
  m.vel_mm_s = feed_;
  at_.x = cx + rx * std::cos(sweep) - ry * std::sin(sweep);
  at_.y = cy + rx * std::sin(sweep) + ry * std::cos(sweep);
  at_.z += dz;
  at_.a += da;
  m.end = at_;
  program_.items.push_back(m);
}

void ProgramWriter::thread(const Pose& to, double pitch) {
  motion::SyncMove m;
  m.end = at_ = to;
  m.per_rev_mm = pitch;
  program_.items.push_back(m);
}

void ProgramWriter::turn(double rpm) {
  motion::SpindleChange m;
  m.action = motion::SpindleChange::Action::forward;
  m.speed_rpm = rpm;
  program_.items.push_back(m);
}

void reference_machine(motion::MachineConfig& config) {
  for (auto& j : config.joint) {
    j.max_vel = 200;
    j.max_acc = 1750;
    j.min_limit = -1e5;
    j.max_limit = 1e5;
  }
  for (auto& a : config.axis) {
    a.max_vel = 200;
    a.max_acc = 1750;
    a.min_limit = -1e5;
    a.max_limit = 1e5;
  }
  config.joint[2].max_vel = config.axis[2].max_vel = 150;
  config.joint[3].max_vel = config.axis[3].max_vel = 90;
  config.joint[3].max_acc = config.axis[3].max_acc = 1200;
}

Program freeform(int segments, double p_mm, double feed, std::uint64_t seed, bool merges) {
  ProgramWriter w(titled(merges ? "freeform" : "freeform Q0", p_mm), p_mm, feed, merges);
  Random r(seed);
  // A smooth curve (sums of sines of the arc) cut into chords of 0.05 to 0.2 mm and rounded as CAM output is.
  const double f1 = r.between(0.02, 0.04), f2 = r.between(0.07, 0.12), f3 = r.between(0.2, 0.3);
  double heading = 0, x = 0, y = 0, s = 0;
  for (int i = 0; i < segments; ++i) {
    const double step = r.between(0.05, 0.2);
    s += step;
    heading +=
        step * (0.12 * std::sin(f1 * s) + 0.1 * std::sin(f2 * s + 1) + 0.06 * std::sin(f3 * s));
    x += step * std::cos(heading);
    y += step * std::sin(heading);
    const double z = 3 * std::sin(x * 0.15) * std::cos(y * 0.12);
    w.line(xyz(rounded(x), rounded(y), rounded(z)));
  }
  return w.done();
}

Program dense_lines(double length, double step, double p_mm, double feed, bool merges,
                    bool circle) {
  char name[60];
  std::snprintf(name, sizeof name, "%s, lines of %g mm%s", circle ? "R40" : "bends", step,
                merges ? "" : " Q0");
  ProgramWriter w(titled(name, p_mm), p_mm, feed, merges);
  const auto rounded_off = [](double v) { return std::round(v * 1e5) / 1e5; };
  double heading = 0, x = 0, y = 0;
  for (double s = 0; s + step / 2 < length; s += step) {
    // The chord over [s, s + step].
    const double bend = circle ? 1.0 / 40 : 0.08 * std::sin(0.3 * (s + step / 2));
    x += step * std::cos(heading + bend * step / 2);
    y += step * std::sin(heading + bend * step / 2);
    heading += bend * step;
    w.line(xyz(rounded_off(x), rounded_off(y), 0));
  }
  return w.done();
}

/// Slopes of reliefs above this one are steep.
constexpr double kFlat = 0.5;

Program relief(int segments, double p_mm, double feed, bool merges, std::uint64_t seed,
               double detail, double slope) {
  char name[60];
  std::snprintf(name, sizeof name, "relief of %g mm%s%s", detail, slope > kFlat ? " steep" : "",
                merges ? "" : " Q0");
  ProgramWriter w(titled(name, p_mm), p_mm, feed, merges);
  Random r(seed);
  struct Wave {
    double kx, ky, phase, high;
  };
  std::vector<Wave> waves;
  for (const double share : {6.25, 3.5, 2.0, 1.0}) {
    const double k = 2 * kPi / (share * detail), along = r.between(0, kPi);
    waves.push_back({k * std::cos(along), k * std::sin(along), r.between(0, 2 * kPi), slope / k});
  }
  const auto height = [&](double x, double y) {
    double z = 0;
    for (const Wave& v : waves) z += v.high * std::sin(v.kx * x + v.ky * y + v.phase);
    return z;
  };
  const auto thousandths = [](double v) { return std::round(v * 1e3) / 1e3; };
  constexpr double kRow = 60, kStepOver = 0.5;
  double x = 0, y = 0, way = 1;
  w.rapid(xyz(0, 0, thousandths(height(0, 0))));
  for (int i = 0; i < segments; ++i) {
    x += way * r.between(0.05, 0.2);
    if (x > kRow || x < 0) {
      x = std::clamp(x, 0.0, kRow);
      way = -way;
      y += kStepOver;
    }
    w.line(xyz(thousandths(x), thousandths(y), thousandths(height(x, y))));
  }
  return w.done();
}

Program arc_wave(double p_mm, double feed, double kink) {
  ProgramWriter w(titled("wave of R4 arcs", p_mm), p_mm, feed);
  Random r(7);
  double heading = 0;  // of the tangent
  for (int i = 0; i < 150; ++i) {
    // To the left and to the right in turns.
    const double radius = r.between(3.5, 4.5), side = i % 2 != 0 ? -1 : 1,
                 sweep = side * r.between(1.2, 2.2);
    const double to_centre = heading + side * kPi / 2;
    const Pose at = w.at();
    w.arc(at.x + radius * std::cos(to_centre), at.y + radius * std::sin(to_centre), sweep);
    heading += sweep + r.between(-kink, kink);
  }
  return w.done();
}

Program short_arcs(double p_mm, double feed) {
  ProgramWriter w(titled("spiral of short R4 arcs", p_mm), p_mm, feed);
  Random r(11);
  double heading = 0, way = 0;
  for (int i = 0; i < 300; ++i) {
    const double radius = r.between(3.5, 4.5), side = i % 2 != 0 ? -1 : 1;
    // Outwards: the way turns left by less and less.
    const double turn = 0.25 / (1 + 0.004 * way), sweep = side * r.between(0.4, 0.9) + turn;
    const double to_centre = heading + std::copysign(kPi / 2, sweep);
    const Pose at = w.at();
    w.arc(at.x + radius * std::cos(to_centre), at.y + radius * std::sin(to_centre), sweep);
    way += radius * std::abs(sweep);
    heading += sweep + r.between(-0.4, 0.4);
  }
  return w.done();
}

Program arc_spiral(double p_mm, double feed) {
  ProgramWriter w(titled("R4 arcs at angles", p_mm), p_mm, feed);
  Random r(7);
  for (int i = 0; i < 150; ++i) {
    const double radius = r.between(3.5, 4.5), sweep = (i % 2 != 0 ? -1 : 1) * r.between(1.2, 2.2);
    const double heading = i * 0.21;
    const Pose at = w.at();
    w.arc(at.x + radius * std::cos(heading), at.y + radius * std::sin(heading), sweep);
  }
  return w.done();
}

Program helical_arcs(double p_mm, double feed) {
  ProgramWriter w(titled("helical arcs", p_mm), p_mm, feed);
  for (int i = 0; i < 150; ++i) {
    const double radius = 3 + (i % 5) * 0.5;
    const Pose at = w.at();
    w.arc(at.x + radius * std::cos(i * 0.3), at.y + radius * std::sin(i * 0.3), kPi / 2, 0.3);
  }
  return w.done();
}

Program helix(double p_mm, double feed) {
  ProgramWriter w(titled("helix of quarter arcs", p_mm), p_mm, feed);
  Random r(5);
  double heading = 0;
  for (int i = 0; i < 150; ++i) {
    const double radius = i % 2 != 0 ? 4.2 : 3.8, sweep = kPi / 2;
    const Pose at = w.at();
    w.arc(at.x + radius * std::cos(heading + kPi / 2), at.y + radius * std::sin(heading + kPi / 2),
          sweep, 0.3);
    heading += sweep + r.between(-0.15, 0.15);
  }
  return w.done();
}

Program zigzag(double p_mm, double feed, double leg) {
  char name[40];
  std::snprintf(name, sizeof name, "zigzag of %g mm", leg);
  ProgramWriter w(titled(name, p_mm), p_mm, feed);
  for (int i = 1; i <= 100; ++i)
    w.line(xyz(rounded(i * leg * 5 / 13), i % 2 != 0 ? rounded(leg * 12 / 13) : 0, 0));
  return w.done();
}

Program contour(int corners, double p_mm, double feed, std::uint64_t seed) {
  ProgramWriter w(titled("contour", p_mm), p_mm, feed);
  Random r(seed);
  double heading = 0;
  const auto along = [&](double length) {
    const Pose at = w.at();
    w.line(xyz(at.x + length * std::cos(heading), at.y + length * std::sin(heading), at.z));
  };
  for (int i = 0; i < corners; ++i) {
    along(r.between(0.5, 12));
    const double size = std::exp(r.between(std::log(0.02), 0.0)),
                 turn = r.between(0.3, 2.4) * (r.below(3) != 0 ? 1 : -1);
    if (r.below(2) == 0) {
      heading += turn / 2;
      along(size);
      heading += turn / 2;
      continue;
    }
    const Pose at = w.at();
    const double side = heading + std::copysign(kPi / 2, turn);
    w.arc(at.x + size * std::cos(side), at.y + size * std::sin(side), turn);
    heading += turn;
  }
  return w.done();
}

Program corner(double degrees, double leg, double p_mm, double feed) {
  ProgramWriter w("corner " + std::to_string(static_cast<int>(degrees)), p_mm, feed);
  const double turn = degrees * kPi / 180;
  w.line(xyz(leg, 0, 0));
  w.line(xyz(leg + leg * std::cos(turn), leg * std::sin(turn), 0));
  return w.done();
}

Program fractal(int order, double step, double p_mm, double feed) {
  ProgramWriter w(titled("fractal", p_mm), p_mm, feed);
  // Hilbert curve.
  double x = 0, y = 0;
  int heading = 0;
  const auto forward = [&] {
    const int dx[] = {1, 0, -1, 0}, dy[] = {0, 1, 0, -1};
    x += step * dx[heading & 3];
    y += step * dy[heading & 3];
    w.line(xyz(x, y, 0));
  };
  const std::function<void(int, int)> draw = [&](int level, int turn) {
    if (level == 0) return;
    heading += turn;
    draw(level - 1, -turn);
    forward();
    heading -= turn;
    draw(level - 1, turn);
    forward();
    draw(level - 1, turn);
    heading -= turn;
    forward();
    draw(level - 1, -turn);
    heading += turn;
  };
  draw(order, 1);
  return w.done();
}

Program four_axis(int moves, double p_mm, double feed, bool reversing, std::uint64_t seed) {
  ProgramWriter w(titled(reversing ? "XYZA, A reversing" : "XYZA mixed", p_mm), p_mm, feed);
  Random r(seed);
  double a = 0;
  for (int i = 0; i < moves; ++i) {
    const Pose at = w.at();
    a += reversing ? (i % 2 != 0 ? -1 : 1) * r.between(1, 8) : r.between(0, 5);
    switch (reversing ? 0 : r.below(3)) {
      case 0:
        w.line(xyz(at.x + r.between(-4, 6), at.y + r.between(-5, 5), at.z + r.between(-1, 1), a));
        break;
      case 1: w.line(xyz(at.x + r.between(-4, 6), at.y + r.between(-5, 5), at.z, at.a)); break;
      default: w.line(xyz(at.x, at.y, at.z, a)); break;
    }
  }
  return w.done();
}

Program inverse_time(int moves, double p_mm, std::uint64_t seed) {
  ProgramWriter w(titled("XYZA in G93", p_mm), p_mm, 100);
  w.program().inverse_time = true;
  Random r(seed);
  double heading = 0, a = 0;
  for (int i = 0; i < moves; ++i) {
    const double length = std::exp(r.between(std::log(0.3), std::log(6.0)));
    heading += r.between(-0.6, 0.6);
    a += r.between(-1, 2) * length;
    w.feed(r.between(30, 120));
    const Pose at = w.at();
    w.line(xyz(at.x + length * std::cos(heading), at.y + length * std::sin(heading),
               at.z + r.between(-0.1, 0.1) * length, a));
  }
  return w.done();
}

Program threading(int passes, double pitch, double rpm) {
  ProgramWriter w("lathe thread", 0.01, 100);
  w.program().machine = Machine::lathe;
  w.turn(rpm);
  for (int i = 1; i <= passes; ++i) {
    const double depth = 0.9 * std::sqrt(static_cast<double>(i) / passes);
    w.rapid(xyz(-depth, 0, 0));
    w.thread(xyz(-depth, 0, -20), pitch);
    w.rapid(xyz(2, 0, -20));
    w.rapid(xyz(2, 0, 0));
  }
  return w.done();
}

Program swarf(int moves, double p_mm, double feed, std::uint64_t seed) {
  char name[60];
  std::snprintf(name, sizeof name, "wall on a tilting table at %g", feed);
  ProgramWriter w(titled(name, p_mm), p_mm, feed);
  w.program().machine = Machine::table;
  Random r(seed);
  double s = 0;
  for (int i = 0; i < moves; ++i) {
    Pose p = xyz(rounded(40 * std::sin(s / 40)), rounded(8 * std::sin(s / 15)),
                 rounded(0.5 * std::sin(s / 5)), rounded(-15 + 10 * std::sin(s / 12)));
    p.c = rounded(25 * std::sin(s / 20));
    w.line(p);
    s += r.between(0.2, 0.8);
  }
  return w.done();
}

Program tangent_moves(int moves, bool exact, bool rounded_off, std::uint64_t seed) {
  Random r(seed);
  ProgramWriter w("tangent moves", exact ? 0 : std::pow(10, r.between(-2.5, -0.5)), 60, false);
  Program program = w.done();
  if (exact)
    std::get<motion::PathControl>(program.items.front()).mode =
        motion::PathControl::Mode::exact_path;
  const auto written = [&](double v) { return rounded_off ? std::round(v * 1e3) / 1e3 : v; };
  Pose at;  // as it is written
  double x = 0, y = 0, heading = r.between(0, 2 * kPi);
  for (int i = 0; i < moves; ++i) {
    const double feed = r.between(10, 190), tx = std::cos(heading), ty = std::sin(heading);
    switch (r.below(3)) {
      case 0: {
        const double length = std::pow(10, r.between(-1.5, 1));
        x += length * tx, y += length * ty;
        at = xyz(written(x), written(y), 0);
        motion::LinearMove line;
        line.end = at;
        line.vel_mm_s = feed;
        program.items.emplace_back(line);
        break;
      }
      case 1: {
        const double radius = std::pow(10, r.between(-0.7, 1.5)), side = r.below(2) == 0 ? 1 : -1;
        const double cx = x - side * radius * ty, cy = y + side * radius * tx;
        heading += side * r.between(0.2, 3.2);
        x = cx + side * radius * std::sin(heading);
        y = cy - side * radius * std::cos(heading);
        motion::ArcMove arc;
        arc.centre[0] = at.x + written(cx - at.x), arc.centre[1] = at.y + written(cy - at.y);
        arc.normal[0] = arc.normal[1] = 0;
        arc.normal[2] = side;
        at = xyz(written(x), written(y), 0);
        arc.end = at;
        arc.vel_mm_s = feed;
        program.items.emplace_back(arc);
        break;
      }
      default: {
        // From where it really begins: a spline is no points with decimals.
        const double bend = r.between(-1, 1), length = std::min(0.15 / std::abs(bend), 2.0);
        motion::CubicMove cubic;
        cubic.first.x = tx, cubic.first.y = ty;
        cubic.second.x = -bend * ty, cubic.second.y = bend * tx;
        const double third = -bend * bend * length;
        const double along = length * (1 + third * length / 6), across = bend * length * length / 2;
        x = at.x + along * tx - across * ty, y = at.y + along * ty + across * tx;
        heading += std::atan2(bend * length, 1 + third * length / 2);
        at = xyz(x, y, 0);
        cubic.end = at;
        cubic.length = length;
        cubic.vel_mm_s = feed;
        program.items.emplace_back(cubic);
      }
    }
  }
  return program;
}

Program mixture(int moves, std::uint64_t seed) {
  Random r(seed);
  const double p = std::exp(r.between(std::log(0.005), std::log(0.2)));
  ProgramWriter w(titled(("mixture " + std::to_string(seed)).c_str(), p), p, 100);
  for (int i = 0; i < moves; ++i) {
    if (r.below(8) == 0) w.feed(r.between(20, 180));
    const Pose at = w.at();
    const double size = std::exp(r.between(std::log(0.003), std::log(16.0)));
    const double angle = r.between(0, 2 * kPi);
    switch (r.below(6)) {
      case 0: {
        const double radius = std::exp(r.between(std::log(0.2), std::log(30.0)));
        w.arc(at.x + radius * std::cos(angle), at.y + radius * std::sin(angle),
              r.between(0.05, 5) * (r.below(2) != 0 ? 1 : -1),
              r.below(3) == 0 ? r.between(-2, 2) : 0);
        break;
      }
      case 1: w.line(xyz(at.x, at.y, at.z + r.between(-3, 3))); break;
      case 2:  // nearly back where it came from
        w.line(xyz(at.x + size, at.y, at.z));
        w.line(xyz(at.x + 0.01, at.y + 0.003, at.z));
        break;
      case 3: w.rapid(xyz(at.x + size, at.y - size, at.z)); break;
      default: w.line(xyz(at.x + size * std::cos(angle), at.y + size * std::sin(angle), at.z));
    }
  }
  return w.done();
}

Program wander(int moves, std::uint64_t seed) {
  Random r(seed);
  const double p = std::exp(r.between(std::log(0.001), std::log(0.1)));
  const double widest_feed = std::exp(r.between(std::log(10.0), std::log(200.0)));
  ProgramWriter w(titled(("wander " + std::to_string(seed)).c_str(), p), p, widest_feed,
                  r.below(2) == 0);
  double heading = r.between(0, 2 * kPi), step = 0.02, bend = 0, noise = 0, climb = 0;
  int left = 0;
  for (int i = 0; i < moves; ++i, --left) {
    if (left == 0 || i == 0) {
      left = 1 + r.below(120);
      step = std::exp(r.between(std::log(0.002), std::log(0.6)));
      bend = r.below(3) == 0 ? 0 : r.between(-0.4, 0.4);
      noise = r.below(3) == 0 ? r.between(0, 0.3) : 0;
      climb = r.below(2) == 0 ? 0 : r.between(-0.5, 0.5);
      if (r.below(3) == 0) heading += r.between(-kPi, kPi);
      if (r.below(4) == 0) w.feed(widest_feed * r.between(0.1, 1));
    }
    double length = step;
    if (r.below(60) == 0) length = std::exp(r.between(std::log(1e-5), std::log(8.0)));
    heading += bend * std::min(1.0, length) + r.between(-noise, noise);
    const Pose at = w.at();
    if (r.below(80) == 0) {
      const double radius = std::exp(r.between(std::log(0.05), std::log(5.0)));
      const double side = r.below(2) == 0 ? 1 : -1, turn = r.between(0.1, 2);
      w.arc(at.x - side * radius * std::sin(heading), at.y + side * radius * std::cos(heading),
            side * turn);
      heading += side * turn;
      continue;
    }
    w.line(xyz(at.x + length * std::cos(heading), at.y + length * std::sin(heading),
               at.z + length * climb));
  }
  return w.done();
}

}  // namespace kerf::bench
