// CompPath: the geometry of cutter radius compensation in a plane. No G-code, no canon, no queue: Compensation owns those.
//
// The tool follows the programmed path at one radius to its left or right. A move ends at `radius` beside its programmed
// end; what follows decides whether it stays there:
//
//   outside corner  the tool rolls around the corner point (an arc of the tool's radius)
//   inside corner   both moves are cut off where their offset paths meet
//   nearly straight nothing: the next move starts where the last one ended
//
// So the last move stays open until the next one is known. Manual: "Cutter Radius Compensation"; the figures of the
// corners (kNearlyStraight, the way into the first move) are the peer's, found by trying.
#pragma once

#include <optional>

namespace kerf::interp {

/// A point or direction in the plane; from `a` to `b` is counter-clockwise (x y in G17, z x in G18).
struct Flat {
  double a{0}, b{0};
  friend constexpr Flat operator+(Flat l, Flat r) noexcept { return {l.a + r.a, l.b + r.b}; }
  friend constexpr Flat operator-(Flat l, Flat r) noexcept { return {l.a - r.a, l.b - r.b}; }
  friend constexpr Flat operator*(Flat p, double k) noexcept { return {p.a * k, p.b * k}; }
  friend constexpr bool operator==(Flat, Flat) = default;
};

/// A programmed circular move. `turns` as in Arc: > 0 counter-clockwise.
struct FlatArc {
  Flat center;
  int turns{1};
};

/// What the tool does in the plane for one programmed move.
struct CompMove {
  Flat start, end;  ///< `end` may still be moved by the next one
  bool is_arc{false};
  Flat center;      ///< of an arc
  double sweep{0};  ///< radians of an arc
  double programmed_sweep{0};
  double turn_sign{1};  ///< 1 counter-clockwise
  Flat programmed;      ///< of a line: from its programmed start to its end
  Flat normal;          ///< from the programmed end to the tool, of length 1
  bool outside{false};  ///< an arc around which the tool goes outside
  bool traverse{false};
  bool entry{false};  ///< leads from the uncompensated path to the compensated one
};

/// How a move follows the open one.
struct CompStep {
  Flat open_end;                     ///< where the open move ends now
  double open_sweep{0};              ///< what an open arc then turns
  std::optional<Flat> corner_end{};  ///< outside corner: the tool rolls around the corner to here
  CompMove move;                     ///< the new open move
  const char* problem{nullptr};      ///< the peer's message; nothing else counts then
};

/// Plain value; the steps change nothing, take() does.
class CompPath {
 public:
  CompPath() = default;
  /// `side` 1: left of the path, -1: right. `radius` > 0.
  CompPath(double side, double radius) : side_(side), radius_(radius) {}

  /// A line from `from` to `to`, programmed points that differ.
  [[nodiscard]] CompStep line(Flat from, Flat to, bool traverse) const;
  /// An arc from `from` to `to`. `tool`: where the tool stands, for the first move.
  [[nodiscard]] CompStep arc(Flat from, Flat to, const FlatArc& arc, Flat tool) const;
  /// The open move as it stands is the last one.
  [[nodiscard]] CompStep last() const;

  void take(const CompMove& move) { open_ = move; }
  /// By how much (radians) an arc may become longer: inexact programs begin it beside its circle.
  void set_slack(double radians) noexcept { slack_ = radians; }
  [[nodiscard]] bool started() const noexcept { return open_.has_value(); }
  /// Where the tool is going to stand.
  [[nodiscard]] Flat end() const noexcept { return open_->end; }
  [[nodiscard]] double side() const noexcept { return side_; }

 private:
  [[nodiscard]] CompStep entry_arc(Flat tool, Flat to, const FlatArc& arc, Flat normal) const;
  /// Ends the open move for `step.move`, which begins with the normal `start_normal` beside the corner.
  void join(CompStep& step, Flat corner, Flat start_normal) const;
  void meet(CompStep& step, Flat corner, Flat start_normal) const;
  void finish_open(CompStep& step, bool strict) const;

  double side_{1}, radius_{0}, slack_{0};
  std::optional<CompMove> open_;
};

}  // namespace kerf::interp
