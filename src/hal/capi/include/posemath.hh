/* posemath.h for C++: the same types with operators. Each is its C type with constructors, so both may be given wherever one is wanted;
   nothing here needs more than the C functions. */
#ifndef POSEMATH_HH
#define POSEMATH_HH

#include <posemath.h>

struct PM_CARTESIAN;
struct PM_SPHERICAL;
struct PM_CYLINDRICAL;
struct PM_ROTATION_VECTOR;
struct PM_ROTATION_MATRIX;
struct PM_QUATERNION;
struct PM_EULER_ZYZ;
struct PM_EULER_ZYX;
struct PM_RPY;
struct PM_POSE;
struct PM_HOMOGENEOUS;

/* What all types have: made of nothing, of their C type, and of whatever converts. */
#define KERF_PM_BASICS(Type, CType)               \
  Type() : CType() {}                             \
  Type(const CType& other) : CType(other) {}      \
  double& operator[](int n) { return *at(n); }    \
  double operator[](int n) const { return *const_cast<Type*>(this)->at(n); }
#define KERF_PM_FROM(Type, From, convert) \
  Type(const From& from) { convert(&from, this); }

struct PM_CARTESIAN : PmCartesian {
  KERF_PM_BASICS(PM_CARTESIAN, PmCartesian)
  PM_CARTESIAN(double x_, double y_, double z_) { x = x_, y = y_, z = z_; }
  KERF_PM_FROM(PM_CARTESIAN, PmSpherical, pmSphCartConvert)
  KERF_PM_FROM(PM_CARTESIAN, PmCylindrical, pmCylCartConvert)
  PM_CARTESIAN& operator+=(const PmCartesian& o) { return pmCartCartAddEq(this, &o), *this; }
  PM_CARTESIAN& operator-=(const PmCartesian& o) { return pmCartCartSubEq(this, &o), *this; }
  PM_CARTESIAN& operator*=(double o) { return pmCartScalMultEq(this, o), *this; }
  PM_CARTESIAN& operator/=(double o) { return pmCartScalDivEq(this, o), *this; }

 private:
  double* at(int n) { return n == 0 ? &x : n == 1 ? &y : &z; }
};

struct PM_SPHERICAL : PmSpherical {
  KERF_PM_BASICS(PM_SPHERICAL, PmSpherical)
  PM_SPHERICAL(double theta_, double phi_, double r_) { theta = theta_, phi = phi_, r = r_; }
  KERF_PM_FROM(PM_SPHERICAL, PmCartesian, pmCartSphConvert)
  KERF_PM_FROM(PM_SPHERICAL, PmCylindrical, pmCylSphConvert)

 private:
  double* at(int n) { return n == 0 ? &theta : n == 1 ? &phi : &r; }
};

struct PM_CYLINDRICAL : PmCylindrical {
  KERF_PM_BASICS(PM_CYLINDRICAL, PmCylindrical)
  PM_CYLINDRICAL(double theta_, double r_, double z_) { theta = theta_, r = r_, z = z_; }
  KERF_PM_FROM(PM_CYLINDRICAL, PmCartesian, pmCartCylConvert)
  KERF_PM_FROM(PM_CYLINDRICAL, PmSpherical, pmSphCylConvert)

 private:
  double* at(int n) { return n == 0 ? &theta : n == 1 ? &r : &z; }
};

struct PM_ROTATION_VECTOR : PmRotationVector {
  KERF_PM_BASICS(PM_ROTATION_VECTOR, PmRotationVector)
  PM_ROTATION_VECTOR(double s_, double x_, double y_, double z_) { s = s_, x = x_, y = y_, z = z_; }
  KERF_PM_FROM(PM_ROTATION_VECTOR, PmQuaternion, pmQuatRotConvert)

 private:
  double* at(int n) { return n == 0 ? &s : n == 1 ? &x : n == 2 ? &y : &z; }
};

struct PM_ROTATION_MATRIX : PmRotationMatrix {
  PM_ROTATION_MATRIX() : PmRotationMatrix() {}
  PM_ROTATION_MATRIX(const PmRotationMatrix& other) : PmRotationMatrix(other) {}
  /* The columns. */
  PM_ROTATION_MATRIX(const PmCartesian& x_, const PmCartesian& y_, const PmCartesian& z_) {
    x = x_, y = y_, z = z_;
  }
  PM_ROTATION_MATRIX(double xx, double xy, double xz, double yx, double yy, double yz, double zx,
                     double zy, double zz) {
    x = {xx, xy, xz}, y = {yx, yy, yz}, z = {zx, zy, zz};
  }
  KERF_PM_FROM(PM_ROTATION_MATRIX, PmRotationVector, pmRotMatConvert)
  KERF_PM_FROM(PM_ROTATION_MATRIX, PmQuaternion, pmQuatMatConvert)
  KERF_PM_FROM(PM_ROTATION_MATRIX, PmRpy, pmRpyMatConvert)
  KERF_PM_FROM(PM_ROTATION_MATRIX, PmEulerZyz, pmZyzMatConvert)
  KERF_PM_FROM(PM_ROTATION_MATRIX, PmEulerZyx, pmZyxMatConvert)
  PM_CARTESIAN& operator[](int n) {
    return static_cast<PM_CARTESIAN&>(n == 0 ? x : n == 1 ? y : z);
  }
};

struct PM_QUATERNION : PmQuaternion {
  KERF_PM_BASICS(PM_QUATERNION, PmQuaternion)
  PM_QUATERNION(double s_, double x_, double y_, double z_) { s = s_, x = x_, y = y_, z = z_; }
  PM_QUATERNION(PM_AXIS axis, double angle) { pmAxisAngleQuatConvert(axis, angle, this); }
  KERF_PM_FROM(PM_QUATERNION, PmRotationVector, pmRotQuatConvert)
  KERF_PM_FROM(PM_QUATERNION, PmRotationMatrix, pmMatQuatConvert)
  KERF_PM_FROM(PM_QUATERNION, PmEulerZyz, pmZyzQuatConvert)
  KERF_PM_FROM(PM_QUATERNION, PmEulerZyx, pmZyxQuatConvert)
  KERF_PM_FROM(PM_QUATERNION, PmRpy, pmRpyQuatConvert)
  void axisAngleMult(PM_AXIS axis, double angle) { pmQuatAxisAngleMult(this, axis, angle, this); }

 private:
  double* at(int n) { return n == 0 ? &s : n == 1 ? &x : n == 2 ? &y : &z; }
};

struct PM_EULER_ZYZ : PmEulerZyz {
  KERF_PM_BASICS(PM_EULER_ZYZ, PmEulerZyz)
  PM_EULER_ZYZ(double z_, double y_, double zp_) { z = z_, y = y_, zp = zp_; }
  KERF_PM_FROM(PM_EULER_ZYZ, PmQuaternion, pmQuatZyzConvert)
  KERF_PM_FROM(PM_EULER_ZYZ, PmRotationMatrix, pmMatZyzConvert)

 private:
  double* at(int n) { return n == 0 ? &z : n == 1 ? &y : &zp; }
};

struct PM_EULER_ZYX : PmEulerZyx {
  KERF_PM_BASICS(PM_EULER_ZYX, PmEulerZyx)
  PM_EULER_ZYX(double z_, double y_, double x_) { z = z_, y = y_, x = x_; }
  KERF_PM_FROM(PM_EULER_ZYX, PmQuaternion, pmQuatZyxConvert)
  KERF_PM_FROM(PM_EULER_ZYX, PmRotationMatrix, pmMatZyxConvert)

 private:
  double* at(int n) { return n == 0 ? &z : n == 1 ? &y : &x; }
};

struct PM_RPY : PmRpy {
  KERF_PM_BASICS(PM_RPY, PmRpy)
  PM_RPY(double r_, double p_, double y_) { r = r_, p = p_, y = y_; }
  KERF_PM_FROM(PM_RPY, PmQuaternion, pmQuatRpyConvert)
  KERF_PM_FROM(PM_RPY, PmRotationMatrix, pmMatRpyConvert)

 private:
  double* at(int n) { return n == 0 ? &r : n == 1 ? &p : &y; }
};

/* Not derived from PmPose: the parts have operators too. They lie as PmPose's do. */
struct PM_POSE {
  PM_CARTESIAN tran;
  PM_QUATERNION rot;
  PM_POSE() {}
  PM_POSE(const PmPose& other) : tran(other.tran), rot(other.rot) {}
  PM_POSE(const PM_CARTESIAN& v, const PM_QUATERNION& q) : tran(v), rot(q) {}
  PM_POSE(double x, double y, double z, double s, double sx, double sy, double sz)
      : tran(x, y, z), rot(s, sx, sy, sz) {}
  inline PM_POSE(const PM_HOMOGENEOUS& h);
  operator PmPose() const { return PmPose{tran, rot}; }
  double& operator[](int n) { return n < 3 ? tran[n] : rot[n - 3]; }
};

struct PM_HOMOGENEOUS {
  PM_CARTESIAN tran;
  PM_ROTATION_MATRIX rot;
  PM_HOMOGENEOUS() {}
  PM_HOMOGENEOUS(const PmHomogeneous& other) : tran(other.tran), rot(other.rot) {}
  PM_HOMOGENEOUS(const PM_CARTESIAN& v, const PM_ROTATION_MATRIX& m) : tran(v), rot(m) {}
  PM_HOMOGENEOUS(const PM_POSE& p) : tran(p.tran), rot(p.rot) {}
  operator PmHomogeneous() const { return PmHomogeneous{tran, rot}; }
  /* The columns; the last is the translation. */
  PM_CARTESIAN& operator[](int n) { return n < 3 ? rot[n] : tran; }
};

inline PM_POSE::PM_POSE(const PM_HOMOGENEOUS& h) : tran(h.tran), rot(h.rot) {}

struct PM_LINE : PmLine {
  PM_LINE() : PmLine() {}
  int init(const PmPose& first, const PmPose& last) { return pmLineInit(this, &first, &last); }
  int point(double way, PM_POSE* out) const {
    PmPose p;
    const int result = pmLinePoint(this, way, &p);
    *out = p;
    return result;
  }
};

struct PM_CIRCLE : PmCircle {
  PM_CIRCLE() : PmCircle() {}
  int init(const PmPose& start, const PmPose& end, const PmCartesian& middle,
           const PmCartesian& axis, int turns) {
    return pmCircleInit(this, &start.tran, &end.tran, &middle, &axis, turns);
  }
  int point(double way, PM_POSE* out) const { return pmCirclePoint(this, way, &out->tran); }
};

#undef KERF_PM_BASICS
#undef KERF_PM_FROM

/* ---- functions */

#define KERF_PM_RESULT(Type, call) \
  Type out;                        \
  call;                            \
  return out

inline double dot(const PM_CARTESIAN& a, const PM_CARTESIAN& b) {
  KERF_PM_RESULT(double, pmCartCartDot(&a, &b, &out));
}
inline PM_CARTESIAN cross(const PM_CARTESIAN& a, const PM_CARTESIAN& b) {
  KERF_PM_RESULT(PM_CARTESIAN, pmCartCartCross(&a, &b, &out));
}
inline double mag(const PM_CARTESIAN& v) { KERF_PM_RESULT(double, pmCartMag(&v, &out)); }
inline double disp(const PM_CARTESIAN& a, const PM_CARTESIAN& b) {
  KERF_PM_RESULT(double, pmCartCartDisp(&a, &b, &out));
}
inline PM_CARTESIAN unit(const PM_CARTESIAN& v) {
  KERF_PM_RESULT(PM_CARTESIAN, pmCartUnit(&v, &out));
}
inline PM_CARTESIAN proj(const PM_CARTESIAN& a, const PM_CARTESIAN& on) {
  KERF_PM_RESULT(PM_CARTESIAN, pmCartCartProj(&a, &on, &out));
}
inline int isNorm(const PM_CARTESIAN& v) { return pmCartIsNorm(&v); }
inline int isNorm(const PM_QUATERNION& q) { return pmQuatIsNorm(&q); }
inline int isNorm(const PM_ROTATION_VECTOR& r) { return pmRotIsNorm(&r); }
inline int isNorm(const PM_ROTATION_MATRIX& m) { return pmMatIsNorm(&m); }
inline PM_CARTESIAN inv(const PM_CARTESIAN& v) {
  KERF_PM_RESULT(PM_CARTESIAN, pmCartInv(&v, &out));
}
inline PM_QUATERNION inv(const PM_QUATERNION& q) {
  KERF_PM_RESULT(PM_QUATERNION, pmQuatInv(&q, &out));
}
inline PM_ROTATION_MATRIX inv(const PM_ROTATION_MATRIX& m) {
  KERF_PM_RESULT(PM_ROTATION_MATRIX, pmMatInv(&m, &out));
}
inline PM_POSE inv(const PM_POSE& p) {
  const PmPose in = p;
  KERF_PM_RESULT(PmPose, pmPoseInv(&in, &out));
}
inline PM_HOMOGENEOUS inv(const PM_HOMOGENEOUS& h) {
  const PmHomogeneous in = h;
  KERF_PM_RESULT(PmHomogeneous, pmHomInv(&in, &out));
}

inline bool operator==(const PM_CARTESIAN& a, const PM_CARTESIAN& b) {
  return pmCartCartCompare(&a, &b) != 0;
}
inline bool operator!=(const PM_CARTESIAN& a, const PM_CARTESIAN& b) { return !(a == b); }
inline bool operator==(const PM_QUATERNION& a, const PM_QUATERNION& b) {
  return pmQuatQuatCompare(&a, &b) != 0;
}
inline bool operator!=(const PM_QUATERNION& a, const PM_QUATERNION& b) { return !(a == b); }
inline bool operator==(const PM_POSE& a, const PM_POSE& b) {
  return a.tran == b.tran && a.rot == b.rot;
}
inline bool operator!=(const PM_POSE& a, const PM_POSE& b) { return !(a == b); }

inline PM_CARTESIAN operator+(const PM_CARTESIAN& v) { return v; }
inline PM_CARTESIAN operator-(const PM_CARTESIAN& v) {
  KERF_PM_RESULT(PM_CARTESIAN, pmCartNeg(&v, &out));
}
inline PM_CARTESIAN operator+(PM_CARTESIAN a, const PM_CARTESIAN& b) { return a += b; }
inline PM_CARTESIAN operator-(PM_CARTESIAN a, const PM_CARTESIAN& b) { return a -= b; }
inline PM_CARTESIAN operator*(PM_CARTESIAN v, double d) { return v *= d; }
inline PM_CARTESIAN operator*(double d, PM_CARTESIAN v) { return v *= d; }
inline PM_CARTESIAN operator/(PM_CARTESIAN v, double d) { return v /= d; }

inline PM_QUATERNION operator+(const PM_QUATERNION& q) { return q; }
inline PM_QUATERNION operator-(const PM_QUATERNION& q) { return inv(q); }
inline PM_QUATERNION operator*(const PM_QUATERNION& q, double d) {
  KERF_PM_RESULT(PM_QUATERNION, pmQuatScalMult(&q, d, &out));
}
inline PM_QUATERNION operator*(double d, const PM_QUATERNION& q) { return q * d; }
inline PM_QUATERNION operator/(const PM_QUATERNION& q, double d) {
  KERF_PM_RESULT(PM_QUATERNION, pmQuatScalDiv(&q, d, &out));
}
inline PM_QUATERNION operator*(const PM_QUATERNION& a, const PM_QUATERNION& b) {
  KERF_PM_RESULT(PM_QUATERNION, pmQuatQuatMult(&a, &b, &out));
}
inline PM_CARTESIAN operator*(const PM_QUATERNION& q, const PM_CARTESIAN& v) {
  KERF_PM_RESULT(PM_CARTESIAN, pmQuatCartMult(&q, &v, &out));
}
inline PM_ROTATION_MATRIX operator*(const PM_ROTATION_MATRIX& a, const PM_ROTATION_MATRIX& b) {
  KERF_PM_RESULT(PM_ROTATION_MATRIX, pmMatMatMult(&a, &b, &out));
}

inline PM_POSE operator+(const PM_POSE& p) { return p; }
inline PM_POSE operator-(const PM_POSE& p) { return inv(p); }
inline PM_POSE operator*(const PM_POSE& a, const PM_POSE& b) {
  const PmPose first = a, second = b;
  KERF_PM_RESULT(PmPose, pmPosePoseMult(&first, &second, &out));
}
inline PM_CARTESIAN operator*(const PM_POSE& p, const PM_CARTESIAN& v) {
  const PmPose first = p;
  KERF_PM_RESULT(PM_CARTESIAN, pmPoseCartMult(&first, &v, &out));
}

#undef KERF_PM_RESULT

#endif
