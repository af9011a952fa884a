#include "motion/core/path/piece.hpp"

namespace kerf::motion::path {
namespace {

/// Values of one circle at an angle: the unit vectors along and across the radius, times what `fill` asks.
Vec turned(const Piece& p, double along, double across, double cos, double sin) noexcept {
  Vec out;
  for (std::size_t i = 0; i < kAxes; ++i)
    out[i] = along * (p.c[i] * cos + p.d[i] * sin) + across * (p.d[i] * cos - p.c[i] * sin);
  return out;
}

}  // namespace

bool Piece::straight() const noexcept { return shape == Shape::cubic && c == Vec{} && d == Vec{}; }

Vec Piece::point(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q;
    for (std::size_t i = 0; i < kAxes; ++i)
      q[i] = a[i] + s * (b[i] + s * (c[i] * 0.5 + s * d[i] * (1.0 / 6.0)));
    return q;
  }
  const double phi = phi0 + rate * s;
  Vec q = turned(*this, radius + growth * phi, 0, std::cos(phi), std::sin(phi));
  q += a;
  q.add(phi, b);
  return q;
}

Vec Piece::first(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q;
    for (std::size_t i = 0; i < kAxes; ++i) q[i] = b[i] + s * (c[i] + s * d[i] * 0.5);
    return q;
  }
  const double phi = phi0 + rate * s;
  Vec q = turned(*this, growth, radius + growth * phi, std::cos(phi), std::sin(phi));
  q += b;
  return q *= rate;
}

Vec Piece::second(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q = c;
    q.add(s, d);
    return q;
  }
  const double phi = phi0 + rate * s;
  return turned(*this, -(radius + growth * phi), 2 * growth, std::cos(phi), std::sin(phi)) *
         (rate * rate);
}

Vec Piece::third(double s) const noexcept {
  if (shape == Shape::cubic) return d;
  const double phi = phi0 + rate * s;
  return turned(*this, -3 * growth, -(radius + growth * phi), std::cos(phi), std::sin(phi)) *
         (rate * rate * rate);
}

Piece straight_piece(const Vec& from, const Vec& direction, double length,
                     const Feed& feed) noexcept {
  Piece p;
  p.length = length;
  p.a = from;
  p.b = direction;
  p.feed = feed;
  return p;
}

Piece part_of(const Piece& whole, double s0, double s1) noexcept {
  Piece p = whole;
  p.length = s1 - s0;
  p.stop_at_end = false;
  if (whole.shape == Piece::Shape::arc) {
    p.phi0 = whole.phi0 + whole.rate * s0;
    return p;
  }
  p.a = whole.point(s0);
  p.b = whole.first(s0);
  p.c = whole.second(s0);
  return p;
}

}  // namespace kerf::motion::path
