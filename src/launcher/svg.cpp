#include "launcher/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

namespace kerf::launcher {

namespace {

constexpr double kWidth = 1280;
constexpr double kMargin = 64;
constexpr double kGap = 76;
constexpr double kLeftWidth = 540;
constexpr double kHead = 96;
constexpr double kLegendHeight = 74;
/// Points nearer than this to the line are left out; in pixels, so that zooming in still shows a smooth line.
constexpr double kPixelTolerance = 0.06;

struct Point2 {
  double x{0}, y{0};
};

/// A view: which way X, Y and Z go on the paper (y upwards).
struct Projection {
  std::array<double, 3> right, up;
  [[nodiscard]] Point2 operator()(const Point3& p) const {
    return {p[0] * right[0] + p[1] * right[1] + p[2] * right[2],
            p[0] * up[0] + p[1] * up[1] + p[2] * up[2]};
  }
};
constexpr Projection kTop{{1, 0, 0}, {0, 1, 0}};
constexpr Projection kFront{{1, 0, 0}, {0, 0, 1}};
constexpr double kC = 0.70710678118654752, kS = 0.40824829046386302;
/// Seen from the front, right and above: X goes to the right and down, Y to the right and up.
constexpr Projection kIso{{kC, kC, 0}, {-kS, kS, 2 * kS}};

struct Box {
  Point3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(const Point3& p) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  [[nodiscard]] double size(std::size_t i) const { return high[i] - low[i]; }
};

/// Part of the paper that shows a view: pixel = origin + scale * (projected - low), y downwards.
struct Panel {
  const char* name;
  Projection projection;
  double x, y, width, height;  ///< of the frame
  double scale;
  Point2 low;  ///< projected point in the frame's lower left corner
  [[nodiscard]] Point2 place(const Point2& p) const {
    return {x + (p.x - low.x) * scale, y + height - (p.y - low.y) * scale};
  }
  [[nodiscard]] Point2 place(const Point3& p) const { return place(projection(p)); }
};

class Drawing {
 public:
  Drawing(const std::vector<PathPiece>& pieces, const DrawingInfo& info)
      : pieces_(pieces), info_(info) {}

  std::string draw() {
    for (const PathPiece& piece : pieces_) {
      for (const Point3& p : piece.points) box_.add(p);
      if (!piece.rapid) feeds_[piece.feed_mm_min] += 1;
    }
    if (pieces_.empty()) box_ = Box{{0, 0, 0}, {1, 1, 1}};
    widen();
    arrange();
    head();
    grid(top_, 0, 1);
    grid(front_, 0, 2);
    iso_frame();
    for (const Panel* panel : {&top_, &front_, &iso_}) path(*panel);
    legend();
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  template <class... A>
  void put(fmt::format_string<A...> format, A&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<A>(values)...);
    out_ += '\n';
  }

  /// A flat or empty direction gets some room, and all a border.
  void widen() {
    const double largest = std::max({box_.size(0), box_.size(1), box_.size(2), 1e-3});
    for (std::size_t i = 0; i < 3; ++i) {
      const double border = std::max(0.04 * box_.size(i), 0.02 * largest);
      box_.low[i] -= border;
      box_.high[i] += border;
    }
  }

  void arrange() {
    const double room = kLeftWidth;
    const double scale = std::min({room / box_.size(0), 460 / box_.size(1), 420 / box_.size(2)});
    const double width = box_.size(0) * scale;
    top_ = {"top",   kTop,
            kMargin, kHead,
            width,   box_.size(1) * scale,
            scale,   {box_.low[0], box_.low[1]}};
    front_ = {"front", kFront,
              kMargin, top_.y + top_.height + kGap,
              width,   box_.size(2) * scale,
              scale,   {box_.low[0], box_.low[2]}};
    const double left = kMargin + width + kGap;
    Point2 low{1e300, 1e300}, high{-1e300, -1e300};
    for (int corner = 0; corner < 8; ++corner) {
      const Point2 p = kIso(corner_of(corner));
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double iso_width = kWidth - left - kMargin / 2;
    const double height = std::max(front_.y + front_.height - kHead, 380.0);
    const double iso_scale =
        0.92 * std::min(iso_width / (high.x - low.x), height / (high.y - low.y));
    iso_ = {"isometric", kIso, left, kHead, iso_width, height, iso_scale, {}};
    iso_.low = {(low.x + high.x - iso_width / iso_scale) / 2,
                (low.y + high.y - height / iso_scale) / 2};
    height_ = kHead + height + 56 + kLegendHeight;
  }

  [[nodiscard]] Point3 corner_of(int bits) const {
    Point3 p{};
    for (std::size_t i = 0; i < 3; ++i)
      p[i] = ((static_cast<unsigned>(bits) >> i) & 1U) != 0 ? box_.high[i] : box_.low[i];
    return p;
  }

  void head() {
    put("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {:.0f} {:.0f}' width='{:.0f}' "
        "height='{:.0f}' "
        "font-family='DejaVu Sans, Verdana, sans-serif' font-size='12'>",
        kWidth, height_, kWidth, height_);
    put("<title>{}</title>", escape_xml("Tool path of " + info_.title));
    put("<style>.t{{fill:#222}}.s{{fill:#667}}.g{{stroke:#e6e8ec;fill:none}}.f{{stroke:#9aa3ad;"
        "fill:none}}"
        ".p{{fill:none;stroke-linecap:round;stroke-linejoin:round}}"
        ".r{{stroke:#8a94a0;stroke-width:.7;stroke-dasharray:4 3}}.c{{stroke-width:1.5}}"
        "text.m{{text-anchor:middle}}text.e{{text-anchor:end}}</style>");
    put("<rect width='100%' height='100%' fill='#fff'/>");
    put("<text class='t' x='{}' y='38' font-size='22' font-weight='bold'>{}</text>", kMargin,
        escape_xml(info_.title));
    put("<text class='s' x='{}' y='60' font-size='13'>{}</text>", kMargin,
        escape_xml(info_.subtitle));
  }

  /// Frame, grid with numbers and axis names of a view along two axes.
  void grid(const Panel& panel, std::size_t across, std::size_t up) {
    static constexpr const char* kNames = "XYZ";
    put("<text class='t' x='{:.1f}' y='{:.1f}' font-weight='bold'>{}</text>", panel.x, panel.y - 8,
        panel.name);
    // Both directions share the step, so that squares are squares; small views get fewer numbers.
    const double step = nice_step(std::max(box_.size(0), box_.size(1)), 8);
    const std::string lines_begin = "<path class='g' d='";
    std::string lines, labels;
    for (double v = std::ceil(box_.low[across] / step) * step; v <= box_.high[across]; v += step) {
      const Point2 p = panel.place(Point2{v, panel.low.y});
      lines += fmt::format("M{:.1f} {:.1f}V{:.1f}", p.x, panel.y, panel.y + panel.height);
      labels += fmt::format("<text class='s m' x='{:.1f}' y='{:.1f}'>{}</text>\n", p.x,
                            panel.y + panel.height + 16, number(v, step));
    }
    double last_label = 1e300;
    for (double v = std::ceil(box_.low[up] / step) * step; v <= box_.high[up]; v += step) {
      const Point2 p = panel.place(Point2{panel.low.x, v});
      lines += fmt::format("M{:.1f} {:.1f}H{:.1f}", panel.x, p.y, panel.x + panel.width);
      if (last_label - p.y < 14) continue;
      last_label = p.y;
      labels += fmt::format("<text class='s e' x='{:.1f}' y='{:.1f}'>{}</text>\n", panel.x - 6,
                            p.y + 4, number(v, step));
    }
    put("{}{}'/>", lines_begin, lines);
    out_ += labels;
    put("<rect class='f' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}'/>", panel.x, panel.y,
        panel.width, panel.height);
    put("<text class='t m' x='{:.1f}' y='{:.1f}'>{} [mm]</text>", panel.x + panel.width / 2,
        panel.y + panel.height + 34, kNames[across]);
    const double mid = panel.y + panel.height / 2;
    put("<text class='t m' transform='translate({:.1f} {:.1f}) rotate(-90)'>{} [mm]</text>",
        panel.x - 44, mid, kNames[up]);
  }

  static std::string number(double v, double step) {
    const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
    std::string text = fmt::format("{:.{}f}", v, digits);
    if (text.find_first_not_of("-0.") == std::string::npos) return "0";
    return text;
  }

  void iso_line(const Point3& a, const Point3& b, std::string& into) const {
    const Point2 p = iso_.place(a), q = iso_.place(b);
    into += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", p.x, p.y, q.x, q.y);
  }

  /// Floor with its grid, the three visible edges with their axis names, and a bar for the scale.
  void iso_frame() {
    put("<text class='t' x='{:.1f}' y='{:.1f}' font-weight='bold'>{}</text>", iso_.x, iso_.y - 8,
        iso_.name);
    const double step = nice_step(std::max(box_.size(0), box_.size(1)), 8);
    const double floor_z = box_.low[2];
    std::string lines;
    for (double v = std::ceil(box_.low[0] / step) * step; v <= box_.high[0]; v += step)
      iso_line({v, box_.low[1], floor_z}, {v, box_.high[1], floor_z}, lines);
    for (double v = std::ceil(box_.low[1] / step) * step; v <= box_.high[1]; v += step)
      iso_line({box_.low[0], v, floor_z}, {box_.high[0], v, floor_z}, lines);
    put("<path class='g' d='{}'/>", lines);
    lines.clear();
    const Point3 near = corner_of(0), x_end = corner_of(1), y_end = corner_of(2),
                 far = corner_of(3);
    iso_line(near, x_end, lines);
    iso_line(x_end, far, lines);
    iso_line(far, y_end, lines);
    iso_line(y_end, near, lines);
    iso_line(near, corner_of(4), lines);
    put("<path class='f' d='{}'/>", lines);
    axis_name(near, x_end, "X", -8, 16);
    axis_name(x_end, far, "Y", 12, 14);
    axis_name(near, corner_of(4), "Z", -12, 0);
    const double bar =
        step * iso_.scale * std::sqrt(2.0 / 3.0);  // an axis is seen this much shorter
    const double y = iso_.y + iso_.height - 2;
    put("<path class='f' stroke-width='2' d='M{:.1f} {:.1f}h{:.1f}m0 -4v8M{:.1f} {:.1f}v8'/>",
        iso_.x, y, bar, iso_.x, y - 4);
    put("<text class='s' x='{:.1f}' y='{:.1f}'>{} mm along each axis</text>", iso_.x + bar + 8,
        y + 4, number(step, step));
  }

  void axis_name(const Point3& a, const Point3& b, const char* name, double dx, double dy) {
    const Point2 p = iso_.place(a), q = iso_.place(b);
    put("<text class='t m' x='{:.1f}' y='{:.1f}'>{}</text>", (p.x + q.x) / 2 + dx,
        (p.y + q.y) / 2 + dy, name);
  }

  [[nodiscard]] double colour_place(double feed) const {
    const double low = std::max(feeds_.begin()->first, 1e-3);
    const double high = std::max(feeds_.rbegin()->first, low);
    return high > low * 1.0001 ? std::log(std::max(feed, low) / low) / std::log(high / low) : 0.5;
  }

  static void add_line(const std::vector<Point3>& points, const Panel& panel, std::string& d) {
    std::vector<Point3> flat;
    flat.reserve(points.size());
    for (const Point3& p : points) {
      const Point2 q = panel.place(p);
      flat.push_back({q.x, q.y, 0});
    }
    Point2 last;
    bool first = true;
    for (const Point3& p : simplify(flat, kPixelTolerance)) {
      // Steps are taken from the rounded position, so that errors do not add up.
      const Point2 at{std::round(p[0] * 100) / 100, std::round(p[1] * 100) / 100};
      fmt::format_to(std::back_inserter(d), "{}{:.6g} {:.6g}", first ? 'M' : 'l',
                     first ? at.x : std::round((at.x - last.x) * 100) / 100,
                     first ? at.y : std::round((at.y - last.y) * 100) / 100);
      last = at;
      first = false;
    }
  }

  void path(const Panel& panel) {
    std::string rapids;
    std::map<double, std::string> feeds;
    for (const PathPiece& piece : pieces_)
      add_line(piece.points, panel, piece.rapid ? rapids : feeds[piece.feed_mm_min]);
    put("<g id='{}'>", panel.name);
    if (!rapids.empty()) put("<path class='p r' d='{}'/>", rapids);
    for (const auto& [feed, d] : feeds)
      put("<path class='p c' stroke='{}' d='{}'><title>F {:g} mm/min</title></path>",
          feed_colour(colour_place(feed)), d, feed);
    if (!pieces_.empty()) {
      const Point2 p = panel.place(pieces_.front().points.front());
      put("<circle cx='{:.1f}' cy='{:.1f}' r='3.5' fill='#fff' "
          "stroke='#222'><title>start</title></circle>",
          p.x, p.y);
    }
    put("</g>");
  }

  void legend() {
    const double y = height_ - kLegendHeight + 26;
    double x = kMargin;
    put("<path class='p r' d='M{:.1f} {:.1f}h36'/><text class='t' x='{:.1f}' "
        "y='{:.1f}'>rapid</text>",
        x, y, x + 44, y + 4);
    put("<circle cx='{:.1f}' cy='{:.1f}' r='3.5' fill='#fff' stroke='#222'/><text class='t' "
        "x='{:.1f}' "
        "y='{:.1f}'>start</text>",
        x + 110, y, x + 122, y + 4);
    x += 190;
    if (feeds_.empty()) {
      put("<text class='s' x='{:.1f}' y='{:.1f}'>{}</text>", x, y + 4,
          pieces_.empty() ? "nothing moved" : "no feed moves");
    } else if (feeds_.size() <= 8) {
      put("<text class='s' x='{:.1f}' y='{:.1f}'>feed [mm/min]</text>", x, y + 4);
      x += 104;
      for (const auto& [feed, count] : feeds_) {
        put("<path class='p' stroke-width='4' stroke='{}' d='M{:.1f} {:.1f}h28'/><text class='t' "
            "x='{:.1f}' "
            "y='{:.1f}'>{:g}</text>",
            feed_colour(colour_place(feed)), x, y, x + 36, y + 4, feed);
        x += 100;
      }
    } else {
      colour_bar(x, y);
    }
    put("<text class='s' x='{:.1f}' y='{:.1f}'>Commanded path in machine coordinates. Top and "
        "front view have "
        "the same scale.</text>",
        kMargin, y + 30);
  }

  void colour_bar(double x, double y) {
    put("<text class='s' x='{:.1f}' y='{:.1f}'>feed [mm/min]</text>", x, y + 4);
    x += 104;
    put("<defs><linearGradient id='feed'>");
    for (int i = 0; i <= 10; ++i)
      put("<stop offset='{}%' stop-color='{}'/>", i * 10, feed_colour(i / 10.0));
    put("</linearGradient></defs>");
    put("<rect x='{:.1f}' y='{:.1f}' width='360' height='10' fill='url(#feed)'/>", x, y - 5);
    const double low = std::max(feeds_.begin()->first, 1e-3), high = feeds_.rbegin()->first;
    for (int i = 0; i <= 4; ++i)
      put("<text class='t m' x='{:.1f}' y='{:.1f}'>{:.0f}</text>", x + i * 90, y - 12,
          low * std::pow(high / low, i / 4.0));
  }

  const std::vector<PathPiece>& pieces_;
  const DrawingInfo& info_;
  Box box_;
  std::map<double, int> feeds_;  ///< programmed feeds in mm/min
  Panel top_{}, front_{}, iso_{};
  double height_{0};
  std::string out_;
};

}  // namespace

double nice_step(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

std::string feed_colour(double t) {
  static constexpr std::array<std::array<double, 3>, 5> kStops{
      {{38, 70, 160}, {22, 138, 173}, {40, 160, 90}, {236, 160, 20}, {214, 60, 40}}};
  t = std::clamp(t, 0.0, 1.0) * (kStops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(t), kStops.size() - 2);
  const double part = t - static_cast<double>(i);
  std::array<int, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<int>(std::lround(kStops[i][c] + part * (kStops[i + 1][c] - kStops[i][c])));
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string escape_xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
  }
  return out;
}

std::string draw_toolpath(const std::vector<PathPiece>& pieces, const DrawingInfo& info) {
  return Drawing(pieces, info).draw();
}

}  // namespace kerf::launcher
