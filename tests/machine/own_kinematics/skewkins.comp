component skewkins "Three axes of which Y is not square, as a template for kinematics of one's own";
description """
Joint 0 is X less `skew` times Y. As in LinuxCNC's template, the pins of the kinematics are made when the motion controller asks for their
type; the pin and the function below are the component's own.
""";
pin out s32 calls = 0 "How often the function ran";
function count;
license "MIT";
author "Kerf";
option singleton yes;
;;
#include <kinematics.h>

static struct data {
  hal_float_t *skew;
} *data;

static int make_pins(void) {
  if (hal_set_unready(comp_id) != 0) return -1;
  data = hal_malloc(sizeof *data);
  if (data == NULL) return -1;
  if (hal_pin_float_newf(HAL_IN, &data->skew, comp_id, "skewkins.skew") != 0) return -1;
  *data->skew = 0.25;
  return hal_ready(comp_id);
}

KINEMATICS_TYPE kinematicsType(void) {
  static int made;
  if (!made && make_pins() != 0) rtapi_print_msg(RTAPI_MSG_ERR, "skewkins: no pins\n");
  made = 1;
  return KINEMATICS_BOTH;
}

int kinematicsForward(const double *joint, EmcPose *world, const KINEMATICS_FORWARD_FLAGS *fflags,
                      KINEMATICS_INVERSE_FLAGS *iflags) {
  (void)fflags, (void)iflags;
  world->tran.y = joint[1];
  world->tran.x = joint[0] + *data->skew * joint[1];
  world->tran.z = joint[2];
  return 0;
}

int kinematicsInverse(const EmcPose *world, double *joint, const KINEMATICS_INVERSE_FLAGS *iflags,
                      KINEMATICS_FORWARD_FLAGS *fflags) {
  (void)fflags, (void)iflags;
  joint[0] = world->tran.x - *data->skew * world->tran.y;
  joint[1] = world->tran.y;
  joint[2] = world->tran.z;
  return 0;
}

KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

FUNCTION(count) { calls = calls + 1; }
