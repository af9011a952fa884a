// threadtest: counts the calls of two functions.
#include "hal/component.hpp"

namespace kerf::components {

class Threadtest final : public hal::Component<Threadtest> {
 public:
  static constexpr hal::Info kInfo{.name = "threadtest",
                                   .summary = "Counts the calls of two functions",
                                   .notes = "For tests of the order and the rate of threads."};
  using Component::Component;

 private:
  hal::Out<std::uint32_t> count_{pin<hal::Out<std::uint32_t>>(
      "count", "Calls of increment since the last call of reset, and more")};

  void increment(const hal::Period&) noexcept { count_ = count_.last() + 1; }
  hal::Function increment_{function<&Threadtest::increment>("increment", "Adds one")};

  void reset(const hal::Period&) noexcept { count_ = 0U; }
  hal::Function reset_{function<&Threadtest::reset>("reset", "Sets the count to zero")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Threadtest)
