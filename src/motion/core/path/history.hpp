// PathHistory: the stretches of path behind the machine, which a negative adaptive feed runs backwards. Pure arithmetic, @rt, O(1).
//
// Each entry knows how fast the machine may be where it ends: forwards as the planner had said when it was driven (that bound only
// grows, so it stays true), backwards so that everything before it can be driven and the machine stands where the history begins.
// That beginning moves on in steps: entries stand in two generations, and each knows its backward bound from the beginning of its own
// and from that of the one before. When a generation is full, the older one is forgotten and nobody's bound changes but to the
// one that he knows already.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "motion/core/path/limits.hpp"
#include "motion/core/span.hpp"
#include "rtapi/base/fetch.hpp"

namespace kerf::motion::path {

class PathHistory {
 public:
  /// That many stretches at least are kept, twice as many at most. A stretch is what the planner makes of a move or a part of one.
  static constexpr std::size_t kGeneration = 256;

  struct Entry {
    PathSpan span;
    SourceTag tag;
    std::uint64_t seq{0};
    double hard{0};  ///< x that its end may be passed with, forwards
    double back_own{0},
        back_before{0};  ///< backwards, from the beginning of its generation and of the one before
  };

  void clear() noexcept { size_ = first_ = bounded_ = 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Begins to fetch the place of the next one.
  void fetch() const noexcept {
    rtapi::fetch_to_write(&entry_[(first_ + size_) % entry_.size()], sizeof(Entry));
  }
  /// `span` has been driven to its end.
  void add(const Span& item, const PathSpan& span, double hard) noexcept;
  /// The bounds backwards of `most` entries that have none yet, oldest first. They are a tenth of a cycle's work on dense paths, so they are only made for who
  /// may turn back.
  void bound(const AxisLimits& limits, std::size_t most) noexcept;
  /// All have them: back() may be asked.
  [[nodiscard]] bool bounded() const noexcept { return bounded_ == size_; }
  /// n = 1: the last one; n <= size().
  [[nodiscard]] const Entry& last(std::size_t n) const noexcept {
    return entry_[(first_ + size_ - n) % entry_.size()];
  }
  /// x that the end of last(n) may be entered with, backwards; n = size() + 1: 0, the history begins there.
  [[nodiscard]] double back(std::size_t n) const noexcept;

 private:
  /// The oldest one is number 0; the newer generation begins at kGeneration when there are two.
  [[nodiscard]] Entry& at(std::size_t i) noexcept { return entry_[(first_ + i) % entry_.size()]; }

  std::array<Entry, 2 * kGeneration> entry_;
  std::size_t first_{0}, size_{0};
  std::size_t bounded_{0};  ///< the oldest ones, with their bounds
};

/// The same stretch driven the other way, from 0 to its length.
[[nodiscard]] PathSpan reversed(const PathSpan& span) noexcept;

}  // namespace kerf::motion::path
