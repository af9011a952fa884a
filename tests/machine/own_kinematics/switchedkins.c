/* A machine with an arm that turns and a slide along it, of three kinds: kind 0 is the arm, kind 1 identity, kind 2 what the user adds.
 * As vendors write them: switchkinsSetup, and the common part has the main. */
#include <hal.h>
#include <kinematics.h>
#include <rtapi.h>
#include <rtapi_math.h>
#include <rtapi_string.h>
#include <switchkins.h>

static struct data { hal_float_t* arm; /* how much longer the radius is than joint 0 */ } * data;

static int axis_of[3];

static int arm_setup(const int comp_id, const char* coordinates, kparms* kp) {
  if (map_coordinates_to_jnumbers(coordinates, kp->max_joints, kp->allow_duplicates, axis_of) != 0)
    return -1;
  if (axis_of[0] != 0 || axis_of[1] != 1 || axis_of[2] != 2) return -1;
  data = hal_malloc(sizeof *data);
  if (data == NULL) return -1;
  if (hal_pin_float_newf(HAL_IN, &data->arm, comp_id, "%s.arm", kp->halprefix) != 0) return -1;
  *data->arm = 20;
  return 0;
}

static int arm_forward(const double* joint, struct EmcPose* world,
                       const KINEMATICS_FORWARD_FLAGS* fflags, KINEMATICS_INVERSE_FLAGS* iflags) {
  (void)fflags, (void)iflags;
  world->tran.x = (joint[0] + *data->arm) * cos(joint[1] * M_PI / 180);
  world->tran.y = (joint[0] + *data->arm) * sin(joint[1] * M_PI / 180);
  world->tran.z = joint[2];
  return 0;
}

static int arm_inverse(const struct EmcPose* world, double* joint,
                       const KINEMATICS_INVERSE_FLAGS* iflags, KINEMATICS_FORWARD_FLAGS* fflags) {
  const double radius = hypot(world->tran.x, world->tran.y);
  (void)fflags, (void)iflags;
  if (radius < *data->arm) return -1;
  joint[0] = radius - *data->arm;
  joint[1] = atan2(world->tran.y, world->tran.x) * 180 / M_PI;
  joint[2] = world->tran.z;
  return 0;
}

int switchkinsSetup(kparms* kp, KS* kset0, KS* kset1, KS* kset2, KF* kfwd0, KF* kfwd1, KF* kfwd2,
                    KI* kinv0, KI* kinv1, KI* kinv2) {
  kp->kinsname = "switchedkins";
  kp->halprefix = "switchedkins";
  kp->required_coordinates = "xyz";
  kp->allow_duplicates = 0;
  kp->max_joints = 3;
  kp->fwd_iterates_mask = 1;
  kp->gui_kinstype = 0;
  *kset0 = arm_setup;
  *kfwd0 = arm_forward;
  *kinv0 = arm_inverse;
  *kset1 = identityKinematicsSetup;
  *kfwd1 = identityKinematicsForward;
  *kinv1 = identityKinematicsInverse;
  *kset2 = userkKinematicsSetup;
  *kfwd2 = userkKinematicsForward;
  *kinv2 = userkKinematicsInverse;
  if (kp->sparm != NULL && strcmp(kp->sparm, "identityfirst") == 0) {
    KS setup = *kset0;
    KF forward = *kfwd0;
    KI inverse = *kinv0;
    *kset0 = *kset1, *kfwd0 = *kfwd1, *kinv0 = *kinv1;
    *kset1 = setup, *kfwd1 = forward, *kinv1 = inverse;
    kp->fwd_iterates_mask = 2;
    kp->gui_kinstype = 1;
  }
  return 0;
}
