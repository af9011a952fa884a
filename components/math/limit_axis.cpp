// limit_axis: limits of an axis that depend on where another one is.
#include "hal/component.hpp"

namespace kerf::components {

class LimitAxis final : public hal::Component<LimitAxis> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit-axis",
      .summary = "Limits of an axis that depend on where another one is",
      .notes =
          "personality= is the number of ranges, 1 to 10 (default 1). A range may be in force "
          "while "
          "it is enabled and fb lies between its min-range and max-range, both included; "
          "min-output and max-output are then its limits. Of several the one with the least number "
          "is in force, but one that is sticky stays so while fb is within it. Without any range "
          "error-no-range is true and the limits stay what they were; a range whose max-limit is "
          "below its min-limit is never in force.",
      .example = "personality=2"};

  explicit LimitAxis(hal::Builder& b) noexcept : Component(b) {
    if (b.personality() < 0 || b.personality() > 10)
      b.fail("personality= must be from 1 to 10: the number of ranges");
  }

 private:
  static constexpr std::size_t kMost = 10;
  using Numbers = hal::PinArray<hal::In<double>, kMost>;
  using Switches = hal::PinArray<hal::In<bool>, kMost>;
  using Errors = hal::PinArray<hal::Out<bool>, kMost>;

  static std::size_t count() noexcept {
    return personality() > 0 && personality() <= 10 ? static_cast<std::size_t>(personality()) : 1;
  }
  hal::Out<bool> error_no_range_{
      pin<hal::Out<bool>>("error-no-range", "True while fb is in no enabled range")};
  hal::Out<double> min_output_{
      pin<hal::Out<double>>("min-output", "Lowest position of the range in force")};
  hal::Out<double> max_output_{
      pin<hal::Out<double>>("max-output", "Highest position of the range in force")};
  hal::In<double> fb_{pin<hal::In<double>>("fb", "Position that chooses the range")};
  hal::Out<std::uint32_t> current_range_{
      pin<hal::Out<std::uint32_t>>("current-range", "Number of the range in force")};
  Numbers min_limit_{pins<hal::In<double>, kMost>(
      "min-limit-##", count(), "Lowest position allowed while range ## is in force")};
  Numbers max_limit_{pins<hal::In<double>, kMost>(
      "max-limit-##", count(), "Highest position allowed while range ## is in force")};
  Numbers min_range_{pins<hal::In<double>, kMost>("min-range-##", count(), "Least fb of range ##")};
  Numbers max_range_{
      pins<hal::In<double>, kMost>("max-range-##", count(), "Greatest fb of range ##")};
  Switches enable_{
      pins<hal::In<bool>, kMost>("enable-##", count(), "True while range ## may be used")};
  Switches sticky_{pins<hal::In<bool>, kMost>(
      "sticky-##", count(), "True: once in force, range ## stays so until fb leaves it")};
  Errors error_range_{pins<hal::Out<bool>, kMost>(
      "error-range-##", count(),
      "True while fb is in no enabled range, or max-range-## is not above min-range-##", true)};
  Errors error_limit_{pins<hal::Out<bool>, kMost>(
      "error-limit-##", count(), "True while max-limit-## is not above min-limit-##", true)};

  [[nodiscard]] bool holds(std::size_t i, double fb) const noexcept {
    return enable_[i] && fb >= min_range_[i] && fb <= max_range_[i] &&
           max_limit_[i] >= min_limit_[i];
  }
  void update(const hal::Period&) noexcept {
    const double fb = fb_;
    const std::size_t size = enable_.size();
    std::size_t range = current_range_.last();
    const bool stays = in_force_ && range < size && sticky_[range] && holds(range, fb);
    if (!stays)
      for (range = 0; range < size && !holds(range, fb);) ++range;
    in_force_ = range < size;
    error_no_range_ = !in_force_;
    for (std::size_t i = 0; i < size; ++i) {
      error_range_[i] = !in_force_ || !(max_range_[i] > min_range_[i]);
      error_limit_[i] = !(max_limit_[i] > min_limit_[i]);
    }
    if (!in_force_) return;
    current_range_ = static_cast<std::uint32_t>(range);
    min_output_ = min_limit_[range];
    max_output_ = max_limit_[range];
  }
  hal::Function update_{function<&LimitAxis::update>("", "Chooses the range")};
  bool in_force_{false};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::LimitAxis)
