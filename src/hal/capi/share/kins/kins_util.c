/* Helpers of kinematics.h for modules in C: which letter is which joint, and identity kinematics. halcompile links them with modules
 * that use them. */
#include <hal.h>
#include <kinematics.h>
#include <rtapi.h>
#include <rtapi_string.h>

enum { most_joints = 16, axes = 9 };

static const char letters[] = "XYZABCUVW";
static int axis_of[most_joints];
static int mapped;

static double* axis_at(EmcPose* pose, int axis) {
  switch (axis) {
    case 0: return &pose->tran.x;
    case 1: return &pose->tran.y;
    case 2: return &pose->tran.z;
    case 3: return &pose->a;
    case 4: return &pose->b;
    case 5: return &pose->c;
    case 6: return &pose->u;
    case 7: return &pose->v;
    default: return &pose->w;
  }
}

int map_coordinates_to_jnumbers(const char* coordinates, const int max_joints,
                                const int allow_duplicates, int axis_idx_for_jno[]) {
  int found[most_joints], used[axes] = {0}, joints = 0;
  const char* at;
  int j;
  if (max_joints < 1 || max_joints > most_joints) {
    rtapi_print_msg(RTAPI_MSG_ERR, "kinematics: max_joints is %d, must be between 1 and %d\n",
                    max_joints, most_joints);
    return -1;
  }
  for (j = 0; j < most_joints; ++j) found[j] = -1;
  for (at = coordinates != NULL ? coordinates : ""; *at != 0; ++at) {
    const char letter = *at >= 'a' && *at <= 'z' ? (char)(*at - 'a' + 'A') : *at;
    int axis = 0;
    if (letter == ' ' || letter == '\t' || letter == ',') continue;
    while (axis < axes && letters[axis] != letter) ++axis;
    if (axis == axes) {
      rtapi_print_msg(RTAPI_MSG_ERR, "kinematics: coordinates=%s: '%c' is none of XYZABCUVW\n",
                      coordinates, *at);
      return -1;
    }
    if (used[axis] && !allow_duplicates) {
      rtapi_print_msg(RTAPI_MSG_ERR, "kinematics: coordinates=%s: '%c' stands there twice\n",
                      coordinates, *at);
      return -1;
    }
    if (joints == max_joints) {
      rtapi_print_msg(RTAPI_MSG_ERR, "kinematics: coordinates=%s: more than %d joints\n",
                      coordinates, max_joints);
      return -1;
    }
    used[axis] = 1;
    found[joints++] = axis;
  }
  if (joints == 0) {
    rtapi_print_msg(RTAPI_MSG_ERR, "kinematics: coordinates= has no letter\n");
    return -1;
  }
  for (j = 0; j < most_joints; ++j) axis_of[j] = found[j];
  if (axis_idx_for_jno != NULL)
    for (j = 0; j < max_joints; ++j) axis_idx_for_jno[j] = found[j];
  mapped = 1;
  return 0;
}

int mapped_joints_to_position(const int max_joints, const double* joints, EmcPose* pose) {
  int j;
  if (!mapped) return -1;
  for (j = (max_joints < most_joints ? max_joints : most_joints) - 1; j >= 0; --j)
    if (axis_of[j] >= 0) *axis_at(pose, axis_of[j]) = joints[j];
  return 0;
}

int position_to_mapped_joints(const int max_joints, const EmcPose* pose, double* joints) {
  EmcPose copy = *pose;
  int j;
  if (!mapped) return -1;
  for (j = 0; j < max_joints && j < most_joints; ++j)
    if (axis_of[j] >= 0) joints[j] = *axis_at(&copy, axis_of[j]);
  return 0;
}

int identityKinematicsSetup(const int comp_id, const char* coordinates, kparms* kp) {
  (void)comp_id;
  return map_coordinates_to_jnumbers(coordinates, kp->max_joints, kp->allow_duplicates, NULL);
}

int identityKinematicsForward(const double* joint, struct EmcPose* world,
                              const KINEMATICS_FORWARD_FLAGS* fflags,
                              KINEMATICS_INVERSE_FLAGS* iflags) {
  (void)fflags, (void)iflags;
  return mapped_joints_to_position(most_joints, joint, world);
}

int identityKinematicsInverse(const struct EmcPose* world, double* joint,
                              const KINEMATICS_INVERSE_FLAGS* iflags,
                              KINEMATICS_FORWARD_FLAGS* fflags) {
  (void)iflags, (void)fflags;
  return position_to_mapped_joints(most_joints, world, joint);
}

__attribute__((weak)) int userkKinematicsSetup(const int comp_id, const char* coordinates,
                                               kparms* kp) {
  return identityKinematicsSetup(comp_id, coordinates, kp);
}

__attribute__((weak)) int userkKinematicsForward(const double* joint, struct EmcPose* world,
                                                 const KINEMATICS_FORWARD_FLAGS* fflags,
                                                 KINEMATICS_INVERSE_FLAGS* iflags) {
  return identityKinematicsForward(joint, world, fflags, iflags);
}

__attribute__((weak)) int userkKinematicsInverse(const struct EmcPose* world, double* joint,
                                                 const KINEMATICS_INVERSE_FLAGS* iflags,
                                                 KINEMATICS_FORWARD_FLAGS* fflags) {
  return identityKinematicsInverse(world, joint, iflags, fflags);
}
