// posemath.h. All rotations go over the matrix or the quaternion.
#include <posemath.h>

#include <algorithm>
#include <cmath>

extern "C" {
int pmErrno = 0;
}

namespace {

constexpr double kHuge = 1.7976931348623157e308;

int said(int result) noexcept { return pmErrno = result; }

using V = PmCartesian;

V plus(const V& a, const V& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
V minus(const V& a, const V& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
V times(const V& a, double d) noexcept { return {a.x * d, a.y * d, a.z * d}; }
double dot(const V& a, const V& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
V cross(const V& a, const V& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const V& a) noexcept { return std::sqrt(dot(a, a)); }
bool close_to(double a, double b, double fuzz) noexcept { return std::abs(a - b) < fuzz; }

V through(const PmRotationMatrix& m, const V& v) noexcept {
  return plus(plus(times(m.x, v.x), times(m.y, v.y)), times(m.z, v.z));
}
PmRotationMatrix transposed(const PmRotationMatrix& m) noexcept {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}
/// A turn about one of the axes.
PmRotationMatrix turn(int axis, double angle) noexcept {
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  switch (axis) {
    case PM_X: return {{1, 0, 0}, {0, c, s}, {0, -s, c}};
    case PM_Y: return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
    default: return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  }
}
PmRotationMatrix product(const PmRotationMatrix& a, const PmRotationMatrix& b) noexcept {
  return {through(a, b.x), through(a, b.y), through(a, b.z)};
}
PmQuaternion conjugate(const PmQuaternion& q) noexcept { return {q.s, -q.x, -q.y, -q.z}; }
double length(const PmQuaternion& q) noexcept {
  return std::sqrt(q.s * q.s + q.x * q.x + q.y * q.y + q.z * q.z);
}
/// The one of the two that has no negative s.
PmQuaternion forward(const PmQuaternion& q) noexcept {
  return q.s >= 0 ? q : PmQuaternion{-q.s, -q.x, -q.y, -q.z};
}
PmQuaternion product(const PmQuaternion& a, const PmQuaternion& b) noexcept {
  return forward({a.s * b.s - a.x * b.x - a.y * b.y - a.z * b.z,
                  a.s * b.x + a.x * b.s + a.y * b.z - a.z * b.y,
                  a.s * b.y - a.x * b.z + a.y * b.s + a.z * b.x,
                  a.s * b.z + a.x * b.y - a.y * b.x + a.z * b.s});
}
V through(const PmQuaternion& q, const V& v) noexcept {
  const V axis{q.x, q.y, q.z};
  const V c = times(cross(axis, v), 2);
  return plus(v, plus(times(c, q.s), cross(axis, c)));
}

// ---- to and from matrices

PmRotationMatrix matrix(const PmQuaternion& q) noexcept {
  return {through(q, {1, 0, 0}), through(q, {0, 1, 0}), through(q, {0, 0, 1})};
}
PmRotationMatrix matrix(const PmRpy& e) noexcept {
  return product(turn(PM_Z, e.y), product(turn(PM_Y, e.p), turn(PM_X, e.r)));
}
PmRotationMatrix matrix(const PmEulerZyx& e) noexcept {
  return product(turn(PM_Z, e.z), product(turn(PM_Y, e.y), turn(PM_X, e.x)));
}
PmRotationMatrix matrix(const PmEulerZyz& e) noexcept {
  return product(turn(PM_Z, e.z), product(turn(PM_Y, e.y), turn(PM_Z, e.zp)));
}
PmQuaternion quaternion(const PmRotationVector& r) noexcept {
  const double s = std::sin(r.s / 2);
  return forward({std::cos(r.s / 2), r.x * s, r.y * s, r.z * s});
}
PmRotationMatrix matrix(const PmRotationVector& r) noexcept { return matrix(quaternion(r)); }

void convert(const PmRotationMatrix& m, PmQuaternion& q) noexcept {
  // The largest of the four comes from the diagonal, the others from it: nothing is divided by little.
  const double trace = m.x.x + m.y.y + m.z.z;
  const double squares[4] = {trace, m.x.x, m.y.y, m.z.z};
  switch (std::max_element(squares, squares + 4) - squares) {
    case 0: {
      const double s = std::sqrt(1 + trace) * 2;
      q = {s / 4, (m.y.z - m.z.y) / s, (m.z.x - m.x.z) / s, (m.x.y - m.y.x) / s};
      break;
    }
    case 1: {
      const double s = std::sqrt(1 + m.x.x - m.y.y - m.z.z) * 2;
      q = {(m.y.z - m.z.y) / s, s / 4, (m.y.x + m.x.y) / s, (m.z.x + m.x.z) / s};
      break;
    }
    case 2: {
      const double s = std::sqrt(1 + m.y.y - m.x.x - m.z.z) * 2;
      q = {(m.z.x - m.x.z) / s, (m.y.x + m.x.y) / s, s / 4, (m.z.y + m.y.z) / s};
      break;
    }
    default: {
      const double s = std::sqrt(1 + m.z.z - m.x.x - m.y.y) * 2;
      q = {(m.x.y - m.y.x) / s, (m.z.x + m.x.z) / s, (m.z.y + m.y.z) / s, s / 4};
    }
  }
  q = forward(q);
}
void convert(const PmRotationMatrix& m, PmRotationMatrix& out) noexcept { out = m; }
/// No turn has no axis.
PmRotationVector vector_of(const PmQuaternion& q) noexcept {
  const double s = length(V{q.x, q.y, q.z});
  if (s < QSIN_FUZZ) return {0, 0, 0, 0};
  return {2 * std::atan2(s, q.s), q.x / s, q.y / s, q.z / s};
}
void convert(const PmRotationMatrix& m, PmRotationVector& r) noexcept {
  PmQuaternion q;
  convert(m, q);
  r = vector_of(q);
}
/// Where the middle angle leaves the others one freedom too many, the last one turned about is 0.
void convert(const PmRotationMatrix& m, PmEulerZyx& e) noexcept {
  e.y = std::atan2(-m.x.z, std::hypot(m.x.x, m.x.y));
  if (std::abs(std::abs(e.y) - PM_PI_2) < ZYX_Y_FUZZ) {
    e.y = std::copysign(PM_PI_2, e.y);
    e.z = 0;
    e.x = e.y > 0 ? std::atan2(m.y.x, m.y.y) : -std::atan2(m.y.x, m.y.y);
  } else {
    e.z = std::atan2(m.x.y, m.x.x);
    e.x = std::atan2(m.y.z, m.z.z);
  }
}
void convert(const PmRotationMatrix& m, PmRpy& e) noexcept {
  PmEulerZyx same;
  convert(m, same);
  e = {same.x, same.y, same.z};
}
void convert(const PmRotationMatrix& m, PmEulerZyz& e) noexcept {
  e.y = std::atan2(std::hypot(m.x.z, m.y.z), m.z.z);
  if (std::abs(e.y) < ZYZ_Y_FUZZ) {
    e = {0, 0, std::atan2(-m.y.x, m.x.x)};
  } else if (std::abs(e.y - PM_PI) < ZYZ_Y_FUZZ) {
    e = {0, PM_PI, std::atan2(m.y.x, -m.x.x)};
  } else {
    e.z = std::atan2(m.z.y, m.z.x);
    e.zp = std::atan2(m.y.z, -m.x.z);
  }
}
PmRotationMatrix matrix(const PmRotationMatrix& m) noexcept { return m; }

template <class From, class To>
int rotation(const From* from, To* to) noexcept {
  convert(matrix(*from), *to);
  return said(PM_OK);
}

bool is_unit(const V& v) noexcept { return close_to(length(v), 1, UNIT_VEC_FUZZ); }
bool is_unit(const PmQuaternion& q) noexcept { return close_to(length(q), 1, UNIT_QUAT_FUZZ); }

int unit(const V& v, V& out) noexcept {
  const double size = length(v);
  if (size == 0) {
    out = {0, 0, 0};
    return said(PM_NORM_ERR);
  }
  out = times(v, 1 / size);
  return said(PM_OK);
}

int line_between(const V& start, const V& end, V& direction, double& size, int& zero) noexcept {
  direction = minus(end, start);
  size = length(direction);
  zero = size < CART_FUZZ ? 1 : 0;
  if (zero != 0) {
    direction = {1, 0, 0};
    return PM_OK;
  }
  return unit(direction, direction);
}

}  // namespace

extern "C" {

double pmSqrt(double x) {
  if (x > 0) return std::sqrt(x);
  (void)said(x > SQRT_FUZZ ? PM_OK : PM_ERR);
  return 0;
}

// ---- vectors

int pmCartCartAdd(const V* a, const V* b, V* out) {
  *out = plus(*a, *b);
  return said(PM_OK);
}
int pmCartCartAddEq(V* a, const V* b) { return pmCartCartAdd(a, b, a); }
int pmCartCartSub(const V* a, const V* b, V* out) {
  *out = minus(*a, *b);
  return said(PM_OK);
}
int pmCartCartSubEq(V* a, const V* b) { return pmCartCartSub(a, b, a); }
int pmCartCartMult(const V* a, const V* b, V* out) {
  *out = {a->x * b->x, a->y * b->y, a->z * b->z};
  return said(PM_OK);
}
int pmCartCartDiv(const V* a, const V* b, V* out) {
  if (b->x == 0 || b->y == 0 || b->z == 0) {
    *out = {0, 0, 0};
    return said(PM_DIV_ERR);
  }
  *out = {a->x / b->x, a->y / b->y, a->z / b->z};
  return said(PM_OK);
}
int pmCartScalMult(const V* a, double d, V* out) {
  *out = times(*a, d);
  return said(PM_OK);
}
int pmCartScalMultEq(V* a, double d) { return pmCartScalMult(a, d, a); }
int pmCartScalDiv(const V* a, double d, V* out) {
  if (d == 0) return said(PM_DIV_ERR);
  *out = {a->x / d, a->y / d, a->z / d};
  return said(PM_OK);
}
int pmCartScalDivEq(V* a, double d) { return pmCartScalDiv(a, d, a); }
int pmCartNeg(const V* a, V* out) {
  *out = {-a->x, -a->y, -a->z};
  return said(PM_OK);
}
int pmCartNegEq(V* a) { return pmCartNeg(a, a); }
int pmCartAbs(const V* a, V* out) {
  *out = {std::abs(a->x), std::abs(a->y), std::abs(a->z)};
  return said(PM_OK);
}
int pmCartInv(const V* a, V* out) {
  const double square = dot(*a, *a);
  if (square == 0) {
    *out = {kHuge, kHuge, kHuge};
    return said(PM_NORM_ERR);
  }
  *out = times(*a, 1 / square);
  return said(PM_OK);
}
int pmCartInvEq(V* a) { return pmCartInv(a, a); }
int pmCartUnit(const V* a, V* out) { return unit(*a, *out); }
int pmCartUnitEq(V* a) { return unit(*a, *a); }
int pmCartIsNorm(const V* a) { return is_unit(*a) ? 1 : 0; }
int pmCartMag(const V* a, double* out) {
  *out = length(*a);
  return said(PM_OK);
}
int pmCartMagSq(const V* a, double* out) {
  *out = dot(*a, *a);
  return said(PM_OK);
}
int pmCartInfNorm(const V* a, double* out) {
  *out = std::max({std::abs(a->x), std::abs(a->y), std::abs(a->z)});
  return said(PM_OK);
}
int pmCartCartDot(const V* a, const V* b, double* out) {
  *out = dot(*a, *b);
  return said(PM_OK);
}
int pmCartCartCross(const V* a, const V* b, V* out) {
  *out = cross(*a, *b);
  return said(PM_OK);
}
int pmCartCartDisp(const V* a, const V* b, double* out) {
  *out = length(minus(*b, *a));
  return said(PM_OK);
}
int pmCartCartCompare(const V* a, const V* b) {
  return close_to(a->x, b->x, V_FUZZ) && close_to(a->y, b->y, V_FUZZ) &&
                 close_to(a->z, b->z, V_FUZZ)
             ? 1
             : 0;
}
int pmCartCartProj(const V* a, const V* on, V* out) {
  V direction;
  const int result = unit(*on, direction);
  *out = times(direction, dot(*a, direction));
  return said(result);
}
int pmCartPlaneProj(const V* a, const V* normal, V* out) {
  V along;
  const int result = pmCartCartProj(a, normal, &along);
  *out = minus(*a, along);
  return said(result);
}

int pmCartSphConvert(const V* a, PmSpherical* out) {
  const V v = *a;
  *out = {std::atan2(v.y, v.x), std::atan2(std::hypot(v.x, v.y), v.z), length(v)};
  return said(PM_OK);
}
int pmCartCylConvert(const V* a, PmCylindrical* out) {
  const V v = *a;
  *out = {std::atan2(v.y, v.x), std::hypot(v.x, v.y), v.z};
  return said(PM_OK);
}
int pmSphCartConvert(const PmSpherical* a, V* out) {
  const PmSpherical s = *a;
  const double flat = s.r * std::sin(s.phi);
  *out = {flat * std::cos(s.theta), flat * std::sin(s.theta), s.r * std::cos(s.phi)};
  return said(PM_OK);
}
int pmSphCylConvert(const PmSpherical* a, PmCylindrical* out) {
  // Here, and in its inverse, the published library takes phi from the xy plane.
  const PmSpherical s = *a;
  *out = {s.theta, s.r * std::cos(s.phi), s.r * std::sin(s.phi)};
  return said(PM_OK);
}
int pmCylCartConvert(const PmCylindrical* a, V* out) {
  const PmCylindrical c = *a;
  *out = {c.r * std::cos(c.theta), c.r * std::sin(c.theta), c.z};
  return said(PM_OK);
}
int pmCylSphConvert(const PmCylindrical* a, PmSpherical* out) {
  const PmCylindrical c = *a;
  *out = {c.theta, std::atan2(c.z, c.r), std::hypot(c.r, c.z)};
  return said(PM_OK);
}

// ---- rotations

int pmAxisAngleQuatConvert(PM_AXIS axis, double angle, PmQuaternion* out) {
  const double s = std::sin(angle / 2);
  PmQuaternion q{std::cos(angle / 2), 0, 0, 0};
  switch (axis) {
    case PM_X: q.x = s; break;
    case PM_Y: q.y = s; break;
    case PM_Z: q.z = s; break;
    default: return said(PM_ERR);
  }
  *out = forward(q);
  return said(PM_OK);
}
int pmQuatAxisAngleMult(const PmQuaternion* q, PM_AXIS axis, double angle, PmQuaternion* out) {
  PmQuaternion turned;
  const int result = pmAxisAngleQuatConvert(axis, angle, &turned);
  if (result == PM_OK) *out = product(*q, turned);
  return result;
}
int pmRotQuatConvert(const PmRotationVector* r, PmQuaternion* out) {
  *out = quaternion(*r);
  return said(PM_OK);
}

int pmQuatRotConvert(const PmQuaternion* q, PmRotationVector* out) {
  *out = vector_of(*q);
  return said(PM_OK);
}

#define KERF_ROTATION(name, From, To) \
  int pm##name##Convert(const From* from, To* to) { return rotation(from, to); }
KERF_ROTATION(RotMat, PmRotationVector, PmRotationMatrix)
KERF_ROTATION(RotZyz, PmRotationVector, PmEulerZyz)
KERF_ROTATION(RotZyx, PmRotationVector, PmEulerZyx)
KERF_ROTATION(RotRpy, PmRotationVector, PmRpy)
KERF_ROTATION(QuatMat, PmQuaternion, PmRotationMatrix)
KERF_ROTATION(QuatZyz, PmQuaternion, PmEulerZyz)
KERF_ROTATION(QuatZyx, PmQuaternion, PmEulerZyx)
KERF_ROTATION(QuatRpy, PmQuaternion, PmRpy)
KERF_ROTATION(MatRot, PmRotationMatrix, PmRotationVector)
KERF_ROTATION(MatQuat, PmRotationMatrix, PmQuaternion)
KERF_ROTATION(MatZyz, PmRotationMatrix, PmEulerZyz)
KERF_ROTATION(MatZyx, PmRotationMatrix, PmEulerZyx)
KERF_ROTATION(MatRpy, PmRotationMatrix, PmRpy)
KERF_ROTATION(ZyzRot, PmEulerZyz, PmRotationVector)
KERF_ROTATION(ZyzQuat, PmEulerZyz, PmQuaternion)
KERF_ROTATION(ZyzMat, PmEulerZyz, PmRotationMatrix)
KERF_ROTATION(ZyzRpy, PmEulerZyz, PmRpy)
KERF_ROTATION(ZyxRot, PmEulerZyx, PmRotationVector)
KERF_ROTATION(ZyxQuat, PmEulerZyx, PmQuaternion)
KERF_ROTATION(ZyxMat, PmEulerZyx, PmRotationMatrix)
KERF_ROTATION(ZyxZyz, PmEulerZyx, PmEulerZyz)
KERF_ROTATION(ZyxRpy, PmEulerZyx, PmRpy)
KERF_ROTATION(RpyRot, PmRpy, PmRotationVector)
KERF_ROTATION(RpyQuat, PmRpy, PmQuaternion)
KERF_ROTATION(RpyMat, PmRpy, PmRotationMatrix)
KERF_ROTATION(RpyZyz, PmRpy, PmEulerZyz)
KERF_ROTATION(RpyZyx, PmRpy, PmEulerZyx)
#undef KERF_ROTATION

int pmRotScalMult(const PmRotationVector* r, double s, PmRotationVector* out) {
  *out = {r->s * s, r->x, r->y, r->z};
  return said(PM_OK);
}
int pmRotScalDiv(const PmRotationVector* r, double s, PmRotationVector* out) {
  if (s == 0) {
    *out = {kHuge, r->x, r->y, r->z};
    return said(PM_NORM_ERR);
  }
  *out = {r->s / s, r->x, r->y, r->z};
  return said(PM_OK);
}
int pmRotIsNorm(const PmRotationVector* r) {
  return std::abs(r->s) < Q_FUZZ || is_unit(V{r->x, r->y, r->z}) ? 1 : 0;
}
int pmRotNorm(const PmRotationVector* r, PmRotationVector* out) {
  const double size = length(V{r->x, r->y, r->z});
  if (size == 0 || r->s == 0) {
    *out = {0, 0, 0, 0};
    return said(size == 0 ? PM_NORM_ERR : PM_OK);
  }
  *out = {r->s, r->x / size, r->y / size, r->z / size};
  return said(PM_OK);
}

int pmQuatQuatCompare(const PmQuaternion* a, const PmQuaternion* b) {
  const PmQuaternion p = forward(*a);
  const PmQuaternion q = forward(*b);
  const auto near = [&](double sign) {
    return close_to(p.s, sign * q.s, Q_FUZZ) && close_to(p.x, sign * q.x, Q_FUZZ) &&
           close_to(p.y, sign * q.y, Q_FUZZ) && close_to(p.z, sign * q.z, Q_FUZZ);
  };
  // Half a turn about an axis is the same about its opposite.
  return near(1) || (p.s < QS_FUZZ && near(-1)) ? 1 : 0;
}
int pmQuatMag(const PmQuaternion* q, double* out) {
  PmRotationVector r;
  const int result = pmQuatRotConvert(q, &r);
  *out = r.s;
  return result;
}
int pmQuatNorm(const PmQuaternion* q, PmQuaternion* out) {
  const double size = length(*q);
  if (size == 0) {
    *out = {1, 0, 0, 0};
    return said(PM_NORM_ERR);
  }
  *out = forward({q->s / size, q->x / size, q->y / size, q->z / size});
  return said(PM_OK);
}
int pmQuatInv(const PmQuaternion* q, PmQuaternion* out) {
  *out = conjugate(*q);
  return said(is_unit(*out) ? PM_OK : PM_NORM_ERR);
}
int pmQuatIsNorm(const PmQuaternion* q) { return is_unit(*q) ? 1 : 0; }
int pmQuatScalMult(const PmQuaternion* q, double s, PmQuaternion* out) {
  PmRotationVector r;
  (void)pmQuatRotConvert(q, &r);
  r.s *= s;
  return pmRotQuatConvert(&r, out);
}
int pmQuatScalDiv(const PmQuaternion* q, double s, PmQuaternion* out) {
  if (s == 0) return said(PM_DIV_ERR);
  return pmQuatScalMult(q, 1 / s, out);
}
int pmQuatQuatMult(const PmQuaternion* a, const PmQuaternion* b, PmQuaternion* out) {
  const bool units = is_unit(*a) && is_unit(*b);
  *out = product(*a, *b);
  return said(units ? PM_OK : PM_NORM_ERR);
}
int pmQuatCartMult(const PmQuaternion* q, const V* v, V* out) {
  *out = through(*q, *v);
  return said(is_unit(*q) ? PM_OK : PM_NORM_ERR);
}

int pmMatNorm(const PmRotationMatrix* m, PmRotationMatrix* out) {
  *out = *m;
  return said(PM_IMPL_ERR);
}
int pmMatIsNorm(const PmRotationMatrix* m) {
  const V u = cross(m->x, m->y);
  return is_unit(m->x) && is_unit(m->y) && is_unit(m->z) && close_to(u.x, m->z.x, CART_FUZZ) &&
                 close_to(u.y, m->z.y, CART_FUZZ) && close_to(u.z, m->z.z, CART_FUZZ)
             ? 1
             : 0;
}
int pmMatInv(const PmRotationMatrix* m, PmRotationMatrix* out) {
  *out = transposed(*m);
  return said(pmMatIsNorm(out) != 0 ? PM_OK : PM_NORM_ERR);
}
int pmMatCartMult(const PmRotationMatrix* m, const V* v, V* out) {
  *out = through(*m, *v);
  return said(PM_OK);
}
int pmMatMatMult(const PmRotationMatrix* a, const PmRotationMatrix* b, PmRotationMatrix* out) {
  *out = product(*a, *b);
  return said(PM_OK);
}

// ---- poses

int pmPosePoseCompare(const PmPose* a, const PmPose* b) {
  return pmQuatQuatCompare(&a->rot, &b->rot) != 0 && pmCartCartCompare(&a->tran, &b->tran) != 0 ? 1
                                                                                                : 0;
}
int pmPoseInv(const PmPose* p, PmPose* out) {
  const PmQuaternion back = conjugate(p->rot);
  const V there = through(back, p->tran);
  *out = {{-there.x, -there.y, -there.z}, back};
  return said(is_unit(back) ? PM_OK : PM_NORM_ERR);
}
int pmPoseCartMult(const PmPose* p, const V* v, V* out) {
  *out = plus(through(p->rot, *v), p->tran);
  return said(is_unit(p->rot) ? PM_OK : PM_NORM_ERR);
}
int pmPosePoseMult(const PmPose* a, const PmPose* b, PmPose* out) {
  const bool units = is_unit(a->rot) && is_unit(b->rot);
  *out = {plus(through(a->rot, b->tran), a->tran), product(a->rot, b->rot)};
  return said(units ? PM_OK : PM_NORM_ERR);
}
int pmPoseHomConvert(const PmPose* p, PmHomogeneous* out) {
  *out = {p->tran, matrix(p->rot)};
  return said(PM_OK);
}
int pmHomPoseConvert(const PmHomogeneous* h, PmPose* out) {
  PmPose made{h->tran, {}};
  convert(h->rot, made.rot);
  *out = made;
  return said(PM_OK);
}
int pmHomInv(const PmHomogeneous* h, PmHomogeneous* out) {
  const PmRotationMatrix back = transposed(h->rot);
  const V there = through(back, h->tran);
  *out = {{-there.x, -there.y, -there.z}, back};
  return said(pmMatIsNorm(&back) != 0 ? PM_OK : PM_NORM_ERR);
}

// ---- lines

int pmLineInit(PmLine* line, const PmPose* start, const PmPose* end) {
  PmLine made{};
  made.start = *start;
  made.end = *end;
  PmRotationVector turned = vector_of(product(conjugate(start->rot), end->rot));
  made.rmag = std::abs(turned.s);
  made.rmag_zero = made.rmag < Q_FUZZ ? 1 : 0;
  turned.s = std::copysign(1.0, turned.s);
  made.qVec = made.rmag_zero != 0 ? PmQuaternion{1, 0, 0, 0} : quaternion(turned);
  const int result = line_between(start->tran, end->tran, made.uVec, made.tmag, made.tmag_zero);
  *line = made;
  return said(result);
}
int pmLinePoint(const PmLine* line, double way, PmPose* point) {
  V there = line->end.tran;
  if (line->tmag_zero == 0) there = plus(line->start.tran, times(line->uVec, way));
  PmQuaternion turned = line->end.rot;
  if (line->rmag_zero == 0) {
    // The turn keeps pace with the way; without one, `way` is the angle.
    const double angle = line->tmag_zero != 0 ? way : way / line->tmag * line->rmag;
    PmQuaternion part;
    (void)pmQuatScalMult(&line->qVec, angle, &part);
    turned = product(line->start.rot, part);
  }
  *point = {there, turned};
  return said(PM_OK);
}

int pmCartLineInit(PmCartLine* line, const V* start, const V* end) {
  PmCartLine made{*start, *end, {}, 0, 0};
  const int result = line_between(*start, *end, made.uVec, made.tmag, made.tmag_zero);
  *line = made;
  return said(result);
}
int pmCartLinePoint(const PmCartLine* line, double way, V* point) {
  *point = line->tmag_zero != 0 ? line->end : plus(line->start, times(line->uVec, way));
  return said(PM_OK);
}
int pmCartLineStretch(PmCartLine* line, double size, int from_end) {
  if (line == nullptr || line->tmag_zero != 0 || size <= DOUBLE_FUZZ) return said(PM_ERR);
  if (from_end != 0)
    line->start = minus(line->end, times(line->uVec, size));
  else
    line->end = plus(line->start, times(line->uVec, size));
  line->tmag = size;
  return said(PM_OK);
}

// ---- arcs

int pmCircleInit(PmCircle* circle, const V* start, const V* end, const V* center, const V* normal,
                 int turns) {
  PmCircle made{};
  const int plane = unit(*normal, made.normal);
  if (plane != PM_OK) return said(PM_ERR);
  // The centre belongs to the start's plane; what lies along the normal is the helix.
  const V out = minus(*start, *center);
  made.center = plus(*center, times(made.normal, dot(out, made.normal)));
  made.rTan = minus(*start, made.center);
  made.radius = length(made.rTan);
  made.rPerp = cross(made.normal, made.rTan);
  const V to_end = minus(*end, made.center);
  made.rHelix = times(made.normal, dot(to_end, made.normal));
  const V flat_end = minus(to_end, made.rHelix);
  const double end_radius = length(flat_end);
  made.spiral = end_radius - made.radius;
  if (made.radius < CIRCLE_FUZZ || end_radius < CIRCLE_FUZZ) return said(PM_ERR);
  double angle = std::atan2(dot(flat_end, made.rPerp), dot(flat_end, made.rTan));
  if (turns >= 0) {
    if (angle <= CIRCLE_FUZZ) angle += PM_2_PI;
    angle += turns * PM_2_PI;
  } else {
    // The other way round: about the opposite normal.
    if (angle >= -CIRCLE_FUZZ) angle -= PM_2_PI;
    angle = -angle - (turns + 1) * PM_2_PI;
    made.normal = times(made.normal, -1);
    made.rPerp = times(made.rPerp, -1);
  }
  made.angle = angle;
  *circle = made;
  return said(PM_OK);
}
int pmCirclePoint(const PmCircle* circle, double angle, V* point) {
  if (circle->angle == 0) return said(PM_DIV_ERR);
  const double share = angle / circle->angle;
  V out = plus(times(circle->rTan, std::cos(angle)), times(circle->rPerp, std::sin(angle)));
  if (circle->radius > 0)
    out = times(out, (circle->radius + circle->spiral * share) / circle->radius);
  *point = plus(plus(circle->center, out), times(circle->rHelix, share));
  return said(PM_OK);
}
int pmCircleStretch(PmCircle* circle, double angle, int from_end) {
  if (circle == nullptr || std::abs(angle) <= DOUBLE_FUZZ) return said(PM_ERR);
  const double ratio = angle / circle->angle;
  if (from_end != 0) {
    // The start goes back along the arc.
    const double back = circle->angle - angle;
    const V tan = circle->rTan;
    const double radius = circle->radius + circle->spiral * (back / circle->angle);
    const double grown = radius / circle->radius;
    circle->center = plus(circle->center, times(circle->rHelix, back / circle->angle));
    circle->rTan =
        times(plus(times(tan, std::cos(back)), times(circle->rPerp, std::sin(back))), grown);
    circle->rPerp = cross(circle->normal, circle->rTan);
    circle->radius = radius;
  }
  circle->rHelix = times(circle->rHelix, ratio);
  circle->spiral *= ratio;
  circle->angle = angle;
  return said(PM_OK);
}

}  // extern "C"
