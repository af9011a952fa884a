/* A point in space, as positions hold it. */
#ifndef POSEMATH_TYPES_H
#define POSEMATH_TYPES_H

typedef struct PmCartesian {
  double x, y, z;
} PmCartesian;

#endif
