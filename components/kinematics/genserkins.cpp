// genserkins: any arm of six turning joints by its Denavit-Hartenberg parameters (manual: kins(9), "genserkins").
#include "kinematics_module.hpp"
#include "serial_arm.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

using Length = kerf::hal::Io<double>;

/// The pins of one link.
struct Link {
  Link(kerf::hal::Builder& b, int i, double a_default, double alpha_default,
       double d_default) noexcept
      : a(b, name(b, "A-", i), "Distance to the axis before, along its common normal", a_default),
        alpha(b, name(b, "ALPHA-", i), "Angle to the axis before, radians", alpha_default),
        d(b, name(b, "D-", i), "Distance along the joint's axis", d_default) {}
  static kerf::hal::Name name(kerf::hal::Builder& b, std::string_view letter, int i) noexcept {
    char suffix[16]{};
    std::size_t n = 0;
    for (const char c : letter) suffix[n++] = c;
    suffix[n] = static_cast<char>('0' + i);
    return b.full_name({suffix, n + 1});
  }
  Length a, alpha, d;
};

class Genser final : public SerialModule<Genser> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "genserkins",
      .summary = "Kinematics of arms with six turning joints, by Denavit-Hartenberg parameters",
      .notes =
          "The parameters are those of John J. Craig. Joints 0 to 5 turn; U V W are joints 6 to 8.",
      .singleton = true};
  explicit Genser(kerf::hal::Builder& b) noexcept : SerialModule(b, "xyzabcuvw") {}

  [[nodiscard]] SerialArm arm() const noexcept {
    SerialArm out;
    const Link* link[] = {&link0_, &link1_, &link2_, &link3_, &link4_, &link5_};
    for (int i = 0; i < SerialArm::kLinks; ++i) {
      out.a[i] = mm(link[i]->a);
      out.alpha_rad[i] = link[i]->alpha.get();
      out.d[i] = mm(link[i]->d);
    }
    return out;
  }
  [[nodiscard]] int most_steps() const noexcept { return static_cast<int>(max_iterations_.get()); }

 private:
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
};

}  // namespace

KERF_HAL_MODULE(Genser)
