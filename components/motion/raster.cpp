// raster: power of a laser along a line of a picture.
#include <cmath>

#include "hal/port_pins.hpp"

namespace kerf::components {

class Raster final : public hal::Component<Raster> {
 public:
  static constexpr hal::Info kInfo{
      .name = "raster",
      .summary = "Power of a laser along a line of a picture",
      .notes =
          "A program is one line of a picture, as text in the port: "
          "\"OFFSET;BPP;PPU;COUNT;DATA%\". OFFSET is the way from where run came to the first "
          "pixel, "
          "BPP the bits of a pixel (4, 8, 12 and so on to 32), PPU the pixels in a unit of "
          "position, "
          "negative for a line that goes in negative direction, COUNT the number of pixels, and "
          "DATA their values in hexadecimal, BPP / 4 digits each. Blanks and ends of lines may "
          "stand "
          "beside the numbers, not in DATA. 0;4;10;4;0F80% is four pixels in 0.4 units. "
          "\n\n"
          "A rising edge of run takes the position as the start and the next program from the "
          "port. While position is over a pixel, output is its value in percent of the "
          "greatest. Before the first and behind the last pixel, and when position goes back "
          "by more than a pixel, output is 0. The end of run drops what is left of its program; "
          "further programs wait in the port for run to rise again. A program may be longer than "
          "the queue, as long as its writer keeps ahead of the position. What cannot be read, and "
          "a pixel that is not there in time, set fault and fault-code; output is then 0 until "
          "reset, which drops all programs.\n\n"
          "LinuxCNC 2.9 has no raster: this is not compared with one. "
          "fault-code: 1 the four numbers, 2 BPP, 3 PPU, 4 COUNT, 5 a digit of a pixel, 6 no pixel "
          "in time, 7 no % behind the last."};
  using Component::Component;

 private:
  enum class State : std::int32_t { idle, header, running, done, dropping, fault };
  enum Fault : std::int32_t {
    none,
    bad_numbers,
    bad_bits,
    bad_pixels_per_unit,
    bad_count,
    bad_digit,
    no_pixel,
    no_end
  };
  static constexpr std::uint32_t kHeaderMost = 128;
  static constexpr std::uint32_t kDroppedACycle = 1024;
  static constexpr std::int32_t kCountMost = 1'000'000;

  hal::In<double> position_{pin<hal::In<double>>("position", "Position of the laser")};
  hal::PortIn program_{pin<hal::PortIn>("program", "Programs, one a line of the picture")};
  hal::In<bool> run_{pin<hal::In<bool>>("run", "Rising: starts the next program; false: ends it")};
  hal::In<bool> reset_{
      pin<hal::In<bool>>("reset", "True: ends and drops all programs, clears the fault")};
  hal::Out<double> output_{pin<hal::Out<double>>("output", "Power, 0 to 100 [percent]")};
  hal::Out<bool> active_{pin<hal::Out<bool>>("active", "True from run to the end of the line")};
  hal::Out<bool> enabled_{
      pin<hal::Out<bool>>("enabled", "True while the position is over the pixels")};
  hal::Out<bool> fault_{pin<hal::Out<bool>>("fault", "True: see fault-code; output is 0")};
  hal::Out<std::int32_t> fault_code_{
      pin<hal::Out<std::int32_t>>("fault-code", "What is wrong, 0 for nothing")};
  hal::Out<std::int32_t> state_{pin<hal::Out<std::int32_t>>(
      "state", "0 idle, 1 reads the numbers, 2 runs, 3 at the end, 4 drops the rest, 5 fault")};
  hal::Out<double> program_position_{
      pin<hal::Out<double>>("program-position", "Position at which run came")};
  hal::Out<double> offset_{
      pin<hal::Out<double>>("offset", "Way from there to the first pixel, of the program")};
  hal::Out<std::int32_t> bpp_{
      pin<hal::Out<std::int32_t>>("bpp", "Bits of a pixel, of the program")};
  hal::Out<double> ppu_{pin<hal::Out<double>>("ppu", "Pixels in a unit, of the program")};
  hal::Out<std::int32_t> count_{
      pin<hal::Out<std::int32_t>>("count", "Number of pixels, of the program")};
  hal::Out<std::int32_t> pixel_index_{pin<hal::Out<std::int32_t>>(
      "current-pixel-index", "Number of the pixel under the laser, -1 before the first", -1)};
  hal::Out<std::uint32_t> pixel_value_{
      pin<hal::Out<std::uint32_t>>("current-pixel-value", "Its value")};

  void enter(State state) noexcept {
    now_ = state;
    state_ = static_cast<std::int32_t>(state);
    active_ = state == State::header || state == State::running;
    if (state != State::running) dark();
  }
  void dark() noexcept {
    output_ = 0.0;
    enabled_ = false;
  }
  void fail(Fault why) noexcept {
    fault_code_ = why;
    fault_ = true;
    enter(State::fault);
  }

  void show(std::int32_t index, std::uint32_t value) noexcept {
    index_ = index;
    value_ = value;
    pixel_index_ = index;
    pixel_value_ = value;
  }

  static bool is_blank(char c) noexcept { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  /// The number before the next ';' of `text`, from `at` on, which then stands behind it. `whole` takes no fraction.
  static bool number(const char* text, std::uint32_t size, std::uint32_t& at, bool whole,
                     double& out) noexcept {
    while (at < size && is_blank(text[at])) ++at;
    const bool negative = at < size && text[at] == '-';
    if (at < size && (text[at] == '-' || text[at] == '+')) ++at;
    double value = 0.0, place = 0.0;
    int digits = 0;
    for (; at < size; ++at) {
      const char c = text[at];
      if (c == '.' && place == 0.0 && !whole) {
        place = 1.0;
      } else if (c >= '0' && c <= '9') {
        ++digits;
        value = value * 10.0 + (c - '0');
        place *= 10.0;
      } else {
        break;
      }
    }
    while (at < size && is_blank(text[at])) ++at;
    if (digits == 0 || at == size || text[at] != ';') return false;
    ++at;
    out = (negative ? -value : value) / (place > 0.0 ? place : 1.0);
    return true;
  }
  /// The four numbers, once they are all there.
  void read_header() noexcept {
    char text[kHeaderMost];
    const std::uint32_t there = program_.readable();
    const std::uint32_t size = there < kHeaderMost ? there : kHeaderMost;
    if (!program_.peek(text, size)) return;
    std::uint32_t fields = 0, at = 0;
    for (; at < size && fields < 4 && text[at] != '%'; ++at) fields += text[at] == ';' ? 1U : 0U;
    if (fields < 4) {
      if (at < size || size == kHeaderMost) fail(bad_numbers);
      return;
    }
    const std::uint32_t end = at;
    double offset = 0, bits = 0, per_unit = 0, count = 0;
    at = 0;
    if (!number(text, end, at, false, offset) || !number(text, end, at, true, bits) ||
        !number(text, end, at, false, per_unit) || !number(text, end, at, true, count))
      return fail(bad_numbers);
    if (bits < 4 || bits > 32 || static_cast<int>(bits) % 4 != 0) return fail(bad_bits);
    if (per_unit == 0.0) return fail(bad_pixels_per_unit);
    if (count < 1 || count > kCountMost) return fail(bad_count);
    (void)program_.skip(end);
    offset_ = offset;
    bpp_ = static_cast<std::int32_t>(bits);
    ppu_ = per_unit;
    count_ = static_cast<std::int32_t>(count);
    from_ += offset;
    per_unit_ = per_unit;
    pixels_ = static_cast<std::int32_t>(count);
    digits_ = static_cast<std::uint32_t>(bits) / 4;
    greatest_ = std::ldexp(1.0, static_cast<int>(bits)) - 1.0;
    show(-1, 0);
    enter(State::running);
  }
  bool missed(Fault why) noexcept {
    fail(why);
    return false;
  }
  /// Goes on to pixel `index`, whose value is then known. False: it could not, and the fault is set.
  bool read_pixel(std::int32_t index) noexcept {
    const auto passed = static_cast<std::uint32_t>(index - index_ - 1);
    if (!program_.skip(passed * digits_)) return missed(no_pixel);
    char text[8];
    if (!program_.read(text, digits_)) return missed(no_pixel);
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < digits_; ++i) {
      const char c = text[i];
      std::uint32_t digit = 16;
      if (c >= '0' && c <= '9') digit = static_cast<std::uint32_t>(c - '0');
      if (c >= 'a' && c <= 'f') digit = static_cast<std::uint32_t>(c - 'a') + 10;
      if (c >= 'A' && c <= 'F') digit = static_cast<std::uint32_t>(c - 'A') + 10;
      if (digit > 15) return missed(bad_digit);
      value = value * 16 + digit;
    }
    show(index, value);
    return true;
  }
  void finish() noexcept {
    const auto left = static_cast<std::uint32_t>(pixels_ - 1 - index_);
    char end = 0;
    if (!program_.skip(left * digits_)) return fail(no_pixel);
    if (!program_.read(&end, 1) || end != '%') return fail(no_end);
    show(pixels_, 0);
    enter(State::done);
  }
  void follow() noexcept {
    const double way = (position_ - from_) * per_unit_;
    // The end is where the last pixel ends. What is no number moves nothing on.
    if (way >= pixels_) return finish();
    const double place = std::floor(way);
    if (!(place >= 0.0) || place < index_ - 1) return dark();
    const auto index = static_cast<std::int32_t>(place);
    if (index > index_ && !read_pixel(index)) return;
    enabled_ = true;
    output_ = 100.0 * value_ / greatest_;
  }
  /// To the % that ends the program, a piece a cycle.
  void drop() noexcept {
    char c = 0;
    for (std::uint32_t i = 0; i < kDroppedACycle && program_.read(&c, 1); ++i)
      if (c == '%') return enter(State::idle);
  }

  void update(const hal::Period&) noexcept {
    const bool run = run_, rises = run && !ran_;
    ran_ = run;
    if (reset_) {
      program_.clear();
      fault_ = false;
      fault_code_ = none;
      return enter(State::idle);
    }
    // A run that came while the last program was being dropped is not lost.
    wanted_ = run && (wanted_ || rises);
    if (!run && now_ == State::header)
      enter(program_.readable() > 0 ? State::dropping : State::idle);
    if (!run && now_ == State::running) enter(State::dropping);
    if (!run && now_ == State::done) enter(State::idle);
    if (now_ == State::dropping) drop();
    if (now_ == State::idle && wanted_) {
      wanted_ = false;
      from_ = position_;
      program_position_ = from_;
      enter(State::header);
    }
    if (now_ == State::header) read_header();
    if (now_ == State::running) follow();
  }
  hal::Function update_{
      function<&Raster::update>("", "Gives the power of the pixel under the laser")};

  State now_{State::idle};
  bool ran_{false};
  bool wanted_{false};
  // What the pins show of the program: others may disturb pins.
  double from_{0.0};
  double per_unit_{1.0};
  std::int32_t pixels_{0};
  std::int32_t index_{-1};
  std::uint32_t value_{0};
  std::uint32_t digits_{1};
  double greatest_{15.0};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Raster)
