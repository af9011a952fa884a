#include "soak/programs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace kerf::soak {
namespace {

/// Where the tool may go, in machine coordinates: within the soft limits, tools of up to 50 mm included.
constexpr double kLowX = 5, kHighX = 295, kLowY = 5, kHighY = 195, kLowZ = -65, kHighZ = -5;
/// Of mill.tbl.
constexpr int kTools = 3;
constexpr int kLength[kTools] = {40, 30, 50};

[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  char text[200];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return std::string(text) + "\n";
}

class Writer {
 public:
  explicit Writer(Dice& dice) : dice_(dice) {}

  Program write() {
    // The place from which incremental words count; the rest of the state is of the program's own making.
    add("G21 G90 G94 G40 G49 G54 G17 G80 G64 P0.05\nG10 L2 P1 X0 Y0 Z0 R0\nG92.1\n");
    add(line("F%.0f", dice_.between(800, 6000)));
    one_tool_ = dice_.one_in(4);
    // Its places are those of the tip; Z of G54 takes the length back, so that they lie where those of other programs do.
    if (one_tool_) {
      const int t = dice_.below(kTools);
      add(line("T%d M6\nG43 H%d\nG10 L2 P1 Z%d", t + 1, t + 1, -kLength[t]));
    }
    go_to(true);
    const int blocks = 5 + dice_.below(40);
    for (int i = 0; i < blocks; ++i) block();
    if (dice_.one_in(25)) {
      add(wrong());
      out_.is_sound = false;
    }
    add(dice_.one_in(2) ? "M2\n" : "M30\n");
    return out_;
  }

 private:
  void add(const std::string& text) { out_.text += text; }
  double x() { return dice_.between(kLowX, kHighX); }
  double y() { return dice_.between(kLowY, kHighY); }
  double z() { return dice_.between(kLowZ, kHighZ); }

  void go_to(bool rapid) {
    x_ = x(), y_ = y(), z_ = z();
    add(line("%s X%.4f Y%.4f Z%.4f", rapid ? "G0" : "G1", x_, y_, z_));
  }
  void near(double reach) {
    x_ = std::clamp(x_ + dice_.between(-reach, reach), kLowX, kHighX);
    y_ = std::clamp(y_ + dice_.between(-reach, reach), kLowY, kHighY);
    z_ = std::clamp(z_ + dice_.between(-reach, reach) / 4, kLowZ, kHighZ);
    add(line("G1 X%.4f Y%.4f Z%.4f", x_, y_, z_));
  }
  /// Short segments along a wave, as CAM programs have them.
  void wave() {
    const int points = 10 + dice_.below(60);
    const double step = dice_.between(0.05, 2), height = dice_.between(0.1, 5);
    const double from_x = std::clamp(x_, kLowX, kHighX - points * step),
                 mid = std::clamp(y_, kLowY + 5, kHighY - 5);
    add(line("G1 X%.4f Y%.4f", from_x, mid));
    for (int i = 0; i < points; ++i) {
      x_ = from_x + i * step;
      y_ = mid + height * std::sin(i * 0.7);
      add(line("X%.4f Y%.4f", x_, y_));
    }
  }
  void circle() {
    const double room = std::min({x_ - kLowX, kHighX - x_, y_ - kLowY, kHighY - y_}) / 2;
    if (room < 0.2) return near(20);
    const double r = dice_.between(0.1, std::min(room, 40.0)), a = dice_.between(0, 6.28);
    const double i = r * std::cos(a), j = r * std::sin(a);
    const char* code = dice_.one_in(2) ? "G2" : "G3";
    if (dice_.one_in(3)) {
      add(line("%s X%.4f Y%.4f I%.6f J%.6f P%d", code, x_, y_, i, j, 1 + dice_.below(2)));
      return;
    }
    // The end is written with more digits than the tolerance of arcs needs.
    const double b = a + 3.14159265358979 + dice_.between(0.1, 6.1);
    const double end_x = x_ + i + r * std::cos(b), end_y = y_ + j + r * std::sin(b);
    add(line("%s X%.8f Y%.8f I%.8f J%.8f", code, end_x, end_y, i, j));
    x_ = end_x, y_ = end_y;
  }
  void cycle() {
    add(line("S%d M3", 300 + dice_.below(3000)));
    const double r = z_, bottom = std::max(kLowZ, z_ - dice_.between(1, 12));
    const char* code[] = {"G81", "G82", "G83", "G73", "G85", "G89"};
    const int which = dice_.below(6);
    std::string words = which == 2 || which == 3   ? " Q1.7"
                        : which == 1 || which == 5 ? " P0.05"
                                                   : "";
    add(line("G99 %s X%.3f Y%.3f Z%.3f R%.3f%s", code[which], x_, y_, bottom - 0.001, r,
             words.c_str()));
    for (int i = dice_.below(4); i > 0; --i) {
      x_ = x(), y_ = y();
      add(line("X%.3f Y%.3f", x_, y_));
    }
    add("G80\n");
    if (dice_.one_in(2)) add("M5\n");
  }
  void loop() {
    const int n = ++labels_;
    x_ = std::clamp(x_, kLowX, kHighX - 30);
    add(line("G1 X%.4f", x_));
    add(line(
        "#%d=0\no%d while [#%d lt %d]\n  G91 G1 X%.3f\n  Y%.3f\n  Y%.3f\n  G90\n  #%d=[#%d+1]\no%d "
        "endwhile",
        n, n, n, 2 + dice_.below(6), 1.5, y_ > 100 ? -3.0 : 3.0, y_ > 100 ? 3.0 : -3.0, n, n, n));
    go_to(false);
  }
  void sub() {
    const int n = ++labels_;
    add(line(
        "o%d sub\n  G1 X[#1] Y[#2]\n  o%d if [#3 gt 0]\n    G1 Z[#3 - 60]\n  o%d endif\no%d endsub",
        n, n + 500, n + 500, n));
    for (int i = 1 + dice_.below(3); i > 0; --i) {
      x_ = x(), y_ = y();
      add(line("o%d call [%.3f] [%.3f] [%d]", n, x_, y_, 1 + dice_.below(20)));
    }
    go_to(dice_.one_in(2));
  }
  void tool() {
    if (one_tool_) return go_to(true);
    const int t = 1 + dice_.below(kTools);
    add(line("T%d M6", t));
    if (dice_.one_in(2)) {
      // The lengths are subtracted again, so that all stays within the limits.
      add(line("G43 H%d", t));
      add("G49\n");
    }
    go_to(true);
  }
  void thread() {
    add(line("S%d M3", 100 + dice_.below(300)));
    const double to = std::max(kLowZ, z_ - 6);
    if (z_ - to < 3) return;
    add(line("G33 Z%.3f K%.2f", to, dice_.between(0.2, 1.5)));
    z_ = to;
    add("M5\n");
    go_to(true);
  }
  void block() {
    switch (dice_.below(24)) {
      case 0: return go_to(true);
      case 1:
      case 2:
      case 3: return go_to(false);
      case 4:
      case 5:
      case 6: return near(15);
      case 7: return near(0.5);
      case 8: return wave();
      case 9:
      case 10: return circle();
      case 11: return cycle();
      case 12: return loop();
      case 13: return sub();
      case 14: return tool();
      case 15: return thread();
      case 16: {
        const char* modes[] = {"G61", "G61.1", "G64", "G64 P0.01", "G64 P1", "G64 P0.1 Q0.05"};
        return add(line("%s", modes[dice_.below(6)]));
      }
      case 17: return add(line("S%d M%d", 100 + dice_.below(8000), 3 + dice_.below(2)));
      case 18: return add(dice_.one_in(2) ? "M5\n" : line("G4 P%.2f", dice_.between(0, 0.5)));
      case 19: return add(line("M%d P%d", 62 + dice_.below(4), dice_.below(4)));
      case 20: return add(line("M%d", 7 + dice_.below(3)));
      case 21: return add(line("F%.1f", dice_.between(400, 8000)));
      case 22:
        if (dice_.one_in(3)) {
          out_.asks = true;
          return add(dice_.one_in(2) ? "M0\n" : "M1\n");
        }
        return add(line("/G4 P%.2f", 0.1));
      default: add(line("G38.3 Z%.3f F%d", z_ - 0.5, 600)); return go_to(false);
    }
  }
  std::string wrong() {
    const char* lines[] = {"G1 X999\n",  "G2 X1 Y1 I50 J50\n", "G1 Q\n", "o999 call\n",
                           "#1=[1/0]\n", "M6 T77\n",           "G4 X2\n"};
    return lines[dice_.below(7)];
  }

  Dice& dice_;
  Program out_;
  double x_{0}, y_{0}, z_{0};
  int labels_{0};
  bool one_tool_{false};  ///< with its length in force from the top to the end
};

}  // namespace

Program random_program(Dice& dice) { return Writer(dice).write(); }

std::string random_mdi(Dice& dice) {
  switch (dice.below(12)) {
    case 0: return "G1 X999 F100";
    case 1: return "G0 X";
    case 2: return "S800 M3";
    case 3: return "M5";
    case 4: return "G4 P0.3";
    case 5: return "T2 M6";
    case 6: return "G91 G1 X0.5 F600";
    case 7: return "G91 G1 Y-0.5 F600";
    case 8: return "M8";
    default: {
      char text[80];
      std::snprintf(text, sizeof text, "G90 G53 G%d X%.3f Y%.3f Z%.3f F3000", dice.below(2),
                    dice.between(kLowX, kHighX), dice.between(kLowY, kHighY),
                    dice.between(kLowZ, kHighZ));
      return text;
    }
  }
}

}  // namespace kerf::soak
