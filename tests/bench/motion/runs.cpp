#include "bench/motion/runs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <random>
#include <vector>

#include "bench/motion/machinery.hpp"
#include "bench/motion/machines.hpp"
#include "bench/motion/seconds.hpp"
#include "motion/core/path/reach.hpp"
#include "unit/motion/spindle_rig.hpp"

namespace kerf::bench {
namespace {

using motion::Pose;
using motion::test::Rig;
using motion::test::SpindleRig;
namespace path = motion::path;

constexpr std::size_t kJoints = 4;  ///< of the mill
constexpr std::size_t kMostJoints = 5;
/// Of the planner's turns: to ask for the processor's time takes about as long as a turn in which there is nothing to do, so only longer ones are
/// measured with it.
constexpr double kShort = 10e-6;
/// How many moves before and behind the one in execution are looked at for the distance.
constexpr int kNear = 40;
/// Nobody is that far from the path (mm).
constexpr double kFar = 1;
constexpr int kFiner = 8;
constexpr int kStraightSteps = 256;

/// Of this thread alone: whatever else the machine does.
double processor_now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

void set_up(Rig& rig, Machine machine, double jerk, double path_jerk = 0) {
  set_limits(rig.config, machine, jerk, path_jerk);
  rig.config.path_check = false;  // times are those of a machine as it comes
  rig.apply_config();
  rig.ready();
}

/// One programmed move in XYZ.
struct Programmed {
  bool arc{false};
  double from[3]{}, to[3]{};
  double centre[2]{}, radius{0}, angle{0}, sweep{0};
};

double distance_to_arc(const Programmed& m, const double p[3]) {
  const double whole = std::abs(m.sweep), sign = m.sweep < 0 ? -1 : 1;
  const auto at = [&](double turn) {
    const double angle = m.angle + sign * turn;
    return std::hypot(p[0] - m.centre[0] - m.radius * std::cos(angle),
                      p[1] - m.centre[1] - m.radius * std::sin(angle),
                      p[2] - m.from[2] - (m.to[2] - m.from[2]) * turn / whole);
  };
  constexpr int kSamples = 24, kRounds = 40;
  int best = 0;
  for (int i = 1; i <= kSamples; ++i)
    if (at(whole * i / kSamples) < at(whole * best / kSamples)) best = i;
  double low = whole * std::max(0, best - 1) / kSamples,
         high = whole * std::min(kSamples, best + 1) / kSamples;
  for (int i = 0; i < kRounds; ++i) {
    const double a = low + (high - low) * 0.382, b = low + (high - low) * 0.618;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at((low + high) / 2);
}

double distance_to(const Programmed& m, const double p[3]) {
  if (m.arc) {
    // In its plane: a bound that most of the time is good enough to see that it is not the nearest.
    const double r = std::hypot(p[0] - m.centre[0], p[1] - m.centre[1]);
    const double far = std::abs(r - m.radius);
    return far > kFar ? far : distance_to_arc(m, p);
  }
  double along = 0, square = 0;
  for (int i = 0; i < 3; ++i) {
    along += (p[i] - m.from[i]) * (m.to[i] - m.from[i]);
    square += (m.to[i] - m.from[i]) * (m.to[i] - m.from[i]);
  }
  const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  double off = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = p[i] - m.from[i] - t * (m.to[i] - m.from[i]);
    off += d * d;
  }
  return std::sqrt(off);
}

std::vector<Programmed> programmed(const Program& program) {
  std::vector<Programmed> out;
  Pose at;
  for (const auto& item : program.items) {
    Programmed m;
    const auto set = [&](const Pose& end) {
      m.from[0] = at.x, m.from[1] = at.y, m.from[2] = at.z;
      m.to[0] = end.x, m.to[1] = end.y, m.to[2] = end.z;
    };
    if (const auto* line = std::get_if<motion::LinearMove>(&item)) {
      set(line->end);
      at = line->end;
    } else if (const auto* thread = std::get_if<motion::SyncMove>(&item)) {
      set(thread->end);
      at = thread->end;
    } else if (const auto* arc = std::get_if<motion::ArcMove>(&item)) {
      set(arc->end);
      m.arc = true;
      m.centre[0] = arc->centre[0], m.centre[1] = arc->centre[1];
      m.radius = std::hypot(at.x - arc->centre[0], at.y - arc->centre[1]);
      m.angle = std::atan2(at.y - arc->centre[1], at.x - arc->centre[0]);
      const double end = std::atan2(arc->end.y - arc->centre[1], arc->end.x - arc->centre[0]);
      const double sign = arc->normal[2] < 0 ? -1 : 1;
      double turn = (end - m.angle) * sign;
      turn -= 2 * M_PI * std::floor(turn / (2 * M_PI));
      if (turn < 1e-9) turn = 2 * M_PI;
      m.sweep = turn * sign;
      at = arc->end;
    } else {
      set(at);
    }
    out.push_back(m);
  }
  return out;
}

/// What of the planner's time goes into stops: the cycles in which it made one and no other law, less what cycles without any law take.
class PlannerParts {
 public:
  void add(double seconds, const motion::LawMaker::Counts& now) {
    const bool stop = now.stops.all != before_.stops.all,
               law = now.rests.all != before_.rests.all || now.children.all != before_.children.all;
    before_ = now;
    if (law) return;
    (stop ? with_ : without_) += seconds;
    ++(stop ? stops_ : others_);
  }
  [[nodiscard]] double stops_s() const {
    const double one = others_ > 0 ? without_ / static_cast<double>(others_) : 0.0;
    return std::max(with_ - one * static_cast<double>(stops_), 0.0);
  }

 private:
  motion::LawMaker::Counts before_;
  double with_{0}, without_{0};
  std::size_t stops_{0}, others_{0};
};

}  // namespace

RunResult run(const Program& program, const RunOptions& options) {
  SpindleRig rig(moved_by(program.machine));
  set_up(rig, program.machine, options.jerk, options.path_jerk);
  rig.acceleration = 0;  // of the spindle: it is at speed at once
  const auto joints = static_cast<std::size_t>(rig.kinematics.joints());
  RunResult out;
  const std::vector<Programmed> moves =
      options.deviation ? programmed(program) : std::vector<Programmed>{};
  std::mt19937_64 random(options.seed);
  std::size_t next = 0, first_move = 0, last_move = 0;
  double p1[kMostJoints]{}, p2[kMostJoints]{}, p3[kMostJoints]{};
  constexpr double kT = Rig::kPeriod;
  Pose before = rig.status().pos_cmd;
  const std::uint64_t seq0 = rig.seq;
  std::vector<float> speeds;
  PlannerParts parts;
  out.hash = 1469598103934665603U;
  while (true) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    if (options.overrides && random() % 200 == 0)
      rig.intent.feed_override = 0.05 + static_cast<double>(random() % 1000) / 512.0;
    if (options.swings)
      rig.intent.feed_override = 0.7 + 0.3 * std::sin(static_cast<double>(out.cycles) * 0.0044);
    const double began = processor_now(), t0 = seconds_now();
    while (rig.planner.run(*rig.path, rig.controller->view(), 1, rig.now_ns) ==
           motion::Planner::Waits::turn) {
    }
    double planned = seconds_now() - t0;
    if (planned > kShort) planned = processor_now() - began;
    out.planner_s += planned;
    parts.add(planned, rig.planner.law_counts());
    rig.plan = false;
    const double t1 = seconds_now();
    if (program.machine == Machine::lathe)
      rig.cycle();
    else
      rig.Rig::cycle();
    const double servo = seconds_now() - t1;
    if (servo < kInterrupted) {
      out.servo_s += servo;
      ++out.timed;
    }
    const auto& s = rig.status();
    for (std::size_t j = 0; j < joints; ++j) {
      const double p = s.joint[j].pos_cmd;
      const auto& limit = rig.config.joint[j];
      if (out.cycles > 1) {
        out.vel = std::max(out.vel, std::abs(p - p1[j]) / kT / limit.max_vel);
        out.acc = std::max(out.acc, std::abs(p - 2 * p1[j] + p2[j]) / (kT * kT) / limit.max_acc);
      }
      if (out.cycles > 2 && options.jerk > 0)
        out.jerk = std::max(
            out.jerk, std::abs(p - 3 * p1[j] + 3 * p2[j] - p3[j]) / (kT * kT * kT) / options.jerk);
      out.hash = (out.hash ^ std::bit_cast<std::uint64_t>(p)) * 1099511628211U;
      p3[j] = p2[j];
      p2[j] = p1[j];
      p1[j] = p;
    }
    const double step =
        std::hypot(s.pos_cmd.x - before.x, s.pos_cmd.y - before.y, s.pos_cmd.z - before.z);
    out.length += step;
    if (!(s.pos_cmd == before)) {
      if (first_move == 0) first_move = out.cycles;
      last_move = out.cycles;
      speeds.push_back(static_cast<float>(step / kT));
    }
    before = s.pos_cmd;
    if (options.record) out.track.push_back(s.pos_cmd);
    if (options.deviation && s.current_seq > seq0) {
      const double p[3] = {s.pos_cmd.x, s.pos_cmd.y, s.pos_cmd.z};
      const int at = static_cast<int>(s.current_seq - seq0) - 1;
      double least = 1e9;
      for (int i = std::max(0, at - kNear);
           i < std::min(static_cast<int>(moves.size()), at + kNear); ++i)
        least = std::min(least, distance_to(moves[static_cast<std::size_t>(i)], p));
      out.deviation = std::max(out.deviation, least);
    }
    ++out.cycles;
    if (next == program.items.size() && s.executed_seq == rig.seq && s.path_empty) break;
    if (out.cycles > 3'000'000 || !rig.faults.empty()) break;
  }
  out.seconds = static_cast<double>(last_move - first_move + 1) * kT;
  out.moves = program.items.size() - 1;
  out.faults = rig.faults.size();
  out.laws = rig.planner.law_counts();
  out.stops_s = parts.stops_s();
  if (!speeds.empty()) {
    const auto quarter = static_cast<std::ptrdiff_t>(speeds.size() / 4);
    out.slowest = *std::min_element(speeds.begin() + quarter, speeds.end() - quarter);
  }
  return out;
}

double speed_cap(const path::Piece& piece, const path::Vec& slope, const path::AxisLimits& limits) {
  double cap = path::kNoLimit;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (slope[i] != 0) cap = std::min(cap, std::pow(limits.vel[i] / slope[i], 2));
  const auto& feed = piece.feed;
  if (feed.speed >= path::kNoLimit) return cap;
  const double rate =
      feed.metric < 0 ? 1 : path::norm3(slope, static_cast<std::size_t>(feed.metric));
  return rate > 0 ? std::min(cap, std::pow(feed.speed / rate, 2)) : cap;
}

std::vector<motion::PathSpan> curve_of(const Program& program, double jerk,
                                       path::AxisLimits& limits) {
  const bool table = program.machine == Machine::table;
  Rig rig(moved_by(table ? Machine::table : Machine::mill));
  set_up(rig, table ? Machine::table : Machine::mill, jerk);
  for (path::Vec* of : {&limits.vel, &limits.acc, &limits.jerk})
    std::fill(std::begin(of->at), std::end(of->at), path::kNoLimit);
  for (std::int32_t j = 0; j < rig.kinematics.joints(); ++j) {
    const std::int32_t axis = rig.kinematics.axis_of_joint(j);
    if (axis < 0) continue;
    const auto i = static_cast<std::size_t>(axis);
    limits.vel[i] = rig.config.joint[j].max_vel;
    limits.acc[i] = rig.config.joint[j].max_acc;
    if (jerk > 0) limits.jerk[i] = jerk;
  }
  for (std::size_t i = 0; i < 3 && table; ++i) {
    limits.vel[i] = rig.config.axis[i].max_vel;
    limits.acc[i] = rig.config.axis[i].max_acc;
  }
  std::vector<motion::PathSpan> curve;
  std::size_t next = 0;
  for (int idle = 0; idle < 300;) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    const auto waits = rig.planner.run(*rig.path, rig.controller->view(), 1, rig.now_ns);
    bool any = false;
    while (const motion::Span* span = rig.spans->front()) {
      const auto* move = std::get_if<motion::PathSpan>(&span->body);
      if (move != nullptr && !move->point) curve.push_back(*move);
      rig.spans->pop();
      any = true;
    }
    if (waits != motion::Planner::Waits::turn && next == program.items.size())
      rig.now_ns += 1'000'000;
    idle = any || next < program.items.size() ? 0 : idle + 1;
  }
  return curve;
}

namespace {

/// A node of the fine grid: limits there, and the way to the next one.
struct Node {
  Values slope{}, bend{};
  double cap{0}, way{0};
  bool stands{false};
};

std::vector<Node> nodes_of(const std::vector<motion::PathSpan>& curve, const Machinery& machine) {
  std::vector<Node> nodes;
  for (const motion::PathSpan& span : curve) {
    const int steps = span.piece.straight() ? kStraightSteps : kFiner;
    for (int k = 0; k < steps; ++k) {
      Node n;
      const double s = span.from + span.length * k / steps;
      Values third;
      machine.derive(span.piece, s, n.slope, n.bend, third);
      n.way = span.length / steps;
      n.cap = machine.cap(span.piece, s);
      nodes.push_back(n);
    }
    if (span.stop_at_end) nodes.back().stands = true;
  }
  return nodes;
}

/// The nearest point of the stretch to q, by Newton from the nearest of some places; by halving around it where that has not settled, as next to a
/// reversal.
double distance_to_stretch(const motion::PathSpan& span, const path::Vec& q) {
  const auto square = [](const path::Vec& d) {
    double sum = 0;
    for (const double v : d.at) sum += v * v;
    return sum;
  };
  const auto off = [&](double s) { return q - span.piece.point(s); };
  constexpr int kPlaces = 8, kRounds = 30, kNarrowings = 80;
  constexpr double kSettled = 1e-10, kElsewhere = 1e-3;  // mm
  double at = span.from;
  for (int k = 1; k <= kPlaces; ++k) {
    const double s = span.from + span.length * k / kPlaces;
    if (square(off(s)) < square(off(at))) at = s;
  }
  double low = std::max(at - span.length / kPlaces, span.from),
         high = std::min(at + span.length / kPlaces, span.from + span.length);
  for (int k = 0; k < kRounds; ++k) {
    const path::Vec t = span.piece.first(at), d = off(at);
    double along = 0;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) along += d[i] * t[i];
    if (!(square(t) > 0)) break;
    at = std::clamp(at + along / square(t), span.from, span.from + span.length);
  }
  const double found = path::max_abs(off(at));
  if (found < kSettled || found > kElsewhere) return found;
  for (int k = 0; k < kNarrowings; ++k) {
    const double a = low + (high - low) * 0.382, b = low + (high - low) * 0.618;
    (square(off(a)) < square(off(b)) ? high : low) = square(off(a)) < square(off(b)) ? b : a;
  }
  return std::min(found, path::max_abs(off((low + high) / 2)));
}

/// |slope u + bend x0| <= acc at the node, u = (x1 - x0) / (2 way).
void rows_at(const Node& n, const JointLimits& limits, path::Rows& rows) {
  rows.count = 0;
  for (std::size_t i = 0; i < kOptimumJoints; ++i) {
    const double p = n.slope[i] / (2 * n.way) / limits.acc[i], e = n.bend[i] / limits.acc[i];
    if (p != 0 || e != 0) rows.at[rows.count++] = {e - p, p};
  }
}

}  // namespace

double optimum(const Program& program) {
  if (program.machine == Machine::lathe) return 0;
  path::AxisLimits axes;
  const std::vector<motion::PathSpan> curve = curve_of(program, 0, axes);
  const Machinery machine = machinery_of(program, axes, 0);
  const JointLimits& limits = machine.limits;
  const std::vector<Node> nodes = nodes_of(curve, machine);
  const std::size_t n = nodes.size();
  if (n == 0) return 0;
  std::vector<double> most(n + 1, 0.0);
  path::Rows rows;
  for (std::size_t i = n; i-- > 0;) {
    rows_at(nodes[i], limits, rows);
    const double end = nodes[i].stands ? 0.0 : most[i + 1];
    most[i] = std::min(nodes[i].cap, path::largest_x0(rows.all(), end));
  }
  double x = 0, seconds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    rows_at(nodes[i], limits, rows);
    const double end = nodes[i].stands ? 0.0 : most[i + 1];
    const path::Range range = path::range_of_x1(rows.all(), x, true);
    const double x1 = std::clamp(end, 0.0, std::max(range.high, 0.0));
    const double sum = std::sqrt(x) + std::sqrt(x1);
    if (sum > 0) seconds += 2 * nodes[i].way / sum;
    x = x1;
  }
  return seconds;
}

double feed_floor(const Program& program) {
  motion::MachineConfig config;
  reference_machine(config);
  double seconds = 0, rps = 0;
  const std::vector<Programmed> moves = programmed(program);
  Pose at;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Programmed& m = moves[i];
    double feed = 0;
    Pose end = at;
    if (const auto* line = std::get_if<motion::LinearMove>(&program.items[i])) {
      feed = line->vel_mm_s;
      end = line->end;
    } else if (const auto* arc = std::get_if<motion::ArcMove>(&program.items[i])) {
      feed = arc->vel_mm_s;
      end = arc->end;
    } else if (const auto* thread = std::get_if<motion::SyncMove>(&program.items[i])) {
      feed = thread->per_rev_mm * rps;
      end = thread->end;
    } else if (const auto* turn = std::get_if<motion::SpindleChange>(&program.items[i])) {
      rps = turn->speed_rpm / 60;
    }
    const double flat =
        m.arc ? m.radius * std::abs(m.sweep) : std::hypot(m.to[0] - m.from[0], m.to[1] - m.from[1]);
    double length = std::hypot(flat, m.to[2] - m.from[2]);
    if (length == 0) length = std::abs(end.a - at.a);
    double least = feed > 0 ? length / feed : 0.0;
    if (!m.arc)
      for (std::size_t j = 0; j < kJoints; ++j)
        least = std::max(least, std::abs(end[j] - at[j]) / config.joint[j].max_vel);
    seconds += least;
    at = end;
  }
  return seconds;
}

RetraceResult retrace(const Program& program, double jerk) {
  path::AxisLimits limits;
  const std::vector<motion::PathSpan> curve = curve_of(program, jerk, limits);
  Rig rig(moved_by(program.machine));
  set_up(rig, program.machine, jerk);
  motion::OverrideEnable enables;
  enables.feed = enables.adaptive = true;
  rig.push(enables);
  std::size_t next = 0;
  const std::uint64_t turn_at = rig.seq + program.items.size() * 4 / 5;
  RetraceResult out;
  Pose before;
  std::size_t near = 0;
  int still = 0;
  constexpr int kStands = 300, kMost = 400'000;
  for (int cycle = 0; cycle < kMost && still < kStands && rig.faults.empty(); ++cycle) {
    while (next < program.items.size() && rig.push(program.items[next])) ++next;
    if (rig.status().current_seq >= turn_at) rig.in.adaptive_feed = -1;
    rig.cycle();
    const Pose& pose = rig.status().pos_cmd;
    const bool back = rig.in.adaptive_feed < 0;
    still = back && pose == before ? still + 1 : 0;
    if (back) out.length += std::hypot(pose.x - before.x, pose.y - before.y, pose.z - before.z);
    before = pose;
    // Near the stretch of the cycle before, both ways.
    constexpr std::size_t kWindow = 60;
    double least = 1e9;
    const std::size_t low = near > kWindow ? near - kWindow : 0,
                      high = std::min(curve.size(), near + kWindow);
    for (std::size_t k = low; k < high; ++k) {
      const double d = distance_to_stretch(curve[k], path::to_vec(pose));
      if (d >= least) continue;
      least = d;
      near = k;
    }
    if (back) out.off = std::max(out.off, least);
  }
  out.faults = rig.faults.size();
  return out;
}

bool write_gcode(const Program& program, const std::string& file) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (out == nullptr) return false;
  std::fprintf(out, "G21 G90 G94 G17 G40 G49");
  if (program.p_mm > 0)
    std::fprintf(out, " G64 P%.9g%s\n", program.p_mm, program.merges ? "" : " Q0");
  else
    std::fprintf(out, " G61.1\n");
  const bool table = program.machine == Machine::table;
  std::fprintf(out, "G0 X0 Y0 Z0 A0%s\n%s", table ? " C0" : "",
               program.inverse_time ? "G93\n" : "");
  Pose at;
  const auto words = [&](const Pose& end, double feed) {
    const double length = std::hypot(end.x - at.x, end.y - at.y, end.z - at.z);
    std::fprintf(out, " X%.6f Y%.6f Z%.6f A%.6f", end.x, end.y, end.z, end.a);
    if (table) std::fprintf(out, " C%.6f", end.c);
    if (feed > 0) std::fprintf(out, " F%.6f", feed * 60 / (program.inverse_time ? length : 1.0));
    at = end;
  };
  for (const auto& item : program.items) {
    if (const auto* line = std::get_if<motion::LinearMove>(&item)) {
      std::fprintf(out, line->kind == motion::MotionKind::traverse ? "G0" : "G1");
      words(line->end, line->vel_mm_s);
      std::fprintf(out, "\n");
    } else if (const auto* arc = std::get_if<motion::ArcMove>(&item)) {
      const double i = arc->centre[0] - at.x, j = arc->centre[1] - at.y;
      std::fprintf(out, arc->normal[2] < 0 ? "G2" : "G3");
      words(arc->end, arc->vel_mm_s);
      std::fprintf(out, " I%.6f J%.6f\n", i, j);
    } else if (const auto* thread = std::get_if<motion::SyncMove>(&item)) {
      std::fprintf(out, "G33");
      words(thread->end, 0);
      std::fprintf(out, " K%.6f\n", thread->per_rev_mm);
    } else if (const auto* turn = std::get_if<motion::SpindleChange>(&item)) {
      std::fprintf(out, "M3 S%.6f\n", turn->speed_rpm);
    }
  }
  std::fprintf(out, "M2\n");
  return std::fclose(out) == 0;
}

double stops_closed_form(const Program& program, double jerk) {
  motion::MachineConfig config;
  reference_machine(config);
  double seconds = 0;
  Pose at;
  for (const auto& item : program.items) {
    const auto* line = std::get_if<motion::LinearMove>(&item);
    if (line == nullptr) continue;
    const double d[3] = {line->end.x - at.x, line->end.y - at.y, line->end.z - at.z};
    at = line->end;
    const double length = std::hypot(d[0], d[1], d[2]);
    if (length == 0) continue;
    double v = line->vel_mm_s, a = 1e99, j = jerk > 0 ? 1e99 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = std::abs(d[i]) / length;
      if (share == 0) continue;
      v = std::min(v, config.joint[i].max_vel / share);
      a = std::min(a, config.joint[i].max_acc / share);
      if (jerk > 0) j = std::min(j, jerk / share);
    }
    // From 0 to v, and the way up and down again.
    const auto ramp = [&](double speed) {
      if (jerk <= 0) return speed / a;
      return speed * j >= a * a ? speed / a + a / j : 2 * std::sqrt(speed / j);
    };
    double low = 0, high = v;
    for (int k = 0; k < 80 && v * ramp(v) > length; ++k) {
      const double middle = (low + high) / 2;
      (middle * ramp(middle) <= length ? low : high) = middle;
      if (k == 79) v = low;
    }
    seconds += 2 * ramp(v) + (length - v * ramp(v)) / v;
  }
  return seconds;
}

}  // namespace kerf::bench
