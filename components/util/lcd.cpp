// lcd: writes values to a character display, one character a call.
#include <cmath>

#include "hal/channels.hpp"

namespace kerf::components {
namespace {

constexpr std::size_t kMostWidth = 20;
constexpr int kUsualDecimals = 4;

enum class Field : std::uint8_t { text, real, signed_integer, integer, hex, octal, letter, bit };

/// One character of the layout, or one value.
struct Item {
  Field field{Field::text};
  bool zeros{false}, plus{false};
  char text[2]{};      ///< what stands there; of a bit when it is true and when it is false
  bool joined{false};  ///< one of several characters of an escape, not the first
  std::size_t width{0};
  int decimals{kUsualDecimals};
  std::size_t arg{0};
};

bool hex_digit(char c, unsigned& out) noexcept {
  if (c >= '0' && c <= '9') {
    out = out * 16 + static_cast<unsigned>(c - '0');
    return true;
  }
  const char upper = c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
  if (upper < 'A' || upper > 'F') return false;
  out = out * 16 + static_cast<unsigned>(upper - 'A' + 10);
  return true;
}

/// Takes apart the text of one page.
class Layout {
 public:
  Layout(hal::Builder& b, std::string_view text) noexcept : builder_(b), rest_(text) {}

  /// False: at the end, or the builder has failed.
  bool next(Item& out) noexcept {
    if (pending_ > 0) {
      --pending_;
      out = Item{};
      out.text[0] = ending_[sizeof ending_ - 1 - pending_];
      out.joined = true;
      return true;
    }
    if (rest_.empty() || builder_.failed()) return false;
    out = Item{};
    const char c = take();
    if (c == '\\') return escape(out);
    if (c == '%') return value(out);
    out.text[0] = c;
    return true;
  }

 private:
  char take() noexcept {
    if (rest_.empty()) return '\0';
    const char c = rest_.front();
    rest_.remove_prefix(1);
    return c;
  }
  [[nodiscard]] char look() const noexcept { return rest_.empty() ? '\0' : rest_.front(); }
  bool fail(std::string_view what) noexcept {
    builder_.fail(what);
    return false;
  }
  bool repeat(Item& out, const char (&text)[5], std::size_t size) noexcept {
    for (std::size_t i = 0; i < size; ++i) ending_[sizeof ending_ - size + i] = text[i];
    pending_ = size;
    next(out);
    out.joined = false;
    return true;
  }
  bool escape(Item& out) noexcept {
    if (look() == 'n') {
      take();
      return repeat(out, "\x18\n\r ", 3);
    }
    if (look() == 't') {
      take();
      return repeat(out, "    ", 4);
    }
    return plain(out.text[0], true);
  }
  /// One character, perhaps by its code behind a backslash.
  bool plain(char& out, bool behind_backslash) noexcept {
    if (!behind_backslash) {
      if (rest_.empty()) return fail("fmt_strings= lacks the two characters behind %b");
      out = take();
      if (out != '\\') return true;
    }
    if (look() == '\\') {
      out = take();
      return true;
    }
    unsigned code = 0;
    if (!hex_digit(take(), code) || !hex_digit(take(), code))
      return fail(
          "fmt_strings= has a backslash without n, t, a backslash or two hexadecimal digits behind "
          "it");
    out = static_cast<char>(code);
    return true;
  }
  bool value(Item& out) noexcept {
    // The number goes on at %% too; existing HAL files count so.
    out.arg = arg_++;
    for (;; take()) {
      if (look() == '0')
        out.zeros = true;
      else if (look() == '+')
        out.plus = true;
      else if (look() == ' ')
        out.zeros = false;
      else if (look() != '-')
        break;
    }
    for (; look() >= '0' && look() <= '9'; take())
      if (out.width <= kMostWidth)
        out.width = out.width * 10 + static_cast<std::size_t>(look() - '0');
    if (out.width > kMostWidth) out.width = kMostWidth;
    if (look() == '.') {
      take();
      for (out.decimals = 0; look() >= '0' && look() <= '9'; take())
        if (out.decimals < 15) out.decimals = out.decimals * 10 + (look() - '0');
      if (out.decimals > 15) out.decimals = 15;
    }
    switch (take()) {
      case '%': out.text[0] = '%'; return true;
      case 'f':
      case 'F': out.field = Field::real; return true;
      case 'i':
      case 'd': out.field = Field::signed_integer; return true;
      case 'u': out.field = Field::integer; return true;
      case 'x':
      case 'X': out.field = Field::hex; return true;
      case 'o': out.field = Field::octal; return true;
      case 'c': out.field = Field::letter; return true;
      case 'b':
        out.field = Field::bit;
        return plain(out.text[0], false) && plain(out.text[1], false);
      default: return fail("fmt_strings= has a % without one of f d i u x o c b % behind it");
    }
  }

  hal::Builder& builder_;
  std::string_view rest_;
  std::size_t arg_{0}, pending_{0};
  char ending_[4]{};
};

/// A field as it goes out.
class FieldText {
 public:
  [[nodiscard]] bool next(char& out) noexcept {
    if (at_ == size_) return false;
    out = text_[at_++];
    return true;
  }
  void set(char c, std::size_t times) noexcept {
    at_ = size_ = 0;
    for (std::size_t i = 0; i < times && i < kMostWidth; ++i) text_[size_++] = c;
  }
  void integer(const Item& item, std::uint32_t value, bool negative, std::uint32_t base) noexcept {
    char digits[16];
    std::size_t n = 0;
    do {
      const std::uint32_t digit = value % base;
      digits[n++] = static_cast<char>(digit < 10 ? '0' + digit : 'A' + digit - 10);
      value /= base;
    } while (value > 0);
    put(item, digits, n, negative);
  }
  void real(const Item& item, double value, char separator) noexcept {
    const bool negative = std::signbit(value);
    double scale = 1.0;
    for (int i = 0; i < item.decimals; ++i) scale *= 10.0;
    const double scaled = std::floor(std::fabs(value) * scale + 0.5);
    char digits[2 * kMostWidth];
    // 1e18 has more digits than the widest field, and whole numbers are exact below it in 64 bits. What is no number is too long.
    std::size_t n = sizeof digits;
    if (scaled < 1e18) {
      n = 0;
      auto rest = static_cast<std::uint64_t>(scaled);
      for (int i = 0; i < item.decimals; ++i, rest /= 10) digits[n++] = digit(rest);
      if (item.decimals > 0) digits[n++] = separator;
      do {
        digits[n++] = digit(rest);
        rest /= 10;
      } while (rest > 0);
    }
    put(item, digits, n, negative && scaled > 0.0);
  }

 private:
  static char digit(std::uint64_t value) noexcept { return static_cast<char>('0' + value % 10); }
  /// `digits`: the last one first.
  void put(const Item& item, const char* digits, std::size_t n, bool negative) noexcept {
    const char sign = negative ? '-' : item.plus ? '+' : '\0';
    const std::size_t signs = sign != '\0' ? 1 : 0;
    const std::size_t width = item.width > 0           ? item.width
                              : n + signs > kMostWidth ? kMostWidth
                                                       : n + signs;
    at_ = size_ = 0;
    if (n + signs > width) {
      if (sign != '\0') text_[size_++] = sign;
      while (size_ < width) text_[size_++] = '*';
      return;
    }
    const std::size_t pad = width - n - signs;
    if (!item.zeros)
      for (std::size_t i = 0; i < pad; ++i) text_[size_++] = ' ';
    if (sign != '\0') text_[size_++] = sign;
    if (item.zeros)
      for (std::size_t i = 0; i < pad; ++i) text_[size_++] = '0';
    while (n > 0) text_[size_++] = digits[--n];
  }

  char text_[kMostWidth]{};
  std::size_t size_{0}, at_{0};
};

std::size_t count_items(hal::Builder& b, std::string_view text) noexcept {
  Layout layout(b, text);
  std::size_t n = 0;
  for (Item item; layout.next(item);) ++n;
  return n;
}

}  // namespace

/// A character of a page, with the pin it shows.
struct LcdItem {
  LcdItem(hal::Builder& b, std::size_t, const hal::Name& page, Layout* const& layout) noexcept {
    if (!layout->next(item) || item.field == Field::text) return;
    hal::Name name = page;
    name.append(hal::numbered(".arg.##", item.arg));
    switch (item.field) {
      case Field::real: real.declare(b, name, "Value that is shown"); return;
      case Field::signed_integer: whole.declare(b, name, "Value that is shown"); return;
      case Field::bit: bit.declare(b, name, "Value that is shown"); return;
      default: count.declare(b, name, "Value that is shown"); return;
    }
  }
  /// False: no character.
  void begin(FieldText& out, char separator) const noexcept {
    switch (item.field) {
      case Field::text: out.set(item.text[0], 1); return;
      case Field::real: out.real(item, real, separator); return;
      case Field::signed_integer: {
        const std::int64_t value = whole.get();
        out.integer(item, static_cast<std::uint32_t>(value < 0 ? -value : value), value < 0, 10);
        return;
      }
      case Field::integer: out.integer(item, count, false, 10); return;
      case Field::hex: out.integer(item, count, false, 16); return;
      case Field::octal: out.integer(item, count, false, 8); return;
      case Field::letter: {
        const std::uint32_t code = count;
        out.set(static_cast<char>(code & 0xFFU), code < ' ' ? 0 : item.width > 0 ? item.width : 1);
        return;
      }
      case Field::bit: out.set(item.text[bit ? 0 : 1], 1); return;
    }
  }
  Item item;
  hal::In<double> real;
  hal::In<std::int32_t> whole;
  hal::In<std::uint32_t> count;
  hal::In<bool> bit;
};

struct LcdPage {
  LcdPage(hal::Builder& b, std::size_t index, const hal::Name& display,
          std::string_view pages) noexcept {
    std::string_view text;
    for (std::size_t i = 0; i <= index; ++i) text = hal::next_field(pages, '|');
    hal::Name name = display;
    name.append(hal::numbered(".page.##", index));
    const std::size_t n = count_items(b, text);
    if (b.failed()) return;
    Layout layout(b, text);
    Layout* each = &layout;
    items = hal::make_array<LcdItem>(b, n, name, each);
  }
  hal::Array<LcdItem> items;
};

class LcdDisplay : public hal::Channel {
 public:
  LcdDisplay(hal::Builder& b, std::size_t index, std::string_view displays) noexcept
      : Channel(b, display_name(index)) {
    std::string_view pages;
    for (std::size_t i = 0; i <= index; ++i) pages = hal::next_field(displays);
    pages_ = hal::make_array<LcdPage>(b, hal::count_fields(pages, '|'), display_name(index), pages);
  }

  void update(std::uint32_t& quiet) noexcept {
    // The display needs time after its power comes.
    if (quiet < kQuietCalls) {
      ++quiet;
      out_ = 0;
      return;
    }
    char c = ' ';
    if (!control_.empty()) {
      c = control_.front();
      control_.remove_prefix(1);
    } else {
      c = of_page();
    }
    out_ = static_cast<unsigned char>(c);
  }

 private:
  static constexpr std::uint32_t kQuietCalls = 100;
  static constexpr std::string_view kStart{"\r\n\x18\r\n\x18\r\n\x18\r\n\x18\x11", 13};
  static constexpr std::string_view kNewPage{"\x11\x1e\x1a", 3};
  static constexpr std::string_view kEnd{"\x00", 1}, kHome{"\x1b=  ", 4};  // upper left corner

  static hal::Name display_name(std::size_t index) noexcept {
    return hal::numbered("lcd.##", index);
  }

  char of_page() noexcept {
    char c = 0;
    if (field_.next(c)) return c;
    if (page_ < pages_.size() && item_ < pages_[page_].items.size() &&
        pages_[page_].items[item_].item.joined) {
      pages_[page_].items[item_++].begin(field_, ' ');
      if (field_.next(c)) return c;
    }
    // Between two characters or values: another page, another contrast.
    const std::uint32_t page = page_num_;
    if (page >= pages_.size()) return ' ';
    if (page != page_) {
      page_ = page;
      item_ = 0;
      ended_ = false;
      return control(kNewPage);
    }
    if (ended_) {
      ended_ = false;
      return control(kHome);
    }
    const double contrast = contrast_;
    if (contrast != contrast_sent_) {
      contrast_sent_ = contrast;
      const double share = contrast > 0.0 ? (contrast < 1.0 ? contrast : 1.0) : 0.0;
      contrast_text_[2] =
          static_cast<char>(static_cast<unsigned char>(0x20 + static_cast<int>(share * 159.0)));
      return control(std::string_view(contrast_text_, 3));
    }
    const hal::Array<LcdItem>& items = pages_[page_].items;
    while (item_ < items.size()) {
      items[item_++].begin(field_, static_cast<char>(separator_.get() & 0xFFU));
      if (field_.next(c)) return c;
    }
    item_ = 0;
    ended_ = true;
    return control(kEnd);
  }
  char control(std::string_view text) noexcept {
    control_ = text;
    const char c = control_.front();
    control_.remove_prefix(1);
    return c;
  }

  hal::Out<std::uint32_t> out_{
      pin<hal::Out<std::uint32_t>>("out", "Characters for the display, one a call")};
  hal::In<std::uint32_t> page_num_{pin<hal::In<std::uint32_t>>("page_num", "Page that is shown")};
  hal::In<double> contrast_{pin<hal::In<double>>("contrast", "Contrast of the display, 0 to 1")};
  hal::Param<std::uint32_t> separator_{param<hal::Param<std::uint32_t>>(
      "decimal-separator", "Code of the character between whole and decimals", 46)};
  hal::Array<LcdPage> pages_;
  FieldText field_;
  std::string_view control_{kStart};
  char contrast_text_[3]{'\x1b', 'C', ' '};
  double contrast_sent_{0.0};
  std::size_t item_{0};
  bool ended_{false};  // the text, and is to begin again
  std::uint32_t page_{0xFFFFFFFF};
};

class Lcd final : public hal::Component<Lcd> {
 public:
  static constexpr hal::Info kInfo{
      .name = "lcd",
      .summary = "Shows values on a character display",
      .notes =
          "fmt_strings= has the layout of each display, with commas between them and | between the "
          "pages of one. %f %d %u %x %o %c show a value and make a pin of its type, %bXY shows X "
          "for true and Y for false. Behind the % may stand + for the sign, 0 for zeros in front, "
          "the width and behind a point the decimals (4 when they are not given). What does not "
          "fit its "
          "width shows asterisks. \\\\n is a new line, \\\\t four blanks, \\\\NN the character of "
          "that "
          "hexadecimal code (\\\\2C a comma, \\\\7C the bar), %% the percent sign.",
      .singleton = true,
      .example = "fmt_strings=X%9.3f\\nY%9.3f",
      .lists = "fmt_strings"};
  explicit Lcd(hal::Builder& b) noexcept : Component(b) {
    const std::string_view displays =
        b.arg("fmt_strings", "", "Layout of each display, with commas between");
    if (displays.empty()) {
      b.fail("fmt_strings= must have the layout of a display at least");
      return;
    }
    displays_ = hal::make_array<LcdDisplay>(b, hal::count_fields(displays), displays);
  }

 private:
  hal::Array<LcdDisplay> displays_;
  std::uint32_t quiet_{0};

  void update(const hal::Period&) noexcept {
    for (LcdDisplay& display : displays_) display.update(quiet_);
  }
  hal::Function update_{function<&Lcd::update>("", "Sends the next character of each display")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Lcd)
