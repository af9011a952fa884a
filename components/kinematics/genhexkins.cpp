// genhexkins: hexapods: six struts from a base to a platform (manual: kins(9), "genhexkins").
#include <array>

#include "spheres.hpp"
#include "struts.hpp"
#include "switchable.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module
namespace hal = kerf::hal;

constexpr std::size_t kStruts = 6;
using Six = std::array<double, kStruts>;
using Number = hal::In<double>;
/// A pin that other programs read though LinuxCNC lists it as an input.
using Shown = hal::detail::Writing<double, hal::Dir::in, hal::PinCell>;

struct Geometry {
  double base[3], platform[3], base_n[3], platform_n[3];
};
constexpr Geometry kGeometry[kStruts]{
    {{-22.95, 13.25, 0}, {-1.0, 11.5, 0}, {0.707107, 0.0, 0.707107}, {-1.0, 0.0, 0.0}},
    {{22.95, 13.25, 0}, {1.0, 11.5, 0}, {0.0, -0.707107, 0.707107}, {0.866025, 0.5, 0.0}},
    {{22.95, 13.25, 0}, {10.459, -4.884, 0}, {-0.707107, 0.0, 0.707107}, {0.866025, 0.5, 0.0}},
    {{0, -26.5, 0}, {9.459, -6.616, 0}, {-0.707107, 0.0, 0.707107}, {0.866025, -0.5, 0.0}},
    {{0, -26.5, 0}, {-9.459, -6.616, 0}, {0.0, 0.707107, 0.707107}, {0.866025, -0.5, 0.0}},
    {{-22.95, 13.25, 0}, {-10.459, -4.884, 0}, {0.707107, 0.0, 0.707107}, {-1.0, 0.0, 0.0}}};

struct Vector {
  Vector(hal::Builder& b, std::string_view pattern, std::size_t n, std::string_view doc,
         const double (&value)[3]) noexcept
      : x(b, name(b, pattern, n, ".x"), doc, value[0]),
        y(b, name(b, pattern, n, ".y"), doc, value[1]),
        z(b, name(b, pattern, n, ".z"), doc, value[2]) {}
  static hal::Name name(hal::Builder& b, std::string_view pattern, std::size_t n,
                        std::string_view letter) noexcept {
    hal::Name whole = b.full_name(hal::numbered(pattern, n).view());
    whole.append(letter);
    return whole;
  }
  [[nodiscard]] Point at(double unit) const noexcept {
    return {x.get() * unit, y.get() * unit, z.get() * unit};
  }
  Number x, y, z;
};

struct Strut {
  Strut(hal::Builder& b, std::size_t n) noexcept
      : base(b, "base.#", n, "Strut's joint on the base", kGeometry[n].base),
        platform(b, "platform.#", n, "Strut's joint on the platform", kGeometry[n].platform),
        base_n(b, "base-n.#", n, "Axis of the cardanic joint on the base, of length 1",
               kGeometry[n].base_n),
        platform_n(b, "platform-n.#", n, "Axis of the cardanic joint on the platform, of length 1",
                   kGeometry[n].platform_n),
        correction(b, b.full_name(hal::numbered("correction.#", n).view()),
                   "What the turning of the strut adds to its length") {}
  Vector base, platform, base_n, platform_n;
  mutable hal::Out<double> correction;
};

class Hexapod final : public SwitchableModule<Hexapod> {
 public:
  static constexpr hal::Info kInfo{
      .name = "genhexkins",
      .summary = "Kinematics of hexapods: six struts from a base to a platform",
      .notes =
          "Joints 0 to 5 are the lengths of the struts. With screw-lead each length counts the "
          "turning of its screw between the cardanic joints too. Kind 1 of "
          "motion.switchkins-type is identity.",
      .singleton = true};
  explicit Hexapod(hal::Builder& b) noexcept
      : SwitchableModule(b, {.own = "xyzabc", .needed = "xyzabc", .identity = "xyzabc"}),
        strut_(hal::make_array<Strut>(b, kStruts)) {
    constexpr std::string_view kLetters = "xyzabc";
    for (std::size_t i = 0; i < kStruts; ++i) {
      hal::Name gui("skgui.");
      gui.append(kLetters.substr(i, 1));
      skgui_[i].declare(b, gui.view(), "Position, for programs that draw the machine");
      hal::declare_pin<Number>(b, b.full_name(kLetters.substr(i, 1)).view(), "Without effect");
    }
  }

  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    if (strut_.size() != kStruts) return false;
    Six wanted, at;
    double mean = 0;
    for (std::size_t i = 0; i < kStruts; ++i) {
      wanted[i] = joint[i];
      mean += joint[i] / kStruts;
      at[i] = world[i];
    }
    const StrutSearch search{mm(convergence_), mm(max_error_),
                             static_cast<std::int32_t>(limit_iterations_.get())};
    const auto length = [this](const Six& pose, Six& out) { lengths(pose, out, nullptr); };
    std::int32_t steps = 0;
    bool found = find_pose<kStruts>(length, wanted, at, search, steps);
    if (!found) {
      // Nobody knows where the platform is: level, above the base.
      at = {0, 0, strut_[0].base.at(1).z * unit() + 0.8 * mean, 0, 0, 0};
      found = find_pose<kStruts>(length, wanted, at, search, steps);
    }
    fail_ = !found;
    last_iterations_ = static_cast<std::uint32_t>(steps);
    if (!found) return false;
    if (static_cast<std::uint32_t>(steps) > max_iterations_.last())
      max_iterations_ = static_cast<std::uint32_t>(steps);
    for (std::size_t i = 0; i < kStruts; ++i) world[i] = at[i];
    Six now{};
    lengths(at, now, &strut_[0]);
    show(world);
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    if (strut_.size() != kStruts) return false;
    Six at, out{};
    for (std::size_t i = 0; i < kStruts; ++i) at[i] = world[i];
    lengths(at, out, nullptr);
    for (std::size_t i = 0; i < kStruts; ++i) {
      if (!std::isfinite(out[i])) return false;
      joint[i] = out[i];
    }
    return true;
  }
  void show(const Pose& world) const noexcept {
    for (std::size_t i = 0; i < kStruts; ++i) skgui_[i] = i < 3 ? world[i] / unit() : world[i];
  }

 private:
  /// `shown`: whose correction pins are set.
  void lengths(const Six& pose, Six& out, const Strut* shown) const noexcept {
    const Rotation turn = Rotation::of_abc(pose[3], pose[4], pose[5]);
    const auto turned = [&turn](const Point& p) {
      const auto& m = turn.m;
      return Point{m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z,
                   m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z,
                   m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z};
    };
    const double up = mm(spindle_offset_) + mm(tool_offset_), lead = mm(screw_lead_);
    for (std::size_t i = 0; i < kStruts; ++i) {
      const Strut& s = strut_[i];
      Point joint = s.platform.at(unit());
      joint.z += up;
      const Point end = turned(joint);
      const Point base = s.base.at(unit());
      const Point strut{pose[0] + end.x - base.x, pose[1] + end.y - base.y,
                        pose[2] - up + end.z - base.z};
      const double length = std::sqrt(dot(strut, strut));
      double more = 0;
      if (lead != 0) {
        const Point along = scaled(strut, 1 / length);
        const Point on_base = unit_of(cross(s.base_n.at(1), along));
        const Point on_platform = unit_of(cross(turned(s.platform_n.at(1)), along));
        const double sine_of = dot(cross(along, on_base), on_platform);
        more = lead * degrees_of(std::asin(std::fmax(-1.0, std::fmin(1.0, sine_of)))) / 360.0;
      }
      if (shown != nullptr) shown[i].correction = more / unit();
      out[i] = length + more;
    }
  }
  static Point unit_of(const Point& p) noexcept {
    const double length = std::sqrt(dot(p, p));
    return length > 0 ? scaled(p, 1 / length) : p;
  }

  hal::Array<Strut> strut_;
  Number spindle_offset_{
      pin<Number>("spindle-offset", "Added to the Z of all joints: moves the machine's origin")};
  Number tool_offset_{pin<Number>("tool-offset", "From the platform to the tip of the tool")};
  Number screw_lead_{
      pin<Number>("screw-lead", "Of the struts' screws, positive for right-handed ones; 0: none")};
  Number convergence_{pin<Number>("convergence-criterion",
                                  "Sum of length errors that the forward search ends with", 1e-9)};
  Number max_error_{
      pin<Number>("max-error", "Sum of length errors that ends the search in vain", 500.0)};
  hal::In<std::uint32_t> limit_iterations_{pin<hal::In<std::uint32_t>>(
      "limit-iterations", "Steps after which the search ends in vain", 120U)};
  // Shown, and no part of the computation; the motion controller asks for the forward kinematics in each cycle.
  mutable hal::Out<std::uint32_t> last_iterations_{
      pin<hal::Out<std::uint32_t>>("last-iterations", "Steps of the last search")};
  mutable hal::Out<std::uint32_t> max_iterations_{
      pin<hal::Out<std::uint32_t>>("max-iterations", "Most steps of a search so far")};
  mutable hal::Out<bool> fail_{pin<hal::Out<bool>>("fwd-kins-fail", "The last search was in vain")};
  mutable Shown skgui_[kStruts];
};

}  // namespace

KERF_HAL_MODULE(Hexapod)
