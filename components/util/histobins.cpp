// histobins: histogram and statistics of a value.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Histobins final : public hal::Component<Histobins> {
 public:
  static constexpr hal::Info kInfo{
      .name = "histobins",
      .summary = "Histogram and statistics of a value",
      .notes =
          "Read availablebins, set minvalue, binsize and nbins, then step index through the bins "
          "and read binvalue once check shows the same index. The first value after a reset sets "
          "input-min and input-max and is in no bin. When an input breaks the rules input-error is "
          "set and counting stops. New limits of the bins start anew."};
  using Component::Component;

 private:
  hal::In<std::uint32_t> pintype_{pin<hal::In<std::uint32_t>>(
      "pintype", "Which input counts: 0 input, 1 input-s32, 2 input-u32, 3 input-bit")};
  hal::In<double> input_{pin<hal::In<double>>("input", "Float to count")};
  hal::In<std::int32_t> input_s32_{pin<hal::In<std::int32_t>>("input-s32", "Integer to count")};
  hal::In<std::uint32_t> input_u32_{
      pin<hal::In<std::uint32_t>>("input-u32", "Unsigned integer to count")};
  hal::In<bool> input_bit_{pin<hal::In<bool>>("input-bit", "Bit to count")};
  hal::In<std::uint32_t> nbins_{pin<hal::In<std::uint32_t>>("nbins", "Bins to use", 20)};
  hal::In<double> binsize_{pin<hal::In<double>>("binsize", "Width of a bin", 1)};
  hal::In<double> minvalue_{pin<hal::In<double>>("minvalue", "Lower end of the first bin", 0)};
  hal::In<std::int32_t> index_{pin<hal::In<std::int32_t>>("index", "Bin to show")};
  hal::Out<std::int32_t> check_{
      pin<hal::Out<std::int32_t>>("check", "The index that binvalue belongs to")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True starts anew")};
  hal::In<bool> method_{pin<hal::In<bool>>(
      "method", "False: running mean and variance, better for many samples; true: from sums")};
  hal::Out<bool> input_error_{
      pin<hal::Out<bool>>("input-error", "True: the settings break the rules")};
  hal::Out<double> binvalue_{
      pin<hal::Out<double>>("binvalue", "Count of the bin, -1 for an index out of range")};
  hal::Out<double> pextra_{pin<hal::Out<double>>("pextra", "Count of values above the last bin")};
  hal::Out<double> nextra_{pin<hal::Out<double>>("nextra", "Count of values below the first bin")};
  hal::Out<double> input_min_{pin<hal::Out<double>>("input-min", "Lowest value")};
  hal::Out<double> input_max_{pin<hal::Out<double>>("input-max", "Highest value")};
  hal::Out<std::uint32_t> nsamples_{pin<hal::Out<std::uint32_t>>("nsamples", "Number of values")};
  hal::Out<double> variance_{pin<hal::Out<double>>("variance", "Variance of the values")};
  hal::Out<double> mean_{pin<hal::Out<double>>("mean", "Mean of the values")};
  hal::Out<std::int32_t> availablebins_{
      pin<hal::Out<std::int32_t>>("availablebins", "Bins that there are", 200)};

  static constexpr std::uint32_t kBins = 200;
  void start() noexcept {
    for (double& bin : bins_) bin = 0.0;
    above_ = below_ = samples_ = sum_ = squares_ = running_squares_ = 0.0;
    mean_ = 0.0;
    variance_ = 0.0;
  }
  [[nodiscard]] double chosen() const noexcept {
    switch (pintype_.get()) {
      case 1: return input_s32_;
      case 2: return input_u32_;
      case 3: return input_bit_ ? 1.0 : 0.0;
      default: return input_;
    }
  }
  void count(double value, std::uint32_t bins) noexcept {
    if (value < input_min_.last()) input_min_ = value;
    if (value > input_max_.last()) input_max_ = value;
    samples_ += 1.0;
    if (!method_) {
      const double before = mean_.last();
      const double mean = before + (value - before) / samples_;
      running_squares_ += (value - before) * (value - mean);
      mean_ = mean;
      variance_ = running_squares_ / (samples_ - 1.0);
    } else {
      sum_ += value;
      squares_ += value * value;
      mean_ = sum_ / samples_;
      variance_ = (squares_ - sum_ * sum_ / samples_) / (samples_ - 1.0);
    }
    const double place = (value - minvalue_) / binsize_;
    if (value < minvalue_)
      below_ += 1.0;
    else if (place > bins)
      above_ += 1.0;
    else if (place < bins)
      bins_[static_cast<std::size_t>(place)] += 1.0;
  }
  double bins_[kBins]{};
  double above_{0.0}, below_{0.0}, samples_{0.0}, sum_{0.0}, squares_{0.0};
  double running_squares_{0.0};
  double old_size_{0.0}, old_min_{0.0};
  std::uint32_t old_bins_{0};
  bool first_{true};

  void update(const hal::Period&) noexcept {
    const std::int32_t index = index_;
    const std::uint32_t bins = nbins_;
    check_ = index;
    if (bins < 1 || bins > kBins || !(binsize_ > 0.0)) {
      input_error_ = true;
      return;
    }
    input_error_ = false;
    // Bins of other limits cannot be gone on with.
    if (reset_ || bins != old_bins_ || binsize_ != old_size_ || minvalue_ != old_min_)
      first_ = true;
    old_bins_ = bins;
    old_size_ = binsize_;
    old_min_ = minvalue_;
    if (first_) start();
    const double value = chosen();
    if (first_) {
      first_ = false;
      input_min_ = value;
      input_max_ = value;
      samples_ = 1.0;
    } else {
      count(value, bins);
    }
    nsamples_ = static_cast<std::uint32_t>(samples_);
    const bool in_range = index >= 0 && index < static_cast<std::int32_t>(bins);
    binvalue_ = in_range ? bins_[index] : -1.0;
    pextra_ = above_;
    nextra_ = below_;
  }
  hal::Function update_{function<&Histobins::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Histobins)
