/* A PWM card: a slow function computes, a fast one makes the pulses. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include "rtapi_math.h"
MODULE_LICENSE("GPL");
static int output_type[4] = {-1, -1, -1, -1};
RTAPI_MP_ARRAY_INT(output_type, 4, "0 single, 1 with direction");
typedef struct {
    hal_float_t *value; hal_bit_t *enable, *pwm, *dir;
    hal_float_t scale, freq; hal_float_t *duty;
    hal_u32_t *high, *total;
    long long on_ns, cycle_ns, at_ns;
    int type;
} pwm_t;
static pwm_t *channels; static int n, comp_id;
static void make(void *arg, long period)
{
    int i; pwm_t *p = arg;
    for (i = 0; i < n; i++, p++) {
        if (!*p->enable || p->cycle_ns == 0) { *p->pwm = 0; continue; }
        *p->pwm = p->at_ns < p->on_ns;
        p->at_ns += period;
        if (p->at_ns >= p->cycle_ns) p->at_ns -= p->cycle_ns;
        ++*p->total;
        if (*p->pwm) ++*p->high;
    }
}
static void update(void *arg, long period)
{
    int i; pwm_t *p = arg;
    (void)period;
    for (i = 0; i < n; i++, p++) {
        double d = p->scale != 0 ? *p->value / p->scale : 0;
        if (p->type == 1) { *p->dir = d < 0; d = fabs(d); }
        if (d < 0) d = 0;
        if (d > 1) d = 1;
        *p->duty = d;
        if (p->freq < 1) p->freq = 1;
        p->cycle_ns = (long long)(1e9 / p->freq);
        p->on_ns = (long long)(d * p->cycle_ns + 0.5);
    }
}
int rtapi_app_main(void)
{
    int i, r = 0;
    while (n < 4 && output_type[n] >= 0) n++;
    if (n == 0) { rtapi_print_msg(RTAPI_MSG_ERR, "vd_pwm: ERROR: no channels\n"); return -EINVAL; }
    if ((comp_id = hal_init("vd_pwm")) < 0) return comp_id;
    channels = hal_malloc(n * sizeof *channels);
    if (!channels) { hal_exit(comp_id); return -ENOMEM; }
    memset(channels, 0, n * sizeof *channels);
    for (i = 0; i < n && !r; i++) {
        pwm_t *p = channels + i;
        char name[HAL_NAME_LEN + 1];
        p->type = output_type[i];
        p->scale = 1; p->freq = 100;
        rtapi_snprintf(name, sizeof name, "vd-pwm.%d.value", i);
        r = hal_pin_float_new(name, HAL_IN, &p->value, comp_id);
        rtapi_snprintf(name, sizeof name, "vd-pwm.%d.enable", i);
        if (!r) r = hal_pin_bit_new(name, HAL_IN, &p->enable, comp_id);
        rtapi_snprintf(name, sizeof name, "vd-pwm.%d.pwm", i);
        if (!r) r = hal_pin_bit_new(name, HAL_OUT, &p->pwm, comp_id);
        if (!r && p->type == 1) r = hal_pin_bit_newf(HAL_OUT, &p->dir, comp_id, "vd-pwm.%d.dir", i);
        if (!r) r = hal_pin_float_newf(HAL_OUT, &p->duty, comp_id, "vd-pwm.%d.duty", i);
        if (!r) r = hal_pin_u32_newf(HAL_OUT, &p->high, comp_id, "vd-pwm.%d.high", i);
        if (!r) r = hal_pin_u32_newf(HAL_OUT, &p->total, comp_id, "vd-pwm.%d.total", i);
        rtapi_snprintf(name, sizeof name, "vd-pwm.%d.scale", i);
        if (!r) r = hal_param_float_new(name, HAL_RW, &p->scale, comp_id);
        if (!r) r = hal_param_float_newf(HAL_RW, &p->freq, comp_id, "vd-pwm.%d.pwm-freq", i);
    }
    if (!r) r = hal_export_funct("vd-pwm.make-pulses", make, channels, 0, 0, comp_id);
    if (!r) r = hal_export_funct("vd-pwm.update", update, channels, 1, 0, comp_id);
    if (r) { hal_exit(comp_id); return r; }
    return hal_ready(comp_id);
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
