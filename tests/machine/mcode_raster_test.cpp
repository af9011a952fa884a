// M62, M63 and M67 between thousands of short blocks: each edge at its programmed point of the path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr int kBlocks = 5000;
constexpr double kStepX = 0.048, kStepY = 0.036;  // blocks of 0.06 mm, a corner between any two
constexpr double kFeed = 20;                      // mm/s
constexpr double kCycle = 0.001;                  // s

struct Point {
  double x{0}, y{0};
};

struct Raster {
  std::string path_mode;
  bool corners;         ///< zigzag; else one straight line, whose blocks may be merged
  double tolerance_mm;  ///< how far from the programmed points the path may be
};

// GoogleTest looks for this name. NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const Raster& r, std::ostream* out) {
  *out << r.path_mode << (r.corners ? " zigzag" : " line");
}

Point programmed(const Raster& r, int block) {
  return {kStepX * block, r.corners && block % 2 == 1 ? kStepY : 0};
}

/// Before block n: analog output 0 becomes n, digital output 0 is on before odd ones, and output 1 turns every 7 blocks.
std::string program(const Raster& r) {
  std::string text = r.path_mode + "\nG0 X0 Y0\nF" + std::to_string(kFeed * 60) + "\n";
  char line[160];
  for (int n = 1; n <= kBlocks; ++n) {
    std::snprintf(line, sizeof line, "M67 E0 Q%d\nM6%d P0\n", n, n % 2 == 1 ? 2 : 3);
    text += line;
    if (n % 7 == 0) text += n % 14 == 0 ? "M63 P1\n" : "M62 P1\n";
    const Point to = programmed(r, n);
    std::snprintf(line, sizeof line, "G1 X%.4f Y%.4f\n", to.x, to.y);
    text += line;
  }
  return text + "M2\n";
}

class OutputRaster : public testing::TestWithParam<Raster> {};

TEST_P(OutputRaster, EveryEdgeIsAtItsPointInOrder) {
  const Raster& r = GetParam();
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  int seen = 0, wrong_order = 0, wrong_bits = 0;
  double farthest = 0, fastest = 0, slowest = 1e9;
  m->on_cycle([&](const motion::MotionStatus& s) {
    fastest = std::max(fastest, s.vel_mm_s);
    if (seen > 10 && seen < kBlocks - 10) slowest = std::min(slowest, s.vel_mm_s);
    const int now = static_cast<int>(s.analog_out[0]);
    if (now == seen) return;
    if (now != seen + 1) ++wrong_order;
    seen = now;
    if (m->bit("motion.digital-out-00") != (now % 2 == 1)) ++wrong_bits;
    if (m->bit("motion.digital-out-01") != (now / 7 % 2 == 1)) ++wrong_bits;
    const Point at = programmed(r, now - 1);
    farthest = std::max(farthest, std::hypot(s.pos_cmd.x - at.x, s.pos_cmd.y - at.y));
  });
  EXPECT_EQ(m->run_text(program(r)).state, task::CommandState::done) << m->errors();
  EXPECT_EQ(seen, kBlocks);
  EXPECT_EQ(wrong_order, 0);
  EXPECT_EQ(wrong_bits, 0);
  // Outputs on the path cost no speed.
  if (r.path_mode.starts_with("G61"))
    EXPECT_LT(slowest, 0.5);
  else
    EXPECT_GT(slowest, r.corners ? 0.5 : kFeed - 0.1) << fastest;
  // What the path is off by, and one servo cycle of motion.
  EXPECT_LE(farthest, r.tolerance_mm + fastest * kCycle + 1e-6);
  RecordProperty("farthest_um", static_cast<int>(farthest * 1000));
  RecordProperty("fastest_um_s", static_cast<int>(fastest * 1000));
}

INSTANTIATE_TEST_SUITE_P(Modes, OutputRaster,
                         testing::Values(Raster{"G64 P0.01", true, 0.01},
                                         Raster{"G64 P0.01", false, 0.01},
                                         Raster{"G64 P0.01 Q0.01", false, 0.01},
                                         Raster{"G61", true, 0}, Raster{"G61.1", true, 0}));

}  // namespace
}  // namespace kerf::harness
