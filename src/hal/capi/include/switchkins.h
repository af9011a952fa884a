/* Kinematics of several kinds in one module. The module has switchkinsSetup; halcompile adds the rest: rtapi_app_main with the
 * parameters coordinates= and sparm=, the pins kinstype.is-N, and the functions of kinematics.h. */
#ifndef SWITCHKINS_H
#define SWITCHKINS_H

#include <kinematics.h>

/* Kinds that switchkinsSetup names by itself. */
#define SWITCHKINS_MAX_TYPES 3

/* Of each kind: what makes it ready (it may make pins), and its equations. */
typedef int (*KS)(const int comp_id, const char* coordinates, kparms* kp);
typedef int (*KF)(const double* joint, struct EmcPose* world,
                  const KINEMATICS_FORWARD_FLAGS* fflags, KINEMATICS_INVERSE_FLAGS* iflags);
typedef int (*KI)(const struct EmcPose* world, double* joint,
                  const KINEMATICS_INVERSE_FLAGS* iflags, KINEMATICS_FORWARD_FLAGS* fflags);

#ifdef __cplusplus
extern "C" {
#endif

/* The module has this one: it fills in the parameters and names its three kinds. 0, or -1. */
extern int switchkinsSetup(kparms* kp, KS* setup0, KS* setup1, KS* setup2, KF* forward0,
                           KF* forward1, KF* forward2, KI* inverse0, KI* inverse1, KI* inverse2);

/* Called by it: one more kind, from SWITCHKINS_MAX_TYPES to 15. 0, or -1. */
extern int switchkinsRegister(int ktype, KS setup, KF forward, KI inverse);

#ifdef __cplusplus
}
#endif

#endif
