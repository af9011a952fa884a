// Programs and typed lines for the random operator: of everything a little, within the machine's limits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

namespace kerf::harness {

/// Where a machine's programs move: a place in machine coordinates, and how far from there.
struct Room {
  std::string axes;  ///< letters, small
  std::vector<double> middle, reach;
  bool lathe{false};
};

/// Of everything a little, on the mill.
inline std::string mill_program(std::mt19937& dice) {
  const std::vector<std::string> parts{
      "G1 X60 Y40 F1500\nG1 X62 Y41\nG1 X60.5 Y43\nG1 X59 Y41.5\nG1 X60 Y40\n",
      "G2 X70 Y40 I5 J0 F2400\nG3 X60 Y40 R6\n",
      "G91 F1200\no101 repeat [9]\nG1 X0.3 Y0.1\nX-0.1 Y-0.05\no101 endrepeat\nG90\nG0 X60 Y40\n",
      "G3 X60 Y40 Z-30 I-6 J2 P3 F3000\nG0 Z-20\n",
      "M62 P0\nG1 X80 Y60 F4000\nM63 P0\nG1 X60 Y40\n",
      "S1500 M3\nG1 X55 F800\nM5\nG1 X60\n",
      "S800 M4\nG4 P0.15\nM5\n",
      "M8\nM7\nG0 X90 Y20\nM9\nG0 X60 Y40\n",
      "T2 M6\nG43\nG0 Z-60\nG49\nG0 Z-20\n",
      "G81 X70 Y50 Z-24 R-21 F600\nX72 Y52\nG80\nG0 X60 Y40 Z-20\n",
      "S600 M3\nG33 Z-26 K1.5\nM5\nG0 Z-20\n",
      "S600 M3\nG33.1 Z-26 K1\nM5\nG0 Z-20\n",
      "G38.3 Z-22 F300\nG0 Z-20\n",
      "S700 M3\nG84 X62 Y42 Z-25 R-21 F700\nG80\nM5\nG0 X60 Y40 Z-20\n",
      "S700 M4\nG74 X62 Y42 Z-25 R-21 F700\nG80\nM5\nG0 X60 Y40 Z-20\n",
      "G73 X63 Y41 Z-25 R-21 Q1.5 F800\nG83 X61 Y44 Z-25 R-21 Q2\nG80\nG0 X60 Y40 Z-20\n",
      "G5.1 X70 Y44 I4 J-3 F2000\nG0 X60 Y40\n",
      "F1800\nG5.2 P1 L3\nX63 Y46 P1\nX68 Y38 P2\nX72 Y41 P1\nX75 Y45 P1\nG5.3\nG0 X60 Y40\n",
      "G92 X61 Y41\nG1 X62 Y41 F1500\nG92.1\nG1 X60 Y40\n",
      "o103 if [#5420 GT 60.5]\nG1 X60 F900\no103 else\nG1 X61 F900\no103 endif\nG1 X60\n",
      "M68 E0 Q[#<_feed> / 1000]\nM67 E1 Q3\nG1 X62 F1200\nG1 X60\n",
      "G96 D2000 S60 M3\nG1 X66 F900\nG1 X60\nG97 S0\nM5\n",
      "G93\nG1 X65 Y45 F30\nG1 X60 Y40 F40\nG94 F1000\n",
      "G95 S900 M3 F0.5\nG1 X64\nG1 X60\nM5\nG94 F1000\n",
      "G5 I3 J5 P-2 Q-4 X70 Y44 F1800\nG0 X60 Y40\n",
      "G61\nG1 X63 Y41 F2000\nG1 X62 Y44\nG1 X60 Y40\nG64 P0.02\n",
      "M66 P0 L3 Q0.1\nG1 X61\nG1 X60\n",
      "M1\nG1 X58 F1000\nG1 X60\n",
      "M0\n",
      "/G1 X57 F1500\nG1 X60\n",
      "M19 R45 Q2\nM5\n",
      "G10 L2 P2 X1 Y1 Z0\nG55\nG1 X60 Y40 F2500\nG54\nG1 X60 Y40\n",
      "G64 P0.5\no102 repeat [10]\nG1 X61 Y40.4 F3000\nG1 X60 Y40\no102 endrepeat\nG64 P0.02\n",
  };
  std::string text = "M52 P1\nM53 P1\nG21 G90 G17 G40 G49 G54 G80 G94 G64 P0.02\nG0 X60 Y40 Z-20\n";
  for (int i = 0; i < 14; ++i) {
    std::string part = parts[dice() % parts.size()];
    // A label of its own for each block.
    for (auto at = part.find("o10"); at != std::string::npos; at = part.find("o10", at + 1))
      part.replace(at, 3, "o" + std::to_string(20 + i));
    text += part;
  }
  return text + "M5 M9\nG49 G54 G0 X60 Y40 Z-20\nM2\n";
}

/// Lines of programs that stay in a room.
class RoomProgram {
 public:
  RoomProgram(const Room& room, std::mt19937& dice) : room_(room), dice_(dice) {}

  std::string text() {
    std::string out = "G21 G90 G40 G49 G80 G94 G64 P0.02 ";
    out += room_.lathe ? "G18 G8\n" : "G17\n";
    out += "M52 P1\nM53 P1\nG53 G0" + place(0) + "\n";
    for (int i = 0; i < 14; ++i) out += part();
    return out + "G94 M5 M9\nG53 G0" + place(0) + "\nM2\n";
  }
  /// Within `share` of the reach; all axes or, at random, some.
  std::string place(double share, bool some = false) {
    std::string out;
    for (std::size_t k = 0; k < room_.axes.size(); ++k) {
      if (some && one_of(3) == 0) continue;
      out += word(k, room_.middle[k] + share * room_.reach[k] * between(-1, 1));
    }
    return out.empty() ? word(0, room_.middle[0]) : out;
  }

 private:
  int one_of(int n) { return static_cast<int>(dice_() % static_cast<unsigned>(n)); }
  double between(double low, double high) { return low + (high - low) * one_of(10001) / 10000; }
  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", value);
    return text;
  }
  [[nodiscard]] std::string word(std::size_t k, double value) const {
    return std::string(" ") + static_cast<char>(room_.axes[k] - 'a' + 'A') + number(value);
  }
  /// Many moves of about one length.
  std::string lines() {
    constexpr double kShares[]{1, 0.3, 0.1, 0.02};
    constexpr double kTolerances[]{0.005, 0.02, 0.1, 1};
    const double share = kShares[one_of(4)];
    std::string out =
        one_of(4) == 0 ? std::string("G61\n") : "G64 P" + number(kTolerances[one_of(4)]) + "\n";
    out += "F" + number(between(200, 9000)) + "\n";
    std::vector<double> at = room_.middle;
    for (int n = 2 + one_of(share < 0.1 ? 60 : 12); n > 0; --n) {
      std::string line;
      for (std::size_t k = 0; k < at.size(); ++k) {
        if (one_of(3) == 0) continue;
        const double low = room_.middle[k] - room_.reach[k],
                     high = room_.middle[k] + room_.reach[k];
        at[k] = std::clamp(at[k] + share * room_.reach[k] * between(-1, 1), low, high);
        line += word(k, at[k]);
      }
      out += "G53 G1" + (line.empty() ? word(0, at[0]) : line) + "\n";
    }
    return out + "G64 P0.02\n";
  }
  std::string arcs() {
    const double r = between(0.02, 0.4) * room_.reach[0];
    std::string out = "G53 G1 F4000" + place(0.3) + "\nF" + number(between(300, 9000)) + "\nG91\n";
    for (int n = 1 + one_of(8); n > 0; --n) {
      const std::string turn = one_of(2) == 0 ? "G2" : "G3";
      if (room_.lathe) {
        out.append(turn).append(" X0 Z0 I").append(number(-r)).append(" K0\n");
        continue;
      }
      out.append(turn).append(" X").append(number(r)).append(" Y0 I").append(number(r / 2));
      out.append(one_of(3) == 0 ? " J0 Z0.3\n" : " J0\n");
      out.append(turn).append(" X").append(number(-r)).append(" Y0 R");
      out.append(number(r * between(0.55, 2))).append(one_of(3) == 0 ? " Z-0.3\n" : "\n");
    }
    return out + "G90\n";
  }
  std::string part() {
    switch (one_of(12)) {
      case 0: return "G53 G0" + place(1) + "\nG53 G0" + place(1, true) + "\n";
      case 1: return "G4 P" + number(between(0, 0.2)) + "\n";
      case 2: return "M62 P0\nG53 G1 F3000" + place(0.5) + "\nM63 P0\n";
      case 3: return "G93\nG53 G1 F" + number(between(20, 200)) + place(0.3) + "\nG94 F1000\n";
      case 4: return "S900 M3\nG95 F0.6\nG53 G1" + place(0.2) + "\nG94 F1000\nM5\n";
      case 5:
        if (room_.lathe)
          return "S800 M3\nG53 G0 X20 Z-40\nG76 P1.5 Z-50 I-1 J0.3 K0.6 R1.5 Q29.5 H1\nG33 Z-44 "
                 "K1\nM5\n";
        return one_of(3) == 0 ? "M0\n" : "M1\n";
      case 6: return "M66 P0 L3 Q0.05\n";
      case 7: return std::string("G91 G38.3 F400 ") + (room_.lathe ? "X" : "Z") + "0.5\nG90\n";
      case 8:
      case 9: return arcs();
      default: return lines();
    }
  }

  const Room& room_;
  std::mt19937& dice_;
};

}  // namespace kerf::harness
