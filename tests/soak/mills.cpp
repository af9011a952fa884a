#include "soak/mills.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <fstream>

#include "soak/programs.hpp"

namespace kerf::soak {
namespace {

constexpr double kInch = 25.4;
constexpr std::array<double, 3> kLow{-0.01, -0.01, -120}, kHigh{300, 200, 0.01};
constexpr double kFarTurned = 900, kFarBeside = 100, kFarMixed = 3000;

struct Kind {
  const char* kinematics;
  const char* axes;  ///< of the joints
  int mixed;         ///< the first joints, that are not an axis each
};
constexpr std::array<Kind, 9> kKinds{{{"trivkins coordinates=XYZ", "XYZ", 0},
                                      {"trivkins coordinates=XYZ kinstype=BOTH", "XYZ", 0},
                                      {"trivkins coordinates=XYZA", "XYZA", 0},
                                      {"trivkins coordinates=XYYZ kinstype=BOTH", "XYYZ", 0},
                                      {"trivkins coordinates=XYZUVW", "XYZUVW", 0},
                                      {"corexykins", "XYZ", 2},
                                      {"rotatekins", "XYZABCUVW", 2},
                                      {"xyzac-trt-kins", "XYZAC", 3},
                                      {"xyzbc-trt-kins", "XYZBC", 3}}};

[[gnu::format(printf, 2, 3)]] void add(std::string& to, const char* format, ...) {
  char text[300];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  to += text;
}

double log_between(Dice& dice, double low, double high) {
  return low * std::exp(dice.between(0, std::log(high / low)));
}

bool turns(char letter) { return letter == 'A' || letter == 'B' || letter == 'C'; }

/// MIN_LIMIT to MAX_JERK of a joint or an axis, in units of `unit` mm.
void add_limits(std::string& ini, const MotionLimits& l, double unit) {
  add(ini, "MIN_LIMIT = %.12g\nMAX_LIMIT = %.12g\nMAX_VELOCITY = %.12g\nMAX_ACCELERATION = %.12g\n",
      l.low / unit, l.high / unit, l.vel / unit, l.acc / unit);
  if (l.jerk > 0) add(ini, "MAX_JERK = %.12g\n", l.jerk / unit);
}

}  // namespace

double Mill::stop_s() const {
  double longest = 0;
  for (const auto& l : joints) {
    const double rise = l.jerk > 0 ? l.acc / l.jerk : 0;
    longest = std::max(longest, l.vel / l.acc + 3 * rise);
  }
  return longest;
}

Mill sample_mill(double max_jerk) {
  Mill mill;
  mill.name = max_jerk > 0 ? "limited in jerk" : "limited in acceleration";
  constexpr std::array<double, 3> kMaxVel{100, 100, 60}, kMaxAcc{1000, 1000, 600};
  for (std::size_t n = 0; n < 3; ++n) {
    mill.axes[n] = {kMaxVel[n], kMaxAcc[n], max_jerk, kLow[n], kHigh[n]};
    mill.joints.push_back(mill.axes[n]);
  }
  mill.letters = mill.joint_letters = "xyz";
  if (max_jerk > 0)
    mill.options.replace = {
        {"MAX_LINEAR_VELOCITY = 120",
         "MAX_LINEAR_VELOCITY = 120\nMAX_LINEAR_JERK = " + std::to_string(max_jerk)}};
  // Joints may be jogged about before they are homed: the switches of the sample would end such rounds.
  mill.options.hal = {"setp x-motor.neg-limit-pos -1e6", "setp x-motor.pos-limit-pos 1e6",
                      "setp y-motor.neg-limit-pos -1e6", "setp y-motor.pos-limit-pos 1e6",
                      "setp z-motor.neg-limit-pos -1e6", "setp z-motor.pos-limit-pos 1e6"};
  return mill;
}

Mill random_mill(std::uint64_t seed, const std::filesystem::path& folder) {
  Dice dice(seed * 7919 + 17);
  const Kind& kind = kKinds[static_cast<std::size_t>(dice.below(kKinds.size()))];
  const std::string axes = kind.axes;
  const bool inch = dice.one_in(4);
  const double unit = inch ? kInch : 1;
  constexpr std::array<int, 5> kPeriods{250'000, 500'000, 1'000'000, 2'000'000, 4'000'000};
  const int period = kPeriods[static_cast<std::size_t>(dice.below(kPeriods.size()))];
  constexpr std::array<const char*, 5> kJerks{"none", "joint", "axis", "path", "all"};
  const std::string jerks = kJerks[static_cast<std::size_t>(dice.below(kJerks.size()))];
  const double acc = log_between(dice, 300, 5000), vel = log_between(dice, 40, 300),
               jerk = acc / log_between(dice, 0.004, 0.2);

  Mill mill;
  mill.has_switches = false;
  mill.has_free_pins = true;
  mill.max_vel = vel * dice.between(0.7, 2);
  std::string ini, hal;
  add(ini,
      "[EMC]\nVERSION = 1.1\n[DISPLAY]\nMAX_FEED_OVERRIDE = 1.5\n[RS274NGC]\nPARAMETER_FILE = "
      "mill.var\n"
      "RS274NGC_STARTUP_CODE = G17 G21 G40 G49 G64 P0.02 G80 G90 G94\n[EMCMOT]\nEMCMOT = motmod\n"
      "SERVO_PERIOD = %d\n[TASK]\nTASK = milltask\nCYCLE_TIME = 0.010\n[EMCIO]\nTOOL_TABLE = "
      "mill.tbl\n",
      period);
  add(ini, "[HAL]\nHALFILE = mill.hal\nHALFILE = spindle.hal\nHALFILE = panel.hal\n");
  add(ini,
      "[TRAJ]\nCOORDINATES = %s\nLINEAR_UNITS = %s\nANGULAR_UNITS = degree\nSPINDLES = 1\n"
      "MAX_LINEAR_VELOCITY = %.12g\nMAX_ANGULAR_VELOCITY = 1000\n",
      kind.axes, inch ? "inch" : "mm", mill.max_vel / unit);
  const bool along_path = jerks == "path" || jerks == "all";
  if (along_path) add(ini, "MAX_LINEAR_JERK = %.12g\n", jerk / unit);
  add(ini, "[KINS]\nKINEMATICS = %s\nJOINTS = %zu\n[KERF]\nPATH_CHECK = 1\nHEARTBEAT_TIMEOUT = 1\n",
      kind.kinematics, axes.size());
  add(ini, "[SPINDLE_0]\nMAX_FORWARD_VELOCITY = 12000\nMAX_REVERSE_VELOCITY = 12000\n");
  add(hal,
      "loadrt [KINS]KINEMATICS\nloadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD "
      "num_joints=[KINS]JOINTS num_spindles=[TRAJ]SPINDLES\naddf motion-command-handler "
      "servo-thread\n"
      "addf motion-controller servo-thread\n");

  for (std::size_t n = 0; n < axes.size(); ++n) {
    const char letter = axes[n];
    const bool second = axes.find(letter) < n, mixed = static_cast<int>(n) < kind.mixed;
    MotionLimits own{vel * log_between(dice, 0.5, 2), acc * log_between(dice, 0.5, 2),
                     jerk * log_between(dice, 0.5, 2)};
    const double far = turns(letter) ? kFarTurned : kFarBeside;
    own.low = letter <= 'Z' && letter >= 'X' ? kLow[static_cast<std::size_t>(letter - 'X')] : -far;
    own.high = letter <= 'Z' && letter >= 'X' ? kHigh[static_cast<std::size_t>(letter - 'X')] : far;
    if (second) own = mill.joints.back();
    MotionLimits joint = own;
    const double u = turns(letter) ? 1 : unit;
    if (jerks != "joint" && jerks != "all") joint.jerk = 0;
    if (mixed) joint.low = -kFarMixed, joint.high = kFarMixed;
    if (!second) {
      MotionLimits axis = own;
      axis.vel *= dice.between(0.5, 1.2);
      axis.acc *= dice.between(0.5, 1.2);
      if (jerks != "axis" && jerks != "all") axis.jerk = 0;
      add(ini, "[AXIS_%c]\n", letter);
      add_limits(ini, axis, u);
      if (letter >= 'X') mill.axes[static_cast<std::size_t>(letter - 'X')] = axis;
      mill.letters += static_cast<char>(letter - 'A' + 'a');
    }
    if (kind.mixed == 0) mill.joint_letters += static_cast<char>(letter - 'A' + 'a');
    add(ini, "[JOINT_%zu]\nTYPE = %s\n", n, turns(letter) ? "ANGULAR" : "LINEAR");
    add_limits(ini, joint, u);
    // A gantry's motors are one axis: homed together, they stay together.
    const int sequence = axes.find("YY") == std::string::npos ? 0 : letter == 'Y' ? -1 : 0;
    add(ini,
        "FERROR = 500\nMIN_FERROR = 500\nHOME = 0\nHOME_OFFSET = 0\nHOME_SEARCH_VEL = 0\n"
        "HOME_LATCH_VEL = 0\nHOME_SEQUENCE = %d\n",
        sequence);
    add(hal, "net fb-%zu joint.%zu.motor-pos-cmd => joint.%zu.motor-pos-fb\n", n, n, n);
    if (jerks == "path" && !mixed && !turns(letter)) joint.jerk = jerk;
    mill.joints.push_back(joint);
  }

  const std::filesystem::path sample = KERF_SOURCE_DIR "/configs/sim/mill";
  for (const char* file : {"spindle.hal", "panel.hal"})
    std::filesystem::copy_file(sample / file, folder / file,
                               std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "mill.ini") << ini;
  std::ofstream(folder / "mill.hal") << hal;
  std::string tools;
  constexpr std::array<int, 3> kLengths{40, 30, 50};  // of the sample's
  for (std::size_t n = 0; n < 3; ++n)
    add(tools, "T%zu P%zu Z%.12g D%.12g\n", n + 1, n + 1, kLengths[n] / unit, 6 / unit);
  std::ofstream(folder / "mill.tbl") << tools;
  mill.options.ini = (folder / "mill.ini").string();
  char text[200];
  std::snprintf(text, sizeof text, "%s in %s, %g ms, jerk %s (%.0f/%.0f/%.0f)", kind.kinematics,
                inch ? "inches" : "mm", period / 1e6, jerks.c_str(), vel, acc, jerk);
  mill.name = text;
  return mill;
}

}  // namespace kerf::soak
