// G5, G5.1: cubic and quadratic splines; G5.2 ... G5.3: NURBS. Manual: the sections of these names.
//
// G5 and G5.1 are no motion modes of their own: axis words on the next line belong to the mode before, as in LinuxCNC.
#include <algorithm>

#include "interp/codes/families.hpp"
#include "interp/nurbs.hpp"

namespace kerf::interp {

namespace {

constexpr int kControlPoint = 52;
constexpr int kLowestOrder = 3;
/// Far more than any program writes; the block's points are kept until G5.3.
constexpr std::int32_t kMostPoints = 100000;

bool only_x_and_y(Core& c, const Block& b) {
  for (std::size_t axis = 2; axis < rtapi::kAxes; ++axis) {
    if (b.has_axis(axis))
      return c.fail(kLetterNames[static_cast<std::size_t>(kAxisLetter[axis])],
                    "Move it on a line of its own", "Splines may not have motion in Z, A, B, or C");
  }
  return true;
}

bool no_compensation(Core& c) {
  return c.state.cutter_comp == 400 ||
         c.fail(0, "Write G40 before", "Cannot convert spline with cutter radius compensation");
}

/// The curve and where it leaves the machine.
void feed_along(Core& c, const Block& b, std::span<const SplinePoint> points, int order) {
  if (c.state.feed_mode == ProgramFeedMode::inverse_time)
    inverse_time_feed(c, b, NurbsCurve(points, order).length(), 0);
  c.out.call<&Canon::nurbs_feed>(c.out.keep(points), order);
  c.state.position.x = points.back().x;
  c.state.position.y = points.back().y;
  c.state.cycle.clear_known = false;
}

/// What G5 and G5.1 have in common; `end` is where the axis words lead.
bool begin(Core& c, const Block& b, Pose& end) {
  if (!check_feed(c, b, "arc", "Cannot make arc with zero feed rate") || !no_compensation(c))
    return false;
  if (c.state.plane() != Plane::xy)
    return c.fail(0, "Write G17 before", "Splines must be in the XY plane");
  return only_x_and_y(c, b) && c.target(b, end);
}

bool cubic(Core& c, const Block& b, int) {
  Pose end;
  if (!begin(c, b, end)) return false;
  if (!b.has('p') || !b.has('q'))
    return c.fail(0, "They lead from the end point to the second control point",
                  "Must specify both P and Q with G5");
  if (b.has('i') != b.has('j'))
    return c.fail(0, "They lead from the start to the first control point",
                  "Must specify both I and J, or neither");
  const Pose s = c.state.position;
  SplineEnd& last = c.state.spline;
  double i = c.mm(b.get('i', 0)), j = c.mm(b.get('j', 0));
  if (!b.has('i')) {
    if (!last.known || !(last.position == s))
      return c.fail(0, "Only a G5 right behind another goes on in its direction",
                    "Must specify both I and J with the first G5 of a series");
    i = -last.p_mm;
    j = -last.q_mm;
  }
  last = {end, c.mm(b['p']), c.mm(b['q']), true};
  const SplinePoint points[] = {
      {s.x, s.y}, {s.x + i, s.y + j}, {end.x + last.p_mm, end.y + last.q_mm}, {end.x, end.y}};
  feed_along(c, b, points, 4);
  return true;
}

bool quadratic(Core& c, const Block& b, int) {
  Pose end;
  if (!begin(c, b, end)) return false;
  const double i = c.mm(b.get('i', 0)), j = c.mm(b.get('j', 0));
  if (i == 0 && j == 0)
    return c.fail(0, "They lead from the start to the control point",
                  "Must specify both I and J with G5.1");
  const Pose& s = c.state.position;
  const SplinePoint points[] = {{s.x, s.y}, {s.x + i, s.y + j}, {end.x, end.y}};
  feed_along(c, b, points, 3);
  return true;
}

/// G5.2, and the lines behind it: each adds a control point. Increments (G91) count from where the curve begins, since
/// nothing moves before G5.3.
bool control_point(Core& c, const Block& b, int) {
  ModalState& s = c.state;
  const bool opens = s.motion != kControlPoint;
  if (s.feed == 0 && s.feed_mode != ProgramFeedMode::inverse_time)
    return c.fail(0, "Write F with a feed, here or before", "Cannot make a NURBS with 0 feedrate");
  if (!no_compensation(c) || !only_x_and_y(c, b)) return false;
  const bool polar = b.has('@') || b.has('^');
  const bool place = polar || (b.has('x') && b.has('y'));
  if (!place && b.has_axes())
    return c.fail(0, "Write X and Y of the control point",
                  "You must specify both X and Y coordinates for Control Points");
  if (b.has('p') && b['p'] <= 0)
    return c.fail('p', "P is the weight of the point; without P it is 1",
                  "Must specify positive weight P for every Control Point");
  if (!place && !opens && b.has('p'))
    return c.fail('p', "Write X and Y of the control point",
                  "Can specify P without X and Y only for the first control point");
  int order = kLowestOrder;
  if (!c.integer(b, 'l', kLowestOrder, order)) return false;
  if (order < 0) return c.fail('l', "L is the order, 3 or more", "Negative l word used");
  if (order > kHighestOrder)
    return c.fail('l', "3 (quadratic) and 4 (cubic) are usual", "L word greater than %d with G5.2",
                  kHighestOrder);
  if (opens) {
    s.nurbs_points = 0;
    s.nurbs_order = kLowestOrder;
  }
  s.nurbs_order = std::max(s.nurbs_order, order);
  c.nurbs.resize(static_cast<std::size_t>(s.nurbs_points));  // forgets points of a block in error
  if (s.nurbs_points >= kMostPoints)
    return c.fail(0, "Close the block with G5.3", "Too many control points");
  const double weight = b.get('p', 1);
  if (opens) c.nurbs.push_back({s.position.x, s.position.y, place ? 1 : weight});
  if (place) {
    Pose end;
    if (!c.target(b, end)) return false;
    c.nurbs.push_back({end.x, end.y, weight});
  }
  s.nurbs_points = static_cast<std::int32_t>(c.nurbs.size());
  s.motion = kControlPoint;
  return true;
}

bool end_of_nurbs(Core& c, const Block& b, int) {
  ModalState& s = c.state;
  if (s.motion != kControlPoint)
    return c.fail(0, "G5.2 opens the block of control points",
                  "Cannot use G5.3 without G5.2 first");
  if (b.has_axes())
    return c.fail(0, "Write the last control point on the line before",
                  "You must specify both X and Y coordinates for Control Points");
  if (!check_feed(c, b, "NURBS", "Cannot make a NURBS with 0 feedrate")) return false;
  c.nurbs.resize(static_cast<std::size_t>(s.nurbs_points));
  if (s.nurbs_points < s.nurbs_order)
    return c.fail(0,
                  "The point where the machine stands counts too; write more points or a smaller L",
                  "You must specify a number of control points at least equal to the order L = %d",
                  s.nurbs_order);
  feed_along(c, b, c.nurbs, s.nurbs_order);
  s.nurbs_points = 0;
  s.motion = -1;
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 50, 50, 1, kOrderMotion, cubic, letters("ijpq"), AxisUse::required},
    {'g', 51, 51, 1, kOrderMotion, quadratic, letters("ij"), AxisUse::required},
    {'g', 52, 52, 1, kOrderMotion, control_point, letters("pl"), AxisUse::optional},
    {'g', 53, 53, 1, kOrderMotion, end_of_nurbs, 0, AxisUse::optional},
};

}  // namespace

std::span<const CodeRow> spline_codes() { return kRows; }

}  // namespace kerf::interp
