// Smoothing: a chain of straight lines becomes one C2 curve within tolerance, corners and dense streams alike.
//
// Each kink (jump of q' at a vertex) is spread over hat functions of q''. Area and first moment of what is spread are kept, so the
// curve leaves each kink exactly on the programmed line again. The result differs from the chain by at most the tolerance
// at equal sigma, proven by Bernstein coefficients on every stretch, which bounds both distances: of the curve from the chain and of
// each programmed point from the curve.
//
// Spread evenly, kinks are cut on their inside, so that one side of the tolerance stays unused. Where legs are short against the widths,
// what is smoothed is not the chain but a guide: its vertices lie farther outside, by as much as brings the curve back to tolerance with
// kinks spread about twice as wide. Legs that are long against the widths stay where they are programmed.
#pragma once

#include <algorithm>
#include <array>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/tolerance.hpp"

namespace kerf::motion::path {

/// The chain: vertex i at `at[i]`, reached at sigma[i]; line i leads from vertex i to i+1 with feed[i].
/// Neighbouring vertices differ; sigma grows. Both ends are kept exactly, with their directions.
struct Chain {
  Buffer<Vec> at;
  Buffer<double> sigma;
  Buffer<Feed> feed;
  Buffer<double>
      widest;  ///< of the kink at the end of each line; empty: as SmoothingSettings has it
  Buffer<double> within;  ///< of each line: the share of the tolerance that it keeps; empty: 1

  [[nodiscard]] bool create(Memory& memory, std::size_t lines) noexcept {
    return at.create(memory, lines + 1) && sigma.create(memory, lines + 1) &&
           feed.create(memory, lines) && widest.create(memory, lines) &&
           within.create(memory, lines);
  }

  void clear() noexcept {
    at.clear();
    sigma.clear();
    feed.clear();
    widest.clear();
    within.clear();
  }
  [[nodiscard]] std::size_t lines() const noexcept { return feed.size(); }
  /// Of line k; of both lines that meet at a vertex between the ends.
  [[nodiscard]] double keeps(std::size_t k) const noexcept {
    return within.empty() ? 1.0 : within[k];
  }
  [[nodiscard]] double keeps_at(std::size_t v) const noexcept {
    return std::min(keeps(v - 1), keeps(v));
  }
  [[nodiscard]] Vec direction(std::size_t line) const noexcept {
    return (at[line + 1] - at[line]) * (1.0 / (sigma[line + 1] - sigma[line]));
  }
};

struct SmoothingSettings {
  Tolerance tolerance;
  double widest{2};  ///< no kink is spread further than this to each side (sigma)
  bool peaked{
      false};  ///< lone kinks become triangles of q'', which ask for the least jerk; else trapezoids
  bool inside{false};  ///< corners are cut on their inside only
  Vec low, high;       ///< the curve stays in this box, which the chain keeps to itself
};

/// A stretch of a curve beside its line of the chain, at equal sigma: the difference is a cubic, and lies within the hull of its Bernstein coefficients.
struct Apart {
  std::array<Vec, 4>
      off;  ///< the coefficients; the first and the last are the differences at both ends
  /// Of a tolerance; at most 1: within it all along.
  [[nodiscard]] double share(const Tolerance& most) const noexcept {
    return std::max(
        {most.share(off[0]), most.share(off[1]), most.share(off[2]), most.share(off[3])});
  }
};
/// On [begin, end] of sigma, along which there is one line and one piece, which begins at `sigma`.
[[nodiscard]] Apart apart_on(const Chain& chain, std::size_t line, const Piece& piece, double sigma,
                             double begin, double end) noexcept;
/// Whether a curve may be outside of the chain by the tolerance in each axis in which it bends (not 0 in `bends`).
[[nodiscard]] bool room_outside(const Chain& chain, const SmoothingSettings& settings,
                                const Vec& bends) noexcept;

/// How a curve goes on that was cut at a vertex of its chain (Smoother::cut), when what follows is known: the chain from that vertex on is smoothed
/// again with more behind it. Kinks that bend the curve before the cut are spread for good; so are the vertices of the guide that make them.
struct Lead {
  bool on{false};
  bool only_whole{false};  ///< goes on as it was
  Vec at, first;           ///< of the curve at the cut
  std::size_t spent{0};    ///< kinks of the vertices up to this one are spread
  double end{0};           ///< and bend nothing from there on
  Tolerance tolerance;     ///< kept up to there
  Buffer<double> sigma;    ///< of knots, from the cut on
  Buffer<Vec> bend;        ///< q'' there by those kinks alone; linear between
  Buffer<Vec> whole;       ///< q'' of all kinks of the chain that was cut, to its end
  Buffer<Vec> guide;       ///< from the vertex of the cut to the end of that chain
  Buffer<double> width;    ///< the same

  [[nodiscard]] bool create(Memory& memory, std::size_t lines) noexcept;
  /// Lines of the rest of the chain that was cut; the last one is a part.
  [[nodiscard]] std::size_t lines() const noexcept { return guide.size() - 1; }
  /// q'' of what is spread.
  [[nodiscard]] Vec bend_at(double s) const noexcept;
};

class Smoother {
 public:
  /// For chains of up to `lines` lines.
  [[nodiscard]] bool create(Memory& memory, std::size_t lines) noexcept;
  /// Appends the pieces of the smoothed chain to `out`. Gives the worst deviation as a share of the tolerance, at most 1; more: there is none with that
  /// `lead`, which is how the curve begins (nullptr: at the chain's start, in its direction).
  double smooth(const Chain& chain, const SmoothingSettings& settings, Buffer<Piece>& out,
                const Lead* lead = nullptr) noexcept;
  /// Appends how the curve goes on without more, to the end of the chain that was cut. `chain` begins with its lines.
  void go_on(const Chain& chain, const Lead& lead, Buffer<Piece>& out) noexcept;
  /// Cuts the curve that smooth() has just appended: at one of the vertices from `least` on, as far on as the end of the chain, where more will
  /// come, has no say. Gives the vertex; 0: nowhere.
  std::size_t cut(const Chain& chain, std::size_t least, Buffer<Piece>& out, Lead& rest) noexcept;
  /// Of what was made last, in its `out`.
  [[nodiscard]] std::size_t first_piece() const noexcept { return first_piece_; }
  /// Of the last one: the guide had to give way at corners, which may have become narrow by that.
  [[nodiscard]] bool gave_way() const noexcept { return gave_way_; }

 private:
  /// The curve of the chain itself: it cuts corners on their inside only.
  double cut_corners(const Chain& chain, const SmoothingSettings& settings,
                     Buffer<Piece>& out) noexcept;
  /// The curve of the guide. False: none within tolerance was found.
  bool use_both_sides(const Chain& chain, const SmoothingSettings& settings,
                      Buffer<Piece>& out) noexcept;
  [[nodiscard]] Vec bends() const noexcept;
  void begin_guide(const Chain& chain, const SmoothingSettings& settings) noexcept;
  void move_guide(const Chain& chain, int round) noexcept;
  double attempt(const Chain& chain, bool peaked, Buffer<Piece>& out) noexcept;
  void reset_guide(const Chain& chain) noexcept;
  void find_kinks() noexcept;
  void first_widths(const Chain& chain, const Tolerance& tolerance,
                    const SmoothingSettings& settings) noexcept;
  void slope_widths(const Chain& chain) noexcept;
  void request_knots(const Chain& chain, bool peaked) noexcept;
  void add_knot(double at, double apart) noexcept;
  void distribute(const Chain& chain, std::size_t last) noexcept;
  void integrate(Buffer<Piece>& out) const noexcept;
  [[nodiscard]] double divides(const Buffer<Piece>& out, double sigma) const noexcept;
  /// Kinks up to this vertex are spread by what the curve begins with.
  [[nodiscard]] std::size_t spent() const noexcept { return lead_ != nullptr ? lead_->spent : 0; }
  double check(const Chain& chain, const Buffer<Piece>& out) noexcept;

  Tolerance tolerance_;
  std::size_t first_piece_{0};
  /// The guide stays up to this vertex: the first one behind spent() that has a kink to spread, for one without would get a kink that nobody spreads.
  std::size_t held_{0};
  bool gave_way_{false};
  const Lead* lead_{nullptr};
  Buffer<Vec> kink_;       ///< per vertex; ends: zero
  Buffer<double> width_;   ///< half-width of each vertex
  Buffer<double> narrow_;  ///< the same for the curve that cuts corners
  Buffer<double> stray_;   ///< a kink as a share of the tolerance
  Buffer<double> shrink_;  ///< per vertex, after a check: factor for its width
  Buffer<Vec> off_;        ///< per vertex, after a check: of the curve there from the chain
  Chain guide_;
  Buffer<std::uint32_t> turn_;  ///< vertices with a kink, between both ends
  Buffer<bool> free_;           ///< of each of turn_: whether the guide may leave the chain there
  Buffer<double> knot_, centroid_, area_;
  Buffer<Vec> bend_;    ///< C of each hat
  Buffer<Vec> second_;  ///< q'' at each knot
  Buffer<std::uint32_t> order_;
  Buffer<std::uint32_t> touch_;  ///< of each vertex: the first hat that its kink is spread over
};

}  // namespace kerf::motion::path
