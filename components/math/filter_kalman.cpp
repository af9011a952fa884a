// filter_kalman: kalman filter of one value.
#include "hal/component.hpp"

namespace kerf::components {

class FilterKalman final : public hal::Component<FilterKalman> {
 public:
  static constexpr hal::Info kInfo{.name = "filter-kalman",
                                   .summary = "Kalman filter of one value",
                                   .notes =
                                       "Rk and Qk must be found for each signal: the larger Rk "
                                       "against Qk, the smoother and slower is the output."};
  using Component::Component;

 private:
  hal::In<bool> debug_{pin<hal::In<bool>>(
      "debug", "Accepted for the files that set it; values are shown by halscope and sampler",
      false)};
  hal::In<bool> passthrough_{pin<hal::In<bool>>("passthrough", "True: xk-out is zk", false)};
  hal::In<bool> reset_{
      pin<hal::In<bool>>("reset", "True: the filter starts anew and xk-out is zero", false)};
  hal::In<double> zk_{pin<hal::In<double>>("zk", "Measured value")};
  hal::Out<double> xk_out_{pin<hal::Out<double>>("xk-out", "Estimated value")};
  hal::Param<double> rk_{
      param<hal::Param<double>>("Rk", "Variance of the measurement", 1.17549e-38)};
  hal::Param<double> qk_{param<hal::Param<double>>("Qk", "Variance of the process", 1.17549e-38)};
  double estimate_{0.0}, variance_{1.0}, gain_{0.0};

  void update(const hal::Period&) noexcept {
    if (reset_) {
      estimate_ = 0.0;
      variance_ = 1.0;
      gain_ = 0.0;
    } else if (passthrough_) {
      xk_out_ = zk_.get();
      return;
    } else {
      const double predicted = variance_ + qk_;
      gain_ = predicted / (predicted + rk_);
      estimate_ += gain_ * (zk_ - estimate_);
      variance_ = (1.0 - gain_) * predicted;
    }
    xk_out_ = estimate_;
  }
  hal::Function update_{
      function<&FilterKalman::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::FilterKalman)
