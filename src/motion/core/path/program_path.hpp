// ProgramPath: programmed moves in, one smooth path out: pieces that join with continuous direction, but at exact stops.
#pragma once

#include "motion/core/path/coarse.hpp"
#include "motion/core/path/junction.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/relax.hpp"
#include "motion/core/path/smoothing.hpp"

namespace kerf::motion::path {

/// G61, G61.1, G64.
struct PathMode {
  enum class Corners : std::int8_t { exact_path, exact_stop, blend };
  Corners corners{Corners::blend};
  Tolerance tolerance;  ///< of blends; mm <= 0 stops at every kink

  [[nodiscard]] bool blends() const noexcept { return corners == Corners::blend; }
};
/// What an exact path may be off where it passes a kink that comes from the rounding of whoever computed the points (mm, degrees).
inline constexpr double kExact = 8e-7;

/// One programmed move: a straight or an arc (Piece with the whole move), with sigma already scaled.
struct Move {
  Piece piece;
  PathMode mode;            ///< counts for the corner at its end
  bool stop_at_end{false};  ///< something that needs a standing machine follows
  /// How wide the corner at its end may be: as all are, as its feed needs, or as the tolerance leaves it.
  enum class Width : std::int8_t { usual, of_feed, any };
  Width width{Width::usual};
  bool joined{
      false};  ///< the corner at its end is part of a curve that was cut before it (ProgramPath::cut)
};

struct PathSettings {
  double widest{2};  ///< see SmoothingSettings; fast feeds have wider ones without jerk limits
  double widest_junction{4};
  Vec low, high;  ///< blends stay in this box
  /// With jerk limits the path needs continuous curvature: tangent joints are blended too, and sharp corners may be passed faster by stopping.
  AxisLimits limits;
  bool by_law{true};  ///< with jerk limits: driven by time laws, not in boxes
  bool relaxes{
      true};  ///< with jerk limits: curves are relaxed by what the axes can do, which is all that counts
};

class ProgramPath {
 public:
  /// For up to `moves` moves at once.
  [[nodiscard]] bool create(Memory& memory, std::size_t moves) noexcept;
  void configure(const PathSettings& settings) noexcept { settings_ = settings; }

  /// Appends the pieces of moves[0..count), none of length 0. The path begins exactly where it was cut, else exactly at the first, and ends exactly at the end
  /// of the last; stop_at_end of pieces says where it has to stand. sigma of the pieces adds up to that of the moves.
  enum class End : std::int8_t {
    here,
    part, /**< the last one is only a part, and more come behind it */
    cut   /**< the same, and the path will be cut before it */
  };
  void make(const Move* moves, std::size_t count, Buffer<Piece>& out, End end = End::here) noexcept;
  /// After End::cut, with jerk limits: takes the end off what was made, as far as what comes may change it. Gives of how many moves the rest is, at
  /// least `least`; of those behind it the ones whose corners were part of the curve become `joined`. 0: it cannot be cut.
  std::size_t cut(Move* moves, std::size_t count, std::size_t least, Buffer<Piece>& out) noexcept;
  /// What was made last will be driven: the next one begins behind it.
  void settle() noexcept;
  /// The next one begins at its first move.
  void forget() noexcept { lead_.on = rest_.on = in_move_ = ends_in_move_ = false; }
  /// Moves that the lead is of; the path can be made of no fewer.
  [[nodiscard]] std::size_t led() const noexcept { return lead_.on ? lead_.lines() : 0; }
  /// What was cut off goes on as it was.
  void keep_lead() noexcept { lead_.only_whole = true; }

 private:
  enum class Joint { stop, pass, chain, blend };
  [[nodiscard]] Joint joint_between(const Move& a, const Move& b) const noexcept;
  [[nodiscard]] bool sharp(const Move& a, const Move& b) const noexcept;
  [[nodiscard]] bool stands_behind(const Move* moves, std::size_t first, std::size_t i,
                                   std::size_t count, bool goes_on) const noexcept;
  /// The pieces from `first` on are the curve of chain_, from its beginning on; another one within tolerance takes their place where it is faster.
  void relax(std::size_t first, Buffer<Piece>& out) noexcept;
  bool smooth_chain(const SmoothingSettings& settings, const Lead* lead,
                    Buffer<Piece>& out) noexcept;
  /// The junction of two moves, in `out`; gives what it takes of each, at most `most`.
  double join(const Move& a, const Move* over, const Move& b, double most,
              Buffer<Piece>& out) noexcept;
  /// A blend from moves[0] over moves[1] to moves[2] that is faster than those at both of its ends, the first of which is blend_ and takes l; in
  /// over_. Gives what it takes of both; 0: none. Leaves the blend at the end of moves[1] in ahead_.
  [[nodiscard]] double join_over(const Move* moves, double l) noexcept;
  void make_run(const Move* moves, std::size_t count, bool leads, Buffer<Piece>& out) noexcept;
  /// The run in work_, between `from` and `to` with coarser moves where these are faster. False: nowhere.
  bool coarsen(const Move* moves, std::size_t count, std::size_t from, std::size_t to) noexcept;
  [[nodiscard]] double widest_of(const Move& move, Move::Width width) const noexcept;
  [[nodiscard]] bool keeps_its_middle(const Move& move) const noexcept;
  [[nodiscard]] double seconds(const Buffer<Move>& moves) noexcept;
  [[nodiscard]] bool may_be_wide(const Move& a, const Move& b) const noexcept;
  bool coarsen_part(const Move* moves, std::size_t count, bool small, bool wide,
                    bool winds) noexcept;
  /// A way to make a part coarser: arcs as tangents, or as so many chords at most, off by `arcs` of the tolerance at most; lines joined at corners, or with
  /// `straightened` above 0 straightened (pulled taut; two and two of them as one) until all is off by that.
  struct Coarser {
    int chords{0};
    double arcs{0}, straightened{0};
    bool taut{false}, pairs{false};
  };
  [[nodiscard]] bool lines_of_part(const Coarser& way, double& share) noexcept;
  [[nodiscard]] bool join_part(const Coarser& way) noexcept;

  PathSettings settings_;
  Buffer<Piece> blend_;
  Chain chain_;
  SmoothingSettings chain_settings_;
  Smoother smoother_;
  Relaxer relaxer_;
  bool will_be_driven_{false};  ///< what is made; else it is only compared with others
  Lead lead_, rest_;            ///< how the path begins; how it would go on behind the cut
  bool ends_in_chain_{false};
  bool will_be_cut_{false};
  bool in_move_{false};                ///< it begins with what is left of a move
  bool ends_in_move_{false};           ///< what was made last ends with a part of one
  std::size_t kept_{0};                ///< of the last moves: those that were not made coarser
  Buffer<Move> work_;                  ///< the run with what has become coarser
  Buffer<Move> part_, coarse_, best_;  ///< of a part of it: as it was, coarser, the fastest
  Buffer<CoarseLine> lines_;
  Buffer<Vec> ends_;  ///< of lines_
  Buffer<Piece> trial_, inside_;
  Buffer<Piece> over_, apart_, ahead_;
  const Move* ahead_of_{
      nullptr};  ///< ahead_ is at its end, nullptr: there is none; and takes this of it
  double ahead_l_{0};
  Buffer<double> x_;
};

/// A straight move: sigma is the length in the feed metric; where that is short against what slow axes need, it is stretched so that sigma
/// at `feed` advances at a rate that the slowest axis can follow. Length 0: nothing moves.
[[nodiscard]] Piece line_move(const Vec& from, const Vec& to, double feed, bool rapid,
                              const Vec& max_vel) noexcept;
/// The same for an arc of which everything but length, rate and feed is filled in: `sweep` and its length in XYZ.
void scale_arc(Piece& arc, double sweep, double length, double feed, bool rapid,
               const Vec& max_vel) noexcept;

}  // namespace kerf::motion::path
