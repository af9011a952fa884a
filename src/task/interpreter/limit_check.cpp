#include "task/interpreter/limit_check.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "task/api/number_text.hpp"

namespace kerf::task {
namespace {

constexpr double kOnLimit = 1e-6;  ///< mm, degrees: rounding
using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

LimitCheck::LimitCheck(TaskEnvironment& environment, const MachineSetup& setup,
                       const motion::MachineConfig& limits, interp::Interpreter& now,
                       const CanonState& from, int tool, int pocket)
    : setup_(setup),
      limits_(limits),
      canon_(list_, setup.tools),
      seek_({environment, (canon_.restore(from), canon_), list_, setup}, now, tool, pocket,
            SeekEnd::check),
      at_(from.position) {
  canon_.set_output_counts(motion::kMaxDigital, motion::kMaxAnalog);
  seek_.watch([this](const TaskItem& item) { look(item); });
}

bool LimitCheck::step() { return --blocks_left_ >= 0 && seek_.step() == ProgramSeek::Step::more; }

void LimitCheck::look(const TaskItem& item) {
  const auto* path = std::get_if<PathBody>(&item.body);
  if (path == nullptr) return;
  const auto straight = [&](const auto* move) {
    if (move == nullptr) return;
    look_at_place(at_, move->end, item.tag);
    at_ = move->end;
  };
  straight(std::get_if<motion::LinearMove>(path));
  straight(std::get_if<motion::SyncMove>(path));
  if (const auto* tap = std::get_if<motion::TapMove>(path)) look_at_place(at_, tap->end, item.tag);
  if (const auto* arc = std::get_if<motion::ArcMove>(path)) {
    look_at_arc(*arc, item.tag);
    at_ = arc->end;
  }
  if (const auto* cubic = std::get_if<motion::CubicMove>(path)) {
    look_at_cubic(*cubic, item.tag);
    at_ = cubic->end;
  }
}

/// Its ends, and where it is farthest out along each axis.
void LimitCheck::look_at_arc(const motion::ArcMove& arc, const motion::SourceTag& tag) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const Vector n{arc.normal[0], arc.normal[1], arc.normal[2]};
  const auto from_centre = [&](const rtapi::Pose& place, double& along) {
    Vector r{place.x - arc.centre[0], place.y - arc.centre[1], place.z - arc.centre[2]};
    along = dot(r, n);
    for (std::size_t i = 0; i < 3; ++i) r[i] -= along * n[i];
    return r;
  };
  double along = 0, along_end = 0;
  const Vector u = from_centre(at_, along), w = from_centre(arc.end, along_end);
  const Vector v = cross(n, u);
  const double radius = std::sqrt(dot(u, u)), radius_end = std::sqrt(dot(w, w));
  double angle = std::atan2(dot(w, v), dot(w, u));
  if (angle <= 1e-9) angle += kTurn;
  angle += kTurn * (arc.turns - 1);
  for (std::size_t i = 0; radius > 0 && i < 3; ++i) {
    // Extrema of the circle along this axis; of a helix or spiral they are as near as its pitch is small.
    for (double a = std::fmod(std::atan2(v[i], u[i]) + kTurn, kTurn / 2); a < angle;
         a += kTurn / 2) {
      const double part = a / angle;
      const double grown = 1 + (radius_end / radius - 1) * part;
      rtapi::Pose place = at_;
      for (std::size_t k = 0; k < rtapi::kAxes; ++k) place[k] += (arc.end[k] - at_[k]) * part;
      for (std::size_t k = 0; k < 3; ++k)
        place[k] = arc.centre[k] + n[k] * (along + (along_end - along) * part) +
                   grown * (u[k] * std::cos(a) + v[k] * std::sin(a));
      look_at_place(at_, place, tag);
    }
  }
  look_at_place(at_, arc.end, tag);
}

void LimitCheck::look_at_cubic(const motion::CubicMove& cubic, const motion::SourceTag& tag) {
  constexpr int kSamples = 8;  // such pieces bend little
  const double s = cubic.length;
  for (int n = 1; n <= kSamples; ++n) {
    const double t = s * n / kSamples;
    rtapi::Pose place;
    for (std::size_t k = 0; k < rtapi::kAxes; ++k) {
      const double rest = cubic.end[k] - at_[k] - cubic.first[k] * s - cubic.second[k] * s * s / 2;
      const double third = s > 0 ? 6 * rest / (s * s * s) : 0;
      place[k] = at_[k] + cubic.first[k] * t + cubic.second[k] * t * t / 2 + third * t * t * t / 6;
    }
    look_at_place(at_, n == kSamples ? cubic.end : place, tag);
  }
}

/// " (joint 0)", where a joint moves the axis alone.
std::string LimitCheck::joints_of(std::size_t axis) const {
  std::string out;
  for (std::size_t j = 0; j < static_cast<std::size_t>(limits_.joints); ++j)
    if (setup_.joint_axis[j] == static_cast<int>(axis))
      out += (out.empty() ? " (joint " : ", joint ") + std::to_string(j);
  return out.empty() ? out : out + ")";
}

void LimitCheck::look_at_place(const rtapi::Pose& from, const rtapi::Pose& place,
                               const motion::SourceTag& tag) {
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    if ((limits_.axis_mask >> a & 1U) == 0) continue;
    const motion::AxisConfig& limit = limits_.axis[a];
    const bool above = place[a] > std::max(limit.max_limit, from[a]) + kOnLimit;
    const bool below = place[a] < std::min(limit.min_limit, from[a]) - kOnLimit;
    const std::uint32_t bit = 1U << (2 * a + (above ? 1 : 0));
    if (!(above || below) || (told_ & bit) != 0) continue;
    told_ |= bit;
    const double unit = rtapi::is_rotary(a) ? setup_.angular_unit_deg : setup_.linear_unit_mm;
    const auto shown = [unit](double value) { return number(value / unit); };
    findings_.push_back(
        {seek_.interpreter().file_name(static_cast<std::uint32_t>(tag.file)), tag.line,
         std::string("this move would take axis ") + rtapi::kAxisLetters[a] + joints_of(a) +
             " to " + shown(place[a]) +
             (above ? ", above its MAX_LIMIT of " : ", below its MIN_LIMIT of ") +
             shown(above ? limit.max_limit : limit.min_limit) +
             "; found when the program was opened. Change the program or the work offset"});
  }
}

}  // namespace kerf::task
