// genserkins: any arm of six turning joints by its Denavit-Hartenberg parameters (manual: kins(9), "genserkins").
#include <array>

#include "serial_arm.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

using Length = kerf::hal::In<double>;
using Flag = kerf::hal::In<std::int32_t>;

/// The pins of one link.
struct Link {
  Link(kerf::hal::Builder& b, int i, double a_default, double alpha_default,
       double d_default) noexcept
      : a(b, name(b, "A-", i), "Distance to the axis before, along its common normal", a_default),
        alpha(b, name(b, "ALPHA-", i), "Angle to the axis before, radians", alpha_default),
        d(b, name(b, "D-", i), "Distance along the joint's axis", d_default),
        unrotate(b, name(b, "unrotate-", i),
                 "Turns of the joint before that this one's motor adds to its own angle", 0) {}
  static kerf::hal::Name name(kerf::hal::Builder& b, std::string_view letter, int i) noexcept {
    char suffix[16]{};
    std::size_t n = 0;
    for (const char c : letter) suffix[n++] = c;
    suffix[n] = static_cast<char>('0' + i);
    return b.full_name({suffix, n + 1});
  }
  Length a, alpha, d;
  Flag unrotate;
};

class Genser final : public SerialModule<Genser> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "genserkins",
      .summary = "Kinematics of arms with six turning joints, by Denavit-Hartenberg parameters",
      .notes =
          "The parameters are those of John J. Craig. Joints 0 to 5 turn; U V W are joints "
          "6 to 8. Kind 1 of motion.switchkins-type is identity.",
      .singleton = true};
  explicit Genser(kerf::hal::Builder& b) noexcept : SerialModule(b) {}

  [[nodiscard]] SerialArm arm() const noexcept {
    SerialArm out;
    const auto link = links();
    for (std::size_t i = 0; i < std::size(out.a); ++i) {
      out.a[i] = mm(link[i]->a);
      out.alpha_rad[i] = link[i]->alpha.get();
      out.d[i] = mm(link[i]->d);
    }
    return out;
  }
  /// What the motors' angles are for the joints', and back: a motor that sits N joints' turns before its joint.
  void to_joints(double (&angle)[SerialArm::kLinks]) const noexcept {
    const auto link = links();
    for (std::size_t i = 1; i < SerialArm::kLinks; ++i)
      angle[i] -= link[i]->unrotate.get() * angle[i - 1];
  }
  void to_motors(double (&angle)[SerialArm::kLinks]) const noexcept {
    const auto link = links();
    for (std::size_t i = SerialArm::kLinks - 1; i > 0; --i)
      angle[i] += link[i]->unrotate.get() * angle[i - 1];
  }
  void took(int steps) const noexcept { last_iterations_ = static_cast<std::uint32_t>(steps); }
  [[nodiscard]] int most_steps() const noexcept { return static_cast<int>(max_iterations_.get()); }

 private:
  [[nodiscard]] std::array<const Link*, SerialArm::kLinks> links() const noexcept {
    return {&link0_, &link1_, &link2_, &link3_, &link4_, &link5_};
  }
  static constexpr double kQuarter = std::numbers::pi / 2;
  // The arm without setp is a Puma 560, in mm.
  Link link0_{builder(), 0, 0, 0, 0};
  Link link1_{builder(), 1, 0, -kQuarter, 0};
  Link link2_{builder(), 2, 300, 0, 70};
  Link link3_{builder(), 3, 50, -kQuarter, 400};
  Link link4_{builder(), 4, 0, kQuarter, 0};
  Link link5_{builder(), 5, 0, -kQuarter, 0};
  kerf::hal::In<std::uint32_t> max_iterations_{pin<kerf::hal::In<std::uint32_t>>(
      "max-iterations", "Steps after which the inverse gives up", 100U)};
  // Shown, and no part of the computation.
  mutable kerf::hal::Out<std::uint32_t> last_iterations_{pin<kerf::hal::Out<std::uint32_t>>(
      "last-iterations", "Steps that the last inverse took", 0U)};
};

}  // namespace

KERF_HAL_MODULE(Genser)
