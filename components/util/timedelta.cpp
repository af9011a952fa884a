// timedelta: times between the calls of a thread.
#include <algorithm>

#include "hal/component.hpp"

namespace kerf::components {

class Timedelta final : public hal::Component<Timedelta> {
 public:
  static constexpr hal::Info kInfo{.name = "timedelta",
                                   .summary = "Times between the calls of a thread",
                                   .notes = "In virtual time there is no jitter."};
  using Component::Component;

 private:
  hal::Out<std::int32_t> jitter_{pin<hal::Out<std::int32_t>>(
      "jitter", "Largest difference between the time since the last call and the period [ns]", 0)};
  hal::Out<std::int32_t> current_jitter_{
      pin<hal::Out<std::int32_t>>("current-jitter", "Size of the difference at this call [ns]", 0)};
  hal::Out<std::int32_t> current_error_{pin<hal::Out<std::int32_t>>(
      "current-error", "Difference at this call, above zero when it came late [ns]", 0)};
  hal::Out<std::int32_t> min_ns_{
      pin<hal::Out<std::int32_t>>("min", "Shortest time between two calls [ns]", 0)};
  hal::Out<std::int32_t> max_ns_{
      pin<hal::Out<std::int32_t>>("max", "Longest time between two calls [ns]", 0)};
  hal::In<bool> reset_{pin<hal::In<bool>>(
      "reset", "True clears jitter, max and out, and min at the next call; err and avg-err go on")};
  hal::Out<std::int32_t> out_{pin<hal::Out<std::int32_t>>("out", "Time since the last call [ns]")};
  hal::Out<std::int32_t> err_{pin<hal::Out<std::int32_t>>("err", "Sum of the differences [ns]", 0)};
  hal::Out<double> avg_err_{pin<hal::Out<double>>("avg-err", "Mean of the differences [ns]", 0.0)};

  static std::int32_t bounded(std::int64_t ns) noexcept {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(ns, INT32_MIN, INT32_MAX));
  }
  std::int64_t count_{1}, sum_{0}, most_{0}, shortest_{0}, longest_{0};
  bool measures_{false};  ///< there was a call before, and no reset since
  bool fresh_{true};      ///< no time yet since the start or the reset

  void update(const hal::Period& period) noexcept {
    if (measures_) measure(period.actual_ns, period.nominal_ns);
    measures_ = !reset_;
    if (!reset_) return;
    most_ = shortest_ = longest_ = 0;
    fresh_ = true;
    jitter_ = 0;
    max_ns_ = 0;
    out_ = 0;
  }
  void measure(std::int64_t elapsed, std::int64_t nominal) noexcept {
    const std::int64_t error = elapsed - nominal, size = error < 0 ? -error : error;
    ++count_;
    sum_ += error;
    shortest_ = fresh_ ? elapsed : std::min(shortest_, elapsed);
    longest_ = fresh_ ? elapsed : std::max(longest_, elapsed);
    most_ = std::max(most_, size);
    // The first time after a start says nothing yet of the thread's regularity.
    if (!fresh_) {
      jitter_ = bounded(most_);
      current_jitter_ = bounded(size);
      current_error_ = bounded(error);
    }
    fresh_ = false;
    min_ns_ = bounded(shortest_);
    max_ns_ = bounded(longest_);
    out_ = bounded(elapsed);
    err_ = bounded(sum_);
    avg_err_ = static_cast<double>(sum_) / static_cast<double>(count_);
  }
  hal::Function update_{function<&Timedelta::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Timedelta)
