// logic: gate with many inputs and the outputs that are asked for.
#include "hal/component.hpp"

namespace kerf::components {

class Logic final : public hal::Component<Logic> {
 public:
  static constexpr hal::Info kInfo{
      .name = "logic",
      .summary = "Gate with many inputs and the outputs that are asked for",
      .notes =
          "personality= is the number of inputs (2 to 16) plus 0x100 for the output and, 0x200 for "
          "or, 0x400 for xor, 0x800 for nand and 0x1000 for nor."};

  explicit Logic(hal::Builder& b) noexcept : Component(b), outputs_(b.personality()) {
    const auto make = [&](std::int64_t bit, hal::Out<bool>& out, std::string_view name,
                          std::string_view doc) {
      if ((outputs_ & bit) != 0) out.declare(b, b.full_name(name), doc);
    };
    make(kAnd, and_, "and", "True while all inputs are true");
    make(kOr, or_, "or", "True while at least one input is true");
    make(kXor, xor_, "xor", "True while an odd number of inputs is true");
    make(kNand, nand_, "nand", "False while all inputs are true");
    make(kNor, nor_, "nor", "False while at least one input is true");
  }

 private:
  static constexpr std::int64_t kAnd = 0x100, kOr = 0x200, kXor = 0x400, kNand = 0x800,
                                kNor = 0x1000;
  static std::size_t count() noexcept { return static_cast<std::size_t>(personality() & 0xff); }

  hal::PinArray<hal::In<bool>, 16> in_{pins<hal::In<bool>, 16>("in-##", count(), "Input")};
  hal::Out<bool> and_{}, or_{}, xor_{}, nand_{}, nor_{};

  void update(const hal::Period&) noexcept {
    std::size_t high = 0;
    for (std::size_t i = 0; i < in_.size(); ++i) high += std::size_t{in_[i].get()};
    const bool all = high == in_.size(), any = high > 0;
    if ((outputs_ & kAnd) != 0) and_ = all;
    if ((outputs_ & kOr) != 0) or_ = any;
    if ((outputs_ & kXor) != 0) xor_ = (high & 1U) != 0;
    if ((outputs_ & kNand) != 0) nand_ = !all;
    if ((outputs_ & kNor) != 0) nor_ = !any;
  }
  hal::Function update_{function<&Logic::update>("", "Computes the outputs from the inputs")};
  std::int64_t outputs_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Logic)
