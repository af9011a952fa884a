// bldc: commutation of three-phase motors.
#include <cmath>
#include <numbers>

#include "hal/channels.hpp"

namespace kerf::components {
namespace {

/// What cfg= chose.
struct Wiring {
  bool hall{false}, absolute{false}, quadrature{false}, index{false}, fanuc{false};
  bool bits{false}, six{false}, hall_out{false}, fanuc_out{false}, trapezoidal{false};
  /// Numbers of the phases are pins only when no other output is.
  [[nodiscard]] bool plain() const noexcept { return !bits && !six && !hall_out && !fanuc_out; }
  [[nodiscard]] bool counts() const noexcept { return absolute || quadrature; }
  [[nodiscard]] bool free() const noexcept { return !hall && !absolute && !quadrature && !index; }
  [[nodiscard]] bool aligns() const noexcept { return quadrature && !hall; }
  /// Where LinuxCNC never sets hall-error.
  [[nodiscard]] bool silent() const noexcept {
    return trapezoidal || (quadrature && !index && (hall_out || fanuc_out));
  }
};

/// Hall signals, the first one worth 4, in the sectors B-A C-A C-B A-B A-C B-C of each pattern.
constexpr std::uint8_t kPatterns[48][6] = {
    {0, 1, 3, 7, 6, 4}, {1, 0, 2, 6, 7, 5}, {0, 2, 3, 7, 5, 4}, {1, 3, 2, 6, 4, 5},
    {2, 3, 1, 5, 4, 6}, {3, 2, 0, 4, 5, 7}, {2, 0, 1, 5, 7, 6}, {3, 1, 0, 4, 6, 7},
    {0, 1, 5, 7, 6, 2}, {1, 0, 4, 6, 7, 3}, {0, 2, 6, 7, 5, 1}, {1, 3, 7, 6, 4, 0},
    {2, 3, 7, 5, 4, 0}, {3, 2, 6, 4, 5, 1}, {2, 0, 4, 5, 7, 3}, {3, 1, 5, 4, 6, 2},
    {0, 4, 5, 7, 3, 2}, {1, 5, 4, 6, 2, 3}, {0, 4, 6, 7, 3, 1}, {1, 5, 7, 6, 2, 0},
    {2, 6, 7, 5, 1, 0}, {3, 7, 6, 4, 0, 1}, {2, 6, 4, 5, 1, 3}, {3, 7, 5, 4, 0, 2},
    {4, 5, 7, 3, 2, 0}, {5, 4, 6, 2, 3, 1}, {4, 6, 7, 3, 1, 0}, {5, 7, 6, 2, 0, 1},
    {6, 7, 5, 1, 0, 2}, {7, 6, 4, 0, 1, 3}, {6, 4, 5, 1, 3, 2}, {7, 5, 4, 0, 2, 3},
    {4, 5, 1, 3, 2, 6}, {5, 4, 0, 2, 3, 7}, {4, 6, 2, 3, 1, 5}, {5, 7, 3, 2, 0, 4},
    {6, 7, 3, 1, 0, 4}, {7, 6, 2, 0, 1, 5}, {6, 4, 0, 1, 3, 7}, {7, 5, 1, 0, 2, 6},
    {4, 0, 1, 3, 7, 6}, {5, 1, 0, 2, 6, 7}, {4, 0, 2, 3, 7, 5}, {5, 1, 3, 2, 6, 4},
    {6, 2, 3, 1, 5, 4}, {7, 3, 2, 0, 4, 5}, {6, 2, 0, 1, 5, 7}, {7, 3, 1, 0, 4, 6}};

/// The sector from 0 (B to C) to 5, or -1.
int sector_of(std::uint32_t pattern, unsigned code) noexcept {
  const std::uint8_t* row = kPatterns[pattern % 48];
  for (int i = 0; i < 6; ++i)
    if (row[i] == code) return (i + 1) % 6;
  return -1;
}
/// Without a sector one that the pattern does not have.
unsigned code_of(std::uint32_t pattern, int sector) noexcept {
  unsigned none = 0;
  while (sector < 0 && sector_of(pattern, none) >= 0) ++none;
  return sector < 0 ? none : kPatterns[pattern % 48][(sector + 5) % 6];
}

/// Part of a turn, from 0 up to 1.
double within_turn(double turns) noexcept {
  if (!std::isfinite(turns)) return 0.0;
  const double rest = turns - std::floor(turns);
  return rest < 1.0 ? rest : 0.0;
}
/// The sector from 0 (B to C) to 5 that drives a rotor onwards, a quarter of a turn ahead of it. A
/// border belongs to the sector before it.
int sector_at(double rotor) noexcept {
  return (static_cast<int>(std::ceil(rotor * 6.0 + 0.5)) + 6) % 6;
}
double wave(double turns) noexcept { return std::cos(2.0 * std::numbers::pi * turns); }

/// Source 1, sink -1 of phase A, B, C in a sector.
constexpr std::int8_t kDriven[6][3] = {{0, 1, -1}, {-1, 1, 0}, {-1, 0, 1},
                                       {0, -1, 1}, {1, -1, 0}, {1, 0, -1}};
}  // namespace

class BldcChannel : public hal::Channel {
 public:
  BldcChannel(hal::Builder& b, std::size_t index, std::string_view cfg) noexcept
      : Channel(b, hal::ChannelList{}.name(b, index)) {
    std::string_view letters;
    for (std::size_t i = 0; i <= index; ++i) letters = hal::next_field(cfg);
    if (!read(letters))
      b.fail(
          "cfg= takes for each motor the letters n h a q i f of its inputs and B 6 H F T of its "
          "outputs, like qi6");
    if (!b.failed()) declare_items(b);
  }

 private:
  enum class Align : std::uint8_t { waits, runs, done };
  struct Phase {
    hal::Out<double> value, high, low;
    hal::Out<bool> on, high_on, low_on;
  };

  bool read(std::string_view letters) noexcept {
    for (const char c : letters) switch (c) {
        case 'n': break;
        case 'h': wiring_.hall = true; break;
        case 'a': wiring_.absolute = true; break;
        case 'q': wiring_.quadrature = true; break;
        case 'i': wiring_.index = true; break;
        case 'f': wiring_.fanuc = true; break;
        case 'B': wiring_.bits = true; break;
        case '6': wiring_.six = true; break;
        case 'H': wiring_.hall_out = true; break;
        case 'F': wiring_.fanuc_out = true; break;
        case 'T': wiring_.trapezoidal = true; break;
        default: return false;
      }
    if (wiring_.hall && !wiring_.quadrature && (wiring_.absolute || wiring_.index)) begins_ = 2;
    return !letters.empty();
  }
  template <class Pin>
  void make(hal::Builder& b, Pin& pin, std::string_view name, std::string_view doc,
            typename Pin::Item initial = {}) noexcept {
    pin.declare(b, whole_name(name), doc, initial);
  }
  void declare_items(hal::Builder& b) noexcept {
    const Wiring& w = wiring_;
    static constexpr std::string_view kHalls[] = {"hall1", "hall2", "hall3"};
    static constexpr std::string_view kHallOuts[] = {"hall1-out", "hall2-out", "hall3-out"};
    static constexpr std::string_view kGrays[] = {"C1", "C2", "C4", "C8"};
    static constexpr std::string_view kGrayOuts[] = {"C1-out", "C2-out", "C4-out", "C8-out"};
    if (w.hall) {
      for (std::size_t i = 0; i < 3; ++i) make(b, hall_[i], kHalls[i], "Hall sensor");
      make(b, hall_error_, "hall-error",
           "The Hall signals came in an order that pattern does not have; never with T, nor with q "
           "without i and H or F");
      make(b, pattern_, "pattern", "Order of the Hall signals, 0 to 47", 25);
    }
    if (w.fanuc)
      for (std::size_t i = 0; i < 4; ++i) make(b, gray_[i], kGrays[i], "Bit of the Gray code");
    if (w.free()) make(b, frequency_, "frequency", "Turns of the field [1/s]");
    if (w.quadrature) make(b, initvalue_, "initvalue", "Current of the alignment", 0.2);
    if (w.counts()) {
      make(b, lead_angle_, "lead-angle", "Angle of the field before the rotor [degrees]", 90.0);
      make(b, rawcounts_, "rawcounts", "From rawcounts of the encoder");
      make(b, scale_, "scale", "Counts of a turn of the rotor", 512);
      make(b, poles_, "poles", "Poles of the motor", 4);
    }
    if (w.index) make(b, index_enable_, "index-enable", "With index-enable of the encoder");
    if (w.aligns()) {
      make(b, init_, "init", "A rising edge aligns the rotor");
      make(b, init_done_, "init-done", "The rotor is aligned");
    }
    if (w.absolute || w.index)
      make(b, encoder_offset_, "encoder-offset",
           "Counts from the encoder's zero to that of the motor", 0);
    if (w.quadrature)
      make(b, offset_measured_, "offset-measured", "Counts at which the alignment found zero", 0);
    static constexpr std::string_view kNames[3][6] = {
        {"A-value", "A-on", "A-high", "A-low", "A-high-on", "A-low-on"},
        {"B-value", "B-on", "B-high", "B-low", "B-high-on", "B-low-on"},
        {"C-value", "C-on", "C-high", "C-low", "C-high-on", "C-low-on"}};
    for (std::size_t i = 0; i < 3; ++i) {
      if (w.plain()) make(b, phase_[i].value, kNames[i][0], "Amplitude of the phase");
      if (w.hall_out || w.fanuc_out) continue;
      if (w.bits && !w.six) make(b, phase_[i].on, kNames[i][1], "Phase is at the high side");
      if (!w.bits && w.six) {
        make(b, phase_[i].high, kNames[i][2], "Amplitude of the high side");
        make(b, phase_[i].low, kNames[i][3], "Amplitude of the low side");
      }
      if (w.bits && w.six) {
        make(b, phase_[i].high_on, kNames[i][4], "High side is on");
        make(b, phase_[i].low_on, kNames[i][5], "Low side is on");
      }
    }
    if (w.hall_out) {
      for (std::size_t i = 0; i < 3; ++i)
        make(b, hall_out_[i], kHallOuts[i], "Hall signal for the drive");
      make(b, output_pattern_, "output-pattern", "Order of these signals, 0 to 47", 25);
    }
    if (w.fanuc_out)
      for (std::size_t i = 0; i < 4; ++i)
        make(b, gray_out_[i], kGrayOuts[i], "Bit of the Gray code for the drive");
  }

  hal::In<double> value_{pin<hal::In<double>>("value", "Wanted amplitude")};
  hal::In<bool> rev_{pin<hal::In<bool>>("rev", "True turns the other way")};
  hal::Out<double> phase_angle_{pin<hal::Out<double>>("phase-angle", "Angle of the field [turns]")};
  hal::Out<double> rotor_angle_{
      pin<hal::Out<double>>("rotor-angle", "Angle of the rotor [electrical turns]")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Amplitude with its sign")};
  hal::Out<bool> out_dir_{
      pin<hal::Out<bool>>("out-dir", "True while the amplitude with its sign is negative")};
  hal::Out<double> out_abs_{pin<hal::Out<double>>("out-abs", "Amplitude without its sign")};
  hal::RoParam<std::int32_t> in_type_{
      param<hal::RoParam<std::int32_t>>("in-type", "Kind of input in use", -1)};
  hal::RoParam<std::int32_t> out_type_{
      param<hal::RoParam<std::int32_t>>("out-type", "Kind of output in use", -1)};
  hal::Param<double> drive_offset_{param<hal::Param<double>>(
      "drive-offset", "Angle that the drive itself adds while the rotor is aligned [degrees]",
      0.0)};

  Wiring wiring_;
  hal::In<bool> hall_[3], gray_[4], init_;
  hal::Out<bool> hall_error_, init_done_, hall_out_[3], gray_out_[4];
  hal::Param<std::uint32_t> pattern_, output_pattern_;
  hal::In<double> frequency_, initvalue_, lead_angle_;
  hal::In<std::int32_t> rawcounts_;
  hal::Io<bool> index_enable_;
  hal::Param<std::int32_t> scale_, poles_, encoder_offset_;
  hal::RoParam<std::int32_t> offset_measured_;
  Phase phase_[3];

  /// Cycles without output; with Hall signals beside an absolute encoder or an index one more.
  int begins_{1};
  bool begun_{false}, commutated_{false}, code_seen_{false}, homed_{false}, init_before_{false};
  Align align_{Align::waits};
  unsigned code_{0};
  int sector_{-1};
  double rotor_{0.0}, field_{0.0}, current_{0.0};
  std::int64_t counts_before_{0}, offset_{0}, aligned_for_{0};

  [[nodiscard]] double counts_of_turn() const noexcept {
    const double pairs = std::fabs(poles_.get() * 0.5);
    return scale_ != 0 && pairs > 0.0 ? scale_ / pairs : 1.0;
  }
  /// The place in the middle of the coming period: the rotor goes on as it went.
  [[nodiscard]] double by_counts(std::int64_t counts, std::int64_t moved) const noexcept {
    const std::int64_t middle = counts - offset_ + moved / 2;
    return within_turn(static_cast<double>(middle) / counts_of_turn());
  }
  void report_halls() noexcept {
    if (!wiring_.silent()) hall_error_ = true;
  }
  void read_halls() noexcept {
    const unsigned code = (hall_[0] ? 4U : 0U) + (hall_[1] ? 2U : 0U) + (hall_[2] ? 1U : 0U);
    const int before = sector_;
    const bool changed = code_seen_ && code != code_;
    sector_ = sector_of(pattern_, code);
    const int step = (sector_ - before + 6) % 6;
    if (code_seen_ && sector_ < 0) report_halls();
    if (changed && (before < 0 || (step != 1 && step != 5))) report_halls();
    if (changed && wiring_.quadrature && !homed_ && !wiring_.index && sector_ >= 0 && before >= 0) {
      // The edge between the two sectors.
      rotor_ = within_turn((step == 1 ? before + 0.5 : sector_ + 0.5) / 6.0);
      offset_ =
          static_cast<std::int64_t>(static_cast<double>(rawcounts_) - rotor_ * counts_of_turn());
      offset_measured_ = static_cast<std::int32_t>(offset_);
      homed_ = true;
    } else {
      rotor_ = sector_ < 0 ? 0.0 : sector_ / 6.0;
    }
    code_ = code;
    code_seen_ = true;
  }
  /// Turns the rotor to a known place, one step for each cycle with init. False: nothing is known yet.
  bool align(double dt, std::int64_t counts) noexcept {
    const bool init = init_, rises = init && !init_before_;
    init_before_ = init;
    if (align_ == Align::done) {
      if (!rises) return true;
      align_ = Align::waits;
      init_done_ = false;
      return false;
    }
    if (!init) return false;
    if (align_ == Align::waits) {
      align_ = Align::runs;
      field_ = 0.0;
      aligned_for_ = 0;
    }
    if (wiring_.index) {
      current_ = std::fabs(initvalue_);
      field_ = within_turn(field_ + (initvalue_ < 0.0 ? -dt : dt));
      if (!index_enable_) return found(counts + encoder_offset_);
      apply_alignment(field_);
      return false;
    }
    // The current grows; then the field swings to both sides and back, so that the rotor comes loose
    // wherever it stands; then it settles.
    constexpr double kPartSeconds = 0.4;
    const double parts = static_cast<double>(aligned_for_++) * dt / kPartSeconds;
    constexpr double kRounding = 1e-9;
    if (parts >= 6.0 - kRounding) return found(counts);
    current_ = initvalue_ * std::fmin(parts, 1.0);
    field_ = within_turn(swing(parts));
    apply_alignment(within_turn(field_ - drive_offset_ / 360.0));
    return false;
  }
  /// The field during the alignment [turns], after parts of 0.4 s.
  static double swing(double parts) noexcept {
    if (parts < 1.0) return 0.0;
    if (parts < 3.0) return (1.0 - parts) / 8.0;
    if (parts < 4.0) return (parts - 3.5) / 2.0;
    if (parts < 5.0) return (5.0 - parts) / 4.0;
    return 0.0;
  }
  bool found(std::int64_t offset) noexcept {
    offset_ = offset;
    offset_measured_ = static_cast<std::int32_t>(offset_);
    align_ = Align::done;
    init_done_ = true;
    return false;
  }
  void apply_alignment(double rotor) noexcept {
    out_ = current_;
    out_abs_ = std::fabs(current_);
    phase_angle_ = field_;
    rotor_angle_ = rotor;
    const int sector = sector_at(rotor);
    if (wiring_.trapezoidal)
      trapezoid(sector, current_);
    else
      sinusoidal(field_, std::fabs(current_));
    // The bits follow value and rev, which are 0 and false while an axis is off.
    commutate(sector, out_dir_.last() ? -1.0 : 1.0, rotor);
  }

  void update(const hal::Period& period) noexcept {
    const Wiring& w = wiring_;
    const double value = value_;
    double out = rev_ ? -value : value;
    out_abs_ = std::fabs(value);
    out_dir_ = out < 0.0;
    const std::int64_t counts = w.counts() ? rawcounts_.get() : 0;
    const std::int64_t moved = counts - counts_before_;
    counts_before_ = counts;
    if (begins_ != 0) {
      --begins_;
      if (w.index && !begun_) index_enable_ = true;
      begun_ = true;
      return;
    }
    if (w.aligns() && !w.absolute && !align(period.seconds(), counts)) return;
    double lead = 0.25;
    bool by_sector = w.trapezoidal;
    if (w.hall && !homed_ && !w.absolute) {
      const bool was = homed_;
      read_halls();
      if (w.index && w.quadrature && !index_enable_) {
        offset_ = counts + encoder_offset_;
        offset_measured_ = static_cast<std::int32_t>(offset_);
        homed_ = true;
      }
      rotor_angle_ = rotor_;
      if (w.counts()) lead = lead_angle_ / 360.0;
      const bool found = homed_ && !was;
      phase_angle_ = within_turn(found ? rotor_ + lead : out < 0.0 ? rotor_ + 0.25 : rotor_ - 0.25);
      out_ = out;
      trapezoid(sector_, out);
      commutate(sector_, out, rotor_);
      return;
    }
    if (w.hall && !w.absolute) check_halls();
    if (w.counts()) {
      if (w.absolute) offset_ = encoder_offset_;
      rotor_ = by_counts(counts, moved);
      lead = lead_angle_ / 360.0;
    } else if (w.fanuc) {
      unsigned code =
          (gray_[0] ? 1U : 0U) + (gray_[1] ? 2U : 0U) + (gray_[2] ? 4U : 0U) + (gray_[3] ? 8U : 0U);
      code ^= code >> 2U;
      code ^= code >> 1U;
      // The middle of where the code is.
      rotor_ = (code + 0.5) / 16.0;
    } else {
      rotor_ = within_turn(rotor_ + frequency_ * period.seconds());
      lead = 0.0;
    }
    const bool turned = out < 0.0 && !(by_sector && w.counts());
    const double field = within_turn(turned ? rotor_ - lead : rotor_ + lead);
    out_ = out;
    rotor_angle_ = rotor_;
    phase_angle_ = field;
    const int sector = sector_at(rotor_);
    if (by_sector)
      trapezoid(sector, out);
    else
      sinusoidal(field, std::fabs(out));
    commutate(sector, out, rotor_);
  }
  /// After the alignment the Hall signals are only watched.
  void check_halls() noexcept {
    const unsigned code = (hall_[0] ? 4U : 0U) + (hall_[1] ? 2U : 0U) + (hall_[2] ? 1U : 0U);
    if (code == code_) return;
    const int before = sector_;
    sector_ = sector_of(pattern_, code);
    code_ = code;
    const int step = (sector_ - before + 6) % 6;
    if (sector_ < 0 || before < 0 || (step != 1 && step != 5)) report_halls();
  }
  void amplitude(std::size_t i, double v) noexcept {
    if (wiring_.plain()) phase_[i].value = v;
    if (wiring_.hall_out || wiring_.fanuc_out || wiring_.bits || !wiring_.six) return;
    phase_[i].high = v > 0.0 ? v : 0.0;
    phase_[i].low = v < 0.0 ? -v : 0.0;
  }
  void sinusoidal(double field, double size) noexcept {
    amplitude(0, size * wave(field));
    amplitude(1, size * wave(field - 1.0 / 3.0));
    amplitude(2, size * wave(field + 1.0 / 3.0));
  }
  void trapezoid(int sector, double out) noexcept {
    for (std::size_t i = 0; i < 3; ++i)
      amplitude(i, sector < 0 || kDriven[sector][i] == 0 ? 0.0 : out * kDriven[sector][i]);
  }
  /// Outputs that are bits.
  void commutate(int sector, double out, double rotor) noexcept {
    const Wiring& w = wiring_;
    if (w.bits && !w.hall_out && !w.fanuc_out) {
      for (std::size_t i = 0; i < 3; ++i) {
        const int driven = sector < 0 ? 0 : out < 0.0 ? -kDriven[sector][i] : kDriven[sector][i];
        if (w.six) {
          phase_[i].high_on = driven > 0;
          phase_[i].low_on = driven < 0;
        } else if (sector < 0 || driven != 0) {
          // A phase without current stays at the side where it was.
          phase_[i].on = driven > 0;
        }
      }
    }
    // With B or 6 beside them these begin one call later, as LinuxCNC's.
    const bool begins = !commutated_ && (w.bits || w.six);
    commutated_ = true;
    if (begins) return;
    if (w.hall_out) {
      const unsigned code = code_of(output_pattern_, sector);
      for (unsigned i = 0; i < 3; ++i) hall_out_[i] = (code >> (2U - i) & 1U) != 0;
    }
    if (w.fanuc_out) {
      const double end = std::ceil(rotor * 16.0);
      const unsigned at = end > 0.0 ? static_cast<unsigned>(end - 1.0) & 15U : 0U;
      const unsigned gray = at ^ at >> 1U;
      for (unsigned i = 0; i < 4; ++i) gray_out_[i] = (gray >> i & 1U) != 0;
    }
  }
  hal::Function update_{
      function<BldcChannel, &BldcChannel::update>("", "Computes the outputs from the inputs")};
};

class Bldc final : public hal::Component<Bldc> {
 public:
  static constexpr hal::Info kInfo{
      .name = "bldc",
      .summary = "Commutation of three-phase motors",
      .notes =
          "cfg= has the letters of each motor, with commas between, at most 8. Inputs: n none, h "
          "Hall "
          "sensors, a absolute encoder, q incremental encoder, i its index, f the Gray code of "
          "Fanuc's "
          "red caps. Outputs: B bits, 6 separate high and low sides, H Hall signals, F Gray code, "
          "T "
          "trapezoidal; without them three numbers. With qh the first change of the Hall signals "
          "tells "
          "where the rotor is. With q or qi a rising edge of init aligns it: the motor is pulled "
          "to "
          "phase A, or turned until the index has come, so do this before the axis is enabled.",
      .singleton = true,
      .example = "cfg=qh,aH",
      .lists = "cfg"};
  explicit Bldc(hal::Builder& b) noexcept : Component(b) {
    constexpr std::size_t kMost = 8;
    const std::string_view cfg = b.arg("cfg", "", "Letters of each motor, with commas between");
    const std::size_t count = hal::count_fields(cfg);
    if (count < 1 || count > kMost) {
      b.fail("cfg= takes the letters of 1 to 8 motors, with commas between");
      return;
    }
    channels_ = hal::make_array<BldcChannel>(b, count, cfg);
  }

 private:
  hal::Array<BldcChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Bldc)
