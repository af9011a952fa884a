/* Kinematics of several kinds in one module. */
#ifndef SWITCHKINS_H
#define SWITCHKINS_H

#include <kinematics.h>

#define SWITCHKINS_MAX_TYPES 3

typedef struct {
  char* sparm;     /* the module's parameter of that name */
  char* kinsname;  /* of the component */
  char* halprefix; /* of its pins */
  char* required_coordinates;
  int max_joints;
  int allow_duplicates;  /* a letter may stand for several joints */
  int fwd_iterates_mask; /* bit n: the forward equations of kind n start from the last position */
  int gui_kinstype;      /* the kind that a preview computes with; -1: none */
} kparms;

/* Of each kind: what makes it ready, and its equations. */
typedef int (*KS)(const int comp_id, const char* coordinates, kparms* kp);
typedef int (*KF)(const double* joint, struct EmcPose* world,
                  const KINEMATICS_FORWARD_FLAGS* fflags, KINEMATICS_INVERSE_FLAGS* iflags);
typedef int (*KI)(const struct EmcPose* world, double* joint,
                  const KINEMATICS_INVERSE_FLAGS* iflags, KINEMATICS_FORWARD_FLAGS* fflags);

#ifdef __cplusplus
extern "C" {
#endif

/* The module has this one: it fills in the parameters and names its three kinds. */
extern int switchkinsSetup(kparms* kp, KS* setup0, KS* setup1, KS* setup2, KF* forward0,
                           KF* forward1, KF* forward2, KI* inverse0, KI* inverse1, KI* inverse2);

#ifdef __cplusplus
}
#endif

#endif
