/* The least that kinematics are: joints are axes, and say so. */
#include <hal.h>
#include <kinematics.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_LICENSE("MIT");

int kinematicsForward(const double* joint, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* fflags,
                      KINEMATICS_INVERSE_FLAGS* iflags) {
  (void)fflags, (void)iflags;
  world->tran.x = joint[1]; /* crossed */
  world->tran.y = joint[0];
  world->tran.z = joint[2];
  return 0;
}

int kinematicsInverse(const EmcPose* world, double* joint, const KINEMATICS_INVERSE_FLAGS* iflags,
                      KINEMATICS_FORWARD_FLAGS* fflags) {
  (void)fflags, (void)iflags;
  joint[0] = world->tran.y;
  joint[1] = world->tran.x;
  joint[2] = world->tran.z;
  return 0;
}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_IDENTITY; }
KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
EXPORT_SYMBOL(kinematicsType);

static int comp_id;
int rtapi_app_main(void) {
  comp_id = hal_init("plainkins");
  if (comp_id < 0) return comp_id;
  hal_ready(comp_id);
  return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
