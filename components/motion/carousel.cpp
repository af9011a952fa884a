// carousel: turns a tool changer's carousel to a pocket (manual: carousel(9)).
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "hal/channels.hpp"

namespace kerf::components {

namespace {
enum class Encoding { gray, binary, bcd, single, index, edge, counts };
constexpr std::size_t kMostInstances = 8;
constexpr std::size_t kMostSensors = 32;

/// One of the lists on the loadrt line; who has fewer entries repeats the last.
std::string_view entry(std::string_view list, std::size_t index) noexcept {
  std::string_view field = hal::next_field(list);
  for (std::size_t i = 0; i < index && !list.empty(); ++i) field = hal::next_field(list);
  return field;
}
}  // namespace

struct CarouselSetup {
  std::string_view pockets, encoding, num_sense, dir;
  bool odd_parity{false};
};

class CarouselChannel : public hal::Channel {
 public:
  CarouselChannel(hal::Builder& b, std::size_t index, const CarouselSetup& setup) noexcept
      : Channel(b, hal::ChannelList{}.name(b, index)) {
    read_encoding(b, entry(setup.encoding, index));
    pockets_ = count(b, entry(setup.pockets, index), 1000,
                     "carousel: pockets= takes numbers from 1 to 1000, one a carousel");
    const std::string_view sensors = entry(setup.num_sense, index);
    std::int32_t n = count(b, sensors, kMostSensors,
                           "carousel: num_sense= takes numbers from 1 to 32, one a carousel");
    if (encoding_ == Encoding::index) n = 2;
    // One for each pocket, or some could not be found.
    if (encoding_ == Encoding::single)
      n = std::max(n, std::min(pockets_, static_cast<std::int32_t>(kMostSensors)));
    const std::string_view dir = entry(setup.dir, index);
    if (dir != "1" && dir != "2")
      b.fail("carousel: dir= takes 1 (one direction only) or 2 (both), one a carousel");
    both_ways_ = dir == "2";
    odd_parity_ = setup.odd_parity;
    if (!b.failed())
      sense_ = hal::make_array<Sensor>(b, static_cast<std::size_t>(n),
                                       hal::ChannelList{}.name(b, index));
  }

  void update(const hal::Period& period) noexcept {
    if (strobe_) {
      read_position();
    } else if (homes() && encoding_ != Encoding::counts) {
      mark_rises_ = sensor(1) && !mark_before_;
      remember(sensor(1));
    }
    watch_requests();
    step(period.seconds(), enable_);
    state_ = static_cast<std::int32_t>(step_);
    motor_dir_ = direction_;
    homing_ = step_ == Step::homing;
  }

 private:
  enum class Step : std::int32_t {
    idle = 0,
    begin_homing,
    homing,
    search,
    lock,           // the motor pushes back against the ratchet
    settle,         // it runs out
    back_to_mark,   // slowly back until the mark is seen
    back_off_mark,  // and gone again
    onto_mark,      // and forwards onto its edge
    let_go,         // of enable
    let_go_of_jog,
  };
  struct Sensor {
    Sensor(hal::Builder& b, std::size_t index, const hal::Name& carousel) noexcept {
      hal::Name name = carousel;
      name.append(hal::numbered(".sense-#", index));
      pin.declare(b, name, "Position sensor");
    }
    hal::In<bool> pin;
  };

  static std::int32_t count(hal::Builder& b, std::string_view text, std::size_t most,
                            std::string_view what) noexcept {
    std::size_t value = 0;
    if (!hal::parse_count(text, value) || value < 1 || value > most) b.fail(what);
    return static_cast<std::int32_t>(std::clamp<std::size_t>(value, 1, most));
  }
  void read_encoding(hal::Builder& b, std::string_view text) noexcept {
    constexpr std::string_view kNames[]{"gray",  "binary", "bcd",   "single",
                                        "index", "edge",   "counts"};
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      // The first letter is enough, as in files that say encoding=C; `b` is binary.
      const char c = text.empty() ? 'x' : static_cast<char>(text[0] | 0x20);
      if (text != kNames[i] && (text.size() != 1 || c != kNames[i][0])) continue;
      encoding_ = static_cast<Encoding>(i);
      return;
    }
    b.fail("carousel: encoding= is gray, binary, bcd, single, index, edge or counts");
  }

  /// The position is known only after a mark was found.
  [[nodiscard]] bool homes() const noexcept {
    return encoding_ == Encoding::index || encoding_ == Encoding::edge ||
           encoding_ == Encoding::counts;
  }
  [[nodiscard]] bool sensor(std::size_t i) const noexcept {
    return i < sense_.size() && sense_[i].pin;
  }
  /// 1 to pockets.
  [[nodiscard]] std::int32_t around(std::int64_t pocket) const noexcept {
    const std::int64_t n = pockets_;
    return static_cast<std::int32_t>(((pocket - 1) % n + n) % n + 1);
  }
  [[nodiscard]] std::int32_t here() const noexcept { return current_.last(); }

  void read_position() noexcept {
    const bool mark = sensor(homes() && encoding_ != Encoding::counts ? 1 : 0);
    const bool rises = mark && !mark_before_, falls = !mark && mark_before_;
    mark_ = mark;
    mark_rises_ = rises;
    remember(mark);
    if (encoding_ == Encoding::counts) {
      read_counts();
    } else if (homes()) {
      if (homed_.last() && direction_ != 0 && (rises || (falls && encoding_ == Encoding::edge)))
        current_ = around(std::int64_t{here()} + direction_);
    } else {
      read_code();
    }
  }

  /// For the edges to come. At rest an index mode does not look: the mark that comes then is the one that it stands at.
  void remember(bool mark) noexcept {
    const bool looks =
        encoding_ == Encoding::edge || direction_ != 0 || step_ == Step::let_go_of_jog;
    if (homed_.last() ? looks : step_ == Step::homing) mark_before_ = mark;
  }

  void read_code() noexcept {
    std::uint32_t code = 0;
    bool odd = parity_;
    for (std::size_t i = 0; i < sense_.size(); ++i) {
      if (!sensor(i)) continue;
      code |= 1U << i;
      // One sensor of many is no code.
      if (encoding_ != Encoding::single) odd = !odd;
    }
    parity_error_ = odd != odd_parity_;
    switch (encoding_) {
      case Encoding::gray:
        for (std::uint32_t shifted = code >> 1U; shifted != 0; shifted >>= 1U) code ^= shifted;
        break;
      case Encoding::bcd: code = (code >> 4U) * 10 + (code & 15U); break;
      case Encoding::single: code = static_cast<std::uint32_t>(std::bit_width(code)); break;
      default: break;
    }
    current_ = static_cast<std::int32_t>(code);
  }

  void read_counts() noexcept {
    if (!homed_.last()) return;
    const std::int64_t scale = scale_ == 0 ? 1 : std::int64_t{scale_};
    const std::int64_t at = std::int64_t{counts_} - origin_ + home_offset_;
    const std::int64_t nearest = std::llround(static_cast<double>(at) / static_cast<double>(scale));
    // Half of the width on each side; without one only the very count is the pocket.
    if (std::abs(at - nearest * scale) > width_ / 2) return;
    current_ = around(nearest + 1);
  }

  /// What is asked for counts at rest, and whoever asks must let go before it counts again.
  void watch_requests() noexcept {
    if (unhome_ && !was_unhomed_) homed_ = false;
    was_unhomed_ = unhome_;
    if (step_ != Step::idle) return;
    const bool forward = jog_fwd_, back = jog_rev_;
    if (forward || (back && both_ways_)) {
      ready_ = false;
      // Where it is must be known first.
      jogging_ = !homes() || homed_.last();
      if (jogging_) {
        // Both pins at once ask for no other pocket.
        const std::int64_t to = std::int64_t{here()} + (forward ? 1 : 0) - (back ? 1 : 0);
        target_ = to < 1 ? pockets_ : around(to);
        direction_ = back ? -1 : 1;
      }
      step_ = jogging_ ? Step::search : Step::begin_homing;
    } else if (enable_) {
      ready_ = false;
      jogging_ = false;
      active_ = true;
      motor(0, hold_dc_);
      aim();
      step_ = homes() && !homed_.last() ? Step::begin_homing : Step::search;
    }
  }
  /// Numbers beyond the last pocket begin again at the first; below there is nothing but the first.
  [[nodiscard]] std::int32_t wanted() const noexcept {
    return pocket_number_ < 1 ? 1 : around(pocket_number_);
  }
  void aim() noexcept {
    target_ = wanted();
    // Of two ways of one length it is the one without the step from the last pocket to the first.
    const std::int32_t way = target_ - here();
    const bool back = 2 * way > pockets_ || (way <= 0 && -2 * way <= pockets_);
    direction_ = both_ways_ && back ? -1 : 1;
  }

  void step(double dt, bool enable) noexcept {
    switch (step_) {
      case Step::idle: return rest();
      case Step::begin_homing: step_ = Step::homing; return;
      case Step::homing: return home();
      case Step::search: return search(enable);
      case Step::lock:
        timer_ = timer_.last() - dt;
        if (!enable) return finish(false);
        if (timer_.last() < 0.5 * dt) finish(true);
        return;
      case Step::settle:
        timer_ = timer_.last() - dt;
        if (timer_.last() >= 0.5 * dt) return;
        motor_vel_ = -align_dc_;
        step_ = Step::back_to_mark;
        return;
      case Step::back_to_mark:
        if (mark_) step_ = Step::back_off_mark;
        return;
      case Step::back_off_mark:
        if (mark_) return;
        motor_vel_ = align_dc_;
        step_ = Step::onto_mark;
        return;
      case Step::onto_mark:
        if (mark_) finish(true);
        return;
      case Step::let_go:
        if (!enable) step_ = Step::idle;
        return rest();
      case Step::let_go_of_jog:
        if (!jog_fwd_ && !jog_rev_) step_ = Step::idle;
        return rest();
    }
  }

  void home() noexcept {
    if (direction_ != 1 || !motor_fwd_.last()) {
      direction_ = 1;
      index_enable_ = true;
      motor(1, fwd_dc_);
    }
    const bool counts = encoding_ == Encoding::counts;
    const bool found = counts ? sensor(0) || !index_enable_ : sensor(0) && mark_rises_;
    if (!found) return;
    if (counts)
      origin_ = index_enable_ ? counts_ : 0;  // an encoder that met its index counts from it
    if (counts) index_enable_ = false;
    current_ = 1;
    homed_ = true;
    active_ = false;
    direction_ = 0;
    motor(0, 0.0);
    step_ = Step::idle;
  }

  void search(bool enable) noexcept {
    if (jogging_) {
      // Not in the cycle in which it begins, with both pins.
      if (here() == target_ && active_.last()) return end_jog();
    } else {
      if (!enable) return finish(false);
      target_ = wanted();
      if (here() == target_) return arrive();
    }
    active_ = true;
    motor(direction_, direction_ > 0 ? fwd_dc_ : rev_dc_);
  }

  void arrive() noexcept {
    if (rev_pulse_ > 0.0) {
      // An index mode: a mark seen against the stop is the same one. The edges of edge are counted backwards.
      direction_ = encoding_ == Encoding::index ? 0 : -1;
      // Also where the pocket is there already: it may not be locked.
      active_ = true;
      timer_ = rev_pulse_;
      motor(-1, rev_dc_);
      step_ = Step::lock;
    } else if (align_dc_ != 0.0 && decel_time_ > 0.0 && both_ways_) {
      timer_ = decel_time_;
      motor(direction_, 0.0);
      direction_ = 0;  // the mark that it passes now is the same one
      step_ = Step::settle;
    } else {
      finish(true);
    }
  }

  void finish(bool there) noexcept {
    ready_ = there;
    step_ = Step::let_go;
    rest();
  }
  void end_jog() noexcept {
    jogging_ = false;
    step_ = jog_fwd_ || jog_rev_ ? Step::let_go_of_jog : Step::idle;
    rest();
  }
  void rest() noexcept {
    active_ = false;
    direction_ = 0;
    timer_ = 0.0;
    motor(0, hold_dc_);
  }
  void motor(int direction, double velocity) noexcept {
    motor_fwd_ = direction > 0;
    motor_rev_ = direction < 0;
    motor_vel_ = velocity;
  }

  using FloatIn = hal::In<double>;
  using IntIn = hal::In<std::int32_t>;
  using BitIn = hal::In<bool>;
  using BitOut = hal::Out<bool>;
  IntIn pocket_number_{pin<IntIn>("pocket-number", "Pocket to go to when enable rises")};
  BitIn enable_{pin<BitIn>("enable", "True at rest starts the search, once; false stops it")};
  BitOut active_{pin<BitOut>("active", "The carousel turns, or shall")};
  BitOut ready_{pin<BitOut>("ready", "The pocket is there")};
  BitIn strobe_{pin<BitIn>("strobe", "The position sensors are valid", true)};
  BitIn parity_{pin<BitIn>("parity", "Parity bit of the encoder")};
  FloatIn rev_pulse_{
      pin<FloatIn>("rev-pulse", "Time to push back against the stop at the pocket [s]; 0: no")};
  FloatIn fwd_dc_{pin<FloatIn>("fwd-dc", "motor-vel forwards")};
  FloatIn rev_dc_{pin<FloatIn>("rev-dc", "motor-vel backwards")};
  FloatIn hold_dc_{pin<FloatIn>("hold-dc", "motor-vel at rest")};
  FloatIn align_dc_{pin<FloatIn>("align-dc", "motor-vel of the slow move onto the mark; 0: none")};
  FloatIn decel_time_{
      pin<FloatIn>("decel-time", "Time for the carousel to stop, before the slow move [s]")};
  IntIn counts_{pin<IntIn>("counts", "Counts of an encoder or stepgen")};
  IntIn scale_{pin<IntIn>("scale", "Counts from a pocket to the next", 100)};
  IntIn width_{pin<IntIn>(
      "width",
      "Width of the place in which a pocket is seen [counts]; 0: at its very count alone")};
  IntIn home_offset_{pin<IntIn>("home-offset", "Counts of which the index lies behind pocket 1")};
  hal::Io<bool> index_enable_{
      pin<hal::Io<bool>>("index-enable", "Set while homing; an encoder clears it at its index")};
  BitIn jog_fwd_{pin<BitIn>("jog-fwd", "True at rest: one pocket forwards, once")};
  BitIn jog_rev_{pin<BitIn>("jog-rev", "True at rest: one pocket backwards, once")};
  BitOut motor_fwd_{pin<BitOut>("motor-fwd", "Motor forwards, to higher pockets")};
  BitOut motor_rev_{pin<BitOut>("motor-rev", "Motor backwards")};
  BitOut parity_error_{pin<BitOut>("parity-error", "Sensors and parity do not go together")};
  hal::Out<std::int32_t> current_{
      pin<hal::Out<std::int32_t>>("current-position", "Pocket that is there")};
  hal::Out<double> motor_vel_{
      pin<hal::Out<double>>("motor-vel", "Speed or duty cycle of the motor")};
  BitOut homed_{pin<BitOut>("homed", "The mark has been found")};
  BitIn unhome_{pin<BitIn>("unhome", "Rising: the next search begins with the mark")};
  hal::RoParam<std::int32_t> state_{param<hal::RoParam<std::int32_t>>("state", "Step at work")};
  hal::RoParam<bool> homing_{param<hal::RoParam<bool>>("homing", "The mark is being looked for")};
  hal::RoParam<double> timer_{param<hal::RoParam<double>>("timer", "Time left of a pulse [s]")};
  hal::RoParam<std::int32_t> motor_dir_{
      param<hal::RoParam<std::int32_t>>("motor-dir", "Direction of the search")};
  hal::RoParam<std::uint32_t> debounce_{
      param<hal::RoParam<std::uint32_t>>("debounce", "Cycles that a position must last; 0 here")};
  hal::Function update_{function<CarouselChannel, &CarouselChannel::update>(
      "", "Reads the position, drives the motor")};
  hal::Array<Sensor> sense_;

  Encoding encoding_{Encoding::gray};
  Step step_{Step::idle};
  std::int32_t pockets_{1}, target_{1}, direction_{0};
  std::int64_t origin_{0};  // counts at the index
  bool both_ways_{true}, odd_parity_{false};
  bool mark_{false}, mark_rises_{false}, mark_before_{false}, jogging_{false}, was_unhomed_{false};
};

class Carousel final : public hal::Component<Carousel> {
 public:
  static constexpr hal::Info kInfo{
      .name = "carousel",
      .summary = "Turns a tool changer's carousel to a pocket",
      .notes =
          "The position comes as a gray, binary or bcd code on the sense pins, from a sensor a "
          "pocket (single), from an index on sense-0 and a mark a pocket on sense-1 (index; edge "
          "counts both edges of the mark), or from counts of an encoder or stepgen. index, edge "
          "and counts turn forwards to the index first. The lists have an entry a carousel; who "
          "has fewer repeats the last one. After a search for the index that ends with enable "
          "still true the carousel goes on to pocket-number.",
      .singleton = true,
      .example = "pockets=8",
      .lists = "pockets encoding num_sense dir"};

  explicit Carousel(hal::Builder& b) noexcept : Component(b) {
    CarouselSetup setup;
    setup.pockets = text_arg("pockets", "8", "Pockets of each carousel");
    setup.encoding =
        text_arg("encoding", "gray", "gray, binary, bcd, single, index, edge or counts");
    setup.num_sense = text_arg("num_sense", "4", "Position sensors of each");
    setup.dir = text_arg("dir", "2", "1: turns forwards only, 2: both ways");
    setup.odd_parity = int_arg("parity", 0, "1: odd parity, 0: even") != 0;
    const std::size_t count = hal::count_fields(setup.pockets);
    if (count < 1 || count > kMostInstances) {
      b.fail(
          "carousel: pockets= takes the number of pockets of each carousel, at most 8, for "
          "example pockets=10,8");
      return;
    }
    channels_ = hal::make_array<CarouselChannel>(b, count, setup);
  }

 private:
  hal::Array<CarouselChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Carousel)
