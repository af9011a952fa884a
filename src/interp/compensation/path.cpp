#include "interp/compensation/path.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::interp {

namespace {

constexpr double kPi = 3.14159265358979323846;
/// Turns of less are no corner (radians).
constexpr double kNearlyStraight = 0.05;
/// Lengths in mm below this are rounding.
constexpr double kTiny = 1e-9;

double dot(Flat p, Flat q) { return p.a * q.a + p.b * q.b; }
double cross(Flat p, Flat q) { return p.a * q.b - p.b * q.a; }
double length(Flat p) { return std::hypot(p.a, p.b); }
Flat left_of(Flat p) { return {-p.b, p.a}; }

/// Angle from p to q, in (-pi, pi].
double angle_between(Flat p, Flat q) { return std::atan2(cross(p, q), dot(p, q)); }

constexpr const char* kArcToArc =
    "Arc to arc motion makes a corner the compensated tool can't fit in without gouging";
constexpr const char* kArcToLine =
    "Arc to straight motion makes a corner the compensated tool can't fit in without gouging";
constexpr const char* kArcInCorner =
    "Arc move in concave corner cannot be reached by the tool without gouging";

}  // namespace

// --- moves ---

CompStep CompPath::line(Flat from, Flat to, bool traverse) const {
  CompStep step;
  CompMove& m = step.move;
  m.traverse = traverse;
  m.programmed = to - from;
  const double distance = length(m.programmed);
  m.entry = !started();
  if (m.entry && distance <= radius_) {
    step.problem = "Length of cutter compensation entry move is not greater than the tool radius";
    return step;
  }
  m.normal = left_of(m.programmed) * (side_ / distance);
  m.end = to + m.normal * radius_;
  if (m.entry)
    m.start = from;
  else
    join(step, from, m.normal);
  return step;
}

CompStep CompPath::arc(Flat from, Flat to, const FlatArc& arc, Flat tool) const {
  CompStep step;
  CompMove& m = step.move;
  m.is_arc = true;
  m.center = arc.center;
  m.turn_sign = arc.turns > 0 ? 1.0 : -1.0;
  // The tool is inside of an arc that bends to its side.
  const double inward = side_ * m.turn_sign;
  m.outside = inward < 0;
  const Flat from_center = from - arc.center, to_center = to - arc.center;
  const double radius = length(to_center);
  if (!started() && length(to - from) <= radius_) {
    step.problem = "Radius of cutter compensation entry arc is not greater than the tool radius";
    return step;
  }
  if (inward > 0 && radius <= radius_) {
    step.problem = "Tool radius not less than arc radius with comp";
    return step;
  }
  m.normal = to_center * (-inward / radius);
  m.end = to + m.normal * radius_;
  if (!started()) return entry_arc(tool, to, arc, m.normal);
  const Flat start_normal = from_center * (-inward / length(from_center));
  const double partial = angle_between(from_center, to_center) * m.turn_sign;
  m.sweep = (partial > kTiny ? partial : partial + 2 * kPi) + 2 * kPi * (std::abs(arc.turns) - 1);
  m.programmed_sweep = m.sweep;
  join(step, from, start_normal);
  if (step.problem != nullptr) return step;
  // It begins where the open move now ends, which lies further on or further back than its programmed start.
  m.sweep -= angle_between(start_normal * -inward, m.start - m.center) * m.turn_sign;
  return step;
}

// The first arc begins on the programmed path and ends beside it, in its own direction there: a circle through both points.
CompStep CompPath::entry_arc(Flat tool, Flat to, const FlatArc& arc, Flat normal) const {
  CompStep step;
  CompMove& m = step.move;
  m.is_arc = m.entry = true;
  m.turn_sign = arc.turns > 0 ? 1.0 : -1.0;
  m.outside = side_ * m.turn_sign < 0;
  m.normal = normal;
  m.start = tool;
  m.end = to + normal * radius_;
  // The centre lies on the line through the end and the programmed centre, as far from the start as from the end.
  const Flat axis = (arc.center - to) * (1 / length(arc.center - to));
  const Flat chord = tool - m.end;
  const double along = dot(chord, axis);
  if (std::fabs(along) < kTiny) {
    step.problem = "Radius of cutter compensation entry arc is not greater than the tool radius";
    return step;
  }
  m.center = m.end + axis * (dot(chord, chord) / (2 * along));
  const double partial = angle_between(m.start - m.center, m.end - m.center) * m.turn_sign;
  m.sweep = (partial > kTiny ? partial : partial + 2 * kPi) + 2 * kPi * (std::abs(arc.turns) - 1);
  m.programmed_sweep = m.sweep;
  return step;
}

CompStep CompPath::last() const {
  CompStep step;
  if (!started()) return step;
  step.open_end = open_->end;
  step.open_sweep = open_->sweep;
  finish_open(step, true);
  return step;
}

// --- corners ---

void CompPath::join(CompStep& step, Flat corner, Flat start_normal) const {
  const CompMove& open = *open_;
  // How far the path turns away from the tool. Next to half a turn the corner is an outside one, unless an arc bends over it.
  const bool bends_over = step.move.is_arc ? step.move.outside : open.outside;
  const double most = bends_over ? kPi - kNearlyStraight : kPi + kNearlyStraight;
  double turn = -side_ * angle_between(open.normal, start_normal);
  if (turn + 2 * kPi <= most) turn += 2 * kPi;
  if (turn > most) turn -= 2 * kPi;
  step.open_end = open.end;
  step.open_sweep = open.sweep;
  step.move.start = open.end;
  if (turn > kNearlyStraight) {
    step.corner_end = corner + start_normal * radius_;
    step.move.start = *step.corner_end;
  } else if (turn < -kNearlyStraight) {
    meet(step, corner, start_normal);
  }
  if (step.problem != nullptr) return;
  // The peer lets a straight move pass that turned back when no corner cuts it off, or an arc leads around the corner.
  // An arc that turned back would become nearly a full circle; it is refused always.
  const bool strict = turn < -kNearlyStraight || (step.corner_end && !step.move.is_arc);
  finish_open(step, strict);
}

namespace {

/// A line through `at`, or a circle.
struct Offset {
  bool circle;
  Flat at;  ///< or the centre
  Flat direction;
  double radius;
};

/// Where a line meets a circle: the parameters along the line, ascending.
bool line_circle(const Offset& line, const Offset& circle, double (&t)[2]) {
  const Flat to_center = circle.at - line.at;
  const double middle = dot(to_center, line.direction);
  const double off = cross(line.direction, to_center);
  double half2 = circle.radius * circle.radius - off * off;
  if (half2 < 0) {
    if (half2 < -kTiny * std::max(1.0, circle.radius)) return false;
    half2 = 0;
  }
  const double half = std::sqrt(half2);
  t[0] = middle - half;
  t[1] = middle + half;
  return true;
}

bool circle_circle(const Offset& p, const Offset& q, Flat (&points)[2]) {
  const Flat axis = q.at - p.at;
  const double d = length(axis);
  const double along = (p.radius * p.radius - q.radius * q.radius + d * d) / (2 * d);
  double half2 = p.radius * p.radius - along * along;
  if (half2 < 0) {
    if (half2 < -kTiny * std::max(1.0, p.radius)) return false;
    half2 = 0;
  }
  const Flat unit = axis * (1 / d);
  const Flat foot = p.at + unit * along;
  const Flat side = left_of(unit) * std::sqrt(half2);
  points[0] = foot + side;
  points[1] = foot - side;
  return true;
}

}  // namespace

// Inside corner: both offset paths end where they meet, next to the corner.
void CompPath::meet(CompStep& step, Flat corner, Flat start_normal) const {
  const CompMove& open = *open_;
  CompMove& m = step.move;
  const auto along = [this](Flat normal) { return left_of(normal) * -side_; };
  const Flat next_at = corner + start_normal * radius_;
  const Offset before{open.is_arc, open.is_arc ? open.center : open.end, along(open.normal),
                      length(open.end - open.center)};
  const Offset after{m.is_arc, m.is_arc ? m.center : next_at, along(start_normal),
                     length(next_at - m.center)};
  Flat meeting;
  if (!before.circle && !after.circle) {
    const double half_turn = std::fabs(angle_between(open.normal, start_normal)) / 2;
    meeting = open.end - before.direction * (radius_ * std::tan(half_turn));
  } else if (before.circle && after.circle) {
    if (length(after.at - before.at) < kTiny) {
      step.problem = "Arc to arc motion is invalid because the arcs have the same center";
      return;
    }
    Flat points[2];
    if (!circle_circle(before, after, points)) {
      step.problem = kArcToArc;
      return;
    }
    // On which side of the line through the centres: that of the tool, unless it is inside of one arc only.
    const bool left = (side_ > 0) == (open.outside == m.outside);
    meeting = points[left ? 0 : 1];
  } else {
    const Offset& line = before.circle ? after : before;
    double t[2];
    if (!line_circle(line, before.circle ? before : after, t)) {
      step.problem = before.circle ? kArcToLine : kArcInCorner;
      return;
    }
    // The line leaves the circle at the corner, or enters it there, as the tool is inside or outside of the arc.
    const bool second = before.circle ? open.outside : !m.outside;
    meeting = line.at + line.direction * t[second ? 1 : 0];
  }
  step.open_end = meeting;
  m.start = meeting;
  if (open.is_arc && !open.entry)
    step.open_sweep =
        open.sweep - angle_between(meeting - open.center, open.end - open.center) * open.turn_sign;
}

// The open move must not be turned back by what was cut off at both of its ends.
void CompPath::finish_open(CompStep& step, bool strict) const {
  const CompMove& open = *open_;
  // The way in leads from another path; its length says nothing.
  if (open.entry) return;
  if (open.is_arc) {
    // Cut off at both ends until nothing is left, or begun before its own circle.
    const bool longer = step.open_sweep > open.programmed_sweep + slack_;
    if (step.open_sweep < -kTiny || (strict && longer)) step.problem = kArcInCorner;
    return;
  }
  if (strict && dot(open.programmed, step.open_end - open.start) < 0)
    step.problem =
        open.traverse
            ? "Straight traverse in concave corner cannot be reached by the tool without gouging"
            : "Straight feed in concave corner cannot be reached by the tool without gouging";
}

}  // namespace kerf::interp
