component userkins "Template of kinematics of one's own";
description """
Copy this file, write your equations, and compile it:

    cp userkins.comp ~/mine; cd ~/mine; halcompile --install userkins.comp

Then name it in the INI file: [KINS]KINEMATICS = userkins, JOINTS = as many as you use. Under another name, say mykins, rename the
file and every userkins in it.

As it is, it moves a machine with three joints that are X, Y and Z.

Pins that the equations need are made in userkins_setup(), which runs when the motion controller asks for the type: they are
there once motmod is loaded. The pin and the function declared above them are an ordinary component's, for whatever else belongs to
the machine; the equations cannot see them.
""";
pin out s32 fpin = 0 "How often the function ran; an example";
function fdemo "An example";
license "MIT";
author "Kerf";
;;
#include <kinematics.h>

static struct haldata {
  hal_float_t *in;  /* examples of pins of the equations */
  hal_float_t *out;
} *haldata;

static int userkins_setup(void) {
  const int id = hal_init("userkins-pins");
  if (id < 0) return -1;
  haldata = hal_malloc(sizeof *haldata);
  if (haldata == NULL || hal_pin_float_newf(HAL_IN, &haldata->in, id, "userkins.in") != 0 ||
      hal_pin_float_newf(HAL_OUT, &haldata->out, id, "userkins.out") != 0) {
    hal_exit(id);
    return -1;
  }
  return hal_ready(id);
}

/* KINEMATICS_IDENTITY while each joint is an axis, else KINEMATICS_BOTH. Any other number refuses the load. */
KINEMATICS_TYPE kinematicsType(void) {
  static int ready;
  if (!ready && userkins_setup() != 0) return 0;
  ready = 1;
  return KINEMATICS_IDENTITY;
}

/* Joints to the position of the tool. 0, or -1 where there is none. Lengths in machine units, angles in degrees. */
int kinematicsForward(const double *j, EmcPose *pos, const KINEMATICS_FORWARD_FLAGS *fflags, KINEMATICS_INVERSE_FLAGS *iflags) {
  (void)fflags, (void)iflags;
  *haldata->out = *haldata->in;
  pos->tran.x = j[0];
  pos->tran.y = j[1];
  pos->tran.z = j[2];
  return 0;
}

/* The position of the tool to joints; of several solutions the one nearest to where `j` stands. */
int kinematicsInverse(const EmcPose *pos, double *j, const KINEMATICS_INVERSE_FLAGS *iflags, KINEMATICS_FORWARD_FLAGS *fflags) {
  (void)iflags, (void)fflags;
  j[0] = pos->tran.x;
  j[1] = pos->tran.y;
  j[2] = pos->tran.z;
  return 0;
}

KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

FUNCTION(fdemo) { fpin = fpin + 1; }
