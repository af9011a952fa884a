// Abort at every servo cycle of short programs.
//
// KERF_COUNT=N machine_test --gtest_filter='*AbortAtEveryCycle*' looks at about N cycles of each program, by default 150 (60 with
// jerk limits); 10000 is all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr double kPeriod = 0.001;
constexpr std::array<double, 3> kAcc{1000, 1000, 600};
constexpr std::array<double, 3> kVel{100, 100, 60};
using Point = std::array<double, 3>;

Point place(const motion::MotionStatus& s) {
  return {s.joint[0].pos_cmd, s.joint[1].pos_cmd, s.joint[2].pos_cmd};
}

double distance(const Point& p, const Point& a, const Point& b) {
  double along = 0, length = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    length += (b[i] - a[i]) * (b[i] - a[i]);
  }
  const double t = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  double d = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double gap = p[i] - a[i] - t * (b[i] - a[i]);
    d += gap * gap;
  }
  return std::sqrt(d);
}

struct Program {
  const char* name;
  const char* text;
  std::vector<std::string> hal{};
  double jerk{0};  ///< limit of all joints [mm/s3], 0 none
};

/// What the whole run does, cycle by cycle.
struct Course {
  std::vector<Point> at;
};

class Stop {
 public:
  Stop(Machine& m, const Course& course, std::size_t cycle, double jerk, const std::string& where)
      : m_(m), course_(course), cycle_(cycle), jerk_(jerk), where_(where) {}

  void check() {
    last_ = place(m_.motion());
    for (std::size_t j = 0; j < 3 && cycle_ > 1; ++j) {
      const double before = course_.at[cycle_ - 1][j];
      vel_[j] = (last_[j] - before) / kPeriod;
      acc_[j] = (vel_[j] - (before - course_.at[cycle_ - 2][j]) / kPeriod) / kPeriod;
    }
    const std::uint64_t faults = m_.motion().faults;
    m_.on_cycle([this](const motion::MotionStatus& s) { look(s); });
    const auto asked = m_.now();
    EXPECT_EQ(m_.abort().state, task::CommandState::done) << where_;
    EXPECT_LE(static_cast<double>(m_.now() - asked) * 1e-9, 0.3) << where_;
    const Point rest = place(m_.motion());
    const std::uint64_t outputs = m_.motion().digital_out;
    m_.run_for(0.3);
    EXPECT_EQ(place(m_.motion()), rest) << where_ << "it moves after its stop";
    EXPECT_EQ(m_.motion().digital_out, outputs) << where_ << "an output changes after the stop";
    EXPECT_EQ(m_.motion().faults, faults) << where_ << m_.errors();
    EXPECT_LE(worst_acc_, 1.001) << where_ << "share of the acceleration limit";
    EXPECT_LE(worst_vel_, 1.001) << where_ << "share of the velocity limit";
    EXPECT_LE(worst_jerk_, 1.01) << where_ << "share of the jerk limit";
    EXPECT_LE(off_path_, 0.001) << where_ << "mm beside the path";
    EXPECT_EQ(late_outputs_, 0) << where_ << "outputs changed behind the abort";
    EXPECT_FALSE(m_.bit("spindle.0.on")) << where_;
    EXPECT_EQ(spindle_starts_, 0) << where_;
    EXPECT_TRUE(m_.task().idle) << where_;
    shown_position_moves_nothing();
    // What waited for a next move is forgotten.
    EXPECT_TRUE(m_.mdi("G91 G0 Z0.01")) << where_ << m_.errors();
    EXPECT_EQ(m_.motion().digital_out, outputs) << where_ << "an output of the aborted program";
  }

 private:
  void look(const motion::MotionStatus& s) {
    const Point now = place(s);
    for (std::size_t j = 0; j < 3; ++j) {
      const double v = (now[j] - last_[j]) / kPeriod;
      worst_vel_ = std::max(worst_vel_, std::fabs(v) / kVel[j]);
      const double a = (v - vel_[j]) / kPeriod;
      worst_acc_ = std::max(worst_acc_, std::fabs(a) / kAcc[j]);
      if (jerk_ > 0) worst_jerk_ = std::max(worst_jerk_, std::fabs(a - acc_[j]) / kPeriod / jerk_);
      acc_[j] = a;
      vel_[j] = v;
    }
    // A stop takes less than 200 cycles of the path.
    double beside = std::numeric_limits<double>::max();
    const std::size_t end = std::min(cycle_ + 200, course_.at.size() - 1);
    for (std::size_t i = cycle_ > 2 ? cycle_ - 2 : 0; i < end; ++i)
      beside = std::min(beside, distance(now, course_.at[i], course_.at[i + 1]));
    off_path_ = std::max(off_path_, beside);
    // The servo cycle in which the abort arrives may still be one of the program.
    if (++cycles_ > 2 && s.digital_out != outputs_) ++late_outputs_;
    if (cycles_ > 2 && s.spindle[0].on) ++spindle_starts_;
    outputs_ = s.digital_out;
    last_ = now;
  }

  void shown_position_moves_nothing() {
    const auto s = m_.motion();
    const std::string line = m_.line_to_shown_place();
    const Point before = place(s);
    m_.on_cycle(nullptr);
    EXPECT_TRUE(m_.mdi(line)) << where_ << m_.errors();
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(place(m_.motion())[j], before[j], 1e-9) << where_ << line;
  }

  Machine& m_;
  const Course& course_;
  std::size_t cycle_;
  double jerk_;
  const std::string& where_;
  Point last_{}, vel_{}, acc_{};
  double worst_jerk_{0}, worst_acc_{0}, worst_vel_{0}, off_path_{0};
  std::uint64_t outputs_{0};
  int cycles_{0}, late_outputs_{0}, spindle_starts_{0};
};

constexpr const char* kCorners =
    "G64 P0.1\nS300 M3\nF2400\nG1 X12\nM62 P1\nM3 S400\nG1 Y12\nM63 P1\nG1 X13 Y12.5\nG1 X14 Y12\n"
    "G1 X15 Y13\nM62 P2\nG1 X13.5 Y12 Z-10.6\nM2\n";
constexpr const char* kArcs =
    "F2000\nS300 M3\nG2 X11.2 Y10 I0.6 J0\nM62 P1\nG3 X11.2 Y10 I-0.5 J0.25 Z-10.4\n"
    "G18 G2 X11.8 Z-10.4 I0.3 K0\nG17 G1 X12.2\nM63 P1\nG3 X11.4 Y10.8 R1\nM2\n";

const Program programs[] = {
    {"corners", kCorners},
    {"arcs", kArcs},
    {"peck",
     "F1200\nS300 M3\nG0 Z-9.8\nG99 G83 X10.5 Y10.5 Z-10.5 R-9.8 Q0.4\nX11 Q2\nG80\nG0 "
     "Z-9.6\nM2\n"},
    {"probe",
     "F900\nG38.2 Z-15\nG10 L20 P1 Z0\nG0 Z0.4\nG91\nG38.3 Z-1 F300\nG90\nG1 Z0.2\nG1 X11 "
     "F900\nM2\n",
     {"loadrt comp names=touch", "addf touch servo-thread", "setp touch.in1 -10.6",
      "setp touch.hyst 0.0001", "net touch-z joint.2.pos-cmd touch.in0",
      "net touched touch.out motion.probe-input"}},
    {"words",
     "o<dot> sub\n  M62 P1\n  G1 Y[#1] F2400\n  M63 P1\n  G1 Y10\no<dot> endsub\nT1 M6\nG43 "
     "H1\nS800 M3\n#1=11\no1 while [#1 LT 13]\n  o<dot> call [#1]\n  #1=[#1+1]\no1 endwhile\nM64 "
     "P3\nG10 L2 P2 X1\nG55\nG1 X12\nM65 P3\nG54\nM2\n"},
    // With laws of time: those of the path, and the stops that are kept ready.
    {.name = "corners_with_jerk", .text = kCorners, .jerk = 40'000},
    {.name = "arcs_with_jerk", .text = kArcs, .jerk = 100'000},
};

class AbortAtEveryCycle : public testing::TestWithParam<Program> {};

TEST_P(AbortAtEveryCycle, StopsOnThePathAndNothingLaterRuns) {
  const char* given = std::getenv("KERF_COUNT");
  // With jerk limits each case has plans of its own to make.
  const std::size_t by_default = GetParam().jerk > 0 ? 60 : 150;
  const std::size_t wanted = given != nullptr ? std::strtoul(given, nullptr, 10) : by_default;
  MachineOptions options;
  options.hal = GetParam().hal;
  // The tool change is where the program is.
  options.replace = {{"TOOL_CHANGE_POSITION = 0 0 0", "TOOL_CHANGE_POSITION = 10 10 -10"}};
  if (GetParam().jerk > 0)
    options.replace.emplace_back(
        "MAX_LINEAR_VELOCITY = 120",
        "MAX_LINEAR_VELOCITY = 120\nMAX_LINEAR_JERK = " + std::to_string(GetParam().jerk));
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G53 G0 X10 Y10 Z-10")) << m->errors();
  const std::string path = m->write_program(GetParam().text);

  const auto each = [&](const std::function<void(std::size_t)>& f) {
    const auto run = m->start_program(path);
    std::size_t n = 0;
    for (; !task::is_terminal(m->outcome(run).state) && n < 5000; ++n) {
      f(n);
      m->cycle();
    }
    f(n);
    EXPECT_EQ(m->outcome(run).state, task::CommandState::done)
        << m->outcome(run).text << m->errors();
    return n;
  };
  Course course;
  // Once in a branch to know the course; its cycles come back through a file.
  const std::string file = m->folder() + "/course";
  ASSERT_EQ(m->branch([&] {
    std::FILE* out = std::fopen(file.c_str(), "w");
    each([&](std::size_t) {
      const Point p = place(m->motion());
      std::fwrite(p.data(), sizeof(double), 3, out);
    });
    std::fclose(out);
  }),
            0);
  std::FILE* in = std::fopen(file.c_str(), "r");
  ASSERT_NE(in, nullptr);
  for (Point p; std::fread(p.data(), sizeof(double), 3, in) == 3;) course.at.push_back(p);
  std::fclose(in);
  EXPECT_GT(course.at.size(), 200U);
  EXPECT_LE(course.at.size(), 600U);

  const std::size_t every =
      std::max<std::size_t>(1, course.at.size() / std::max<std::size_t>(1, wanted));
  std::size_t failures = 0, cases = 0;
  each([&](std::size_t n) {
    if (n % every != 0 || failures > 3 || n + 1 >= course.at.size()) return;
    const std::string where = std::string(GetParam().name) + " cycle " + std::to_string(n) +
                              " line " + std::to_string(m->task().current_line) + ": ";
    ++cases;
    failures +=
        m->branch([&] { Stop(*m, course, n, GetParam().jerk, where).check(); }) != 0 ? 1 : 0;
  });
  EXPECT_EQ(failures, 0U) << "of " << cases;
  std::printf("[ figures ] abort in %s: %zu of its %zu cycles, %zu failed\n", GetParam().name,
              cases, course.at.size(), failures);
}

INSTANTIATE_TEST_SUITE_P(Programs, AbortAtEveryCycle, testing::ValuesIn(programs),
                         [](const auto& p) { return std::string(p.param.name); });

}  // namespace
}  // namespace kerf::harness
