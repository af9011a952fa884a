/* A machine with an arm that turns and a slide along it: joint 0 is the radius, joint 1 the angle in degrees, joint 2 Z. Kind 1 is identity.
 * As a user writes one against the published functions. */
#include <hal.h>
#include <kinematics.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <rtapi_math.h>

MODULE_LICENSE("MIT");

static struct data {
  hal_float_t* arm; /* how much longer the radius is than joint 0 */
} * data;
static int comp_id, kind;

int kinematicsForward(const double* joint, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* fflags,
                      KINEMATICS_INVERSE_FLAGS* iflags) {
  (void)fflags, (void)iflags;
  world->tran.z = joint[2];
  if (kind == 1) {
    world->tran.x = joint[0];
    world->tran.y = joint[1];
    return 0;
  }
  world->tran.x = (joint[0] + *data->arm) * cos(joint[1] * M_PI / 180);
  world->tran.y = (joint[0] + *data->arm) * sin(joint[1] * M_PI / 180);
  return 0;
}

int kinematicsInverse(const EmcPose* world, double* joint, const KINEMATICS_INVERSE_FLAGS* iflags,
                      KINEMATICS_FORWARD_FLAGS* fflags) {
  (void)fflags, (void)iflags;
  joint[2] = world->tran.z;
  if (kind == 1) {
    joint[0] = world->tran.x;
    joint[1] = world->tran.y;
    return 0;
  }
  const double radius = hypot(world->tran.x, world->tran.y);
  if (radius < *data->arm) return -1; /* the slide is at its end */
  joint[0] = radius - *data->arm;
  joint[1] = atan2(world->tran.y, world->tran.x) * 180 / M_PI;
  return 0;
}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }
int kinematicsSwitchable(void) { return 1; }
int kinematicsSwitch(int wanted) {
  if (wanted < 0 || wanted > 1) return -1;
  kind = wanted;
  return 0;
}

EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsSwitchable);
EXPORT_SYMBOL(kinematicsSwitch);

int rtapi_app_main(void) {
  comp_id = hal_init("polarkins");
  if (comp_id < 0) return comp_id;
  data = hal_malloc(sizeof *data);
  if (data == NULL || hal_pin_float_new("polarkins.arm", HAL_IN, &data->arm, comp_id) != 0) {
    hal_exit(comp_id);
    return -1;
  }
  *data->arm = 20;
  hal_ready(comp_id);
  return 0;
}

void rtapi_app_exit(void) { hal_exit(comp_id); }
