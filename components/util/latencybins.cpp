// latencybins: histogram of the lateness of a thread.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hal/component.hpp"

namespace kerf::components {

class Latencybins final : public hal::Component<Latencybins> {
 public:
  static constexpr hal::Info kInfo{
      .name = "latencybins",
      .summary = "Histogram of the lateness of a thread",
      .notes =
          "Set maxbinnumber and nsbinsize, then step index from 0 to maxbinnumber and read the two "
          "bins once check shows the same index. In virtual time there is no lateness."};
  using Component::Component;

 private:
  hal::In<std::int32_t> maxbinnumber_{
      pin<hal::In<std::int32_t>>("maxbinnumber", "Bins on each side", 1000)};
  hal::In<std::int32_t> index_{pin<hal::In<std::int32_t>>("index", "Bin to show")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True starts anew")};
  hal::In<std::int32_t> nsbinsize_{pin<hal::In<std::int32_t>>("nsbinsize", "Width of a bin [ns]")};
  hal::Out<std::int32_t> check_{
      pin<hal::Out<std::int32_t>>("check", "The index that the bins belong to")};
  hal::Out<std::int32_t> latency_{
      pin<hal::Out<std::int32_t>>("latency", "Time since the last call minus the period [ns]")};
  hal::Out<std::int32_t> latency_max_{pin<hal::Out<std::int32_t>>(
      "latency-max", "Highest latency since the start or the reset [ns]")};
  hal::Out<std::int32_t> latency_min_{pin<hal::Out<std::int32_t>>(
      "latency-min", "Lowest latency since the start or the reset [ns]")};
  hal::Out<std::int32_t> pbinvalue_{pin<hal::Out<std::int32_t>>(
      "pbinvalue", "Count of the bin on the late side, -1 for an index out of range")};
  hal::Out<std::int32_t> nbinvalue_{pin<hal::Out<std::int32_t>>(
      "nbinvalue", "Count of the bin on the early side, -1 for an index out of range")};
  hal::Out<std::int32_t> pextra_{
      pin<hal::Out<std::int32_t>>("pextra", "Count of calls later than the last bin")};
  hal::Out<std::int32_t> nextra_{
      pin<hal::Out<std::int32_t>>("nextra", "Count of calls earlier than the last bin")};
  hal::Out<std::int32_t> variance_{pin<hal::Out<std::int32_t>>(
      "variance", "Variance of the latency [ns^2], of use while no latency is above 46340 ns")};
  hal::Out<std::int32_t> availablebins_{
      pin<hal::Out<std::int32_t>>("availablebins", "Bins that there are on each side", 1000)};

  static constexpr std::int64_t kBins = 1000;
  static std::int32_t bounded(std::int64_t ns) noexcept {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(ns, INT32_MIN, INT32_MAX));
  }
  void start() noexcept {
    for (std::int64_t i = 0; i <= kBins; ++i) early_[i] = late_[i] = 0;
    above_ = below_ = 0;
    samples_ = 0;
    sum_ = squares_ = 0;
    latency_ = 0;
    latency_max_ = INT32_MIN;
    latency_min_ = INT32_MAX;
  }
  std::int32_t early_[kBins + 1]{}, late_[kBins + 1]{};
  std::int32_t above_{0}, below_{0};
  std::int64_t samples_{0}, sum_{0}, squares_{0};
  bool first_{true};

  void update(const hal::Period& period) noexcept {
    const std::int32_t index = index_;
    check_ = index;
    if (reset_ || first_) {
      first_ = false;
      start();
    } else {
      count(period.actual_ns - period.nominal_ns);
    }
    const bool in_range = index >= 0 && index <= last_bin();
    pbinvalue_ = in_range ? late_[index] : -1;
    nbinvalue_ = in_range ? early_[index] : -1;
    pextra_ = above_;
    nextra_ = below_;
  }
  [[nodiscard]] std::int64_t last_bin() const noexcept {
    return std::clamp<std::int64_t>(maxbinnumber_, 0, kBins);
  }
  void count(std::int64_t late) noexcept {
    const std::int64_t width = std::max<std::int64_t>(nsbinsize_, 1);
    latency_ = bounded(late);
    latency_max_ = std::max(latency_max_.last(), bounded(late));
    latency_min_ = std::min(latency_min_.last(), bounded(late));
    const std::int64_t bin = (late < 0 ? -late : late) / width;
    const bool early = late < 0 && bin > 0;  // the middle bin is one
    if (bin > last_bin())
      ++(early ? below_ : above_);
    else
      ++(early ? early_ : late_)[bin];
    ++samples_;
    // As in LinuxCNC each square is kept in 32 bits, and what may have become negative by that is divided unsigned.
    const std::int64_t value = bounded(late);
    sum_ += value;
    squares_ += static_cast<std::int32_t>(value * value);
    if (samples_ > 1)
      variance_ =
          static_cast<std::int32_t>(static_cast<std::uint64_t>(squares_ - sum_ * sum_ / samples_) /
                                    static_cast<std::uint64_t>(samples_ - 1));
  }
  hal::Function update_{function<&Latencybins::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Latencybins)
