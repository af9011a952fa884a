// limit_axis: limits of an axis that depend on where it is.
#include "hal/component.hpp"

namespace kerf::components {

class LimitAxis final : public hal::Component<LimitAxis> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit-axis",
      .summary = "Limits of an axis that depend on where it is",
      .notes =
          "personality= is the number of ranges, 1 to 10 (default 1). A range is in force while it "
          "is enabled and fb lies within its min and max; min-output and max-output are then its "
          "limits, for the pins of a joint or axis that take limits. The range in force stays so "
          "while fb is within it, others beside it set error-range-overlap. Without any range "
          "error-no-range is true and the limits stay what they were.",
      .example = "personality=2"};

  explicit LimitAxis(hal::Builder& b) noexcept : Component(b) {
    if (b.personality() < 0 || b.personality() > 10)
      b.fail("personality= must be from 1 to 10: the number of ranges");
  }

 private:
  static std::size_t count() noexcept {
    return personality() > 0 && personality() <= 10 ? static_cast<std::size_t>(personality()) : 1;
  }
  hal::In<double> fb_{pin<hal::In<double>>("fb", "Position of the axis")};
  hal::PinArray<hal::In<bool>, 10> enable_{
      pins<hal::In<bool>, 10>("enable-##", count(), "True while this range may be used", true)};
  hal::PinArray<hal::In<double>, 10> min_{
      pins<hal::In<double>, 10>("min-##", count(), "Lowest position of this range", -1e99)};
  hal::PinArray<hal::In<double>, 10> max_{
      pins<hal::In<double>, 10>("max-##", count(), "Highest position of this range", 1e99)};
  hal::Out<double> min_output_{
      pin<hal::Out<double>>("min-output", "Lowest position of the range in force", -1e99)};
  hal::Out<double> max_output_{
      pin<hal::Out<double>>("max-output", "Highest position of the range in force", 1e99)};
  hal::Out<std::uint32_t> current_range_{
      pin<hal::Out<std::uint32_t>>("current-range", "Number of the range in force")};
  hal::Out<bool> error_no_range_{
      pin<hal::Out<bool>>("error-no-range", "True while fb is in no enabled range")};
  hal::Out<bool> error_range_overlap_{
      pin<hal::Out<bool>>("error-range-overlap", "True while fb is in more than one")};

  void update(const hal::Period&) noexcept {
    const double fb = fb_;
    const std::uint32_t before = current_range_.last();
    std::size_t found = 0;
    std::uint32_t range = before;
    for (std::size_t i = 0; i < min_.size(); ++i) {
      if (!enable_[i] || !(fb >= min_[i] && fb <= max_[i])) continue;
      if (found++ == 0 || i == before) range = static_cast<std::uint32_t>(i);
    }
    error_no_range_ = found == 0;
    error_range_overlap_ = found > 1;
    if (found == 0) return;
    current_range_ = range;
    min_output_ = min_[range];
    max_output_ = max_[range];
  }
  hal::Function update_{function<&LimitAxis::update>("", "Chooses the range")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::LimitAxis)
