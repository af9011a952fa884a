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
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "While true the statistics start anew")};
  hal::Out<std::int32_t> out_{pin<hal::Out<std::int32_t>>("out", "Time since the last call [ns]")};
  hal::Out<std::int32_t> err_{pin<hal::Out<std::int32_t>>("err", "Sum of the differences [ns]", 0)};
  hal::Out<double> avg_err_{pin<hal::Out<double>>("avg-err", "Mean of the differences [ns]", 0.0)};

  static std::int32_t bounded(std::int64_t ns) noexcept {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(ns, INT32_MIN, INT32_MAX));
  }
  std::int64_t count_{0}, sum_{0}, most_{0}, shortest_{0}, longest_{0};

  void update(const hal::Period& period) noexcept {
    const std::int64_t elapsed = period.actual_ns, error = elapsed - period.nominal_ns;
    const std::int64_t size = error < 0 ? -error : error;
    const bool first = count_ == 0;
    if (reset_) {
      count_ = 0;
      sum_ = most_ = 0;
      shortest_ = longest_ = elapsed;
    } else if (first) {
      shortest_ = longest_ = elapsed;
    }
    ++count_;
    sum_ += error;
    most_ = std::max(most_, size);
    shortest_ = std::min(shortest_, elapsed);
    longest_ = std::max(longest_, elapsed);
    jitter_ = bounded(most_);
    current_jitter_ = bounded(size);
    current_error_ = bounded(error);
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
