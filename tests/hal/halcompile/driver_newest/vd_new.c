/* A filter card in floating point and 64-bit counters: what a new driver of the vendor looks like. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
typedef struct { hal_real_t in, out; hal_sint_t total; hal_uint_t calls; hal_bool_t over; hal_real_t gain; } chan_t;
static chan_t c;
static int comp_id;
static void update(void *arg, long period)
{
    (void)arg; (void)period;
    hal_set_real(c.out, hal_get_real(c.in) * hal_get_real(c.gain));
    hal_set_sint(c.total, hal_get_sint(c.total) - 3000000000LL);
    if (hal_get_uint(c.calls) < 10) hal_set_uint(c.calls, hal_get_uint(c.calls) + 1);
    hal_set_bool(c.over, hal_get_real(c.out) > 5);
}
int rtapi_app_main(void)
{
    int r;
    comp_id = hal_init("vd_new");
    if (comp_id < 0) return comp_id;
    r = hal_pin_new_real(comp_id, HAL_IN, &c.in, 1.5, "vd-new.in");
    if (!r) r = hal_pin_new_real(comp_id, HAL_OUT, &c.out, 0, "vd-new.out");
    if (!r) r = hal_pin_new_sint(comp_id, HAL_OUT, &c.total, 0, "vd-new.total");
    if (!r) r = hal_pin_new_uint(comp_id, HAL_OUT, &c.calls, 0, "vd-new.calls");
    if (!r) r = hal_pin_new_bool(comp_id, HAL_OUT, &c.over, 0, "vd-new.over");
    if (!r) r = hal_param_new_real(comp_id, HAL_RW, &c.gain, 4, "vd-new.gain");
    if (!r) r = hal_export_funct("vd-new", update, 0, 1, 0, comp_id);
    if (r) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
