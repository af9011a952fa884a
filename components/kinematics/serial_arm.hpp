// Arms of up to six turning joints by Denavit-Hartenberg parameters as in John J. Craig, "Introduction to Robotics": link i follows
// from link i-1 by Rot(x, alpha) Trans(x, a) Rot(z, joint) Trans(z, d). The pose of the last link is X Y Z and the angles A B C, which
// turn about the fixed axes X, then Y, then Z. The inverse is found by Newton's method from where the arm stands, with the geometric
// Jacobian; near singular poses it is damped (Levenberg).
#pragma once

#include "spheres.hpp"
#include "switchable.hpp"

namespace kerf::kinematics {

struct SerialArm {
  static constexpr int kLinks = 6;
  double a[kLinks]{}, alpha_rad[kLinks]{}, d[kLinks]{};

  struct Frame {
    Rotation r{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Point p;
  };

  [[nodiscard]] static Rotation times(const Rotation& l, const Rotation& r) noexcept {
    Rotation out{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        out.m[i][j] = l.m[i][0] * r.m[0][j] + l.m[i][1] * r.m[1][j] + l.m[i][2] * r.m[2][j];
    return out;
  }

  /// Frames of all links for joints in degrees.
  void frames(const double (&joint)[kLinks], Frame (&out)[kLinks]) const noexcept {
    Frame at;
    for (int i = 0; i < kLinks; ++i) {
      const double ca = std::cos(alpha_rad[i]), sa = std::sin(alpha_rad[i]);
      const double ct = cosine(joint[i]), st = sine(joint[i]);
      const Rotation turn{{{ct, -st, 0}, {st * ca, ct * ca, -sa}, {st * sa, ct * sa, ca}}};
      const Point way{a[i], -sa * d[i], ca * d[i]};
      const auto& m = at.r.m;
      at.p = {at.p.x + m[0][0] * way.x + m[0][1] * way.y + m[0][2] * way.z,
              at.p.y + m[1][0] * way.x + m[1][1] * way.y + m[1][2] * way.z,
              at.p.z + m[2][0] * way.x + m[2][1] * way.y + m[2][2] * way.z};
      at.r = times(at.r, turn);
      out[i] = at;
    }
  }

  /// False: no solution within `limit` steps; `joint` then is where the search ended. `steps`: how many it took.
  bool solve(const Frame& wanted, double (&joint)[kLinks], int limit, int& steps) const noexcept {
    // A radian counts as much as the arm is long.
    double reach = 1e-9;
    for (int i = 0; i < kLinks; ++i) reach += std::fabs(a[i]) + std::fabs(d[i]);
    bool close = false;
    for (steps = 0; steps < limit; ++steps) {
      Frame link[kLinks];
      frames(joint, link);
      const Frame& end = link[kLinks - 1];
      double error[6];
      difference(wanted, end, reach, error);
      double worst = 0;
      for (const double e : error) {
        if (!std::isfinite(e)) return false;
        worst = std::fmax(worst, std::fabs(e));
      }
      // One step more than is needed: it takes the rest of the error to the last digits.
      if (close) return worst < 1e-9 * reach;
      close = worst < 1e-10 * reach;
      double jacobian[6][6];
      for (int i = 0; i < kLinks; ++i) {
        const Point axis{link[i].r.m[0][2], link[i].r.m[1][2], link[i].r.m[2][2]};
        const Point arm = cross(axis, end.p - link[i].p);
        const double column[6] = {arm.x,          arm.y,          arm.z,
                                  axis.x * reach, axis.y * reach, axis.z * reach};
        for (int row = 0; row < 6; ++row) jacobian[row][i] = column[row];
      }
      double step[6];
      if (!damped_step(jacobian, error, reach, worst, step)) return close;
      double largest = 0;
      for (const double s : step) largest = std::fmax(largest, std::fabs(s));
      const double part = largest > 0.5 ? 0.5 / largest : 1.0;
      for (int i = 0; i < kLinks; ++i) joint[i] += degrees_of(step[i] * part);
    }
    return close;
  }

 private:
  static void difference(const Frame& wanted, const Frame& at, double reach,
                         double (&error)[6]) noexcept {
    const Point way = wanted.p - at.p;
    // The small turn from one orientation to the other, as a vector about the fixed axes.
    Point turn;
    for (int k = 0; k < 3; ++k) {
      const Point from{at.r.m[0][k], at.r.m[1][k], at.r.m[2][k]};
      const Point to{wanted.r.m[0][k], wanted.r.m[1][k], wanted.r.m[2][k]};
      const Point c = cross(from, to);
      turn = {turn.x + 0.5 * c.x, turn.y + 0.5 * c.y, turn.z + 0.5 * c.z};
    }
    const double all[6] = {way.x, way.y, way.z, turn.x * reach, turn.y * reach, turn.z * reach};
    for (int i = 0; i < 6; ++i) error[i] = all[i];
  }

  /// (J'J + damping) step = J' error by Cholesky.
  static bool damped_step(const double (&j)[6][6], const double (&error)[6], double reach,
                          double worst, double (&step)[6]) noexcept {
    double m[6][6], right[6];
    const double damping = 1e-12 * reach * reach + 1e-6 * worst * reach;
    for (int r = 0; r < 6; ++r) {
      right[r] = 0;
      for (int k = 0; k < 6; ++k) right[r] += j[k][r] * error[k];
      for (int c = 0; c < 6; ++c) {
        m[r][c] = r == c ? damping : 0;
        for (int k = 0; k < 6; ++k) m[r][c] += j[k][r] * j[k][c];
      }
    }
    for (int c = 0; c < 6; ++c) {
      for (int r = c; r < 6; ++r) {
        for (int k = 0; k < c; ++k) m[r][c] -= m[r][k] * m[c][k];
        if (r == c) {
          if (!(m[c][c] > 0)) return false;
          m[c][c] = std::sqrt(m[c][c]);
        } else {
          m[r][c] /= m[c][c];
        }
      }
    }
    for (int r = 0; r < 6; ++r) {
      for (int k = 0; k < r; ++k) right[r] -= m[r][k] * right[k];
      right[r] /= m[r][r];
    }
    for (int r = 5; r >= 0; --r) {
      for (int k = r + 1; k < 6; ++k) right[r] -= m[k][r] * right[k];
      right[r] /= m[r][r];
      step[r] = right[r];
    }
    return true;
  }
};

/// The parts that modules with six turning joints share; Derived gives `arm()`.
template <class Derived>
class SerialModule : public SwitchableModule<Derived> {
 public:
  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    this->remember(joint);
    this->map().to_pose(joint, world);
    double turned[SerialArm::kLinks];
    for (int i = 0; i < SerialArm::kLinks; ++i) turned[i] = joint[static_cast<std::size_t>(i)];
    self().to_joints(turned);
    SerialArm::Frame link[SerialArm::kLinks];
    self().arm().frames(turned, link);
    const SerialArm::Frame& end = link[SerialArm::kLinks - 1];
    world.x = end.p.x;
    world.y = end.p.y;
    world.z = end.p.z;
    end.r.to_abc(world.a, world.b, world.c);
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    this->begin_at(joint);
    double turned[SerialArm::kLinks];
    for (int i = 0; i < SerialArm::kLinks; ++i) turned[i] = joint[static_cast<std::size_t>(i)];
    self().to_joints(turned);
    const SerialArm::Frame wanted{Rotation::of_abc(world.a, world.b, world.c),
                                  {world.x, world.y, world.z}};
    int steps = 0;
    const bool found = self().arm().solve(wanted, turned, self().most_steps(), steps);
    this->map().to_joints(world, joint);
    self().took(steps);
    if (!found) return false;
    self().to_motors(turned);
    for (int i = 0; i < SerialArm::kLinks; ++i) joint[static_cast<std::size_t>(i)] = turned[i];
    return true;
  }
  // What modules may have otherwise: motors that sit before the joint, steps shown.
  [[nodiscard]] int most_steps() const noexcept { return 100; }
  void to_joints(double (&)[SerialArm::kLinks]) const noexcept {}
  void to_motors(double (&)[SerialArm::kLinks]) const noexcept {}
  void took(int) const noexcept {}

 protected:
  explicit SerialModule(hal::Builder& b) noexcept
      : SwitchableModule<Derived>(
            b, {.own = "xyzabcuvw", .needed = "xyzabc", .identity = "xyzabcuvw"}) {}

 private:
  [[nodiscard]] const Derived& self() const noexcept { return static_cast<const Derived&>(*this); }
};

}  // namespace kerf::kinematics
