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

/* What a module of several kinds says about itself (switchkins.h). */
typedef struct kinematics_parms {
  char* sparm;                /* the module's parameter of that name */
  char* kinsname;             /* of the component and its file */
  char* halprefix;            /* of its pins */
  char* required_coordinates; /* letters that coordinates= must have; its default too */
  int max_joints;
  int allow_duplicates;  /* a letter may stand for several joints */
  int fwd_iterates_mask; /* bit n: the forward equations of kind n start from the last position */
  int gui_kinstype; /* the kind that a preview computes with, on pins skgui.x to skgui.c; -1: none */
} kparms;

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

/* Helpers, which halcompile links with modules that use them. Letters get joints in their order: "XYZY" makes Y joints 1 and 3.
 * axis_idx_for_jno has max_joints places, 0 for X to 8 for W, -1 where there is no letter. 0, or -1 when that cannot be. */
extern int map_coordinates_to_jnumbers(const char* coordinates, const int max_joints,
                                       const int allow_duplicates, int axis_idx_for_jno[]);
/* By the letters mapped last. Of the joints of one letter the first says where the axis is. */
extern int mapped_joints_to_position(const int max_joints, const double* joints, EmcPose* pose);
extern int position_to_mapped_joints(const int max_joints, const EmcPose* pose, double* joints);

/* A kind of equations that are none: each joint is an axis. */
extern int identityKinematicsSetup(const int comp_id, const char* coordinates, kparms* kp);
extern int identityKinematicsForward(const double* joint, struct EmcPose* world,
                                     const KINEMATICS_FORWARD_FLAGS* fflags,
                                     KINEMATICS_INVERSE_FLAGS* iflags);
extern int identityKinematicsInverse(const struct EmcPose* world, double* joint,
                                     const KINEMATICS_INVERSE_FLAGS* iflags,
                                     KINEMATICS_FORWARD_FLAGS* fflags);

/* A place for a kind of the user's own, beside a vendor's source; identity when nobody defines them. */
extern int userkKinematicsSetup(const int comp_id, const char* coordinates, kparms* kp);
extern int userkKinematicsForward(const double* joint, struct EmcPose* world,
                                  const KINEMATICS_FORWARD_FLAGS* fflags,
                                  KINEMATICS_INVERSE_FLAGS* iflags);
extern int userkKinematicsInverse(const struct EmcPose* world, double* joint,
                                  const KINEMATICS_INVERSE_FLAGS* iflags,
                                  KINEMATICS_FORWARD_FLAGS* fflags);

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
