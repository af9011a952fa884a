#include "motion/core/path/piece.hpp"

namespace kerf::motion::path {
namespace {

/// Values of one circle at an angle: the unit vectors along and across the radius, times what is asked.
struct Circle {
  Circle(const Piece& piece, double angle) noexcept
      : p(piece), phi(angle), cos(std::cos(angle)), sin(std::sin(angle)) {}
  [[nodiscard]] Vec turned(double along, double across) const noexcept {
    Vec out;
    for (std::size_t i = 0; i < kAxes; ++i)
      out[i] = along * (p.c[i] * cos + p.d[i] * sin) + across * (p.d[i] * cos - p.c[i] * sin);
    return out;
  }
  [[nodiscard]] Vec point() const noexcept {
    Vec q = turned(p.radius + p.growth * phi, 0);
    q += p.a;
    q.add(phi, p.b);
    return q;
  }
  [[nodiscard]] Vec first() const noexcept {
    Vec q = turned(p.growth, p.radius + p.growth * phi);
    q += p.b;
    return q *= p.rate;
  }
  [[nodiscard]] Vec second() const noexcept {
    return turned(-(p.radius + p.growth * phi), 2 * p.growth) * (p.rate * p.rate);
  }

  const Piece& p;
  double phi, cos, sin;
};

}  // namespace

bool Piece::straight() const noexcept { return shape == Shape::cubic && c == Vec{} && d == Vec{}; }

Vec Piece::point(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q;
    for (std::size_t i = 0; i < kAxes; ++i)
      q[i] = a[i] + s * (b[i] + s * (c[i] * 0.5 + s * d[i] * (1.0 / 6.0)));
    return q;
  }
  return Circle(*this, phi0 + rate * s).point();
}

Vec Piece::first(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q;
    for (std::size_t i = 0; i < kAxes; ++i) q[i] = b[i] + s * (c[i] + s * d[i] * 0.5);
    return q;
  }
  return Circle(*this, phi0 + rate * s).first();
}

Vec Piece::second(double s) const noexcept {
  if (shape == Shape::cubic) {
    Vec q = c;
    q.add(s, d);
    return q;
  }
  return Circle(*this, phi0 + rate * s).second();
}

Vec Piece::third(double s) const noexcept {
  if (shape == Shape::cubic) return d;
  const double phi = phi0 + rate * s;
  return Circle(*this, phi).turned(-3 * growth, -(radius + growth * phi)) * (rate * rate * rate);
}

Piece::Place Piece::place(double s) const noexcept {
  if (shape == Shape::cubic) return {point(s), first(s)};
  const Circle circle(*this, phi0 + rate * s);
  return {circle.point(), circle.first()};
}

Piece::Bend Piece::bend(double s) const noexcept {
  if (shape == Shape::cubic) return {first(s), second(s)};
  const Circle circle(*this, phi0 + rate * s);
  return {circle.first(), circle.second()};
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
