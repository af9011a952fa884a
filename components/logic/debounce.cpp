// debounce: filters the bounce out of groups of switches.
#include "bounce_filter.hpp"
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
class Filter {
 public:
  Filter(hal::Builder& b, std::size_t index, const hal::Name& group) noexcept {
    hal::Name name = group;
    name.append(hal::numbered(".#", index));
    hal::Name in = name, out = name;
    in.append(".in");
    out.append(".out");
    in_.declare(b, in, "Input that bounces");
    out_.declare(b, out, "Input without bounces");
  }
  void update(std::int32_t delay) noexcept { filter_.update(in_, out_, delay); }

 private:
  hal::In<bool> in_;
  hal::Out<bool> out_;
  BounceFilter filter_;
};

struct Groups : hal::ChannelList {
  std::string_view sizes;
};
Groups read_list(hal::Builder& b) noexcept {
  Groups out;
  out.sizes = b.arg("cfg", "", "Number of filters of each group");
  out.size = hal::count_fields(out.sizes);
  if (out.size < 1 || out.size > 8) b.fail("cfg= must have a size for each of 1 to 8 groups");
  if (b.failed()) out.size = 0;
  return out;
}
}  // namespace

class DebounceChannel : public hal::Channel {
 public:
  DebounceChannel(hal::Builder& b, std::size_t index, const Groups& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view sizes = list.sizes;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(sizes);
    std::size_t size = 0;
    if (!hal::parse_count(hal::next_field(sizes), size) || size < 1 || size > 50) {
      b.fail("cfg= must be a list of sizes from 1 to 50");
      return;
    }
    filters_ = hal::make_array<Filter>(b, size, whole_name(""));
  }

 private:
  void update(const hal::Period&) noexcept {
    for (Filter& f : filters_) f.update(delay_);
  }

  hal::Param<std::int32_t> delay_{param<hal::Param<std::int32_t>>(
      "delay", "Calls for which an input must have a new value, and one more", 5)};
  hal::Array<Filter> filters_;

  hal::Function update_{
      function<DebounceChannel, &DebounceChannel::update>("", "Filters all inputs of the group")};
};

class Debounce final : public hal::Component<Debounce> {
 public:
  static constexpr hal::Info kInfo{
      .name = "debounce",
      .summary = "Filters the bounce out of groups of switches",
      .notes =
          "cfg= has the number of filters of each group, at most 8 groups of up to 50. A group has "
          "one delay. An input must be the other way for delay calls and one more; with a delay of "
          "0 nothing is filtered. dbounce has a delay for each filter.",
      .singleton = true,
      .example = "cfg=2,1",
      .lists = "cfg",
      .own_names = true};
  explicit Debounce(hal::Builder& b) noexcept : Component(b) {
    const Groups list = read_list(b);
    channels_ = hal::make_array<DebounceChannel>(b, list.size, list);
  }

 private:
  hal::Array<DebounceChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Debounce)
