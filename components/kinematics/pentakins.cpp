// pentakins: pentapods: five struts from a base to rings on the tool's axis (manual: kins(9), "pentakins").
#include <array>

#include "spheres.hpp"
#include "struts.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module
namespace hal = kerf::hal;

constexpr std::size_t kStruts = 5;
using Five = std::array<double, kStruts>;
using Setting = hal::Param<double>;

struct Geometry {
  double base[3], r, z;
};
constexpr Geometry kGeometry[kStruts]{{{-418.03, 324.56, 895.56}, 80.32, -185.50},
                                      {{417.96, 324.56, 895.56}, 80.32, -159.50},
                                      {{-418.03, -325.44, 895.56}, 80.32, -67.50},
                                      {{417.96, -325.44, 895.56}, 80.32, -41.50},
                                      {{-0.06, -492.96, 895.56}, 80.32, -14.00}};

struct Strut {
  Strut(hal::Builder& b, std::size_t n) noexcept
      : x(b, name(b, "base.#", n, ".x"), "Strut's joint on the base", kGeometry[n].base[0]),
        y(b, name(b, "base.#", n, ".y"), "Strut's joint on the base", kGeometry[n].base[1]),
        z(b, name(b, "base.#", n, ".z"), "Strut's joint on the base", kGeometry[n].base[2]),
        ring_r(b, name(b, "effector.#", n, ".r"), "Radius of the strut's ring", kGeometry[n].r),
        ring_z(b, name(b, "effector.#", n, ".z"), "Place of the ring on the tool's axis",
               kGeometry[n].z) {}
  static hal::Name name(hal::Builder& b, std::string_view pattern, std::size_t n,
                        std::string_view letter) noexcept {
    hal::Name whole = b.full_name(hal::numbered(pattern, n).view());
    whole.append(letter);
    return whole;
  }
  Setting x, y, z, ring_r, ring_z;
};

class Pentapod final : public KinematicsModule<Pentapod> {
 public:
  static constexpr hal::Info kInfo{
      .name = "pentakins",
      .summary = "Kinematics of pentapods: five struts from a base to rings on the tool's axis",
      .notes = "Joints 0 to 4 are the lengths of the struts.",
      .singleton = true};
  explicit Pentapod(hal::Builder& b) noexcept
      : KinematicsModule(b, "xyzab"), strut_(hal::make_array<Strut>(b, kStruts)) {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    if (strut_.size() != kStruts) return false;
    Five wanted, at;
    double mean = 0, base = 0;
    for (std::size_t i = 0; i < kStruts; ++i) {
      wanted[i] = joint[i];
      mean += joint[i] / kStruts;
      base += strut_[i].z.get() * unit() / kStruts;
      at[i] = world[i];
    }
    const StrutSearch search{mm(convergence_), mm(max_error_),
                             static_cast<std::int32_t>(limit_iterations_.get())};
    const auto length = [this](const Five& pose, Five& out) { lengths(pose, out); };
    std::int32_t steps = 0;
    bool found = find_pose<kStruts>(length, wanted, at, search, steps);
    if (!found) {
      // Nobody knows where the tool is: upright, below the base.
      at = {0, 0, base - 0.85 * mean, 0, 0};
      const StrutSearch wide{search.good_mm, std::fmax(search.bad_mm, 5 * mean), search.most};
      found = find_pose<kStruts>(length, wanted, at, wide, steps);
    }
    last_iterations_ = static_cast<std::uint32_t>(steps);
    if (!found) return false;
    if (static_cast<std::uint32_t>(steps) > max_iterations_.last())
      max_iterations_ = static_cast<std::uint32_t>(steps);
    for (std::size_t i = 0; i < kStruts; ++i) world[i] = at[i];
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    if (strut_.size() != kStruts) return false;
    Five at, out{};
    for (std::size_t i = 0; i < kStruts; ++i) at[i] = world[i];
    lengths(at, out);
    for (std::size_t i = 0; i < kStruts; ++i) {
      if (!std::isfinite(out[i])) return false;
      joint[i] = out[i];
    }
    return true;
  }

 private:
  /// A ring turns freely, so its joint is on the side of the base's joint.
  void lengths(const Five& pose, Five& out) const noexcept {
    const double sa = sine(pose[3]), ca = cosine(pose[3]), sb = sine(pose[4]), cb = cosine(pose[4]);
    const double tool = mm(tool_offset_);
    for (std::size_t i = 0; i < kStruts; ++i) {
      const Strut& s = strut_[i];
      const double k = unit();
      const Point way{s.x.get() * k - pose[0], s.y.get() * k - pose[1],
                      s.z.get() * k - pose[2] + tool};
      // As the tool sees it, which turns by A about X and then by B about Y.
      const double x = cb * way.x - sb * way.z, level = sb * way.x + cb * way.z;
      const double y = ca * way.y + sa * level, z = ca * level - sa * way.y;
      out[i] = std::hypot(std::hypot(x, y) - s.ring_r.get() * k, z - s.ring_z.get() * k - tool);
    }
  }

  hal::Array<Strut> strut_;
  hal::In<double> tool_offset_{
      pin<hal::In<double>>("tool-offset", "From the effector to the tip of the tool")};
  hal::Io<double> convergence_{pin<hal::Io<double>>(
      "convergence-criterion", "Sum of length errors that the forward search ends with", 1e-9)};
  hal::Io<double> max_error_{pin<hal::Io<double>>(
      "max-error", "Sum of length errors that ends the search in vain", 100.0)};
  hal::Io<std::uint32_t> limit_iterations_{pin<hal::Io<std::uint32_t>>(
      "limit-iterations", "Steps after which the search ends in vain", 120U)};
  // Shown, and no part of the computation; the motion controller asks for the forward kinematics in each cycle.
  mutable hal::Out<std::uint32_t> last_iterations_{
      pin<hal::Out<std::uint32_t>>("last-iterations", "Steps of the last search")};
  mutable hal::Out<std::uint32_t> max_iterations_{
      pin<hal::Out<std::uint32_t>>("max-iterations", "Most steps of a search so far")};
};

}  // namespace

KERF_HAL_MODULE(Pentapod)
