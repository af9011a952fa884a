#include "motion/motmod/args.hpp"

#include <algorithm>

namespace kerf::motion {
namespace {

using Text = rtapi::FixedString<200>;

void append_number(Text& text, std::int64_t value) noexcept {
  if (value < 0) text.append("-");
  const auto magnitude =
      value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  text.append(hal::numbered("#", magnitude));
}

/// Decimal or 0x hexadecimal with sign; false: no number.
bool parse(std::string_view text, std::int64_t& out) noexcept {
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  std::int64_t base = 10;
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    base = 16;
    text.remove_prefix(2);
  }
  if (text.empty() || text.size() > 15) return false;
  std::int64_t value = 0;
  for (const char c : text) {
    std::int64_t digit = 99;
    if (c >= '0' && c <= '9') digit = c - '0';
    if (c >= 'a' && c <= 'f') digit = c - 'a' + 10;
    if (c >= 'A' && c <= 'F') digit = c - 'A' + 10;
    if (digit >= base) return false;
    value = value * base + digit;
  }
  out = negative ? -value : value;
  return true;
}

std::int64_t integer(hal::Builder& b, std::string_view name, std::string_view fallback,
                     std::string_view doc) noexcept {
  const std::string_view text = b.arg(name, fallback, doc);
  std::int64_t value = 0;
  if (!text.empty() && !parse(text, value)) {
    Text what("MOTION: ");
    what.append(name);
    what.append("=");
    what.append(text);
    what.append(" is not an integer");
    b.fail(what);
  }
  return value;
}

/// "MOTION: num_dio is 65, must be between 1 and 64"
std::int32_t ranged(hal::Builder& b, std::string_view name, std::int64_t value, std::int64_t low,
                    std::int64_t high) noexcept {
  if (value >= low && value <= high) return static_cast<std::int32_t>(value);
  Text what("MOTION: ");
  what.append(name);
  what.append(" is ");
  append_number(what, value);
  what.append(", must be between ");
  append_number(what, low);
  what.append(" and ");
  append_number(what, high);
  b.fail(what);
  return static_cast<std::int32_t>(std::clamp(value, low, high));
}

std::int32_t count_or_names(hal::Builder& b, std::string_view key, std::string_view doc,
                            std::string_view kind, std::string_view first, std::string_view second,
                            std::int64_t most) noexcept {
  const std::string_view text = b.arg(key, "", doc);
  const std::size_t names = std::max(count_names(first), count_names(second));
  if (names > 0) {
    if (!text.empty()) {
      Text what("MOTION: Can't specify both names and number for ");
      what.append(kind);
      what.append(" pins");
      b.fail(what);
    }
    return ranged(b, key, static_cast<std::int64_t>(names), 1, most);
  }
  std::int64_t value = 4;
  if (!text.empty() && !parse(text, value)) b.fail("MOTION: the number of pins is not an integer");
  return ranged(b, key, value, 1, most);
}

}  // namespace

std::string_view take_name(std::string_view& list) noexcept {
  while (!list.empty() && list[0] == ',') list.remove_prefix(1);
  const std::size_t end = std::min(list.find(','), list.size());
  const std::string_view name(list.data(), end);
  list.remove_prefix(end);
  return name;
}

std::size_t count_names(std::string_view list) noexcept {
  std::size_t n = 0;
  while (!take_name(list).empty()) ++n;
  return n;
}

MotmodArgs read_args(hal::Builder& b) noexcept {
  MotmodArgs a;
  a.base_period_ns =
      integer(b, "base_period_nsec", "0", "Period of base-thread [ns]; 0: no such thread");
  a.servo_period_ns = integer(b, "servo_period_nsec", "1000000", "Period of servo-thread [ns]");
  (void)integer(b, "traj_period_nsec", "0",
                "Accepted for old INI files; the planner has no period");
  (void)integer(b, "base_thread_fp", "1", "Accepted for old INI files");
  (void)integer(b, "key", "0", "Accepted for old INI files");
  if (a.servo_period_ns < 10'000 || a.servo_period_ns > 100'000'000) {
    b.fail("MOTION: servo_period_nsec must be between 10000 and 100000000");
    a.servo_period_ns = 1'000'000;
  }
  if (a.base_period_ns < 0 || a.base_period_ns > a.servo_period_ns) {
    b.fail("MOTION: base_period_nsec must be between 0 and servo_period_nsec");
    a.base_period_ns = 0;
  }
  a.joints = ranged(b, "num_joints", integer(b, "num_joints", "16", "Joints, [KINS]JOINTS"), 1,
                    kMaxJoints);
  a.extra_joints =
      ranged(b, "num_extrajoints",
             integer(b, "num_extrajoints", "0", "Of these, homed but not moved by kinematics"), 0,
             a.joints);
  a.spindles = ranged(b, "num_spindles",
                      integer(b, "num_spindles", "1", "Spindles, [TRAJ]SPINDLES"), 1, kMaxSpindles);
  a.names_din = b.arg("names_din", "", "Names of digital inputs: motion.din-NAME");
  a.names_dout = b.arg("names_dout", "", "Names of digital outputs: motion.dout-NAME");
  a.names_ain = b.arg("names_ain", "", "Names of analog inputs: motion.ain-NAME");
  a.names_aout = b.arg("names_aout", "", "Names of analog outputs: motion.aout-NAME");
  a.names_misc = b.arg("names_misc_errors", "", "Names of error inputs: motion.err-NAME");
  a.dio = count_or_names(b, "num_dio", "Digital inputs and outputs (4)", "digital", a.names_din,
                         a.names_dout, kMaxDigital);
  a.aio = count_or_names(b, "num_aio", "Analog inputs and outputs (4)", "analog", a.names_ain,
                         a.names_aout, kMaxAnalog);
  a.misc_errors =
      ranged(b, "num_misc_error",
             integer(b, "num_misc_error", "0", "Error inputs motion.misc-error-NN"), 0, 64);
  a.unlock_mask =
      static_cast<std::uint32_t>(integer(b, "unlock_joints_mask", "0", "Joints with unlock pins"));
  return a;
}

}  // namespace kerf::motion
