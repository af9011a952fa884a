/* A position in nine axes. */
#ifndef EMCPOSE_H
#define EMCPOSE_H

#include <posemath_types.h>

typedef struct EmcPose {
  PmCartesian tran;
  double a, b, c;
  double u, v, w;
} EmcPose;

#define ZERO_EMC_POSE(pos) \
  do {                     \
    (pos).tran.x = 0.0;    \
    (pos).tran.y = 0.0;    \
    (pos).tran.z = 0.0;    \
    (pos).a = 0.0;         \
    (pos).b = 0.0;         \
    (pos).c = 0.0;         \
    (pos).u = 0.0;         \
    (pos).v = 0.0;         \
    (pos).w = 0.0;         \
  } while (0)

#endif
