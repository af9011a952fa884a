halcompile --compile tiltkins.comp
nm -D --defined-only tiltkins.so | awk '{print $3}' | sort
cat > probe.c <<'C'
#include <hal.h>
#include <rtapi_app.h>
#include <rtapi_math.h>
#include "kinematics.h"
static hal_float_t **err;
static int id;
int rtapi_app_main(void) {
    EmcPose p = {{0}};
    double j[9] = {10, 20, 30}, back[9] = {0};
    KINEMATICS_FORWARD_FLAGS f = 0;
    KINEMATICS_INVERSE_FLAGS i = 0;
    id = hal_init("probe");
    err = hal_malloc(sizeof *err);
    hal_pin_float_newf(HAL_OUT, err, id, "probe.error");
    if (kinematicsType() != KINEMATICS_BOTH) return -1;
    kinematicsForward(j, &p, &f, &i);
    kinematicsInverse(&p, back, &i, &f);
    **err = fabs(back[0] - 10) + fabs(back[1] - 20) + fabs(back[2] - 30) + fabs(p.tran.x - 14.9480791850905);
    hal_ready(id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(id); }
C
halcompile --compile probe.c
cat > test.hal <<'H'
loadrt threads name1=t period1=1000000
loadrt tiltkins
loadrt probe
addf tiltkins.0.fdemo t
start
loadusr -w sleep 0.1
show pin tiltkins
show pin probe
list comp
H
halrun -f test.hal
