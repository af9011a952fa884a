// weighted_sum: adds up the weights of the bits that are true.
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
struct Sums : hal::ChannelList {
  std::string_view sizes;
  [[nodiscard]] static hal::Name name(const hal::Builder&, std::size_t index) noexcept {
    return hal::numbered("wsum.#", index);
  }
};
Sums read_list(hal::Builder& b) noexcept {
  Sums out;
  out.sizes = b.arg("wsum_sizes", "", "Number of bits of each sum");
  out.size = hal::count_fields(out.sizes);
  if (out.size < 1 || out.size > 8) b.fail("wsum_sizes= must have a size for each of 1 to 8 sums");
  if (b.failed()) out.size = 0;
  return out;
}
}  // namespace

class WeightedSumChannel : public hal::Channel {
 public:
  WeightedSumChannel(hal::Builder& b, std::size_t index, const Sums& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view sizes = list.sizes;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(sizes);
    if (!hal::parse_count(hal::next_field(sizes), size_) || size_ < 1 || size_ > 16) {
      b.fail("wsum_sizes= must be a list of sizes from 1 to 16");
      size_ = 0;
    }
    for (std::size_t i = 0; i < size_; ++i) {
      hal::Name name = hal::numbered("bit.#", i), weight = name;
      name.append(".in");
      weight.append(".weight");
      bits_[i].declare(b, whole_name(name), "Bit of this number");
      weights_[i].declare(b, whole_name(weight), "What the bit adds to the sum",
                          static_cast<std::int32_t>(1U << i));
    }
  }

  void process(const hal::Period&) noexcept {
    if (hold_) return;
    std::int64_t sum = offset_;
    for (std::size_t i = 0; i < size_; ++i) {
      if (bits_[i]) sum += weights_[i];
    }
    sum_ = static_cast<std::int32_t>(sum);
  }

 private:
  hal::In<bool> hold_{pin<hal::In<bool>>("hold", "True keeps sum as it is")};
  hal::Out<std::int32_t> sum_{
      pin<hal::Out<std::int32_t>>("sum", "offset and the weights of all bits that are true")};
  hal::Io<std::int32_t> offset_{pin<hal::Io<std::int32_t>>("offset", "Added to the sum", 0)};
  hal::In<bool> bits_[16]{};
  hal::Io<std::int32_t> weights_[16]{};
  std::size_t size_{0};
};

class WeightedSum final : public hal::Component<WeightedSum> {
 public:
  static constexpr hal::Info kInfo{
      .name = "weighted-sum",
      .summary = "Adds up the weights of the bits that are true",
      .notes =
          "wsum_sizes= has the number of bits of each sum, at most 8 sums of up to 16 bits. The "
          "weights start as powers of two, which makes a number of the bits.",
      .singleton = true,
      .example = "wsum_sizes=4,2",
      .lists = "wsum_sizes",
      .own_names = true};
  explicit WeightedSum(hal::Builder& b) noexcept : Component(b) {
    const Sums list = read_list(b);
    channels_ = hal::make_array<WeightedSumChannel>(b, list.size, list);
  }

 private:
  hal::Array<WeightedSumChannel> channels_;

  void process(const hal::Period& period) noexcept {
    for (WeightedSumChannel& c : channels_) c.process(period);
  }
  hal::Function process_{
      function_named<&WeightedSum::process>("process_wsums", "Computes all sums")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::WeightedSum)
