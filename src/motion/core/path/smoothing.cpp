#include "motion/core/path/smoothing.hpp"

#include <algorithm>
#include <iterator>

namespace kerf::motion::path {
namespace {

constexpr double kAim = 0.97;   ///< share of the tolerance that the first guess of a width uses
constexpr double kGrow = 1.25;  ///< step of the search for the largest width
constexpr double kShrinkStep = 0.9;  ///< and of its way back where the check fails
constexpr double kKnotsApart =
    0.24;                        ///< of the width: a knot nearer to another one is not worth it
constexpr int kMaxRounds = 120;  ///< 0.9^120 = 3e-6 of the first widths: always ends before
/// With a lead the kinks that are spread may ask for wide ones behind them, so it need not end.
constexpr int kLeadRounds = 24;
/// A curve is cut so many widths and lines before the end of its chain; where that leaves this share of the piece that is divided, at least, if there is such a
/// vertex. In no case shorter ones (sigma).
constexpr double kCutBefore = 3, kGoodShare = 0.45, kShortest = 2e-3;
constexpr std::size_t kLinesBehind = 8;
constexpr double kSamePlace = 1e-9;
/// A curve that ends farther than this from the end of its chain (mm, degrees) is none; its share of the tolerance.
constexpr double kArrives = 1e-7, kAstray = 2;
/// Near to 1: the least acceleration for a sharp corner. Shallow ones are driven near to the feed and gain from width.
constexpr double kSharpPlateau = 0.8, kShallowPlateau = 0.5;
constexpr double kSharp = 0.9;
/// The guide: widths are those of this many times the tolerance; no leg is moved that is longer than this many widths.
constexpr double kWider = 1.5, kWiderPeaked = 2, kWiderLone = 2, kLongLeg = 8;
/// It moves as far as brings the curve at its vertices to this share of the tolerance.
constexpr double kGuideAim = 0.9;
/// Rounds in which only the guide moves; then widths shrink too; at the end it goes back to the chain where it is still too far off.
constexpr int kOnlyMove = 4, kMoveBack = 9, kGuideRounds = 16;
/// Where the feed changes so near to the end of a piece, or within this share of it, it changes at its end: no law can be found over slivers (sigma).
constexpr double kSliver = 3e-4, kSliverShare = 0.1;
/// A kink above this is a corner, not one of many in a dense stream.
constexpr double kNoStream = 0.6;
/// A kink below this turns nothing: rounding of the input.
constexpr double kNoKink = 1e-12;

/// Deviation that a unit kink spread over a triangle of half-width h leaves at distance s from its vertex.
double triangle_off(double s, double h) noexcept {
  const double d = h - std::abs(s);
  return d <= 0 ? 0.0 : d * d * d / (6.0 * h * h);
}

constexpr double kTriangleAtVertex = 1.0 / 6.0;

/// Half-width of the plateau of a lone corner's trapezoid, as a share of the whole.
double plateau_of(const Vec& kink) noexcept {
  return max_abs(kink) > kSharp ? kSharpPlateau : kShallowPlateau;
}

/// The same at its vertex for the trapezoid (R(0) of docs/planner.md).
double trapezoid_at_vertex(double plateau) noexcept {
  return (1 + plateau + plateau * plateau) / (6 * (1 + plateau));
}

/// Five knots a vertex at most, and some at the ends.
constexpr std::size_t knots_of(std::size_t lines) noexcept { return 5 * lines + 64; }

}  // namespace

Apart apart_on(const Chain& chain, std::size_t line, const Piece& piece, double sigma, double begin,
               double end) noexcept {
  const Vec t = chain.direction(line);
  const double third = (end - begin) / 3.0;
  const auto off = [&](double s) {
    return piece.point(s - sigma) - (chain.at[line] + t * (s - chain.sigma[line]));
  };
  Apart a;
  a.off[0] = off(begin);
  a.off[3] = off(end);
  a.off[1] = a.off[0] + (piece.first(begin - sigma) - t) * third;
  a.off[2] = a.off[3] - (piece.first(end - sigma) - t) * third;
  return a;
}

bool room_outside(const Chain& chain, const SmoothingSettings& settings,
                  const Vec& bends) noexcept {
  for (const Vec& at : chain.at)
    for (std::size_t i = 0; i < kAxes; ++i) {
      const double room = i >= 3 && i < 6 ? settings.tolerance.deg : settings.tolerance.mm;
      if (bends[i] > 0 && (at[i] + room > settings.high[i] || at[i] - room < settings.low[i]))
        return false;
    }
  return true;
}

bool Lead::create(Memory& memory, std::size_t lines) noexcept {
  const std::size_t knots = knots_of(lines);
  return sigma.create(memory, knots) && bend.create(memory, knots) && whole.create(memory, knots) &&
         guide.create(memory, lines + 1) && width.create(memory, lines + 1);
}

Vec Lead::bend_at(double s) const noexcept {
  const auto after =
      static_cast<std::size_t>(std::lower_bound(sigma.begin(), sigma.end(), s) - sigma.begin());
  if (s >= end || after == sigma.size()) return Vec{};
  if (sigma[after] == s) return bend[after];
  const double share = (s - sigma[after - 1]) / (sigma[after] - sigma[after - 1]);
  return bend[after - 1] + (bend[after] - bend[after - 1]) * share;
}

bool Smoother::create(Memory& memory, std::size_t lines) noexcept {
  const std::size_t knots = knots_of(lines);
  return kink_.create(memory, lines + 1) && width_.create(memory, lines + 1) &&
         narrow_.create(memory, lines + 1) && shrink_.create(memory, lines + 1) &&
         stray_.create(memory, lines + 1) && off_.create(memory, lines + 1) &&
         guide_.create(memory, lines) && turn_.create(memory, lines + 1) &&
         free_.create(memory, lines + 1) && order_.create(memory, lines + 1) &&
         knot_.create(memory, knots) && centroid_.create(memory, knots) &&
         area_.create(memory, knots) && bend_.create(memory, knots) &&
         second_.create(memory, knots) && touch_.create(memory, lines + 1);
}

double Smoother::smooth(const Chain& chain, const SmoothingSettings& settings, Buffer<Piece>& out,
                        const Lead* lead) noexcept {
  tolerance_ = settings.tolerance;
  first_piece_ = out.size();
  lead_ = lead;
  reset_guide(chain);
  find_kinks();
  first_widths(chain, settings.tolerance, settings);
  gave_way_ = false;
  if (!settings.inside && room_outside(chain, settings, bends()) &&
      use_both_sides(chain, settings, out))
    return 1.0;
  return cut_corners(chain, settings, out);
}

double Smoother::cut_corners(const Chain& chain, const SmoothingSettings& settings,
                             Buffer<Piece>& out) noexcept {
  double worst = 0;
  for (int round = 0; round < (lead_ != nullptr ? kLeadRounds : kMaxRounds); ++round) {
    worst = attempt(chain, settings.peaked, out);
    if (worst <= 1.0) return worst;
    for (std::size_t v = spent() + 1; v < chain.lines(); ++v) width_[v] *= shrink_[v];
  }
  return worst;
}

bool Smoother::use_both_sides(const Chain& chain, const SmoothingSettings& settings,
                              Buffer<Piece>& out) noexcept {
  begin_guide(chain, settings);
  const bool any = std::find(free_.begin(), free_.end(), true) != free_.end();
  for (int round = 0; any && round < kGuideRounds; ++round) {
    if (attempt(chain, settings.peaked, out) <= 1.0) return true;
    move_guide(chain, round);
    find_kinks();
  }
  gave_way_ = false;
  reset_guide(chain);
  find_kinks();
  width_.assign(chain.lines() + 1, 0.0);
  for (std::size_t v = 0; v <= chain.lines(); ++v) width_[v] = narrow_[v];
  return false;
}

/// One curve of the guide, with the widths as they are; its worst deviation from the chain.
double Smoother::attempt(const Chain& chain, bool peaked, Buffer<Piece>& out) noexcept {
  slope_widths(chain);
  request_knots(chain, peaked);
  distribute(chain, chain.lines());
  second_.assign(knot_.size(), Vec{});
  for (std::size_t k = 1; k + 1 < knot_.size(); ++k) second_[k] = bend_[k] * (1.0 / area_[k]);
  if (lead_ != nullptr)
    for (std::size_t k = 0; k < knot_.size() && knot_[k] < lead_->end; ++k)
      second_[k] += lead_->bend_at(knot_[k]);
  out.truncate(first_piece_);
  integrate(out);
  shrink_.assign(chain.lines() + 1, 1.0);
  off_.assign(chain.lines() + 1, Vec{});
  return check(chain, out);
}

/// The chain itself; where the curve was cut, as far as it is known the guide of that one, which bends back to the chain at its end.
void Smoother::reset_guide(const Chain& chain) noexcept {
  guide_.clear();
  for (std::size_t v = 0; v <= chain.lines(); ++v) {
    const bool led = lead_ != nullptr && v + 1 < lead_->guide.size();
    guide_.at.push_back(led ? lead_->guide[v] : chain.at[v]);
    guide_.sigma.push_back(chain.sigma[v]);
    if (v < chain.lines()) guide_.feed.push_back(chain.feed[v]);
  }
}

void Smoother::find_kinks() noexcept {
  const std::size_t lines = guide_.lines();
  kink_.assign(lines + 1, Vec{});
  for (std::size_t v = 1; v < lines; ++v) {
    kink_[v] = guide_.direction(v) - guide_.direction(v - 1);
    if (max_abs(kink_[v]) < kNoKink) kink_[v] = Vec{};
  }
}

/// The largest kink in each axis.
Vec Smoother::bends() const noexcept {
  Vec bends;
  for (const Vec& kink : kink_)
    for (std::size_t i = 0; i < kAxes; ++i) bends[i] = std::max(bends[i], std::abs(kink[i]));
  return bends;
}

void Smoother::begin_guide(const Chain& chain, const SmoothingSettings& settings) noexcept {
  const std::size_t lines = chain.lines();
  held_ = 0;
  if (lead_ != nullptr) {
    held_ = spent() + 1;
    while (held_ < lines && !(width_[held_] > 0)) ++held_;
  }
  narrow_.clear();
  turn_.clear();
  for (std::size_t v = 0; v <= lines; ++v) {
    narrow_.push_back(width_[v]);
    if (v <= spent() || v == held_ || v == lines || width_[v] > 0)
      turn_.push_back(static_cast<std::uint32_t>(v));
  }
  Tolerance wider = settings.tolerance;
  wider.mm *= settings.peaked ? kWiderPeaked : kWider;
  wider.deg *= settings.peaked ? kWiderPeaked : kWider;
  first_widths(chain, wider, settings);
  free_.assign(turn_.size(), false);
  for (std::size_t t = 1; t + 1 < turn_.size(); ++t) {
    const std::size_t v = turn_[t];
    if (v <= spent()) continue;
    const double before = chain.sigma[v] - chain.sigma[turn_[t - 1]],
                 after = chain.sigma[turn_[t + 1]] - chain.sigma[v];
    // The directions at both ends stay.
    const bool stays = lead_ != nullptr && v == held_;
    const bool wide =
        stays ? !(guide_.at[v] == chain.at[v])
              : t > 1 && t + 2 < turn_.size() && std::max(before, after) <= kLongLeg * width_[v];
    free_[t] = wide && !stays;
    // A corner that was alone stays so: overlapping bends of sharp corners cost more than wide ones gain.
    const double half = std::min(before, after) / 2;
    if (!wide)
      width_[v] = narrow_[v];
    else if (narrow_[v] < half)
      width_[v] = std::min(kWiderLone * narrow_[v], half);
  }
}

void Smoother::move_guide(const Chain& chain, int round) noexcept {
  for (std::size_t t = 1; t + 1 < turn_.size(); ++t) {
    const std::size_t v = turn_[t];
    if (v <= spent()) continue;
    if (round >= kMoveBack && shrink_[v] < 1 && v > held_) {
      const bool moved = !(guide_.at[v] == chain.at[v]);
      guide_.at[v] = chain.at[v];
      width_[v] = moved ? narrow_[v] : width_[v] * shrink_[v];
      continue;
    }
    if (round >= kOnlyMove && shrink_[v] < 1) {
      const double before = chain.sigma[v] - chain.sigma[turn_[t - 1]],
                   after = chain.sigma[turn_[t + 1]] - chain.sigma[v];
      gave_way_ =
          gave_way_ || narrow_[v] < std::min(before, after) / 2 || max_abs(kink_[v]) > kNoStream;
    }
    const double share = tolerance_.share(off_[v]) / chain.keeps_at(v);
    if (free_[t] && share > kGuideAim && (round == 0 || shrink_[v] < 1)) {
      // Beside what stays it may not jump.
      const double apart = lead_ != nullptr ? chain.sigma[v] - chain.sigma[held_] : width_[v];
      guide_.at[v].add((kGuideAim / share - 1) * std::min(1.0, apart / width_[v]), off_[v]);
    }
    if (round >= kOnlyMove) width_[v] *= shrink_[v];
  }
  // What lies straight between two turns stays so.
  for (std::size_t t = 0; t + 1 < turn_.size(); ++t) {
    const std::size_t from = turn_[t], to = turn_[t + 1];
    const Vec along =
        (guide_.at[to] - guide_.at[from]) * (1 / (chain.sigma[to] - chain.sigma[from]));
    for (std::size_t v = from + 1; v < to; ++v)
      guide_.at[v] = guide_.at[from] + along * (chain.sigma[v] - chain.sigma[from]);
  }
}

void Smoother::first_widths(const Chain& chain, const Tolerance& tolerance,
                            const SmoothingSettings& settings) noexcept {
  const std::size_t lines = chain.lines();
  width_.assign(lines + 1, 0.0);
  stray_.assign(lines + 1, 0.0);
  for (std::size_t v = 1; v < lines; ++v) stray_[v] = tolerance.share(kink_[v]);
  const double begin = chain.sigma.front(), end = chain.sigma.back();
  for (std::size_t v = 1; v < lines; ++v) {
    if (v <= spent()) width_[v] = lead_->width[v];
    if (kink_[v] == Vec{} || v <= spent()) continue;
    const double at = chain.sigma[v];
    const double widest = chain.widest.empty() ? settings.widest : chain.widest[v - 1];
    const double room = std::min({at - begin, end - at, widest});
    const double near = std::min(at - chain.sigma[v - 1], chain.sigma[v + 1] - at);
    const double alone = stray_[v] * (settings.peaked ? kTriangleAtVertex
                                                      : trapezoid_at_vertex(plateau_of(kink_[v])));
    const double aim = kAim * chain.keeps_at(v);
    double h = std::min(aim / alone, room);
    if (h <= near) {
      width_[v] = h;
      continue;
    }
    // Others lie within reach: march up while all that is spread there stays within the tolerance at this vertex.
    const auto each_near = [&](double reach, auto&& f) {
      for (std::size_t j = v; j > 0 && at - chain.sigma[j] < reach; --j)
        f(triangle_off(at - chain.sigma[j], reach), j);
      for (std::size_t j = v + 1; j < lines && chain.sigma[j] - at < reach; ++j)
        f(triangle_off(chain.sigma[j] - at, reach), j);
    };
    double best = std::min(near, room);
    for (double next = best;; next *= kGrow) {
      next = std::min(next, room);
      // Together they are no farther off than all of them in one direction.
      double most = 0;
      each_near(next, [&](double by, std::size_t j) { most += by * stray_[j]; });
      if (!(most <= aim)) {
        Vec off;
        each_near(next, [&](double by, std::size_t j) { off.add(by, kink_[j]); });
        if (tolerance.share(off) > aim) break;
      }
      best = next;
      if (next >= room) break;
    }
    width_[v] = best;
  }
}

void Smoother::slope_widths(const Chain& chain) noexcept {
  const std::size_t lines = chain.lines();
  double reach = 0;
  bool any = false;
  const auto sweep = [&](std::size_t v, double step) {
    if (any) reach += step;
    // Where the chain does not turn, what rounding makes of the guide there is no kink.
    if (!(width_[v] > 0)) return;
    if (any && v > spent()) width_[v] = std::min(width_[v], reach);
    reach = width_[v];
    any = true;
  };
  for (std::size_t v = 1; v < lines; ++v) sweep(v, chain.sigma[v] - chain.sigma[v - 1]);
  any = false;
  for (std::size_t v = lines - 1; v >= 1 && lines > 1; --v)
    sweep(v, chain.sigma[v + 1] - chain.sigma[v]);
}

void Smoother::add_knot(double at, double apart) noexcept {
  const auto after = std::lower_bound(knot_.begin(), knot_.end(), at);
  if (after != knot_.end() && *after - at < apart) return;
  if (after != knot_.begin() && at - *std::prev(after) < apart) return;
  knot_.insert(after, at);
}

void Smoother::request_knots(const Chain& chain, bool peaked) noexcept {
  const std::size_t lines = chain.lines();
  order_.clear();
  for (std::size_t v = spent() + 1; v < lines; ++v)
    if (width_[v] > 0) order_.push_back(static_cast<std::uint32_t>(v));
  knot_.clear();
  knot_.push_back(chain.sigma.front());
  if (lead_ != nullptr)
    for (std::size_t k = 1; k < lead_->sigma.size() && lead_->sigma[k] <= lead_->end; ++k)
      if (lead_->sigma[k] < chain.sigma.back() - kSamePlace) knot_.push_back(lead_->sigma[k]);
  knot_.push_back(chain.sigma.back());
  if (!order_.empty()) {
    // The outermost kinks must lie between centroids of hats, or their moment cannot be kept.
    const std::size_t first = order_.front(), last = order_.back();
    const double s0 = chain.sigma[first], s1 = chain.sigma[last];
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t l, std::uint32_t r) {
      return width_[l] != width_[r] ? width_[l] < width_[r] : l < r;
    });
    for (const std::size_t v : order_) {
      const double h = width_[v], at = chain.sigma[v];
      const bool lone = !peaked && at - chain.sigma[v - 1] >= h && chain.sigma[v + 1] - at >= h;
      const double plateau = lone ? plateau_of(kink_[v]) : 0.5;
      const double apart = (lone ? 0.9 * (1 - plateau) : kKnotsApart) * h;
      if (!lone) add_knot(at, apart);  // alone: a trapezoid
      add_knot(at - plateau * h, apart);
      add_knot(at + plateau * h, apart);
      add_knot(at - h, apart);
      add_knot(at + h, apart);
    }
    const auto centroid = [&](std::size_t k) {
      return (knot_[k - 1] + knot_[k] + knot_[k + 1]) / 3.0;
    };
    if (knot_.size() < 3 || centroid(1) > s0) {
      add_knot(s0, 0);
      add_knot((chain.sigma.front() + s0) / 2, 0);
      while (centroid(1) > s0 && !knot_.full()) add_knot((knot_[0] + knot_[1]) / 2, 0);
    }
    if (centroid(knot_.size() - 2) < s1) {
      add_knot(s1, 0);
      add_knot((chain.sigma.back() + s1) / 2, 0);
      while (centroid(knot_.size() - 2) < s1 && !knot_.full())
        add_knot((knot_[knot_.size() - 1] + knot_[knot_.size() - 2]) / 2, 0);
    }
  }
  const std::size_t n = knot_.size();
  centroid_.assign(n, 0.0);
  area_.assign(n, 0.0);
  bend_.assign(n, Vec{});
  for (std::size_t k = 1; k + 1 < n; ++k) {
    centroid_[k] = (knot_[k - 1] + knot_[k] + knot_[k + 1]) / 3.0;
    area_[k] = (knot_[k + 1] - knot_[k - 1]) / 2.0;
  }
}

/// Spreads the kinks up to vertex `last` over the hats.
void Smoother::distribute(const Chain& chain, std::size_t last) noexcept {
  bend_.assign(knot_.size(), Vec{});
  if (knot_.size() < 3) return;
  const auto begin = centroid_.begin() + 1, end = centroid_.end() - 1;
  for (const std::size_t v : order_) {
    if (v > last) continue;
    const double at = chain.sigma[v], h = width_[v];
    const auto lo =
        static_cast<std::size_t>(std::upper_bound(begin, end, at - h) - centroid_.begin());
    const auto hi =
        static_cast<std::size_t>(std::lower_bound(begin, end, at + h) - centroid_.begin());
    bool spread = false;
    if (hi >= lo + 3) {
      // Weights (1 - |d|/h) A (alpha + beta d): sum 1, first moment 0.
      double m0 = 0, m1 = 0, m2 = 0;
      for (std::size_t k = lo; k < hi; ++k) {
        const double d = centroid_[k] - at, w = (1.0 - std::abs(d) / h) * area_[k];
        m0 += w;
        m1 += w * d;
        m2 += w * d * d;
      }
      const double det = m0 * m2 - m1 * m1;
      if (det > 1e-12 * m0 * m2) {
        const double alpha = m2 / det, beta = -m1 / det;
        spread = alpha + beta * (centroid_[lo] - at) >= 0 &&
                 alpha + beta * (centroid_[hi - 1] - at) >= 0;
        for (std::size_t k = lo; spread && k < hi; ++k) {
          const double d = centroid_[k] - at;
          bend_[k].add((1.0 - std::abs(d) / h) * area_[k] * (alpha + beta * d), kink_[v]);
        }
      }
    }
    touch_[v] = static_cast<std::uint32_t>(lo);
    if (spread) continue;
    auto right = static_cast<std::size_t>(std::lower_bound(begin, end, at) - centroid_.begin());
    right = std::min(right, knot_.size() - 2);
    if (right == 1 || centroid_[right] == at) {
      bend_[right].add(1.0, kink_[v]);
      touch_[v] = static_cast<std::uint32_t>(right);
      continue;
    }
    touch_[v] = static_cast<std::uint32_t>(right - 1);
    const double g = (at - centroid_[right - 1]) / (centroid_[right] - centroid_[right - 1]);
    bend_[right].add(g, kink_[v]);
    bend_[right - 1].add(1.0 - g, kink_[v]);
  }
}

/// From second_, along the guide.
void Smoother::integrate(Buffer<Piece>& out) const noexcept {
  const Chain& chain = guide_;
  Vec q = chain.at.front(), d1 = chain.direction(0), d2 = second_.front();
  if (lead_ != nullptr) q = lead_->at, d1 = lead_->first;
  std::size_t line = 0;
  // Rounding adds up over long chains; on each straight the curve is on the chain again, exactly.
  for (std::size_t k = 0; k + 1 < knot_.size(); ++k) {
    const double length = knot_[k + 1] - knot_[k];
    const Vec next = second_[k + 1];
    const double middle = (knot_[k] + knot_[k + 1]) / 2;
    while (line + 1 < chain.lines() && chain.sigma[line + 1] <= middle) ++line;
    const bool straight = d2 == Vec{} && next == Vec{};
    if (straight) {
      d1 = chain.direction(line);
      q = chain.at[line] + d1 * (knot_[k] - chain.sigma[line]);
    }
    Piece p;
    p.length = length;
    p.a = q;
    p.b = d1;
    p.c = d2;
    if (!straight) p.d = (next - d2) * (1.0 / length);
    p.feed = chain.feed[line];
    q = p.point(length);
    d1 = p.first(length);
    d2 = next;
    // A piece that reaches over a vertex with another feed is divided there.
    std::size_t last = line;
    while (last + 1 < chain.lines() && chain.sigma[last + 1] < knot_[k + 1]) ++last;
    while (line > 0 && chain.sigma[line] > knot_[k]) --line;
    const double sliver = std::min(kSliver, kSliverShare * length);
    double from = 0;
    for (std::size_t j = line; j <= last && from < length; ++j) {
      double to = j == last ? length : chain.sigma[j + 1] - knot_[k];
      const bool differs = j < last && !(chain.feed[j + 1] == chain.feed[j]);
      if (j < last && (!differs || to - from <= sliver)) continue;
      if (length - to <= sliver) to = length;
      Piece part = from == 0 && to == length ? p : part_of(p, from, to);
      part.feed = chain.feed[j];
      out.push_back(part);
      from = to;
    }
    line = last;
  }
}

double Smoother::check(const Chain& chain, const Buffer<Piece>& out) noexcept {
  double worst = 0, sigma = chain.sigma.front();
  std::size_t line = 0;
  std::size_t near = 1;  // first vertex that may reach here
  for (std::size_t p = first_piece_; p < out.size(); ++p) {
    const Piece& piece = out[p];
    const double end = sigma + piece.length;
    double from = sigma;
    while (from < end) {
      while (line + 1 < chain.lines() && chain.sigma[line + 1] <= from) ++line;
      double to = line + 1 < chain.lines() ? std::min(end, chain.sigma[line + 1]) : end;
      if (!(to > from)) to = end;
      const Apart apart = apart_on(chain, line, piece, sigma, from, to);
      double share = apart.share(tolerance_) / chain.keeps(line);
      // What leads here was within its own tolerance when this line's was not known yet.
      if (lead_ != nullptr && from < lead_->end)
        share = std::min(share, apart.share(lead_->tolerance));
      worst = std::max(worst, share);
      if (line + 1 < chain.lines() && to == chain.sigma[line + 1]) off_[line + 1] = apart.off[3];
      if (share > 1.0) {
        while (near < chain.lines() && chain.sigma[near] + width_[near] < from) ++near;
        // Much too far off: go back faster.
        const double step = std::clamp(0.97 / share, 0.5, kShrinkStep);
        for (std::size_t v = near; v < chain.lines(); ++v) {
          if (chain.sigma[v] - width_[v] > to) {
            // Widths grow by at most the distance (slope_widths), so nothing beyond reaches here either.
            break;
          }
          if (chain.sigma[v] + width_[v] >= from) shrink_[v] = std::min(shrink_[v], step);
        }
      }
      from = to;
    }
    sigma = end;
  }
  // Where widths left no room for a kink's moment the curve ends beside its chain, and what follows would begin with a jump.
  const Vec last = out.back().point(out.back().length);
  return max_abs(last - chain.at[chain.lines()]) > kArrives ? kAstray : worst;
}

void Smoother::go_on(const Chain& chain, const Lead& lead, Buffer<Piece>& out) noexcept {
  lead_ = &lead;
  guide_.clear();
  for (std::size_t v = 0; v < lead.guide.size(); ++v) {
    const bool ends = v == lead.lines();
    guide_.at.push_back(lead.guide[v]);
    guide_.sigma.push_back(ends ? lead.sigma.back() : chain.sigma[v]);
    if (!ends) guide_.feed.push_back(chain.feed[v]);
  }
  knot_.clear();
  second_.clear();
  for (std::size_t k = 0; k < lead.sigma.size(); ++k) {
    knot_.push_back(lead.sigma[k]);
    second_.push_back(lead.whole[k]);
  }
  integrate(out);
}

/// How well the piece at sigma can be divided there: by the shorter part's share of it; 1 at its ends. 0: the shorter part would be a sliver.
double Smoother::divides(const Buffer<Piece>& out, double sigma) const noexcept {
  double begin = 0;
  for (std::size_t p = first_piece_; p < out.size(); ++p) {
    const double end = begin + out[p].length;
    if (sigma <= end + kSamePlace) {
      const double near = std::min(std::abs(end - sigma), std::abs(sigma - begin));
      if (near <= kSamePlace) return 1;
      return near > kShortest ? near / out[p].length : 0.0;
    }
    begin = end;
  }
  return 0;
}

std::size_t Smoother::cut(const Chain& chain, std::size_t least, Buffer<Piece>& out,
                          Lead& rest) noexcept {
  const std::size_t lines = chain.lines();
  const double led = lead_ != nullptr ? lead_->end : 0.0;
  least = std::max<std::size_t>(least, 1);
  while (least < lines && chain.sigma[least] < led) ++least;
  std::size_t at = lines;
  double widest = 0, best = 0;
  for (std::size_t v = least; v < lines; ++v) widest = std::max(widest, width_[v]);
  for (std::size_t v = lines; best < kGoodShare && v-- > least;) {
    const double sigma = chain.sigma[v];
    const bool near = lines - v < kLinesBehind || chain.sigma.back() - sigma < kCutBefore * widest;
    if (v > least && near) continue;
    const double share = divides(out, sigma);
    if (share > best) best = share, at = v;
  }
  if (at == lines) return 0;
  const double sigma = chain.sigma[at];
  // Hats that reach before the cut; then the last vertex whose kink is spread over any of them.
  const auto knot = static_cast<std::size_t>(
      std::lower_bound(knot_.begin(), knot_.end(), sigma - kSamePlace) - knot_.begin());
  std::size_t spent_to = at;
  for (const std::size_t v : order_)
    if (touch_[v] <= knot) spent_to = std::max(spent_to, v);
  if (spent_to + 2 > lines || lines - at + 1 > rest.guide.size() + rest.guide.room()) return 0;
  for (Buffer<Vec>* of : {&rest.bend, &rest.whole, &rest.guide}) of->clear();
  rest.sigma.clear();
  rest.width.clear();
  rest.only_whole = false;
  rest.spent = spent_to - at;
  for (std::size_t v = at; v <= lines; ++v) {
    rest.guide.push_back(guide_.at[v]);
    rest.width.push_back(width_[v]);
  }
  // The pieces up to the cut.
  double begin = 0;
  std::size_t last = first_piece_;
  while (begin + out[last].length < sigma - kSamePlace) begin += out[last++].length;
  if (begin + out[last].length > sigma + kSamePlace)
    out[last] = part_of(out[last], 0, sigma - begin);
  out.truncate(last + 1);
  const Piece& end = out.back();
  rest.at = end.point(end.length);
  rest.first = end.first(end.length);
  rest.sigma.push_back(0);
  rest.whole.push_back(end.second(end.length));
  rest.bend.push_back(rest.whole.front());
  distribute(chain, spent_to);
  rest.end = 0;
  for (std::size_t k = knot; k < knot_.size(); ++k) {
    const double s = knot_[k] - sigma;
    if (s <= kSamePlace) continue;
    Vec bend;
    if (k + 1 < knot_.size()) bend = bend_[k] * (1.0 / area_[k]);
    if (!(bend == Vec{}) || !(rest.bend.back() == Vec{})) rest.end = s;
    rest.sigma.push_back(s);
    rest.bend.push_back(bend);
    rest.whole.push_back(second_[k]);
  }
  // Of the least of the lines from there on: what comes may add to none of them more than it keeps.
  double keeps = 1;
  for (std::size_t k = at; k < lines; ++k) keeps = std::min(keeps, chain.keeps(k));
  rest.tolerance = {tolerance_.mm * keeps, tolerance_.deg * keeps};
  rest.on = true;
  return at;
}

}  // namespace kerf::motion::path
