// updown: counts up and down.
#include "hal/component.hpp"

namespace kerf::components {

class Updown final : public hal::Component<Updown> {
 public:
  static constexpr hal::Info kInfo{.name = "updown",
                                   .summary = "Counts up and down",
                                   .notes =
                                       "Each input counts at its rising edge. At the bounds wrap "
                                       "goes on at the other end, clamp stays."};
  using Component::Component;

 private:
  hal::In<bool> countup_{pin<hal::In<bool>>("countup", "A rising edge adds one")};
  hal::In<bool> countdown_{pin<hal::In<bool>>("countdown", "A rising edge takes one off")};
  hal::In<bool> reset_{
      pin<hal::In<bool>>("reset", "True sets the count to zero and keeps it there")};
  hal::Out<std::int32_t> count_{pin<hal::Out<std::int32_t>>("count", "The count")};
  hal::Param<bool> clamp_{
      param<hal::Param<bool>>("clamp", "True: count stays between min and max", false)};
  hal::Param<bool> wrap_{param<hal::Param<bool>>(
      "wrap", "True: past max count goes on from min, and the other way round", false)};
  hal::Param<std::int32_t> max_{
      param<hal::Param<std::int32_t>>("max", "Highest count with clamp or wrap", 0x7FFFFFFF)};
  hal::Param<std::int32_t> min_{
      param<hal::Param<std::int32_t>>("min", "Lowest count with clamp or wrap", 0)};

  struct Edge {
    bool before{true};  // what is true from the start has not risen
    bool rose(bool now) noexcept {
      const bool rising = now && !before;
      before = now;
      return rising;
    }
  };
  Edge up_, down_;

  void update(const hal::Period&) noexcept {
    std::int64_t count = count_.last();
    if (up_.rose(countup_)) ++count;
    if (down_.rose(countdown_)) --count;
    if (reset_) count = 0;
    if (wrap_) {
      if (count > max_)
        count = min_;
      else if (count < min_)
        count = max_;
    } else if (clamp_) {
      if (count > max_)
        count = max_;
      else if (count < min_)
        count = min_;
    }
    count_ = static_cast<std::int32_t>(count);
  }
  hal::Function update_{function<&Updown::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Updown)
