// mux_generic, and with KERF_DEMUX demux_generic: multiplexers of any size and type, and the other way round.

#include <type_traits>
#include "hal/channels.hpp"

#include "rtapi/base/limited.hpp"

namespace kerf::components {

namespace {
#ifdef KERF_DEMUX
constexpr bool kDemux = true;
#else
constexpr bool kDemux = false;
#endif
/// Type{} for a letter that is none.
hal::Type type_of(char letter) noexcept {
  switch (letter) {
    case 'b':
    case 'B': return hal::Type::bit;
    case 'f':
    case 'F': return hal::Type::floating;
    case 's':
    case 'S': return hal::Type::s32;
    case 'u':
    case 'U': return hal::Type::u32;
    default: return hal::Type{};
  }
}
const char* type_word(hal::Type type) noexcept {
  switch (type) {
    case hal::Type::bit: return "bit";
    case hal::Type::floating: return "float";
    case hal::Type::s32: return "s32";
    default: return "u32";
  }
}
// The pins of which one is selected, and the one on the other side.
using Choice = std::conditional_t<kDemux, hal::Out<std::uint64_t>, hal::In<std::uint64_t>>;
using Single = std::conditional_t<kDemux, hal::In<std::uint64_t>, hal::Out<std::uint64_t>>;
struct ChoicePin : Choice {
  ChoicePin(hal::Builder& b, std::size_t index, const hal::Name& prefix, hal::Type type) noexcept {
    hal::Name name = prefix;
    name.append(kDemux ? ".out-" : ".in-");
    name.append(type_word(type));
    name.append(hal::numbered("-##", index));
    declare(b, name,
            kDemux ? "The input while it is selected, else 0" : "Value while it is selected", 0,
            type);
  }
};
struct Configs : hal::ChannelList {
  std::string_view configs;
  [[nodiscard]] static hal::Name name(const hal::Builder&, std::size_t index) noexcept {
    return hal::numbered(kDemux ? "demux-gen.##" : "mux-gen.##", index);
  }
};
Configs read_list(hal::Builder& b) noexcept {
  Configs out;
  out.configs = b.arg("config", "",
                      kDemux ? "Types and number of outputs of each"
                             : "Types and number of inputs of each multiplexer");
  out.size = hal::count_fields(out.configs);
  if (out.size < 1) b.fail("config= is missing: types and number of each, like ff4,bu12");
  if (b.failed()) out.size = 0;
  return out;
}
class MuxGenericChannel : public hal::Channel {
 public:
  MuxGenericChannel(hal::Builder& b, std::size_t index, const Configs& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view configs = list.configs;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(configs);
    const std::string_view config = hal::next_field(configs);
    std::size_t letters = 0, size = 0;
    for (const char c : config) {
      if (c >= '0' && c <= '9') {
        size = size * 10 + static_cast<std::size_t>(c - '0');
        if (size > 1024) break;
        continue;
      }
      const hal::Type type = type_of(c);
      if (type == hal::Type{} && c != 'b' && c != 'B') letters = 9;
      (letters == 0 ? from_ : to_) = type;
      ++letters;
    }
    if (letters != 2 || size < 2 || size > 1024) {
      b.fail(
          "config= must have two of the letters b f s u and a number from 2 to 1024 for each, like "
          "ff4");
      return;
    }
    choices_ = hal::make_array<ChoicePin>(b, size, whole_name(""), kDemux ? to_ : from_);
    std::size_t bits = 0;
    while ((std::size_t{1} << bits) < size) ++bits;
    if ((std::size_t{1} << bits) == size) {
      for (std::size_t i = 0; i < bits; ++i)
        bits_.add(b, whole_name(hal::numbered("sel-bit-##", i)),
                  "Bit of the number that is selected");
    }
    const hal::Type type = kDemux ? from_ : to_;
    hal::Name name(kDemux ? "in-" : "out-");
    name.append(type_word(type));
    single_.declare(b, whole_name(name),
                    kDemux ? "Value for the selected output" : "The selected input", 0, type);
  }

 private:
  void update(const hal::Period& period) noexcept {
    std::uint64_t number = sel_int_;
    for (std::size_t i = 0; i < bits_.size(); ++i) number += std::uint64_t{bits_[i].get()} << i;
    if (suppress_no_input_ && number == 0) return;
    if (number != number_) {
      if (elapsed_.last() < debounce_us_) {
        elapsed_ = elapsed_.last() + period.seconds() * 1e6;
        return;
      }
      number_ = number;
    }
    elapsed_ = 0.0;
    if (number >= choices_.size()) number = choices_.size() - 1;
    pass(choices_, single_, number);
    selected_ = static_cast<std::int32_t>(number);
  }

  hal::In<bool> suppress_no_input_{pin<hal::In<bool>>(
      "suppress-no-input", "True: all stays what it is while nothing is selected")};
  hal::In<std::uint32_t> debounce_us_{pin<hal::In<std::uint32_t>>(
      "debounce-us", "Time for which the selection must differ from the one in use [us]")};
  hal::In<std::uint32_t> sel_int_{
      pin<hal::In<std::uint32_t>>("sel-int", "Number that is selected, added to that of the bits")};
  hal::RoParam<double> elapsed_{param<hal::RoParam<double>>(
      "elapsed", "Time for which another selection has been waiting [us]")};
  hal::RoParam<std::int32_t> selected_{
      param<hal::RoParam<std::int32_t>>("selected", "Number that is selected")};
  hal::PinArray<hal::In<bool>, 10> bits_;
  hal::Array<ChoicePin> choices_;
  Single single_;

  template <class Choices, class One>
  void pass(Choices& choices, One& single, std::size_t number) noexcept {
    if constexpr (kDemux) {
      choices[static_cast<std::size_t>(selected_.last())].set(0);
      choices[number].set(converted(single.get()));
    } else {
      single.set(converted(choices[number].get()));
    }
  }
  [[nodiscard]] std::uint64_t converted(std::uint64_t raw) const noexcept {
    double value = 0.0;
    switch (from_) {
      case hal::Type::bit: value = hal::from_raw<bool>(raw) ? 1.0 : 0.0; break;
      case hal::Type::floating: value = hal::from_raw<double>(raw); break;
      case hal::Type::s32: value = hal::from_raw<std::int32_t>(raw); break;
      default: value = hal::from_raw<std::uint32_t>(raw);
    }
    if (!(value == value)) value = 0.0;
    switch (to_) {
      case hal::Type::bit: return hal::to_raw<bool>(value != 0.0);
      case hal::Type::floating: return hal::to_raw<double>(value);
      case hal::Type::s32:
        // LinuxCNC limits a float to 2147483647 in both directions.
        return hal::to_raw<std::int32_t>(static_cast<std::int32_t>(rtapi::limited(
            value, from_ == hal::Type::floating ? -2147483647.0 : -2147483648.0, 2147483647.0)));
      default:
        return hal::to_raw<std::uint32_t>(
            static_cast<std::uint32_t>(rtapi::limited(value, 0.0, 4294967295.0)));
    }
  }
  hal::Type from_{hal::Type::floating}, to_{hal::Type::floating};
  std::uint64_t number_{0};

  hal::Function update_{function<MuxGenericChannel, &MuxGenericChannel::update>(
      "", "Copies the selected input to the output")};
};

class MuxGeneric final : public hal::Component<MuxGeneric> {
 public:
  static constexpr hal::Info kInfo{
      .name = kDemux ? "demux-generic" : "mux-generic",
      .summary =
          kDemux ? "Demultiplexers of any size and type" : "Multiplexers of any size and type",
      .notes = kDemux
                   ? "config= has for each demultiplexer the letters of the types of its input and "
                     "its outputs "
                     "(b bit, f float, s s32, u u32) and the number of outputs, up to 1024, as in "
                     "\"ff4,bu12\". "
                     "The bits and sel-int are added; a number past the last output is that of the "
                     "last. "
                     "Outputs that are not selected are 0. Values are brought to the type and the "
                     "range of the "
                     "outputs."
                   : "config= has for each multiplexer the letters of the types of its inputs and "
                     "its output "
                     "(b bit, f float, s s32, u u32) and the number of inputs, up to 1024, as in "
                     "\"ff4,bu12\". The bits and sel-int are added; a number past the last input "
                     "is that of "
                     "the last. Values are brought to the type and the range of the output.",
      .singleton = true,
      .example = "config=ff4,bu2",
      .lists = "config",
      .own_names = true};
  explicit MuxGeneric(hal::Builder& b) noexcept : Component(b) {
    const Configs list = read_list(b);
    channels_ = hal::make_array<MuxGenericChannel>(b, list.size, list);
  }

 private:
  hal::Array<MuxGenericChannel> channels_;
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::MuxGeneric)
