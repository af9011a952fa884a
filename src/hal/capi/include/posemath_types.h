/* What posemath.h computes with. Angles are in radians. */
#ifndef POSEMATH_TYPES_H
#define POSEMATH_TYPES_H

typedef struct PmCartesian {
  double x, y, z;
} PmCartesian;

/* theta: from the x axis, in the xy plane; phi: from the z axis. */
typedef struct PmSpherical {
  double theta, phi, r;
} PmSpherical;

typedef struct PmCylindrical {
  double theta, r, z;
} PmCylindrical;

typedef enum { PM_X = 0, PM_Y = 1, PM_Z = 2 } PM_AXIS;

/* A turn by s about the unit vector. */
typedef struct PmRotationVector {
  double s, x, y, z;
} PmRotationVector;

/* The columns: where the unit vectors go. */
typedef struct PmRotationMatrix {
  PmCartesian x, y, z;
} PmRotationMatrix;

typedef struct PmQuaternion {
  double s, x, y, z;
} PmQuaternion;

/* Turns about z, then the new y, then the newest z. */
typedef struct PmEulerZyz {
  double z, y, zp;
} PmEulerZyz;

/* Turns about z, then the new y, then the newest x. */
typedef struct PmEulerZyx {
  double z, y, x;
} PmEulerZyx;

/* Turns about the fixed x (roll), then y (pitch), then z (yaw). */
typedef struct PmRpy {
  double r, p, y;
} PmRpy;

typedef struct PmPose {
  PmCartesian tran;
  PmQuaternion rot;
} PmPose;

typedef struct PmHomogeneous {
  PmCartesian tran;
  PmRotationMatrix rot;
} PmHomogeneous;

/* A move along a line. uVec: its direction; qVec: its turn, by 1 radian of it; tmag, rmag: how far; *_zero: it does not move, or turn. */
typedef struct PmLine {
  PmPose start, end;
  PmCartesian uVec;
  PmQuaternion qVec;
  double tmag, rmag;
  int tmag_zero, rmag_zero;
} PmLine;

typedef struct PmCartLine {
  PmCartesian start, end;
  PmCartesian uVec;
  double tmag;
  int tmag_zero;
} PmCartLine;

/* An arc, helix or spiral. rTan: from the centre to the start; rPerp: as long, a quarter turn further; rHelix: the way along the
   normal; spiral: how much the radius grows over the whole angle. */
typedef struct PmCircle {
  PmCartesian center, normal, rTan, rPerp, rHelix;
  double radius, angle, spiral;
} PmCircle;

#endif
