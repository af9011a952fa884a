component tiltkins "Kinematics of a machine whose Y leans";
description "Kinematics as users write them: functions for the motion controller, pins of their own made by a second component.";
pin out s32 fpin = 0 "a pin of the ordinary kind";
function fdemo;
license "GPL";
author "Kerf";
;;
#include "rtapi_math.h"
#include "kinematics.h"

static struct haldata {
    hal_float_t *angle;
    hal_u32_t *calls;
} *haldata;

FUNCTION(fdemo) { fpin = haldata ? (int)*haldata->calls : -1; }

static int tilt_setup(void) {
    int r = 0, id = hal_init("tiltdata");
    if (id < 0) return id;
    haldata = hal_malloc(sizeof(struct haldata));
    if (!haldata) return -1;
    r += hal_pin_float_newf(HAL_IN, &haldata->angle, id, "tiltkins.angle");
    r += hal_pin_u32_newf(HAL_OUT, &haldata->calls, id, "tiltkins.calls");
    if (r) { hal_exit(id); return -1; }
    *haldata->angle = 0.25;
    hal_ready(id);
    return 0;
}

KINEMATICS_TYPE kinematicsType(void) {
    static int ready;
    if (!ready) { ready = 1; if (tilt_setup()) return 0; }
    return KINEMATICS_BOTH;
}

int kinematicsForward(const double *j, EmcPose *pos, const KINEMATICS_FORWARD_FLAGS *f, KINEMATICS_INVERSE_FLAGS *i) {
    (void)f; (void)i;
    ++*haldata->calls;
    pos->tran.x = j[0] + j[1] * sin(*haldata->angle);
    pos->tran.y = j[1] * cos(*haldata->angle);
    pos->tran.z = j[2];
    return 0;
}

int kinematicsInverse(const EmcPose *pos, double *j, const KINEMATICS_INVERSE_FLAGS *i, KINEMATICS_FORWARD_FLAGS *f) {
    (void)f; (void)i;
    j[1] = pos->tran.y / cos(*haldata->angle);
    j[0] = pos->tran.x - j[1] * sin(*haldata->angle);
    j[2] = pos->tran.z;
    return 0;
}

KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
