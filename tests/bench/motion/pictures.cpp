#include "bench/motion/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bench/motion/runs.hpp"

namespace kerf::bench {
namespace {

constexpr double kCycle = 0.001;
constexpr double kJerk = 50000;
constexpr const char* kGrey = "#888888";
constexpr const char* kBlue = "#1f5fbf";
constexpr const char* kRed = "#c03030";
constexpr const char* kGreen = "#2f8f4f";

struct Dot {
  double x{0}, y{0};
};

/// One drawing with frames side by side or one above the other.
class Drawing {
 public:
  Drawing(const std::string& file, int wide, int high) : out_(std::fopen(file.c_str(), "w")) {
    if (out_ == nullptr) return;
    std::fprintf(out_,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                 "font-family=\"sans-serif\" font-size=\"12\">\n"
                 "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
                 wide, high);
  }
  ~Drawing() { (void)close(); }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  [[nodiscard]] bool open() const { return out_ != nullptr; }
  /// Where the next lines go on the sheet, and which values are at its edges.
  void frame(double left, double top, double wide, double high, Dot low, Dot most) {
    left_ = left;
    top_ = top;
    wide_ = wide;
    high_ = high;
    low_ = low;
    most_ = most;
    std::fprintf(out_,
                 "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" "
                 "stroke=\"#cccccc\"/>\n",
                 left, top, wide, high);
  }
  void line(const std::vector<Dot>& dots, const char* colour, double width, const char* dash = "") {
    std::fprintf(out_,
                 "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" "
                 "stroke-dasharray=\"%s\" points=\"",
                 colour, width, dash);
    for (const Dot& d : dots) std::fprintf(out_, "%.1f,%.1f ", at_x(d.x), at_y(d.y));
    std::fprintf(out_, "\"/>\n");
  }
  void dots(const std::vector<Dot>& dots, const char* colour) {
    for (const Dot& d : dots)
      std::fprintf(out_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.6\" fill=\"%s\"/>\n", at_x(d.x),
                   at_y(d.y), colour);
  }
  void circle(Dot centre, double radius, const char* colour) {
    std::fprintf(out_,
                 "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"none\" stroke=\"%s\" "
                 "stroke-dasharray=\"4 3\"/>\n",
                 at_x(centre.x), at_y(centre.y), radius / (most_.x - low_.x) * wide_, colour);
  }
  /// In sheet coordinates.
  void text(double x, double y, const char* colour, const std::string& words) {
    std::fprintf(out_, "<text x=\"%.1f\" y=\"%.1f\" fill=\"%s\">%s</text>\n", x, y, colour,
                 words.c_str());
  }
  [[nodiscard]] bool close() {
    if (out_ == nullptr) return false;
    std::fprintf(out_, "</svg>\n");
    const bool ok = std::fclose(out_) == 0;
    out_ = nullptr;
    return ok;
  }

 private:
  [[nodiscard]] double at_x(double x) const {
    return left_ + (x - low_.x) / (most_.x - low_.x) * wide_;
  }
  [[nodiscard]] double at_y(double y) const {
    return top_ + high_ - (y - low_.y) / (most_.y - low_.y) * high_;
  }
  std::FILE* out_;
  double left_{0}, top_{0}, wide_{1}, high_{1};
  Dot low_, most_;
};

std::vector<Dot> programmed(const Program& program) {
  std::vector<Dot> out{{0, 0}};
  for (const auto& item : program.items)
    if (const auto* m = std::get_if<motion::LinearMove>(&item)) out.push_back({m->end.x, m->end.y});
  return out;
}

std::vector<Dot> travelled(const Program& program, double jerk) {
  RunOptions options;
  options.jerk = jerk;
  options.record = true;
  std::vector<Dot> out;
  for (const motion::Pose& p : run(program, options).track) out.push_back({p.x, p.y});
  return out;
}

std::vector<Dot> within(const std::vector<Dot>& dots, Dot low, Dot most) {
  std::vector<Dot> out;
  for (const Dot& d : dots)
    if (d.x >= low.x && d.x <= most.x && d.y >= low.y && d.y <= most.y) out.push_back(d);
  return out;
}

/// A right angle at P0.05 beside the parabola within P: every dot is a cycle.
bool corner_picture(const std::string& folder) {
  constexpr double kP = 0.05, kLeg = 40, kSide = 0.3;
  Drawing d(folder + "/corner.svg", 460, 420);
  if (!d.open()) return false;
  const Program program = corner(90, kLeg, kP, 190);
  const Dot low{kLeg - kSide, -kSide * 0.2}, most{kLeg + kSide * 0.2, kSide};
  d.frame(20, 20, 380, 380, low, most);
  d.line({{low.x, 0}, {kLeg, 0}, {kLeg, most.y}}, kGrey, 1);
  d.circle({kLeg, 0}, kP, kGrey);
  std::vector<Dot> parabola;
  // q'' = kink / 2l over [-l, l], off by kink l / 4 at the corner.
  const double l = 4 * kP / std::sqrt(2.0);
  constexpr int kSteps = 60;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = -l + 2 * l * i / kSteps, bend = (u + l) * (u + l) / (4 * l);
    parabola.push_back({kLeg + u - bend, bend});
  }
  d.line(parabola, kGreen, 1, "6 4");
  d.dots(within(travelled(program, 0), low, most), kBlue);
  d.dots(within(travelled(program, kJerk), low, most), kRed);
  d.text(40, 60, kBlue, "limited in acceleration, one dot a cycle");
  d.text(40, 78, kRed, "limited in jerk");
  d.text(40, 96, kGreen, "parabola within P");
  d.text(40, 114, kGrey, "programmed; circle of P = 0.05 mm");
  return d.close();
}

bool fractal_picture(const std::string& folder) {
  Drawing d(folder + "/fractal.svg", 440, 440);
  if (!d.open()) return false;
  const Program program = fractal(3, 0.5, 0.05, 100);
  const std::vector<Dot> corners = programmed(program);
  Dot low = corners[0], most = corners[0];
  for (const Dot& c : corners) {
    low = {std::min(low.x, c.x), std::min(low.y, c.y)};
    most = {std::max(most.x, c.x), std::max(most.y, c.y)};
  }
  const double side = std::max(most.x - low.x, most.y - low.y);
  low = {low.x - 0.2, low.y - 0.2};
  d.frame(20, 20, 400, 400, low, {low.x + side + 0.4, low.y + side + 0.4});
  d.line(corners, kGrey, 1);
  for (const Dot& c : corners) d.circle(c, 0.05, "#dddddd");
  d.line(travelled(program, 0), kBlue, 1.2);
  d.line(travelled(program, kJerk), kRed, 1.2);
  return d.close();
}

/// Short lines with rounding noise; the curve is not bound to go through their ends.
bool stream_picture(const std::string& folder) {
  constexpr double kP = 0.01;
  Drawing d(folder + "/stream.svg", 860, 300);
  if (!d.open()) return false;
  ProgramWriter w("stream", kP, 100);
  constexpr double kHundredth = 100, kRadius = 3;
  for (int i = 1; i <= 90; ++i) {
    const double angle = i * 0.03;
    motion::Pose p;
    p.x = std::round(kRadius * std::sin(angle) * kHundredth) / kHundredth;
    p.y = std::round(kRadius * (1 - std::cos(angle)) * kHundredth) / kHundredth;
    w.line(p);
  }
  const Program program = w.done();
  const Dot low{0.9, 0.1}, most{1.9, 0.7};
  d.frame(20, 20, 420, 252, low, most);
  const std::vector<Dot> points = within(programmed(program), low, most);
  d.line(points, kGrey, 1);
  for (const Dot& c : points) d.circle(c, kP, kGrey);
  d.line(within(travelled(program, 0), low, most), kBlue, 1.5);
  d.text(460, 50, kGrey, "programmed: chords of R3, rounded to 0.01 mm; circles of P = 0.01 mm");
  d.text(460, 70, kBlue, "travelled");
  return d.close();
}

struct Curves {
  std::vector<Dot> v, a, j;
};

/// Along time: speed in XYZ, and the largest share of a joint limit.
Curves curves_of(const Program& program, double jerk) {
  RunOptions options;
  options.jerk = jerk;
  options.record = true;
  const std::vector<motion::Pose> track = run(program, options).track;
  motion::MachineConfig config;
  reference_machine(config);
  Curves out;
  for (std::size_t i = 3; i < track.size(); ++i) {
    const motion::Pose &p = track[i], &p1 = track[i - 1], &p2 = track[i - 2], &p3 = track[i - 3];
    const double t = static_cast<double>(i) * kCycle;
    const motion::Pose step = p - p1;
    double acc = 0, third = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      acc = std::max(
          acc, std::abs(p[k] - 2 * p1[k] + p2[k]) / (kCycle * kCycle) / config.joint[k].max_acc);
      third = std::max(third, std::abs(p[k] - 3 * p1[k] + 3 * p2[k] - p3[k]) /
                                  (kCycle * kCycle * kCycle) / kJerk);
    }
    out.v.push_back({t, std::hypot(step.x, step.y, step.z) / kCycle});
    out.a.push_back({t, acc});
    out.j.push_back({t, std::min(third, 1.2)});
  }
  return out;
}

bool profile_picture(const std::string& folder) {
  Drawing d(folder + "/profile.svg", 900, 640);
  if (!d.open()) return false;
  ProgramWriter w("profile", 0.05, 100);
  const auto to = [&](double x, double y) { w.line({.x = x, .y = y}); };
  to(20, 0);
  to(20, 12);
  w.arc(26, 12, -3.1);
  to(32, 0);
  to(33, 0.4);
  to(34, 0);
  to(35, 0.4);
  to(50, 5);
  const Program program = w.done();
  const Curves acc = curves_of(program, 0), jerk = curves_of(program, kJerk);
  const double end = std::max(acc.v.back().x, jerk.v.back().x);
  d.frame(40, 20, 840, 180, {0, 0}, {end, 110});
  d.line(acc.v, kBlue, 1);
  d.line(jerk.v, kRed, 1);
  d.text(50, 36, kGrey, "speed, 0 to 110 mm/s (F 100)");
  d.frame(40, 220, 840, 180, {0, 0}, {end, 1.2});
  d.line({{0, 1}, {end, 1}}, kGrey, 1, "4 3");
  d.line(acc.a, kBlue, 1);
  d.line(jerk.a, kRed, 1);
  d.text(50, 236, kGrey, "largest share of a joint's acceleration, 0 to 1.2");
  d.frame(40, 420, 840, 180, {0, 0}, {end, 1.2});
  d.line({{0, 1}, {end, 1}}, kGrey, 1, "4 3");
  d.line(jerk.j, kRed, 1);
  d.text(50, 436, kGrey, "largest share of a joint's jerk, 0 to 1.2");
  d.text(50, 625, kBlue, "limited in acceleration");
  d.text(230, 625, kRed, "limited in jerk, 50 000 mm/s3");
  return d.close();
}

}  // namespace

bool draw_pictures(const std::string& folder) {
  return corner_picture(folder) && fractal_picture(folder) && stream_picture(folder) &&
         profile_picture(folder);
}

}  // namespace kerf::bench
