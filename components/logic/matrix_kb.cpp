// matrix_kb: keys of a matrix keyboard as pins.
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
struct Key : hal::Out<bool> {
  Key(hal::Builder& b, std::size_t index, const hal::Name& prefix, std::size_t columns) noexcept {
    hal::Name name = prefix;
    name.append(hal::numbered(".key.r#", index / columns));
    name.append(hal::numbered("c#", index % columns));
    declare(b, name, "True while this key is down");
  }
};
struct Configs : hal::ChannelList {
  std::string_view configs;
  [[nodiscard]] hal::Name name(const hal::Builder& b, std::size_t index) const noexcept {
    return names.empty() ? hal::numbered("matrix_kb.#", index) : ChannelList::name(b, index);
  }
};
Configs read_list(hal::Builder& b) noexcept {
  Configs out;
  out.configs = b.arg("config", "", "Rows and columns of each keyboard, like 4x8 or 4x4s");
  const std::size_t size = hal::count_fields(out.configs);
  if (size < 1) b.fail("config= is missing: rows and columns of each keyboard, like 4x8");
  static_cast<hal::ChannelList&>(out) = hal::channels_of(b, size);
  return out;
}
}  // namespace

class MatrixKbChannel : public hal::Channel {
 public:
  MatrixKbChannel(hal::Builder& b, std::size_t index, const Configs& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view configs = list.configs;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(configs);
    std::string_view config = hal::next_field(configs);
    scans_ = !config.empty() && (config.back() == 's' || config.back() == 'S');
    if (scans_) config.remove_suffix(1);
    std::size_t rows = 0, columns = 0;
    const std::string_view first =
        hal::next_field(config, config.find('X') == std::string_view::npos ? 'x' : 'X');
    if (!hal::parse_count(first, rows) || !hal::parse_count(config, columns) || rows < 1 ||
        columns < 1 || rows > 32 || columns > 32) {
      b.fail("config= must be a list like 4x8 or 4x4s: rows and columns from 1 to 32");
      return;
    }
    if (scans_) {
      code_out_.declare(b, whole_name("keycode"),
                        "Code of the key that has changed in this call, 0x40 when none has");
      negative_.declare(b, whole_name("negative-logic"), "True: a key pulls its column low", true);
      for (std::size_t i = 0; i < rows; ++i)
        rows_.add(b, whole_name(hal::numbered("row-##-out", i)), "Drives this row of keys");
      for (std::size_t i = 0; i < columns; ++i)
        columns_.add(b, whole_name(hal::numbered("col-##-in", i)), "Reads this column of keys");
    } else {
      code_in_.declare(b, whole_name("keycode"), "Code from the card");
    }
    while (std::size_t{1} << row_shift_ < columns) ++row_shift_;
    width_ = columns;
    keys_ = hal::make_array<Key>(b, rows * columns, whole_name(""), columns);
  }

 private:
  void update(const hal::Period&) noexcept {
    if (scans_)
      scan();
    else
      take(code_in_);
  }

  static constexpr std::uint32_t kPress = 0xC0, kRelease = 0x80, kNothing = 0x40;
  hal::Param<std::uint32_t> rollover_{param<hal::Param<std::uint32_t>>(
      "key_rollover", "Keys that may be down at a time; a further one is not taken", 2)};
  hal::In<std::uint32_t> code_in_;
  hal::Out<std::uint32_t> code_out_;
  hal::Param<bool> negative_;
  hal::PinArray<hal::Out<bool>, 32> rows_;
  hal::PinArray<hal::In<bool>, 32> columns_;
  hal::Array<Key> keys_;

  void take(std::uint32_t code) noexcept {
    const std::uint32_t kind = code & 0xC0U, key = code & 0x3FU;
    const std::size_t column = key & ((1U << row_shift_) - 1U);
    const std::size_t number = (key >> row_shift_) * width_ + column;
    if (column >= width_ || number >= keys_.size() || (kind != kPress && kind != kRelease)) return;
    set_key(number, kind == kPress);
  }
  void set_key(std::size_t number, bool down) noexcept {
    Key& key = keys_[number];
    if (key.last() == down || (down && down_ >= rollover_)) return;
    key.set(down);
    down_ += down ? 1U : ~0U;
  }
  /// One row a call: the columns show the keys of the row that was driven in the last call.
  void scan() noexcept {
    const bool low = negative_;
    code_out_ = kNothing;
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      const std::size_t number = row_ * columns_.size() + column;
      const bool down = columns_[column] != low;
      // Two scans that agree after one that did not: a change, or a bounce that has ended.
      if (down == seen_[number] && down != older_[number]) {
        set_key(number, down);
        code_out_ =
            (down ? kPress : kRelease) + static_cast<std::uint32_t>((row_ << row_shift_) + column);
      }
      older_[number] = seen_[number];
      seen_[number] = down;
    }
    row_ = (row_ + 1) % rows_.size();
    for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] = (row == row_) != low;
  }
  std::size_t row_{0}, width_{1}, row_shift_{0};
  std::uint32_t down_{0};
  bool scans_{false};
  bool seen_[1024]{}, older_[1024]{};  // in the last scan of the key's row, and in the one before

  hal::Function update_{
      function<MatrixKbChannel, &MatrixKbChannel::update>("", "Updates the keys")};
};

class MatrixKb final : public hal::Component<MatrixKb> {
 public:
  static constexpr hal::Info kInfo{
      .name = "matrix-kb",
      .summary = "Keys of a matrix keyboard as pins",
      .notes =
          "config= has rows and columns of each keyboard, like 4x4, and an s behind it when this "
          "component scans the matrix itself: then it drives one row after the other and reads the "
          "columns. Without s it takes the codes of a card at keycode: 0xC0 plus the key for a "
          "press, 0x80 for a release, 0x40 while nothing changes. The key is the column, with the "
          "row in the bits above those that the columns need: times 4 with 3 or 4 columns, times 8 "
          "with 5 to 8.",
      .singleton = true,
      .example = "config=4x4s,4x8",
      .lists = "config",
      .own_names = true};
  explicit MatrixKb(hal::Builder& b) noexcept : Component(b) {
    const Configs list = read_list(b);
    channels_ = hal::make_array<MatrixKbChannel>(b, list.size, list);
  }

 private:
  hal::Array<MatrixKbChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::MatrixKb)
