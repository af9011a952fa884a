/* What a kinematics module offers to the motion controller. */
#ifndef KINEMATICS_H
#define KINEMATICS_H

#include <emcpos.h>

typedef enum {
  KINEMATICS_IDENTITY = 1,     /* joints are axes: homing and limits in both spaces are the same */
  KINEMATICS_FORWARD_ONLY = 2, /* joints to position only */
  KINEMATICS_INVERSE_ONLY = 3, /* position to joints only */
  KINEMATICS_BOTH = 4
} KINEMATICS_TYPE;

/* Which of several solutions is meant; bits have the module's own meaning. */
typedef unsigned long KINEMATICS_FORWARD_FLAGS;
typedef unsigned long KINEMATICS_INVERSE_FLAGS;

#ifdef __cplusplus
extern "C" {
#endif

/* 0, or -1 when there is no solution. */
extern int kinematicsForward(const double* joint, struct EmcPose* world,
                             const KINEMATICS_FORWARD_FLAGS* fflags,
                             KINEMATICS_INVERSE_FLAGS* iflags);
extern int kinematicsInverse(const struct EmcPose* world, double* joint,
                             const KINEMATICS_INVERSE_FLAGS* iflags,
                             KINEMATICS_FORWARD_FLAGS* fflags);
extern int kinematicsHome(struct EmcPose* world, double* joint, KINEMATICS_FORWARD_FLAGS* fflags,
                          KINEMATICS_INVERSE_FLAGS* iflags);
extern KINEMATICS_TYPE kinematicsType(void);
extern int kinematicsSwitchable(void);
extern int kinematicsSwitch(int switchkins_type);

#ifdef __cplusplus
}
#endif

/* For modules with one set of equations. */
#define KINS_NOT_SWITCHABLE                    \
  int kinematicsSwitchable(void) { return 0; } \
  int kinematicsSwitch(int ktype_) {           \
    (void)ktype_;                              \
    return 0;                                  \
  }                                            \
  EXPORT_SYMBOL(kinematicsSwitchable);         \
  EXPORT_SYMBOL(kinematicsSwitch);

#endif
