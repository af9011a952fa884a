/* Vectors, rotations, poses, lines and arcs. Functions give 0 (PM_OK), or a negative number that pmErrno then holds too; the result
   may be one of the operands. */
#ifndef POSEMATH_H
#define POSEMATH_H

#include <posemath_types.h>

#define PM_PI 3.14159265358979323846
#define PM_PI_2 1.57079632679489661923
#define PM_PI_4 0.78539816339744830962
#define PM_2_PI 6.28318530717958647692
#ifndef TO_DEG
#define TO_DEG (180. / PM_PI)
#endif
#ifndef TO_RAD
#define TO_RAD (PM_PI / 180.)
#endif

#define PM_OK 0
#define PM_ERR (-1)
#define PM_IMPL_ERR (-2)
#define PM_NORM_ERR (-3)
#define PM_DIV_ERR (-4)

/* What counts as nothing. */
#define DOUBLE_FUZZ 2.2204460492503131e-16
#define DOUBLECP_FUZZ 1.0842021724855044e-19
#define CART_FUZZ 1.0e-8
#define V_FUZZ 1.0e-8
#define Q_FUZZ 1.0e-6
#define QS_FUZZ 1.0e-6
#define QSIN_FUZZ 1.0e-6
#define SQRT_FUZZ (-1.0e-6)
#define UNIT_VEC_FUZZ 1.0e-6
#define UNIT_QUAT_FUZZ 1.0e-6
#define UNIT_SC_FUZZ 1.0e-6
#define E_EPSILON 1.0e-6
#define SINGULAR_EPSILON 1.0e-6
#define RPY_P_FUZZ 1.0e-6
#define ZYZ_Y_FUZZ 1.0e-6
#define ZYX_Y_FUZZ 1.0e-6
#define CIRCLE_FUZZ 1.0e-6

#ifdef __cplusplus
extern "C" {
#endif

extern int pmErrno;

int pmAxisAngleQuatConvert(PM_AXIS, double, PmQuaternion*);
int pmCartAbs(const PmCartesian*, PmCartesian*);
int pmCartCartAdd(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartAddEq(PmCartesian*, const PmCartesian*);
int pmCartCartCompare(const PmCartesian*, const PmCartesian*);
int pmCartCartCross(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartDisp(const PmCartesian*, const PmCartesian*, double*);
int pmCartCartDiv(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartDot(const PmCartesian*, const PmCartesian*, double*);
int pmCartCartMult(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartProj(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartSub(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartCartSubEq(PmCartesian*, const PmCartesian*);
int pmCartCylConvert(const PmCartesian*, PmCylindrical*);
int pmCartInfNorm(const PmCartesian*, double*);
int pmCartInv(const PmCartesian*, PmCartesian*);
int pmCartInvEq(PmCartesian*);
int pmCartIsNorm(const PmCartesian*);
int pmCartLineInit(PmCartLine*, const PmCartesian*, const PmCartesian*);
int pmCartLinePoint(const PmCartLine*, double, PmCartesian*);
int pmCartLineStretch(PmCartLine*, double, int);
int pmCartMag(const PmCartesian*, double*);
int pmCartMagSq(const PmCartesian*, double*);
int pmCartNeg(const PmCartesian*, PmCartesian*);
int pmCartNegEq(PmCartesian*);
int pmCartPlaneProj(const PmCartesian*, const PmCartesian*, PmCartesian*);
int pmCartScalDiv(const PmCartesian*, double, PmCartesian*);
int pmCartScalDivEq(PmCartesian*, double);
int pmCartScalMult(const PmCartesian*, double, PmCartesian*);
int pmCartScalMultEq(PmCartesian*, double);
int pmCartSphConvert(const PmCartesian*, PmSpherical*);
int pmCartUnit(const PmCartesian*, PmCartesian*);
int pmCartUnitEq(PmCartesian*);
int pmCircleInit(PmCircle*, const PmCartesian*, const PmCartesian*, const PmCartesian*,
                 const PmCartesian*, int);
int pmCirclePoint(const PmCircle*, double, PmCartesian*);
int pmCircleStretch(PmCircle*, double, int);
int pmCylCartConvert(const PmCylindrical*, PmCartesian*);
int pmCylSphConvert(const PmCylindrical*, PmSpherical*);
int pmHomInv(const PmHomogeneous*, PmHomogeneous*);
int pmHomPoseConvert(const PmHomogeneous*, PmPose*);
int pmLineInit(PmLine*, const PmPose*, const PmPose*);
int pmLinePoint(const PmLine*, double, PmPose*);
int pmMatCartMult(const PmRotationMatrix*, const PmCartesian*, PmCartesian*);
int pmMatInv(const PmRotationMatrix*, PmRotationMatrix*);
int pmMatIsNorm(const PmRotationMatrix*);
int pmMatMatMult(const PmRotationMatrix*, const PmRotationMatrix*, PmRotationMatrix*);
int pmMatNorm(const PmRotationMatrix*, PmRotationMatrix*);
int pmMatQuatConvert(const PmRotationMatrix*, PmQuaternion*);
int pmMatRotConvert(const PmRotationMatrix*, PmRotationVector*);
int pmMatRpyConvert(const PmRotationMatrix*, PmRpy*);
int pmMatZyxConvert(const PmRotationMatrix*, PmEulerZyx*);
int pmMatZyzConvert(const PmRotationMatrix*, PmEulerZyz*);
int pmPoseCartMult(const PmPose*, const PmCartesian*, PmCartesian*);
int pmPoseHomConvert(const PmPose*, PmHomogeneous*);
int pmPoseInv(const PmPose*, PmPose*);
int pmPosePoseCompare(const PmPose*, const PmPose*);
int pmPosePoseMult(const PmPose*, const PmPose*, PmPose*);
int pmQuatAxisAngleMult(const PmQuaternion*, PM_AXIS, double, PmQuaternion*);
int pmQuatCartMult(const PmQuaternion*, const PmCartesian*, PmCartesian*);
int pmQuatInv(const PmQuaternion*, PmQuaternion*);
int pmQuatIsNorm(const PmQuaternion*);
int pmQuatMag(const PmQuaternion*, double*);
int pmQuatMatConvert(const PmQuaternion*, PmRotationMatrix*);
int pmQuatNorm(const PmQuaternion*, PmQuaternion*);
int pmQuatQuatCompare(const PmQuaternion*, const PmQuaternion*);
int pmQuatQuatMult(const PmQuaternion*, const PmQuaternion*, PmQuaternion*);
int pmQuatRotConvert(const PmQuaternion*, PmRotationVector*);
int pmQuatRpyConvert(const PmQuaternion*, PmRpy*);
int pmQuatScalDiv(const PmQuaternion*, double, PmQuaternion*);
int pmQuatScalMult(const PmQuaternion*, double, PmQuaternion*);
int pmQuatZyxConvert(const PmQuaternion*, PmEulerZyx*);
int pmQuatZyzConvert(const PmQuaternion*, PmEulerZyz*);
int pmRotIsNorm(const PmRotationVector*);
int pmRotMatConvert(const PmRotationVector*, PmRotationMatrix*);
int pmRotNorm(const PmRotationVector*, PmRotationVector*);
int pmRotQuatConvert(const PmRotationVector*, PmQuaternion*);
int pmRotRpyConvert(const PmRotationVector*, PmRpy*);
int pmRotScalDiv(const PmRotationVector*, double, PmRotationVector*);
int pmRotScalMult(const PmRotationVector*, double, PmRotationVector*);
int pmRotZyxConvert(const PmRotationVector*, PmEulerZyx*);
int pmRotZyzConvert(const PmRotationVector*, PmEulerZyz*);
int pmRpyMatConvert(const PmRpy*, PmRotationMatrix*);
int pmRpyQuatConvert(const PmRpy*, PmQuaternion*);
int pmRpyRotConvert(const PmRpy*, PmRotationVector*);
int pmRpyZyxConvert(const PmRpy*, PmEulerZyx*);
int pmRpyZyzConvert(const PmRpy*, PmEulerZyz*);
int pmSphCartConvert(const PmSpherical*, PmCartesian*);
int pmSphCylConvert(const PmSpherical*, PmCylindrical*);
double pmSqrt(double);
int pmZyxMatConvert(const PmEulerZyx*, PmRotationMatrix*);
int pmZyxQuatConvert(const PmEulerZyx*, PmQuaternion*);
int pmZyxRotConvert(const PmEulerZyx*, PmRotationVector*);
int pmZyxRpyConvert(const PmEulerZyx*, PmRpy*);
int pmZyxZyzConvert(const PmEulerZyx*, PmEulerZyz*);
int pmZyzMatConvert(const PmEulerZyz*, PmRotationMatrix*);
int pmZyzQuatConvert(const PmEulerZyz*, PmQuaternion*);
int pmZyzRotConvert(const PmEulerZyz*, PmRotationVector*);
int pmZyzRpyConvert(const PmEulerZyz*, PmRpy*);

#ifdef __cplusplus
} /* extern "C" */
#include <posemath.hh>
#endif

#endif
