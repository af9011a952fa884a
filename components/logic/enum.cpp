// enum: numbers with names.
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
struct Lists : hal::ChannelList {
  std::string_view enums;
};
constexpr const char* kWanted =
    "enums= must have for each: E or D, then the names from 0 on, as in D;OFF;SLOW;;FAST";

Lists read_lists(hal::Builder& b) noexcept {
  Lists out;
  out.enums = b.arg("enums", "", "E (bits to a number) or D (a number to bits), and the names");
  const std::size_t size = hal::count_fields(out.enums);
  if (size < 1) b.fail(kWanted);
  static_cast<hal::ChannelList&>(out) = hal::channels_of(b, size);
  return out;
}
/// The list of the channel of this number.
std::string_view list_of(std::string_view enums, std::size_t index) noexcept {
  for (std::size_t i = 0; i < index; ++i) hal::next_field(enums);
  return hal::next_field(enums);
}
bool is_decoder(std::string_view list) noexcept {
  return list.starts_with("D") || list.starts_with("d");
}
/// The number of the name at `index` among those that are there, and the name.
std::size_t place_of(std::string_view list, std::size_t index, std::string_view& name) noexcept {
  hal::next_field(list, ';');
  std::size_t number = 0;
  for (;; ++number) {
    name = hal::next_field(list, ';');
    if (!name.empty() && index-- == 0) return number;
  }
}

struct Entry {
  Entry(hal::Builder& b, std::size_t index, const hal::Name& prefix,
        std::string_view list) noexcept {
    std::string_view label;
    const auto number = static_cast<std::uint32_t>(place_of(list, index, label));
    const auto name = [&](const char* ending) {
      hal::Name whole = prefix;
      whole.append(".");
      whole.append(label);
      whole.append(ending);
      return whole;
    };
    value.declare(b, name("-val"), "The number that has this name", number);
    if (is_decoder(list))
      out.declare(b, name("-out"), "True while the input is this number");
    else
      in.declare(b, name("-in"), "True asks for this number");
  }
  hal::In<std::uint32_t> value;
  hal::In<bool> in;
  hal::Out<bool> out;
};

class EnumChannel : public hal::Channel {
 public:
  EnumChannel(hal::Builder& b, std::size_t index, const Lists& lists) noexcept
      : Channel(b, name_of(b, index, lists)), decodes_(is_decoder(list_of(lists.enums, index))) {
    const std::string_view list = list_of(lists.enums, index);
    std::string_view rest = list;
    const std::string_view kind = hal::next_field(rest, ';');
    std::size_t names = 0;
    while (!rest.empty()) names += hal::next_field(rest, ';').empty() ? 0 : 1;
    if (kind.size() != 1 || (!decodes_ && kind != "E" && kind != "e") || names < 1) {
      b.fail(kWanted);
      return;
    }
    if (decodes_)
      input_.declare(b, whole_name("input"), "The number");
    else
      output_.declare(b, whole_name("output"), "The number of the input that is true, else 0");
    entries_ = hal::make_array<Entry>(b, names, whole_name(""), list);
  }

 private:
  static hal::Name name_of(const hal::Builder& b, std::size_t index, const Lists& lists) noexcept {
    if (!lists.names.empty()) return lists.name(b, index);
    return hal::numbered(
        is_decoder(list_of(lists.enums, index)) ? "enum-decode.##" : "enum-encode.##", index);
  }
  void update(const hal::Period&) noexcept {
    if (decodes_) {
      const std::uint32_t input = input_;
      for (Entry& e : entries_) e.out = input == e.value;
      return;
    }
    std::uint32_t output = 0;
    for (Entry& e : entries_)
      if (e.in) output = e.value;
    output_ = output;
  }
  bool decodes_;
  hal::In<std::uint32_t> input_;
  hal::Out<std::uint32_t> output_;
  hal::Array<Entry> entries_;
  hal::Function update_{
      function<EnumChannel, &EnumChannel::update>("", "Computes the outputs from the inputs")};
};

class Enum final : public hal::Component<Enum> {
 public:
  static constexpr hal::Info kInfo{
      .name = "enum",
      .summary = "Numbers with names, to bits and back",
      .notes =
          "enums= has a list for each: E makes a number of bits, D bits of a number; the names "
          "that "
          "follow stand for 0, 1, 2 and so on, and an empty one is left out, as in "
          "\"D;OFF;SLOW;;FAST\". The pins -val may give them other numbers. Of several inputs "
          "of E that are true the last counts; none gives 0. names= gives other names than "
          "enum-decode.00 and enum-encode.01.",
      .singleton = true,
      .example = "enums=D;OFF;ON,E;STOP;GO",
      .lists = "enums",
      .own_names = true};
  explicit Enum(hal::Builder& b) noexcept : Component(b) {
    const Lists lists = read_lists(b);
    channels_ = hal::make_array<EnumChannel>(b, lists.size, lists);
  }

 private:
  hal::Array<EnumChannel> channels_;
};
}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Enum)
