// time: clock of running time.
#include "hal/component.hpp"

namespace kerf::components {

class Time final : public hal::Component<Time> {
 public:
  static constexpr hal::Info kInfo{.name = "time",
                                   .summary = "Clock of running time",
                                   .notes =
                                       "It starts from zero as start becomes true, stands while "
                                       "pause is true, and keeps its last reading."};
  using Component::Component;

 private:
  hal::In<bool> start_{pin<hal::In<bool>>("start", "True lets the time run")};
  hal::In<bool> pause_{pin<hal::In<bool>>("pause", "True lets it stand", false)};
  hal::Out<std::uint32_t> seconds_{pin<hal::Out<std::uint32_t>>("seconds", "Seconds, 0 to 59")};
  hal::Out<std::uint32_t> minutes_{pin<hal::Out<std::uint32_t>>("minutes", "Minutes, 0 to 59")};
  hal::Out<std::uint32_t> hours_{pin<hal::Out<std::uint32_t>>("hours", "Hours")};
  bool before_{false};
  std::int64_t elapsed_ns_{0};

  void update(const hal::Period& period) noexcept {
    const bool start = start_;
    if (start && !before_) elapsed_ns_ = 0;
    before_ = start;
    if (start && !pause_) elapsed_ns_ += period.nominal_ns;
    const auto seconds = static_cast<std::uint32_t>(elapsed_ns_ / 1'000'000'000);
    seconds_ = seconds % 60;
    minutes_ = seconds / 60 % 60;
    hours_ = seconds / 3600;
  }
  hal::Function update_{function<&Time::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Time)
