/* A servo drive: position and speed loops over a motor of first order, instances by names=. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include "rtapi_math.h"
MODULE_LICENSE("GPL");
static char *names[8] = {0,};
RTAPI_MP_ARRAY_STRING(names, 8, "names of the drives");
static int count;
RTAPI_MP_INT(count, "number of drives");
typedef struct {
    hal_float_t *command, *feedback, *speed, *torque, *error;
    hal_bit_t *enable, *in_position;
    hal_float_t kp, kv, ki, inertia, max_torque, window;
    double integral;
} drive_t;
static int comp_id;
static void run(void *arg, long period)
{
    drive_t *d = arg;
    double dt = period * 1e-9, wanted, t;
    *d->error = *d->command - *d->feedback;
    if (*d->enable) {
        wanted = d->kp * *d->error;
        d->integral += d->ki * (wanted - *d->speed) * dt;
        if (fabs(d->integral) > d->max_torque) d->integral = copysign(d->max_torque, d->integral);
        t = d->kv * (wanted - *d->speed) + d->integral;
        if (t > d->max_torque) t = d->max_torque;
        if (t < -d->max_torque) t = -d->max_torque;
    } else {
        t = -d->kv * *d->speed;
        d->integral = 0;
    }
    *d->torque = t;
    *d->speed = *d->speed + t / d->inertia * dt;
    *d->feedback = *d->feedback + *d->speed * dt;
    *d->in_position = *d->enable && fabs(*d->error) < d->window;
}
static int export_drive(drive_t *d, const char *name)
{
    int r = hal_pin_float_newf(HAL_IN, &d->command, comp_id, "%s.command", name);
    if (!r) r = hal_pin_float_newf(HAL_OUT, &d->feedback, comp_id, "%s.feedback", name);
    if (!r) r = hal_pin_float_newf(HAL_OUT, &d->speed, comp_id, "%s.speed", name);
    if (!r) r = hal_pin_float_newf(HAL_OUT, &d->torque, comp_id, "%s.torque", name);
    if (!r) r = hal_pin_float_newf(HAL_OUT, &d->error, comp_id, "%s.error", name);
    if (!r) r = hal_pin_bit_newf(HAL_IN, &d->enable, comp_id, "%s.enable", name);
    if (!r) r = hal_pin_bit_newf(HAL_OUT, &d->in_position, comp_id, "%s.in-position", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->kp, comp_id, "%s.kp", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->kv, comp_id, "%s.kv", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->ki, comp_id, "%s.ki", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->inertia, comp_id, "%s.inertia", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->max_torque, comp_id, "%s.max-torque", name);
    if (!r) r = hal_param_float_newf(HAL_RW, &d->window, comp_id, "%s.window", name);
    d->kp = 50; d->kv = 100; d->inertia = 1; d->max_torque = 1e4; d->window = 0.001;
    if (!r) r = hal_export_funct(name, run, d, 1, 0, comp_id);
    return r;
}
int rtapi_app_main(void)
{
    int i, n = 0, r = 0;
    drive_t *d;
    while (n < 8 && names[n] && *names[n]) n++;
    if (n && count) { rtapi_print_msg(RTAPI_MSG_ERR, "count= and names= are mutually exclusive\n"); return -EINVAL; }
    if (!n) n = count ? count : 1;
    comp_id = hal_init("vd_drive");
    if (comp_id < 0) return comp_id;
    d = hal_malloc(n * sizeof *d);
    if (!d) { hal_exit(comp_id); return -ENOMEM; }
    memset(d, 0, n * sizeof *d);
    for (i = 0; i < n && !r; i++) {
        char buf[HAL_NAME_LEN + 1];
        if (names[i]) rtapi_snprintf(buf, sizeof buf, "%s", names[i]);
        else rtapi_snprintf(buf, sizeof buf, "vd-drive.%d", i);
        r = export_drive(&d[i], buf);
    }
    if (r) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
