#include "motion/core/path/history.hpp"

#include <algorithm>
#include <utility>

#include "motion/core/path/reach.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kRounding = 1.0 - 1e-7;

}  // namespace

PathSpan reversed(const PathSpan& span) noexcept {
  PathSpan r = span;
  const Piece& p = span.piece;
  const double end = span.from + span.length;
  if (p.shape == Piece::Shape::arc) {
    r.piece.phi0 = p.phi0 + p.rate * end;
    r.piece.rate = -p.rate;
  } else {
    r.piece.a = p.point(end);
    r.piece.b = p.first(end) * -1.0;
    r.piece.c = p.second(end);
    r.piece.d = p.d * -1.0;
  }
  r.piece.length = span.length;
  r.piece.stop_at_end = false;
  r.from = 0;
  r.turned_at = end;
  r.end = to_pose(r.piece.point(span.length));
  r.to_move_end = 0;
  r.stop_at_end = r.at_end_exactly = false;
  return r;
}

void PathHistory::add(const Span& item, const PathSpan& span, double hard) noexcept {
  if (size_ == entry_.size()) {
    first_ = (first_ + kGeneration) % entry_.size();
    size_ -= kGeneration;
    bounded_ -= std::min(bounded_, kGeneration);
  }
  Entry& e = at(size_++);
  e.span = span;
  e.tag = item.tag;
  e.seq = item.seq;
  e.hard = span.stop_at_end ? 0 : hard;
}

void PathHistory::bound(const AxisLimits& limits, std::size_t most) noexcept {
  for (; most > 0 && bounded_ < size_; --most, ++bounded_) {
    const std::size_t i = bounded_;
    Entry& e = at(i);
    e.back_own = e.back_before = 0;
    const PathSpan& span = e.span;
    if (span.stop_at_end) continue;
    const double cap = span.speed.cap;
    const double own = i % kGeneration == 0 ? 0 : at(i - 1).back_own;
    const double before = i == 0             ? 0
                          : i == kGeneration ? at(i - 1).back_own
                                             : at(i - 1).back_before;
    if (span.even_acc > 0) {
      const double gain = 2.0 * span.length * span.even_acc * kRounding;
      e.back_own = std::min(cap, std::min(own, cap) + gain);
      e.back_before = std::min(cap, std::min(before, cap) + gain);
    } else {
      // Driven the other way q' changes its sign and the ends change places: so do the two x of each row.
      Rows rows;
      rows_of(span, limits, rows);
      for (std::size_t k = 0; k < rows.count; ++k) std::swap(rows.at[k].a, rows.at[k].b);
      e.back_own = std::min(cap, largest_x0(rows.all(), std::min(own, cap)));
      e.back_before = std::min(cap, largest_x0(rows.all(), std::min(before, cap)));
    }
  }
}

double PathHistory::back(std::size_t n) const noexcept {
  if (n > size_) return 0;
  const Entry& e = last(n);
  // The older generation has none before it.
  return size_ > kGeneration && n <= size_ - kGeneration ? e.back_before : e.back_own;
}

}  // namespace kerf::motion::path
